"""Rigid wheels and body as FMUs: rest, flight, impacts, friction limits and steering, over every kind of ground."""

from __future__ import annotations

import numpy as np
import pytest
from rigid_checks import ROBOT, assert_keeps_the_laws_of_contact, chatter, drive, mechanical_energy, touchdowns

from plants.contact_loss import impact
from plants.ground import Flat, Ground, Hump, Ramp, RoughRoad, Step
from plants.planar import Bicycle, Posture
from plants.rigid_contact import RigidContact
from plants.tables import G

FLAT = Ground.same(Flat())
ROUGH = Ground.same(RoughRoad(road_class="E", start=0.8, length=40.0, seed=1))
TWO_TRACKS = Ground(*(RoughRoad(road_class="D", start=0.8, length=40.0, seed=seed) for seed in (1, 2)))
GROUNDS = {
    "ramp": Ground.same(Ramp(start=0.8, angle=0.3, length=1.5)),
    "step down": Ground.same(Step(start=0.8, height=-0.03)),
    "short hump": Ground.same(Hump(start=0.8, length=0.6, height=0.04)),
    "rough": ROUGH,
    "two rough tracks": TWO_TRACKS,
}


def test_a_minute_at_rest_is_rest() -> None:
    """At steps of 1 ms, where sideslip held over a step would be unstable with the cornering stiffness C_alpha / v_min.

    That is where 4 C_alpha (1 / m + h r / I_x) / v_min > 2 / step.
    """
    wheels = RigidContact()
    r = ROBOT.h + ROBOT.R
    assert 4 * wheels.C_alpha * (1 / ROBOT.m + ROBOT.h * r / ROBOT.I_x) / wheels.v_min > 2 / 1e-3
    record = drive(FLAT, wheels, 0.0, 60.0, 1e-3)
    assert np.all(record["wheels.contact"][1:] == 1)
    front = ROBOT.m * G * ROBOT.L_r / ROBOT.L / 2
    statics = np.array([front, front, ROBOT.m * G / 2 - front, ROBOT.m * G / 2 - front])
    # the start lies within F / k_split = 5e-11 m of the balance, which is 5e-8 m/s in a step or 2e-3 N at 1/P = 50 kg
    np.testing.assert_allclose(record["wheels.normal_force"][1:], np.tile(statics, (60_000, 1)), rtol=0, atol=1e-2)
    assert np.max(np.abs(record["body.velocity"])) < 1e-7
    assert np.max(np.abs(record["body.position"][-1] - record["body.position"][0])) < 1e-9


@pytest.mark.parametrize("step", [1e-3, 5e-3])
def test_a_push_to_the_side_dies_out_at_any_step(step: float) -> None:
    """Friction brakes the sideslip and never turns it round; it needs mu h < half_track not to tip the robot."""
    mu, push = 0.5, 0.2
    assert mu * (ROBOT.h + ROBOT.R) < ROBOT.half_track
    record = drive(FLAT, RigidContact(mu=mu), 0.0, 0.5, step, moved={"body.v": np.array([0.0, push, 0.0])})
    v = record["body.velocity"][:, 1]
    assert np.all(v >= -1e-9)
    assert np.all(np.diff(v) <= 1e-9)
    assert abs(v[-1]) < 1e-6
    stopping = push / (mu * G)  # s; the cornering stiffness brakes less when it has become slow
    assert v[int(np.ceil(stopping / step))] < 0.25 * push
    assert np.all(record["wheels.contact"][1:] == 1)


@pytest.mark.parametrize("height", [1e-3, 0.05])
def test_a_dropped_robot_is_back_on_the_ground_as_a_stone_is(height: float) -> None:
    """After sqrt(2 z / g), to one step; e = 0.5 gives it back a quarter of its energy."""
    step = 1e-4
    x, y, z = drive(FLAT, RigidContact(), 0.0, step, step)["body.position"][0]
    record = drive(FLAT, RigidContact(e=0.5), 0.0, 0.3, step, moved={"body.r": np.array([x, y, z + height])})
    pushed = np.any(record["wheels.contact"][1:] > 0.5, axis=1)  # the first point still has the force of the start
    landed = record.time[1:][np.argmax(pushed)]
    assert landed == pytest.approx(np.sqrt(2 * height / G), abs=step)
    after = record["body.position"][record.time > landed + 2 * step, 2] - z
    # e v, off by the g h of two steps, of v = sqrt(2 g z)
    apex = height / 4
    assert np.max(after) == pytest.approx(apex, rel=8 * step * np.sqrt(G / (2 * height)))


@pytest.mark.parametrize(("m", "ratio"), [(170.0, -0.001), (270.0, 0.264)])
def test_an_impact_of_the_fronts_on_the_flat_lifts_or_loads_the_rears(m: float, ratio: float) -> None:
    """Lam_r = (m L_f L_r - I_y) / (I_y + m L_r^2) Lam_f, at 0.6 m/s with the rear wheels at rest on the ground.

    Beside the weight, that bears on the wheels all the same: of 170 kg it is just enough to hold the rears down in a
    step of 0.1 ms.  The turning of the body adds m omega^2 h in that step; the compliance of the contacts, 1e-5 1/kg
    in it, is 7e-4 of the least mobility of P, 0.014 1/kg, and counts for both axles.
    """
    step, robot = 1e-4, ROBOT.with_changes(m=m)
    turn = 0.6 / robot.L  # rad/s, nose-down about the rear wheels
    moved = {
        "body.v": np.array([-turn * robot.h, 0.0, -turn * robot.L_r]),
        "body.omega": np.array([0.0, turn, 0.0]),
    }
    record = drive(FLAT, RigidContact(), 0.0, 2e-3, step, moved=moved, robot=robot)
    np.testing.assert_allclose(record["body.gap_rate"][0], [-0.6, -0.6, 0, 0], atol=1e-9)
    weight = m * G * step * np.array([robot.L_f, robot.L_r]) / robot.L
    passed = record["wheels.normal_impulse"][1].reshape(2, 2).sum(axis=1)[::-1] - weight
    held = impact(Bicycle(robot), Posture(0.0), np.array([0.0, -0.6]), bilateral=True)
    assert held[0] / held[1] == pytest.approx(ratio, abs=5e-4)
    np.testing.assert_allclose(passed, held, atol=2 * m * turn**2 * robot.h * step, rtol=2 * 7e-4)


@pytest.mark.parametrize("steered", [False, True], ids=["straight", "steered"])
@pytest.mark.parametrize("e", [0.0, 0.5], ids=["plastic", "bouncing"])
@pytest.mark.parametrize("ground", GROUNDS)
def test_contact_is_lost_and_regained_by_its_laws(ground: str, e: float, steered: bool) -> None:
    """With more traction asked for than friction passes on, so that wheels are at their limit while they land.

    Steered to the left, but on two tracks, where each wheel has to stay on its own: there all wheels point aside.
    """
    step = 1e-3
    angles = np.array([0.05] * 4 if ground == "two rough tracks" else [0.1, 0.1, -0.1, -0.1])
    held = {"wheels.traction_demand": [300.0] * 4, "body.steer": angles * steered}
    record = drive(GROUNDS[ground], RigidContact(e=e, mu=0.6), 2.0, 1.5, step, held=held)
    assert_keeps_the_laws_of_contact(record, step)
    assert np.sum(touchdowns(record)) >= 2
    used, limit = np.abs(record["wheels.traction"]), record["wheels.friction_limit"]
    assert np.any((limit > 1.0) & (used > 0.99 * limit))  # N: the limit was reached, and not in the air
    if steered:
        assert np.max(np.abs(record["wheels.lateral"])) > 50.0


@pytest.mark.parametrize("step", [1e-3, 5e-4])
def test_without_friction_only_impacts_take_energy(step: float) -> None:
    """What leaves the body is what the wheels count; what lifts a wheel out of the ground is its load times the depth.

    A second of rough road at 2 m/s.  The count is exact for forces that are constant over a step while the body's
    velocities change linearly; curvature makes them bend, which is of the order of the step.
    """
    record = drive(ROUGH, RigidContact(mu=0.0), 2.0, 5.0, step)
    energy, lost = mechanical_energy(record), record["wheels.dissipated_energy"]
    assert lost[-1] > 1.0
    assert energy[0] - energy[-1] == pytest.approx(lost[-1], rel=20 * step)
    depth, load = np.max(-record["body.gap"]), ROBOT.m * np.max(np.abs(record["body.b_free"]))
    assert np.max(energy - np.minimum.accumulate(energy)) <= load * depth


@pytest.mark.parametrize("step", [1e-3, 5e-4])
def test_contacts_do_not_chatter_on_two_rough_tracks(step: float) -> None:
    """Four rigid wheels rock on three; how long each is off does not hang on the step, and none flickers."""
    record = drive(TWO_TRACKS, RigidContact(), 2.0, 8.0, step)
    assert_keeps_the_laws_of_contact(record, step)
    assert np.sum(touchdowns(record)) > 40
    assert np.all(chatter(record) < 1e-3)
    assert np.all(np.abs(record["body.position"][:, 1]) < 0.8 * ROBOT.half_track)  # every wheel stays on its track
