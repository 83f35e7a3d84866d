"""Coupled systems as one linear system in continuous time: closed forms, and python-control's own interconnection."""

from typing import Any

import control
import numpy as np
import pytest
import toys

from cosim import Component, CouplingError, DeclarationError, Link, System, WiringError, input, output, parameter, state
from cosim.linearize import linearize


class Mass(Component):
    """m v' = F."""

    m = parameter(1.0, "kg", "mass")
    F = input("N", "force")
    x = state(0.0, "m", "position")
    v = state(0.0, "m/s", "velocity")
    pos = output("m", "position")
    vel = output("m/s", "velocity")

    def derivatives(s: Any) -> dict[str, Any]:
        return dict(x=s.v, v=s.F / s.m)

    def outputs(s: Any) -> dict[str, Any]:
        return dict(pos=s.x, vel=s.v)


class Link2(Component):
    """A spring between two points, and a force from outside on both ends."""

    k = parameter(4.0, "N/m", "stiffness")
    ends = input("m", "positions of the two ends", shape=2)
    push = input("N", "force that drives them apart")
    F = output("N", "forces on what is at the ends", shape=2)

    def outputs(s: Any) -> dict[str, Any]:
        pull = s.k * (s.ends[1] - s.ends[0]) - s.push
        return dict(F=[pull, -pull])


def two_masses(**link: Any) -> System:
    parts = {"one": Mass(m=2.0), "two": Mass(m=3.0), "spring": Link2(**link)}
    wires = {
        "spring.ends[1]": "one.pos", "spring.ends[2]": "two.pos", "one.F": "spring.F[1]", "two.F": "spring.F[2]",
    }  # fmt: skip
    system = System({name: part.instance() for name, part in parts.items()}, wires)
    system.initialize()
    return system


def test_two_masses_on_a_spring_are_their_closed_form() -> None:
    found = linearize(two_masses(k=4.0))
    assert found.state_labels == ["one_x", "one_v", "two_x", "two_v"]
    assert found.input_labels == ["spring_push"]  # the only one that is not connected
    assert found.output_labels == ["one_pos", "one_vel", "two_pos", "two_vel", "spring_F[1]", "spring_F[2]"]
    np.testing.assert_allclose(
        found.A, [[0, 1, 0, 0], [-4 / 2, 0, 4 / 2, 0], [0, 0, 0, 1], [4 / 3, 0, -4 / 3, 0]], rtol=1e-15
    )
    np.testing.assert_allclose(found.B.ravel(), [0, -1 / 2, 0, 1 / 3], rtol=1e-15)
    np.testing.assert_allclose(found.D.ravel(), [0, 0, 0, 0, -1, 1], rtol=1e-15)
    # twice 0 (they fly together), and sqrt(k (1/m1 + 1/m2)); a double 0 comes out as the root of the rounding
    w = np.sqrt(4 * (1 / 2 + 1 / 3))
    np.testing.assert_allclose(np.sort(found.poles().imag), [-w, 0, 0, w], atol=1e-7)


def test_it_is_what_python_control_makes_of_the_parts() -> None:
    parts = [linearize(c.instance(n)) for n, c in
             {"one": Mass(m=2.0), "two": Mass(m=3.0), "spring": Link2(k=4.0)}.items()]  # fmt: skip
    other = control.interconnect(
        parts,
        connections=[["spring.ends[1]", "one.pos"], ["spring.ends[2]", "two.pos"], ["one.F", "spring.F[1]"],
                     ["two.F", "spring.F[2]"]],
        inplist=["spring.push", "two.F"], outlist=["one.pos", "spring.F[2]"], warn_duplicate=False, check_unused=False,
    )  # fmt: skip
    found = linearize(two_masses(k=4.0), inputs=["spring.push", "two.F"], outputs=["one.pos", "spring.F[2]"])
    w = np.array([0.3, 1.0, 7.0])
    np.testing.assert_allclose(found(1j * w), other(1j * w), rtol=1e-12)


def test_a_direct_loop_is_closed() -> None:
    """Two gains in a circle, y = 2 (y / 4 + e), are y = 4 e."""
    gains = {"a": toys.Gain(k=2.0).instance(), "b": toys.Gain(k=0.25).instance()}
    system = System(gains, {"a.u": "b.y", "b.u": "a.y"})
    system.time = dict.fromkeys(system.names, 0)  # a loop cannot be initialised; its derivatives are the same anywhere
    found = linearize(system, inputs=["a.u"], outputs=["a.y"])
    assert found.D.item() == pytest.approx(4.0, rel=1e-14)
    gains["b"].set("k", 0.5)
    with pytest.raises(CouplingError, match="outputs that feed through at once form a singular loop"):
        linearize(system)


def test_conversions_are_part_of_the_wires() -> None:
    system = System(
        {"mass": Mass().instance(), "spring": toys.Spring(k=2.0).instance()},
        {"spring.x": Link("mass.pos", factor=3.0, offset=1.0), "spring.v": "mass.vel", "mass.F": "spring.F"},
    )
    system.initialize()
    np.testing.assert_allclose(linearize(system).A, [[0, 1], [-6, 0]])


@pytest.mark.parametrize(
    ("choose", "sentence"),
    [
        ({"inputs": ["one.G"]}, "there is no input 'one.G' to linearise; did you mean 'one.F'?"),
        ({"outputs": ["spring.F[3]"]}, "there is no output 'spring.F[3]' to linearise; did you mean 'spring.F'?"),
    ],
)
def test_names_that_do_not_exist(choose: dict[str, Any], sentence: str) -> None:
    with pytest.raises(WiringError) as caught:
        linearize(two_masses(), **choose)
    assert str(caught.value) == sentence


def test_what_has_no_model_in_continuous_time_is_refused() -> None:
    system = System({"mass": Mass().instance()}, {})
    with pytest.raises(CouplingError) as caught:
        linearize(system)
    assert str(caught.value) == "the system has no values to be linearised at; initialize() it first, or run it"
    for component, error, reason in (
        (toys.Watch(), CouplingError, "sets states at communication points, so that its derivatives alone do not"),
        (toys.Mass(), DeclarationError, "part cannot be linearised: it does not declare the derivatives of its states"),
    ):
        system = System({"part": component.instance()}, {})
        system.initialize()
        with pytest.raises(error, match=reason):
            linearize(system)
