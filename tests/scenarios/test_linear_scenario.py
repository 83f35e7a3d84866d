"""The rover linearised as a whole: its wheels' natural frequencies, and the poles that its controller placed."""

from __future__ import annotations

from typing import Any

import control
import numpy as np
import pytest

import fmus
from controllers.uncontrolled import Uncontrolled
from cosim import Component, ScenarioError, linearize
from plants.planar import Bicycle, Posture
from plants.tables import robot
from studies.assembly import assemble
from studies.catalog import find_scenario
from studies.linear import linearize_scenario

K_AXLE = 5.6e6  # N/m
STANDING = {"x": 0.016, "speed": 0.0}  # m: the fronts 1 mm up the slope, so that the pitch is 4e-4 rad
MOTION = ("body.[rqv]", "body.omega", "wheels.*", "controller.*")  # all but the chassis, which nothing depends on
# What P and k leave out: the weight turns with the robot, g / L_r = 21 1/s2, a shift of 21 / (2 w) = 0.05 rad/s; the
# coupling, w (w h)^2 / 24 = 0.01 rad/s at h = 1e-4 s; the pitch of 4e-4 rad, 0.02 rad/s. Their sum, rounded up.
LEFT_OUT = 0.1


def oscillations(variant: str, **controller: Any) -> tuple[control.StateSpace, np.ndarray]:
    """Return the linearised scenario and its oscillating poles in rad/s, the slowest first."""
    changes = {"start": STANDING, "components": {"controller": controller}, "run": {"step": 1e-4}}
    found = linearize_scenario(find_scenario("ramp-impact").load(variant, [changes]), states=MOTION)
    poles = found.poles().astype(complex)
    rates = np.log(poles[np.abs(poles) > 1e-2]) / found.dt  # the others are states that a step sets anew
    return found, np.sort_complex(rates[rates.imag > 150])  # below lies the roll, which the tyres damp sideways


def test_the_undamped_wheels_oscillate_at_the_frequencies_of_k_times_P() -> None:
    found, poles = oscillations("uncontrolled", period=1e-4)
    assert found.dt == 1e-4
    w = np.sort(np.sqrt(np.linalg.eigvals(K_AXLE * Bicycle(robot("thesis_6_1")).P(Posture(0.3)))))
    np.testing.assert_allclose(w, [226.6, 253.8], atol=0.05)  # thesis, Table 6.1
    np.testing.assert_allclose(np.sort(poles.imag), w, atol=LEFT_OUT)
    # no damping is added: the wheels' force is the mean over the step, so that the coupling keeps the energy
    assert np.max(np.abs(poles.real)) < 1e-3


@pytest.mark.parametrize("period", [1e-4, 1e-3])
def test_the_closed_loop_has_the_poles_that_were_placed(period: float) -> None:
    """Placed for the sampled loop; here they come back from the whole co-simulation, tick by tick."""
    found, poles = oscillations("pole-placement", period=period)
    assert found.dt == pytest.approx(period)
    w = np.sqrt(np.linalg.eigvals(K_AXLE * Bicycle(robot("thesis_6_1")).P(Posture(0.3))))
    placed = np.sort_complex(w * (-0.7 + 1j * np.sqrt(1 - 0.7**2)))
    np.testing.assert_allclose(poles, placed, atol=LEFT_OUT)


def test_a_controller_alone_is_its_gain() -> None:
    """Where all wheels press, placed poles are proportional: what is shown after the tick is -K times what was read."""
    part = assemble(find_scenario("ramp-impact").load("pole-placement")).components["controller"]
    assert isinstance(part, Component)
    instance = part.instance()
    for port, value in (("normal_force", 417.0), ("gap", -1.5e-4), ("b_free", -9.81)):
        instance.set(port, np.full(4, value))
    for port in "PU":
        instance.set(port, part.values[f"{port}_model"])
    found = linearize(instance, inputs=["gap", "gap_rate"], outputs=["traction_demand"])
    assert found.dt == 1e-4
    np.testing.assert_allclose(found.D, -np.hstack([part.values["K_z"], part.values["K_rate"]]), rtol=1e-9)


def test_late_sensors_move_the_poles_towards_instability() -> None:
    """Two samples of delay at a period of 1 ms turn the loop by w T = 25 degrees a sample."""
    late = {p: {"type": "Sensor", "delay": 2} for p in ("controller.gap", "controller.gap_rate")}
    changes = {"start": STANDING, "components": {"controller": {"period": 1e-3}}, "through": late}
    states = (*MOTION, "*_to_controller.*")
    found = linearize_scenario(find_scenario("ramp-impact").load("pole-placement", [changes]), states=states)
    assert "gap_to_controller_line[1,1]" in found.state_labels
    slowest = np.max(np.log(np.abs([p for p in found.poles() if abs(p) > 1e-2 and p.imag > 0.05])) / found.dt)
    assert slowest > -120  # placed: -159


def test_a_force_accelerates_the_robot_by_one_over_its_mass() -> None:
    """Over one step, along the level road; the ends are named as they are chosen."""
    scenario = find_scenario("ramp-impact").load("uncontrolled", [{"components": {"controller": {"period": 1e-4}}}])
    found = linearize_scenario(
        scenario, inputs=["body.force[1]"], outputs=["body.velocity[1]"], states=MOTION, nominal={"body.force": 1e4}
    )
    assert (found.name, found.input_labels, found.output_labels) == (
        "ramp-impact", ["body_force[1]"], ["body_velocity[1]"],
    )  # fmt: skip
    row = found.state_labels.index("body_v[1]")
    # moved by 0.01 N: 6e-9 m/s, in which the rounding of 2 m/s is 4e-16
    assert found.B[row, 0] == pytest.approx(found.dt / 170.0, rel=1e-6)


def test_it_is_taken_where_the_run_is_at_that_time() -> None:
    """After 100 ms the fronts are in the air, and what does not press has no stiffness."""
    scenario = find_scenario("ramp-impact").load("uncontrolled", [{"components": {"controller": {"period": 1e-4}}}])
    stiffness = []
    for at in (0.0, 0.1):
        found = linearize_scenario(scenario, at=at, outputs=["wheels.normal_force_end"], states=MOTION)
        columns = [found.state_labels.index(f"wheels_z[{i}]") for i in (1, 3)]
        stiffness.append(-found.C[[0, 2], columns])
    np.testing.assert_allclose(stiffness[0], 2.8e6, rtol=1e-6)
    assert stiffness[1][0] == 0


def test_a_foreign_fmu_cannot_be_linearised() -> None:
    fmu = {"components": {"controller": {"fmu": str(fmus.build(Uncontrolled()))}}}
    scenario = find_scenario("ramp-impact").load("uncontrolled", [fmu])
    with pytest.raises(ScenarioError, match="controller is a foreign FMU, whose states cannot be set once it runs"):
        linearize_scenario(scenario)
