"""One step of a coupled system as a linear system in discrete time: closed forms of every algorithm."""

from typing import Any

import control
import numpy as np
import pytest
import toys

from controllers.sensor import Sensor
from cosim import CouplingError, Extrapolated, GaussSeidel, Jacobi, Richardson, System, WiringError
from cosim.step_map import step_map

H = 0.01
# Differences of 1e-6 of values around 1 leave rounding of 2e-16 / 1e-6 in a derivative, a few times over.
EXACT = {"rtol": 1e-8, "atol": 1e-9}


def oscillator(**more: Any) -> System:
    """A mass of 1 kg, exact for a held force, on a spring with a damper: x'' = -4 x - 0.5 v."""
    system = System(
        {"mass": toys.Mass().instance(), "spring": toys.Spring(k=4.0, d=0.5).instance()},
        {"spring.x": "mass.pos", "spring.v": "mass.vel", "mass.F": "spring.F"},
        **more,
    )
    system.initialize()
    return system


def held(k: float, d: float, h: float) -> np.ndarray:
    """The exact step of (x, v) with the force -k x - d v of its begin held: python-control's zero-order hold."""
    free = control.StateSpace([[0, 1], [0, 0]], [[0], [1]], np.eye(2), np.zeros((2, 1)))
    step = control.c2d(free, h, "zoh")
    return step.A + step.B @ [[-k, -d]]


def test_gauss_seidel_with_the_spring_behind_the_mass_holds_the_force_of_the_begin() -> None:
    found = step_map(oscillator(), GaussSeidel(("mass", "spring")), step=H)
    assert found.state_labels == ["mass_x", "mass_v"]  # the spring's inputs follow the mass
    assert found.dt == H
    np.testing.assert_allclose(found.A, held(4.0, 0.5, H), **EXACT)
    np.testing.assert_allclose(found.C, [[1, 0], [0, 1], [-4, -0.5]], **EXACT)  # position, velocity, force


def test_jacobi_remembers_the_values_of_the_step_before() -> None:
    """The spring shows the force of what it was fed with at the begin of its step: its inputs are states, too."""
    found = step_map(oscillator(), Jacobi(), step=H)
    assert found.state_labels == ["mass_x", "mass_v", "spring_x", "spring_v"]
    ahead = np.array([[1, H], [0, 1]])
    force = np.array([[H**2 / 2], [H]]) @ [[-4.0, -0.5]]
    np.testing.assert_allclose(found.A, np.block([[ahead, force], [np.eye(2), np.zeros((2, 2))]]), **EXACT)


def test_inputs_are_held_over_the_step_and_outputs_follow_them_at_once() -> None:
    system = System({"mass": toys.Mass(m=2.0).instance(), "gain": toys.Gain(k=3.0).instance()}, {})
    system.initialize()
    found = step_map(system, Jacobi(), step=H)
    assert found.input_labels == ["mass_F", "gain_u"]
    np.testing.assert_allclose(found.B, [[H**2 / 4, 0], [H / 2, 0]], **EXACT)
    np.testing.assert_allclose(found.D, [[0, 0], [0, 0], [0, 3]], **EXACT)
    assert step_map(system, Jacobi(), step=H, inputs=["gain.u"], outputs=["gain.y"]).D.item() == pytest.approx(3)


def test_it_spans_the_steps_until_all_periods_have_come_round() -> None:
    """A mass under a force that is sampled every 3 steps: the map is that of the sampling, exact for any macro step."""
    sensors = {name: Sensor(unit=unit, period=3 * H) for name, unit in (("x", "m"), ("v", "m/s"))}
    parts = {"mass": toys.Mass(), "spring": toys.Spring(k=4.0, d=0.5), **sensors}
    wires = {"x.u": "mass.pos", "v.u": "mass.vel", "spring.x": "x.y", "spring.v": "v.y", "mass.F": "spring.F"}
    system = System({n: p.instance() for n, p in parts.items()}, wires)
    system.initialize()
    found = step_map(system, GaussSeidel(("x", "v", "spring", "mass")), step=H)
    assert found.dt == pytest.approx(3 * H)
    assert not [label for label in found.state_labels if "s1" in label]  # a noise generator has no derivative
    mass = [found.state_labels.index(n) for n in ("mass_x", "mass_v")]
    np.testing.assert_allclose(found.A[np.ix_(mass, mass)], held(4.0, 0.5, 3 * H), **EXACT)
    # what the sensors hold was sampled at the last tick and is not used any more
    others = np.setdiff1d(np.arange(found.nstates), mass)
    np.testing.assert_allclose(found.A[:, others], 0, atol=1e-9)


def test_what_steps_more_seldom_counts_too() -> None:
    found = step_map(oscillator(every={"spring": 2}), GaussSeidel(("mass", "spring")), step=H)
    assert found.dt == 2 * H
    np.testing.assert_allclose(found.A, held(4.0, 0.5, 2 * H), **EXACT)


def test_the_system_is_left_as_it_was() -> None:
    system = oscillator()
    before = (system["mass.pos"], system["spring.F"], system.time["mass"], system.instances["mass"].get("v"))
    step_map(system, Jacobi(), step=H)
    assert (system["mass.pos"], system["spring.F"], system.time["mass"], system.instances["mass"].get("v")) == before


def test_states_can_be_chosen() -> None:
    system = System({"mass": toys.Mass(m=2.0).instance(), "gain": toys.Gain().instance()}, {})
    system.initialize()
    found = step_map(system, Jacobi(), step=H, states=["*.v"])
    assert (found.state_labels, found.A.item()) == (["mass_v"], pytest.approx(1))


def test_what_cannot_be_linearised_says_why() -> None:
    with pytest.raises(CouplingError, match="the system has no values to be linearised at; initialize"):
        step_map(System({"mass": toys.Mass().instance()}, {}), Jacobi(), step=H)
    with pytest.raises(WiringError) as caught:
        step_map(oscillator(), Jacobi(), step=H, inputs=["spring.x"])
    assert str(caught.value) == "spring.x is connected, so that it cannot be an input of the step; leave it open"
    foreign = toys.Scripted([toys.port("x", "local")], rollback=True)
    foreign.set("x", 0.0)
    rigid = "part cannot be taken back to an earlier state, so its step cannot be linearised"
    for part, error, reason in (
        (toys.silent(), CouplingError, rigid),
        (foreign, WiringError, "the states of part cannot be set once it runs"),
    ):
        system = System({"part": part}, {})
        system.initialize()
        with pytest.raises(error) as refused:
            step_map(system, Jacobi(), step=H)
        assert str(refused.value) == reason


def test_in_the_midst_of_a_slow_step_there_is_no_map() -> None:
    system = oscillator(every={"spring": 2})
    system.time["mass"] += 10_000_000
    with pytest.raises(CouplingError, match="spring stands at 0 s, in the midst of its step over several macro steps"):
        step_map(system, Jacobi(), step=H)


def test_a_nominal_value_makes_a_small_effect_plain() -> None:
    """A newton on 1e9 kg at 1 m: moved by 1e-6 N nothing is seen, moved by 1e3 N the closed form."""
    system = System({"mass": toys.Mass(m=1e9).instance()}, {})
    system.initialize()
    plain, sized = (step_map(system, Jacobi(), step=H, nominal=n).B[0, 0] for n in (None, {"mass.F": 1e9}))
    assert plain == 0
    # 1e3 N move it by 5e-11 m from 1 m, whose rounding is 1e-16
    assert sized == pytest.approx(H**2 / 2e9, rel=1e-5)
    with pytest.raises(WiringError) as caught:
        step_map(system, Jacobi(), step=H, nominal={"mas.F": 1.0})
    assert str(caught.value) == "nominal names 'mas.F', which is not moved; did you mean 'mass.F'?"


@pytest.mark.filterwarnings("ignore:mass takes no derivatives")
def test_an_algorithm_that_remembers_has_no_map_of_one_step() -> None:
    with pytest.raises(CouplingError, match="Extrapolated goes by earlier points, which are no states of a map"):
        step_map(oscillator(), Richardson(Extrapolated(Jacobi())), step=H)
