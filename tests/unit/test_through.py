"""What stands in connections: fitted to the port it drives, placed right before it, wired between the two ends."""

from typing import Any

import pytest
import toys
from toys import port

import fmus
from cosim import Component, GaussSeidel, ScenarioError, System, input, output, parameter
from cosim.scenario import LinkSpec, Scenario
from studies import catalog
from studies.assembly import Assembly, assemble
from studies.runner import link
from studies.through import before, rerouted


class Reader(Component):
    """Reads a vector, sampled every 2 ms."""

    period = parameter(2e-3, "s", "sample period")
    gap = input("mm", "a distance", shape=3)
    level = input("N", "a force")
    seen = output("mm", "what it read", shape=3)

    def outputs(s: Any) -> dict[str, Any]:
        return dict(seen=s.gap)


class Writer(Component):
    """Writes a vector."""

    gap = output("m", "a distance", shape=3)
    level = output("N", "a force")

    def outputs(s: Any) -> dict[str, Any]:
        return dict(gap=[s.time, 1, 2], level=s.time)


@pytest.fixture(autouse=True)
def known(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let scenarios name these components."""
    for kind in (Reader, Writer, toys.Watch):
        monkeypatch.setitem(catalog.COMPONENTS, kind.__name__, kind)


def scenario(through: dict[str, Any], **more: Any) -> Scenario:
    table = {
        "name": "test", "title": "", "claim": "", "run": {"duration": 0.01, "step": 1e-3, **more.pop("run", {})},
        "components": {"reader": {"type": "Reader"}, "writer": {"type": "Writer"}},
        "connections": {"reader.gap": {"source": "writer.gap", "convert": True}, "reader.level": "writer.level"},
        "through": through, **more,
    }  # fmt: skip
    return Scenario.model_validate(table)


def wires(assembly: Assembly) -> dict[str, LinkSpec]:
    slots = {n: c.variables for n, c in assembly.components.items() if isinstance(c, Component)}
    return {t: LinkSpec(source=s) if isinstance(s, str) else s for t, s in assembly.wiring(slots).items()}


def test_an_element_has_the_shape_the_unit_and_the_period_of_its_target() -> None:
    assembly = assemble(scenario({"reader.gap": {"type": "Sensor"}, "reader.level": {"type": "Actuator", "lag": 0.1}}))
    assert repr(assembly.components["gap_to_reader"]) == "Sensor(unit='mm', shape=(3,), period=0.002)"
    assert repr(assembly.components["level_to_reader"]) == "Actuator(unit='N', lag=0.1)"


def test_what_the_scenario_says_goes_first() -> None:
    assembly = assemble(scenario({"reader.gap": {"type": "Sensor", "period": 5e-3, "unit": "m", "every": 5}}))
    assert repr(assembly.components["gap_to_reader"]) == "Sensor(unit='m', shape=(3,), period=0.005)"
    assert assembly.every == {"reader": 1, "writer": 1, "gap_to_reader": 5}


def test_without_a_sampled_target_the_period_is_the_macro_step() -> None:
    parts = {"reader": {"type": "Watch"}, "writer": {"type": "Watch"}}
    made = scenario({"reader.u": {"type": "Sensor"}}, components=parts, connections={"reader.u": "writer.y"})
    assert assemble(made).components["u_to_reader"].values["period"] == 1e-3  # type: ignore[union-attr]


def test_elements_step_right_before_their_target_and_add_no_delay() -> None:
    through = {"reader.gap": [{"type": "Sensor"}, {"type": "Actuator"}], "reader.level": {"type": "Sensor"}}
    parts = {"writer": {"type": "Writer"}, "reader": {"type": "Reader"}}
    made = assemble(scenario(through, components=parts))
    assert made.order == ("writer", "gap_to_reader_1", "gap_to_reader_2", "level_to_reader", "reader")
    assert tuple(made.components) == made.order
    instances = {n: c.instance() for n, c in made.components.items() if isinstance(c, Component)}
    system = System(instances, {t: link(s) for t, s in wires(made).items()})
    assert set(system.delays(GaussSeidel(made.order)).values()) == {0}


def test_an_order_that_is_given_is_kept_and_completed() -> None:
    through = {"reader.gap": {"type": "Sensor"}, "reader.level": {"type": "Sensor"}}
    made = assemble(scenario(through, run={"order": ["level_to_reader", "writer", "reader"]}))
    assert made.order == ("level_to_reader", "writer", "gap_to_reader", "reader")
    assert before(("a", "b"), []) == ("a", "b")


def test_the_connection_leads_through_the_chain_and_is_converted_where_it_enters() -> None:
    found = wires(assemble(scenario({"reader.gap": [{"type": "Sensor"}, {"type": "Actuator"}]})))
    assert {t: s.source for t, s in found.items()} == {
        "gap_to_reader_1.u": "writer.gap",
        "gap_to_reader_2.u": "gap_to_reader_1.y",
        "reader.gap": "gap_to_reader_2.y",
        "reader.level": "writer.level",
    }
    assert [s.convert for s in found.values()].count(True) == 1
    assert found["gap_to_reader_1.u"].convert


def test_elements_of_an_array_connected_one_by_one_lead_through_the_whole_sensor() -> None:
    by_element = {f"reader.gap[{i}]": {"source": f"writer.gap[{i}]", "convert": True} for i in (1, 2, 3)}
    found = wires(assemble(scenario({"reader.gap": {"type": "Sensor"}}, connections=by_element)))
    assert {t: s.source for t, s in found.items()} == {
        **{f"gap_to_reader.u[{i}]": f"writer.gap[{i}]" for i in (1, 2, 3)}, "reader.gap": "gap_to_reader.y",
    }  # fmt: skip


def test_a_port_without_a_unit_takes_the_number_as_it_comes() -> None:
    """A foreign FMU may declare none; the connection says what its number means, and does so where it enters."""
    placed = scenario({"reader.gap": {"type": "Sensor", "unit": "m"}}).elements()
    slots = {"reader": {"gap": port("gap", "input", unit=None)}}
    found = rerouted({"reader.gap": LinkSpec(source="writer.gap", factor=2.0)}, placed, slots)
    assert found == {
        "gap_to_reader.u": LinkSpec(source="writer.gap", factor=2.0),
        "reader.gap": LinkSpec(source="gap_to_reader.y", factor=1.0),
    }


def test_an_fmu_can_be_the_target_and_the_element() -> None:
    gain = str(fmus.build(toys.Gain()))
    watch = str(fmus.build(toys.Watch()))
    parts = {"reader": {"fmu": watch}, "writer": {"type": "Watch"}}
    through = {"reader.u": [{"type": "Sensor"}, {"fmu": gain}]}
    made = assemble(scenario(through, components=parts, connections={"reader.u": "writer.y"}))
    assert repr(made.components["u_to_reader_1"]) == "Sensor(unit='s')"
    assert made.components["u_to_reader_2"] == gain


@pytest.mark.parametrize(
    ("through", "sentence"),
    [
        ({"raeder.gap": {"type": "Sensor"}},
         "through.raeder.gap: there is no component 'raeder'; did you mean 'reader'?"),
        ({"reader.gup": {"type": "Sensor"}}, "through.reader.gup: reader has no input 'gup'; did you mean 'gap'?"),
        ({"reader.gap": {"type": "Senser"}},
         "through.reader.gap: there is no component 'Senser'; did you mean 'Sensor'?"),
        ({"reader.gap": {}}, "through.reader.gap needs a type of the catalog or the path of an fmu"),
        ({"reader.gap": {"type": "Sensor", "fmu": "x.fmu"}},
         "through.reader.gap names an fmu, so it cannot have a type or parameters beside it"),
        ({"reader.gap": {"type": "Writer"}},
         "through.reader.gap cannot be a Writer: what stands in a connection has an input u and an output y"),
        ({"reader.gap": [{"type": "Sensor"}, {"type": "Sensor", "nose": 1}]},
         "through.reader.gap[2]: Sensor has no parameter 'nose'; did you mean 'noise'?"),
        ({"reader.gap": {"type": "Sensor", "noise": -1}},
         "through.reader.gap: Sensor.noise is -1; it must be 0 or positive"),
    ],
)  # fmt: skip
def test_mistakes(through: dict[str, Any], sentence: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        assemble(scenario(through))
    assert str(caught.value) == sentence


def test_a_name_that_is_taken() -> None:
    parts = {"reader": {"type": "Reader"}, "writer": {"type": "Writer"}, "gap_to_reader": {"type": "Writer"}}
    with pytest.raises(ScenarioError, match="is to be called gap_to_reader, like another component; rename that one"):
        assemble(scenario({"reader.gap": {"type": "Sensor"}}, components=parts))


def test_a_port_that_nothing_drives() -> None:
    with pytest.raises(ScenarioError) as caught:
        wires(assemble(scenario({"reader.gap": {"type": "Sensor"}}, connections={})))
    assert str(caught.value) == ("through.reader.gap: nothing drives reader.gap; connect it, or leave the element out")
