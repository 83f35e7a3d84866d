"""The 3-D body, symmetric left and right, is the planar model: axle by axle.

A force F on an axle is F/2 on either of its wheels, and both gaps of an axle are equal, so the planar P_ij (and U_ij)
is the mean of the four elements that the wheels of axle i and of axle j have in the 3-D matrix.
"""

import numpy as np
import pytest
from tracks import curve, on_two_slopes, placed, turned

from plants.planar import Bicycle, Posture
from plants.rigid_body import RigidBody
from plants.tables import robot

ROBOT = robot("thesis_6_1")
POSTURES = [
    (Posture(0.3), 2.0, 0.0),
    (Posture(0.2), 2.0, -0.414),
    (Posture(0.25, -0.1, 0.08), 1.5, 0.7),
    (Posture(0.5, 0.2, -0.1), -0.8, 0.3),
]
ARMS = ["ground", "centre"]
# Both sides take some hundred operations; the largest condition number among them is that of the sums, below 100.
NEAR = 1e-13


def axles(wheels: np.ndarray) -> np.ndarray:
    """Return the mean over left and right in the order (rear, front), for one value or one matrix per wheel."""
    halves = np.array([[0, 0, 0.5, 0.5], [0.5, 0.5, 0, 0]])
    return halves @ wheels if wheels.ndim == 1 else halves @ wheels @ halves.T


@pytest.mark.parametrize("arm", ARMS)
@pytest.mark.parametrize(("at", "v_x", "omega"), POSTURES)
def test_interface_model_and_accelerations(at: Posture, v_x: float, omega: float, arm: str) -> None:
    bicycle, twist = Bicycle(ROBOT, arm), np.array([v_x, 0.2, omega])
    body = on_two_slopes(at, twist, traction_arm=arm, **ROBOT.body_parameters())
    np.testing.assert_allclose(body.get("slope"), [at.front, at.front, at.rear, at.rear], rtol=NEAR, atol=1e-16)
    np.testing.assert_allclose(body.get("pitch"), at.pitch, rtol=NEAR)
    for name, planar in (("P", bicycle.P(at)), ("U", bicycle.U(at)), ("b_free", bicycle.b(at, twist))):
        np.testing.assert_allclose(axles(body.get(name)), planar, rtol=0, atol=NEAR * np.max(np.abs(planar)))

    normal, traction = np.array([700.0, 900.0]), np.array([150.0, -80.0])
    body.set("normal_force", np.repeat(normal[::-1] / 2, 2))
    body.set("traction", np.repeat(traction[::-1] / 2, 2))
    a_x, a_z, alpha = bicycle.accelerations(at, normal, traction)
    # 9.81 m/s2 of gravity cancels in a_z
    np.testing.assert_allclose(body.get("acceleration"), [a_x, 0, a_z], rtol=0, atol=NEAR * 9.81)
    np.testing.assert_allclose(body.get("angular_acceleration"), [0, alpha, 0], rtol=0, atol=NEAR * 10)


@pytest.mark.parametrize(("arm", "force"), [("centre", 146.705), ("ground", 143.952)])
def test_the_static_climb_force_holds_the_robot(arm: str, force: float) -> None:
    """Fronts on 0.2 rad, at rest, rear drive: nothing accelerates."""
    bicycle, at = Bicycle(ROBOT, arm), Posture(0.2)
    rear = bicycle.climb_force(0.2)
    assert rear == pytest.approx(force, abs=5e-4)
    body = on_two_slopes(at, np.zeros(3), traction_arm=arm, **ROBOT.body_parameters())
    normal = bicycle.contact_forces(at, np.zeros(3), np.array([rear, 0.0]))
    body.set("normal_force", np.repeat(normal[::-1] / 2, 2))
    body.set("traction", [0, 0, rear / 2, rear / 2])
    # rounding of 9.81 m/s2 times the condition number of the planar P, 30
    np.testing.assert_allclose(body.get("acceleration"), 0, atol=1e-12)
    np.testing.assert_allclose(body.get("angular_acceleration"), 0, atol=1e-12)


def test_four_coplanar_contacts_leave_their_split_undetermined() -> None:
    """P has rank 3 on the flat and with all wheels on one slope, and 4 with the fronts on another slope."""
    for front, rear, pitch, rank in ((0.0, 0.0, 0.0, 3), (0.3, 0.3, 0.3, 3), (0.3, 0.3, 0.1, 3), (0.3, 0.0, 0.0, 4)):
        body = on_two_slopes(Posture(front, rear, pitch), np.zeros(3), **ROBOT.body_parameters())
        values = np.linalg.svd(body.get("P"), compute_uv=False)
        assert np.sum(values > 1e-14 * values[0]) == rank, values
    assert values[0] / values[3] == pytest.approx(166, abs=0.5)


def test_P_is_symmetric_without_rolling_resistance_only() -> None:
    at, twist = Posture(0.3, 0.0, 0.05), np.array([1.0, 0.0, 0.2])
    P = on_two_slopes(at, twist, **ROBOT.body_parameters()).get("P")
    np.testing.assert_allclose(P, P.T, rtol=0, atol=1e-16)
    P = on_two_slopes(at, twist, mu_r=0.02, **ROBOT.body_parameters()).get("P")
    assert np.max(np.abs(P - P.T)) > 1e-5  # mu_r (1/m + h/I_y ...) is of the order of 1e-4


def test_rolling_resistance_brakes() -> None:
    """On the flat, in either direction of travel: mu_r F_n against the motion, at the contact."""
    for v_x in (1.0, -1.0):
        body = placed(RigidBody(mu_r=0.02), v=[v_x, 0, 0], normal_force=[400.0] * 4)
        assert body.get("acceleration")[0] == pytest.approx(-np.sign(v_x) * 0.02 * 1600 / 170, rel=1e-12)
        normal_moment = (0.46 - 0.6) * 800  # N.m, nose-down positive
        expected = (normal_moment + np.sign(v_x) * 0.02 * 1600 * 0.5) / 47  # braking at h + R below turns the nose down
        assert body.get("angular_acceleration")[1] == pytest.approx(expected, rel=1e-12)


def test_traction_follows_the_heading_and_lateral_force_pushes_left() -> None:
    """A yawed robot on a slope: directions are unit, tangent to the ground, and the heading lies in their plane."""
    yaw, steer, slope = 0.7, 0.2, 0.25
    path = curve(0.1, np.tan(slope))
    body = placed(RigidBody(left=path, right=path), q=turned(yaw, 2), steer=[steer, steer, 0, 0])
    n = np.array([-np.sin(slope), 0, np.cos(slope)])
    np.testing.assert_allclose(body.get("contact_normal"), np.tile(n, (4, 1)), atol=1e-15)
    for direction, angle in zip(body.get("traction_direction"), (yaw + steer, yaw + steer, yaw, yaw), strict=True):
        heading = np.array([np.cos(angle), np.sin(angle), 0])
        expected = heading - (heading @ n) * n
        np.testing.assert_allclose(direction, expected / np.linalg.norm(expected), atol=1e-15)

    level = placed(RigidBody(g=0.0), q=turned(yaw, 2), traction=[10.0] * 4)
    np.testing.assert_allclose(level.get("acceleration"), [40 / 170, 0, 0], atol=1e-15)
    level.set("traction", np.zeros(4))
    level.set("lateral", [10.0] * 4)
    np.testing.assert_allclose(level.get("acceleration"), [0, 40 / 170, 0], atol=1e-15)
    # at the contacts, below the centre of mass: it rolls the body to the left side down, which is omega_x > 0
    assert level.get("angular_acceleration")[0] == pytest.approx(40 * 0.5 / 20, rel=1e-12)
    assert level.get("angular_acceleration")[2] == pytest.approx(20 * (0.6 - 0.46) / 55, rel=1e-12)


def test_the_two_tracks_are_the_left_and_the_right_of_the_road() -> None:
    """The track under a wheel is that of the side of the road where its centre is, whichever way the robot faces."""
    left, right = curve(0.11), curve(0.08)
    ahead = placed(RigidBody(left=left, right=right))
    np.testing.assert_allclose(ahead.get("gap"), [-0.01, 0.02, -0.01, 0.02], atol=1e-15)
    back = placed(RigidBody(left=left, right=right), q=turned(np.pi, 2))
    np.testing.assert_allclose(back.get("gap"), [0.02, -0.01, 0.02, -0.01], atol=1e-15)
