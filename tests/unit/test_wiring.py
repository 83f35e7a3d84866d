"""Connections: what is refused and in which words, what passes, and what arrives."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from toys import Scripted, port

from cosim import GaussSeidel, Jacobi, Link, System, WiringError
from cosim.units import parse


def instances() -> dict[str, Scripted]:
    """Return a sender and a receiver with one port of every kind that matters here."""
    unit = {"N": "N", "m": "m", "speed": "m/s", "kmh": "km/h", "celsius": "degC", "bare": None}
    sender = [port(name, "output", unit=u) for name, u in unit.items()]
    sender += [port("P", "output", shape=(2, 3)), port("four", "output", shape=(4,))]
    sender += [port("flag", "output", "Boolean"), port("n", "output", "Int32"), port("k", "parameter")]
    receiver = [port("pos", "input", unit="m"), port("v", "input", unit="m/s"), port("T", "input", unit="K")]
    receiver += [port("P", "input", shape=(2, 3)), port("three", "input", shape=(3,)), port("x", "input")]
    receiver += [port("flag", "input", "Boolean"), port("y", "output"), port("bare", "input", unit=None)]
    return {"mass": Scripted(sender), "spring": Scripted(receiver)}


REFUSED: list[tuple[Mapping[str, Any], str]] = [
    ({"sprin.v": "mass.m"}, "'sprin.v' names no component; did you mean 'spring'?"),
    ({"spring.v": "mas.m"}, "'mas.m' names no component; did you mean 'mass'?"),
    ({"spring.v": "mass.sped"}, "mass has no output 'sped'; did you mean 'speed'?"),
    ({"spring.w": "mass.m"}, "spring has no input 'w'; known: pos, v, T, P, three, x, flag, bare"),
    (
        {"spring.y": "mass.m"},
        "spring.y is declared as output and cannot be driven; inputs of spring: pos, v, T, P, three, x, flag, bare",
    ),
    (
        {"spring.v": "mass.k"},
        "mass.k is declared as parameter and cannot be a source; "
        "outputs of mass: N, m, speed, kmh, celsius, bare, P, four, flag, n",
    ),
    ({"spring.v": "mass.m"}, "cannot connect mass.m [m] to spring.v [m/s]: dimensions differ"),
    (
        {"spring.v": "mass.kmh"},
        "cannot connect mass.kmh [km/h] to spring.v [m/s]: the number would have to be multiplied by "
        "0.2777777777777778; write Link('mass.kmh', convert=True) to have it converted",
    ),
    (
        {"spring.T": "mass.celsius"},
        "cannot connect mass.celsius [degC] to spring.T [K]: the number would have to be multiplied by "
        "1.0 with 273.15 added; write Link('mass.celsius', convert=True) to have it converted",
    ),
    (
        {"spring.v": "mass.bare"},
        "cannot connect mass.bare [no unit] to spring.v [m/s]: mass.bare declares no unit; "
        "write Link('mass.bare', factor=1.0) if the two numbers mean the same",
    ),
    (
        {"spring.bare": "mass.m"},
        "cannot connect mass.m [m] to spring.bare [no unit]: spring.bare declares no unit; "
        "write Link('mass.m', factor=1.0) if the two numbers mean the same",
    ),
    (
        {"spring.flag": "mass.n"},
        "cannot connect mass.n [no unit] to spring.flag [no unit]: types Int32 and Boolean differ; "
        "connect ports of the same type",
    ),
    (
        {"spring.three": "mass.four"},
        "cannot connect mass.four [1] to spring.three [1]: shapes [4] and [3] differ; connect whole ports of the same "
        "shape, or single elements such as mass.four[1] to spring.three[1]",
    ),
    (
        {"spring.x": "mass.P"},
        "cannot connect mass.P [1] to spring.x [1]: shapes [2, 3] and [] differ; connect whole ports of the same "
        "shape, or single elements such as mass.P[1,1] to spring.x",
    ),
    ({"spring.x": "mass.P[3,1]"}, "mass.P[3,1] does not exist: P has shape [2, 3], and indices start at 1"),
    ({"spring.x": "mass.P[0,1]"}, "mass.P[0,1] does not exist: P has shape [2, 3], and indices start at 1"),
    ({"spring.x": "mass.four[1,1]"}, "mass.four[1,1] does not exist: four has shape [4], and indices start at 1"),
    (
        {"spring.P": "mass.P", "spring.P[2,3]": "mass.four[1]"},
        "spring.P[2,3] has two sources, mass.P and mass.four[1]; connect it once",
    ),
    (
        {"spring.v": {"source": "mass.kmh", "convet": True}},
        "the connection of spring.v has no setting 'convet'; did you mean 'convert'?",
    ),
    ({"spring.v": {"factor": 2.0}}, "the connection of spring.v names no source; write source = 'component.port'"),
    (
        {"spring.v": Link("mass.kmh", convert=True, factor=0.3)},
        "cannot connect mass.kmh [km/h] to spring.v [m/s]: convert=True and a factor or offset exclude each other; "
        "give one of them",
    ),
    (
        {"spring.v": Link("mass.m", factor=3.0)},
        "cannot connect mass.m [m] to spring.v [m/s]: dimensions differ",
    ),
    (
        {"spring.flag": Link("mass.flag", factor=2.0)},
        "cannot connect mass.flag [no unit] to spring.flag [no unit]: a Boolean cannot be converted; "
        "connect it without a conversion",
    ),
]


@pytest.mark.parametrize(("connections", "sentence"), REFUSED, ids=[sentence[:50] for _, sentence in REFUSED])
def test_refused_with_a_sentence(connections: Mapping[str, Any], sentence: str) -> None:
    with pytest.raises(WiringError) as caught:
        System(instances(), connections)
    assert str(caught.value) == sentence


def test_a_unit_that_cannot_be_read_is_refused_with_both_ends() -> None:
    strange = {"a": Scripted([port("y", "output", unit="furlong")]), "b": Scripted([port("u", "input", unit="m")])}
    with pytest.raises(WiringError) as caught:
        System(strange, {"b.u": "a.y"})
    assert str(caught.value) == (
        "cannot connect a.y [furlong] to b.u [m]: cannot read unit 'furlong': the symbol 'furlong' is not known"
    )


@pytest.mark.parametrize(
    ("every", "sentence"),
    [
        ({"mas": 2}, "every names no component 'mas'; did you mean 'mass'?"),
        ({"mass": 2.5}, "mass cannot step every 2.5 macro steps; give a whole number, at least 1"),
        ({"mass": 0}, "mass cannot step every 0 macro steps; give a whole number, at least 1"),
    ],
)
def test_every_is_a_whole_number_of_macro_steps(every: Any, sentence: str) -> None:
    with pytest.raises(WiringError) as caught:
        System(instances(), {}, every=every)
    assert str(caught.value) == sentence


def test_component_names_have_no_dots() -> None:
    with pytest.raises(WiringError) as caught:
        System({"a.b": Scripted([])}, {})
    assert str(caught.value) == "a component cannot be named 'a.b': ports are written component.port"


def arrived(connections: Mapping[str, Any]) -> System:
    """Return a system whose sender put 1, 2, 3, ... on its outputs, delivered to the receiver."""
    parts = instances()
    system = System(parts, connections)
    sender = parts["mass"]
    sender.pull = lambda: sender.y.__setitem__(slice(None), np.arange(1.0, len(sender.y) + 1))  # type: ignore[method-assign]
    system.collect("mass")
    system.feed("spring")
    return system


def test_arrays_and_elements_arrive_where_they_belong() -> None:
    # Positions in the sender's buffer: N, m, speed, kmh, celsius, bare are 1..6, P is 7..12, four is 13..16.
    system = arrived({"spring.P": "mass.P", "spring.x": "mass.P[2,3]", "spring.three[2]": "mass.four[4]"})
    np.testing.assert_array_equal(system["spring.P"], [[7, 8, 9], [10, 11, 12]])
    assert system["spring.x"] == 12
    np.testing.assert_array_equal(system["spring.three"], [0, 16, 0])
    assert system.unconnected == (
        "spring.pos", "spring.v", "spring.T", "spring.three[1]", "spring.three[3]", "spring.flag", "spring.bare",
    )  # fmt: skip


@pytest.mark.parametrize(
    ("target", "link", "value"),
    [
        ("spring.pos", "mass.m", 2.0),
        ("spring.v", Link("mass.kmh", convert=True), 4 / 3.6),
        ("spring.v", {"source": "mass.kmh", "factor": 0.5, "offset": 1.0}, 3.0),
        ("spring.T", Link("mass.celsius", convert=True), 278.15),
        ("spring.v", Link("mass.bare", factor=1.0), 6.0),
        ("spring.bare", "mass.bare", 6.0),
    ],
)
def test_conversions_are_made_only_where_asked_for(target: str, link: Any, value: float) -> None:
    assert arrived({target: link})[target] == pytest.approx(value, rel=1e-15)


def test_a_port_fully_driven_out_of_order_is_permuted() -> None:
    parts = {"a": Scripted([port("y", "output", shape=(2,))]), "b": Scripted([port("u", "input", shape=(2,))])}
    system = System(parts, {"b.u[2]": "a.y[1]", "b.u[1]": "a.y[2]"})
    parts["a"].pull = lambda: parts["a"].y.__setitem__(slice(None), [1.0, 2.0])  # type: ignore[method-assign]
    system.collect("a")
    system.feed("b")
    np.testing.assert_array_equal(system["b.u"], [2, 1])


def test_a_variable_whose_name_looks_like_an_element_is_found() -> None:
    parts = {"a": Scripted([port("P[1,1]", "output")]), "b": Scripted([port("u", "input")])}
    assert System(parts, {"b.u": "a.P[1,1]"}).connections[0].source.port == "a.P[1,1]"


def test_a_unit_defined_by_a_foreign_fmu_goes_before_its_spelling() -> None:
    foreign = port("y", "output", unit="knots", unit_definition=parse("m/s"))
    parts = {"a": Scripted([foreign]), "b": Scripted([port("u", "input", unit="m/s")])}
    assert System(parts, {"b.u": "a.y"}).connections[0].factor == 1.0


def test_delays_follow_from_the_algorithm() -> None:
    ports = [port("u", "input"), port("y", "output")]
    system = System({n: Scripted(ports) for n in "abc"}, {"b.u": "a.y", "c.u": "b.y", "a.u": "c.y"})
    assert system.delays(Jacobi()) == {"b.u": 1, "c.u": 1, "a.u": 1}
    assert system.delays(GaussSeidel()) == {"b.u": 0, "c.u": 0, "a.u": 1}
    assert system.delays(GaussSeidel(("c", "b", "a"))) == {"b.u": 1, "c.u": 1, "a.u": 0}


def test_a_component_hears_itself_one_step_later() -> None:
    system = System({"a": Scripted([port("u", "input"), port("y", "output")])}, {"a.u": "a.y"})
    assert system.delays(GaussSeidel()) == {"a.u": 1}
