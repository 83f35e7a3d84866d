"""Balance laws of the co-simulated rover: impulse, energy, unilateral contact, friction, symmetry, rest."""

from __future__ import annotations

import numpy as np
import pytest
from rigid_checks import ROBOT, drive

from cosim.record import Record
from plants.ground import Flat, Ground, Hump, Ramp
from plants.tables import G
from plants.wheel_deformation import WheelDeformation
from studies.coupling import Case, cosimulate

RAMP = Ground.same(Ramp(start=0.63, angle=0.3))


@pytest.fixture(scope="module")
def impact() -> Record:
    """The hard-wheeled rover hits the ramp while every wheel is asked for more traction than friction allows."""
    return drive(
        RAMP,
        WheelDeformation(k_w=np.full(4, 2.8e6), mu=0.4),
        2.0,
        0.1,
        1e-4,
        held={"wheels.traction_demand": np.full(4, 2e3)},
    )


def test_impulse_delivered_is_impulse_received(impact: Record) -> None:
    assert len(impact.events) == 1  # a shortened step is among them
    delivered, received = impact["wheels.normal_impulse"], impact["body.normal_impulse"]
    # both are a force times the length of the step, which each component takes as t_end - t_start in floats: a rounding
    # of either time is eps t / h of the length, and the substeps inside add a few more
    start, end = np.array(impact.points).T[:, 1:] * 1e-9
    bound = 4 * np.finfo(float).eps * (1 + end / (end - start))
    assert np.all(np.abs(delivered - received)[1:] <= bound[:, None] * np.max(delivered, axis=1)[1:, None])
    assert np.max(delivered) > 0.1  # N.s; the comparison is about something


def test_ground_pushes_and_never_pulls(impact: Record) -> None:
    for port in ("normal_force", "normal_force_end"):
        assert np.min(impact[f"wheels.{port}"]) >= 0
    assert np.min(impact["wheels.normal_force"]) == 0  # the wheels do leave the ground in this run


def test_traction_never_exceeds_friction(impact: Record) -> None:
    used, available = np.abs(impact["wheels.traction"]), 0.4 * impact["wheels.normal_force"]
    # the two integrals share every stage of the integrator, so they differ by rounding only
    assert np.all(used <= available + 1e-12 * np.max(available))
    assert np.max(used) > 100  # N


def test_symmetric_run_stays_symmetric(impact: Record) -> None:
    """To the bit: left and right go through the same operations, pair by pair, so no rounding tells them apart."""
    for port in ("normal_force", "traction", "deformation"):
        left, right = impact[f"wheels.{port}"][:, 0::2], impact[f"wheels.{port}"][:, 1::2]
        np.testing.assert_array_equal(left, right)
    assert not np.any(impact["body.velocity"][:, 1])
    assert not np.any(impact["body.rate"][:, [0, 2]])


def test_robot_at_rest_stays_at_rest() -> None:
    """Ten seconds on the flat: below 1e-9 m/s, with the normal forces of statics."""
    wheels = WheelDeformation(k_w=np.full(4, 1e5))
    record = drive(Ground.same(Flat()), wheels, 0.0, 10.0, 1e-3)
    assert np.max(np.abs(record["body.velocity"])) < 1e-9
    forces = record["wheels.normal_force"][-1]
    # moments about the centre of mass, from where the wheels really are: the sag tilts the body by some 1e-4 rad
    arms = record["body.wheel_centre"][-1, :, 0] - record["body.position"][-1, 0]
    assert abs(forces @ arms) < 1e-9 * ROBOT.m * G * ROBOT.L
    np.testing.assert_allclose(forces[:2], ROBOT.m * G * ROBOT.L_r / ROBOT.L / 2, rtol=1e-3)
    np.testing.assert_allclose(np.sum(forces), ROBOT.m * G, rtol=1e-9)


def test_a_robot_pushed_aside_comes_to_rest() -> None:
    """At a step of 1 ms, too: sideslip held over a step does not turn round in it, so standing wheels do not shiver.

    What is left is roll on the tyres, which decays with 4 c_w y^2 / (2 (I_x + m (h + R)^2)) = 2.7 1/s.
    """
    wheels = WheelDeformation(k_w=np.full(4, 1e5), c_w=np.full(4, 1e3))
    record = drive(Ground.same(Flat()), wheels, 0.0, 4.0, 1e-3, moved={"body.v": np.array([0.0, 0.05, 0.0])})
    aside = np.abs(record["body.velocity"][:, 1])
    assert np.max(aside) > 0.04
    assert np.max(aside[-500:]) < 0.05 * np.exp(-2.7 * 3.0)  # half a second later than that


@pytest.mark.parametrize(
    "case",
    [
        pytest.param(
            Case(ROBOT, Ground.same(Flat()), k_w=1e5, lift=5e-3, speed=0.0, duration=0.2), id="5 mm drop on the flat"
        ),
        pytest.param(
            Case(ROBOT, Ground.same(Hump(start=0.65, length=0.8, height=0.02)), k_w=1e5, speed=1.0, duration=0.4),
            id="smooth hump",
        ),
    ],
)
def test_energy_drift_shrinks_with_the_step(case: Case) -> None:
    """Undamped, the only loss is the coupling's: its drift falls at least linearly with the macro step."""
    steps = (8e-4, 4e-4, 2e-4, 1e-4)
    drift = [float(np.max(np.abs(trace.energy - trace.energy[0]))) for trace in (cosimulate(case, h) for h in steps)]
    order = np.polyfit(np.log(steps), np.log(drift), 1)[0]
    assert 1.0 < order < 4.0, drift
    assert drift[-1] < drift[0] / 8


def test_energy_does_not_jump_at_a_kink() -> None:
    """Across the located kink the energy changes no more than over an ordinary step nearby."""
    wheels = WheelDeformation(k_w=np.full(4, 2.8e6))
    record = drive(RAMP, wheels, 2.0, 0.012, 1e-4)
    gap = np.minimum(record["body.gap"], 0)
    energy = record["body.kinetic_energy"] + record["body.potential_energy"] + 1.4e6 * np.sum(gap**2, axis=1)
    at = int(np.searchsorted(record.time_ns, record.events[0][0]))
    assert record.time_ns[at] == record.events[0][0]
    # at the switch both faces are equally far: elastic energy is continuous to k z (v tick), 1e-9 s after the crossing
    jump = abs(energy[at] - energy[at - 1])
    stored = 1.4e6 * np.sum(gap[at] ** 2)
    assert jump < 1e-3 * stored
