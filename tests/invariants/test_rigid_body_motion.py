"""What the body's outputs say about its motion is what happens when it is integrated: gaps, jerks, work, momentum."""

import numpy as np
import pytest
from tracks import curve, kink, matrix, placed, sampled, slope_of, turned

from cosim.twin import PythonInstance
from plants.rigid_body import RigidBody

STEP = 1e-3  # s
# Differences over STEP of a motion with time scales above 0.1 s and values below 10: step^4/30 times the fifth
# derivative (10/0.1^5) is 3e-8, the integrator's 1e-12 over the step is 1e-9.
ACCURACY = 1e-7


def rolling(arm: str = "ground", **parameters: float) -> PythonInstance:
    """Return a body in general motion over curved ground: yawed, rolling, pitching, steering, with all forces."""
    component = RigidBody(
        traction_arm=arm, left=curve(0.1, 0.05, 0.2, -0.3, 0.1), right=curve(0.1, -0.02, -0.15, 0.2), **parameters
    )
    attitude = matrix(turned(0.2, 2)) @ matrix(turned(-0.1, 1)) @ matrix(turned(0.05, 0))
    w = np.sqrt(1 + np.trace(attitude)) / 2
    skew = [attitude[2, 1] - attitude[1, 2], attitude[0, 2] - attitude[2, 0], attitude[1, 0] - attitude[0, 1]]
    return placed(
        component, r=[0.05, 0, 0.52], q=[w, *np.array(skew) / (4 * w)], v=[1.8, 0.3, 0.2], omega=[0.3, -0.4, 0.5],
        normal_force=[500, 300, 450, 420], traction=[50, -30, 80, 60], lateral=[20, -40, 35, 10],
        steer=[0.1, 0.15, -0.05, 0], force=[10, -20, 30], moment=[3, -2, 5],
    )  # fmt: skip


@pytest.mark.parametrize("mu_r", [0.0, 0.03])
@pytest.mark.parametrize("arm", ["ground", "centre"])
def test_gap_gap_rate_and_interface_model_are_one_motion(arm: str, mu_r: float) -> None:
    """d(gap)/dt is gap_rate, and d(gap_rate)/dt is P F_n + U F_a + b_free."""
    body = rolling(arm, mu_r=mu_r)
    out = sampled(body, ("gap", "gap_rate", "P", "U", "b_free", "curvature"), 20, STEP)
    np.testing.assert_allclose(slope_of(out["gap"], STEP), out["gap_rate"][2:-2], rtol=0, atol=ACCURACY)
    predicted = out["P"] @ body.get("normal_force") + out["U"] @ body.get("traction") + out["b_free"]
    np.testing.assert_allclose(slope_of(out["gap_rate"], STEP), predicted[2:-2], rtol=0, atol=10 * ACCURACY)
    assert np.min(np.abs(out["curvature"])) > 0.1  # the term kappa v_t^2 is 0.3 m/s2 at least: it is being tested


def test_the_slope_turns_with_the_curvature() -> None:
    """d(theta)/dt = kappa v_t/(1 - kappa gap), v_t the speed of the wheel centre along the profile."""
    body = rolling()
    out = sampled(body, ("slope", "curvature", "gap", "wheel_centre"), 20, STEP)
    speed = slope_of(out["wheel_centre"], STEP)
    theta, kappa, gap = (out[name][2:-2] for name in ("slope", "curvature", "gap"))
    along = speed[:, :, 0] * np.cos(theta) + speed[:, :, 2] * np.sin(theta)
    expected = kappa * along / (1 - kappa * gap)
    np.testing.assert_allclose(slope_of(out["slope"], STEP), expected, rtol=0, atol=10 * ACCURACY)


@pytest.mark.parametrize("mu_r", [0.0, 0.03])
@pytest.mark.parametrize("arm", ["ground", "centre"])
def test_jerks_are_rates_of_the_acceleration(arm: str, mu_r: float) -> None:
    """Three definitions: of the body components, of the vector, and the second rate of the body's v_z (4.54)."""
    names = ("acceleration", "angular_acceleration", "orientation", "velocity_body", "rate",
             "jerk_body", "jerk_inertial", "jerk_thesis")  # fmt: skip
    out = sampled(rolling(arm, mu_r=mu_r), names, 20, STEP)
    inner = slice(2, -2)
    tolerance = 100 * ACCURACY  # one more derivative: ten times the values, ten times the integrator's share
    np.testing.assert_allclose(out["jerk_body"][inner], slope_of(out["acceleration"], STEP), rtol=0, atol=tolerance)
    turn = np.array([matrix(q) for q in out["orientation"]])
    vector = slope_of(np.einsum("tij,tj->ti", turn, out["acceleration"]), STEP)
    in_body = np.einsum("tji,tj->ti", turn[inner], vector)
    np.testing.assert_allclose(out["jerk_inertial"][inner], in_body, rtol=0, atol=tolerance)
    rising = slope_of(out["velocity_body"][:, 2], STEP)
    np.testing.assert_allclose(out["jerk_thesis"][4:-4], slope_of(rising, STEP), rtol=0, atol=tolerance)
    # the definitions differ here, and the velocity's rates are the accelerations
    assert np.min(np.abs(out["jerk_body"][:, 2] - out["jerk_inertial"][:, 2])) > 1e-2
    assert np.min(np.abs(out["jerk_body"][:, 2] - out["jerk_thesis"])) > 1e-2
    np.testing.assert_allclose(
        slope_of(out["rate"], STEP), out["angular_acceleration"][inner], rtol=0, atol=10 * ACCURACY
    )


@pytest.mark.parametrize("arm", ["centre", "ground"])
def test_forces_do_the_work_that_the_energy_shows(arm: str) -> None:
    """Power = F_n gap_rate + F_a v_along + F_l v_left + F_ext.v + M.omega.

    At the ground v_left is the sideslip there; v_along is that of the wheel centre, so no traction in that case.
    """
    body = rolling(arm)
    if arm == "ground":
        body.set("traction", np.zeros(4))
    names = ("kinetic_energy", "potential_energy", "gap_rate", "contact_velocity", "velocity", "rate")
    out = sampled(body, names, 20, STEP)
    held = {name: body.get(name) for name in ("normal_force", "traction", "lateral", "force", "moment")}
    power = (
        out["gap_rate"] @ held["normal_force"] + out["contact_velocity"][:, :, 0] @ held["traction"]
        + out["contact_velocity"][:, :, 1] @ held["lateral"]
        + out["velocity"] @ held["force"] + out["rate"] @ held["moment"]
    )  # fmt: skip
    energy = out["kinetic_energy"] + out["potential_energy"]
    # energies are near 1e3 J, a hundred times the values that ACCURACY is made for
    np.testing.assert_allclose(slope_of(energy, STEP), power[2:-2], rtol=0, atol=1e3 * ACCURACY)


def test_forces_at_the_ground_turn_the_body_by_the_wheel_radius() -> None:
    """The two arms differ by the torque -R n x (A F_a + l F_l) at each wheel, and by no force."""
    ground, centre = rolling("ground"), rolling("centre")
    np.testing.assert_allclose(ground.get("acceleration"), centre.get("acceleration"), rtol=1e-13)
    n, A = ground.get("contact_normal"), ground.get("traction_direction")
    tangential = A * ground.get("traction")[:, None] + np.cross(n, A) * ground.get("lateral")[:, None]
    torque = matrix(ground.get("orientation")).T @ np.sum(np.cross(-0.1 * n, tangential), axis=0)
    difference = ground.get("angular_acceleration") - centre.get("angular_acceleration")
    np.testing.assert_allclose(difference, torque / [20, 47, 55], rtol=0, atol=1e-13)


def test_free_flight_keeps_energy_and_angular_momentum() -> None:
    """Spun about the middle axis, which is unstable: the body tumbles over, which takes the gyroscopic term."""
    inertia = np.array([20.0, 47.0, 55.0])
    low = curve(-50.0)
    body = placed(RigidBody(inertia=inertia, left=low, right=low), v=[2, 1, 3], omega=[2, 12, 2])
    out = sampled(body, ("kinetic_energy", "potential_energy", "orientation", "rate", "position"), 30, 0.05)
    energy = out["kinetic_energy"] + out["potential_energy"]
    momentum = np.array([matrix(q) @ (inertia * w) for q, w in zip(out["orientation"], out["rate"], strict=True)])
    # 1e-12 per step of the integrator, some 300 steps; errors grow with the tumbling, at most by exp(5.3 t)
    np.testing.assert_allclose(energy, energy[0], rtol=1e-8)
    np.testing.assert_allclose(momentum, np.tile(momentum[0], (len(momentum), 1)), rtol=0, atol=1e-8 * momentum[0, 1])
    assert np.min(out["rate"][:, 1]) < -10  # it did tumble over
    np.testing.assert_allclose(np.linalg.norm(out["orientation"], axis=1), 1, rtol=0, atol=1e-10)
    t = np.linspace(0, 1.5, 31)
    parabola = np.column_stack([2 * t, t, 0.5 + 3 * t - 9.81 * t**2 / 2])
    np.testing.assert_allclose(out["position"], parabola, rtol=0, atol=1e-9)


def test_symmetric_input_gives_symmetric_motion_to_the_bit() -> None:
    """Roll, yaw and sideways motion stay exactly zero across a kink, left and right wheels do exactly the same."""
    path = kink(0.8, 0.0, 0.3)
    body = placed(RigidBody(left=path, right=path, mu_r=0.01), v=[2.0, 0, 0], normal_force=[500, 500, 400, 400],
                  traction=[60, 60, 30, 30])  # fmt: skip
    names = ("position", "velocity", "rate", "orientation", "gap", "slope", "b_free", "jerk_body")
    out = sampled(body, names, 40, 5e-3)
    assert out["slope"][0, 0] != out["slope"][-1, 0]  # the fronts did reach the slope
    for name, sideways in (("position", [1]), ("velocity", [1]), ("rate", [0, 2]), ("orientation", [1, 3]),
                           ("jerk_body", [1])):  # fmt: skip
        np.testing.assert_array_equal(out[name][:, sideways], 0)
    for name in ("gap", "slope", "b_free"):
        np.testing.assert_array_equal(out[name][:, [0, 2]], out[name][:, [1, 3]])


def test_received_impulse_is_that_of_the_last_step() -> None:
    """Momentum passed is momentum received: F_n times the step, not summed up over steps."""
    body = rolling()
    out = sampled(body, ("normal_impulse", "orientation"), 3, STEP)
    expected = body.get("normal_force") * STEP
    np.testing.assert_array_equal(out["normal_impulse"][0], 0)
    np.testing.assert_allclose(out["normal_impulse"][1:], np.tile(expected, (3, 1)), rtol=1e-12)
    assert body.get("elapsed") == pytest.approx(STEP, rel=1e-12)


def test_wheel_force_is_the_vertical_part_of_all_contact_forces() -> None:
    """Without gravity and external force, the wheels' vertical forces alone accelerate the body along its z axis."""
    body = rolling(mu_r=0.03, g=0.0)
    body.set("force", np.zeros(3))
    assert np.sum(body.get("wheel_force")) == pytest.approx(170 * body.get("acceleration")[2], rel=1e-12)
