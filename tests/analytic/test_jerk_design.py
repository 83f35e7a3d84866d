"""Crossings and plans: energy, the planar model, the limits of a plan, and how it is played back."""

from dataclasses import replace

import numpy as np
import pytest

from controllers.force_profile import ForceProfile
from controllers.jerk_design import Crossing, Limits, best_constant_force, crossing, least_jerk, profile_rows, rms
from controllers.planar_jerk import Frame
from cosim.errors import ScenarioError
from plants.ground import Hump
from plants.planar import Bicycle, Posture
from plants.tables import G, robot
from plants.wheel_path import WheelPath, rolling_path

ROBOT = robot("thesis_6_1")
LIMITS = Limits(force=500.0, rate=2e4, mu=0.72, speed=0.5, end_speed=1.0)


def road(spacing: float = 0.01) -> tuple[Crossing, WheelPath]:
    """Return the crossing of a smooth 5 cm hump, 1 m long, and the path of the wheel centres."""
    path = rolling_path(Hump(start=1.0, length=1.0, height=0.05, shape="sin4"), ROBOT.R)
    frame = Frame(ROBOT.m, ROBOT.I_y, ROBOT.L_f, ROBOT.L_r, ROBOT.h, ROBOT.R)
    return crossing(frame, path, np.linspace(0.2, 2.8, 1 + round(2.6 / spacing))), path


ROAD, PATH = road()


def posture(path: WheelPath, x: float) -> tuple[Posture, float]:
    """Return the posture at x and the height of the centre of mass, by bisection on the pitch."""
    low, high = -0.3, 0.3

    def place(p: float) -> tuple[float, np.ndarray]:
        centres = x + np.array([-ROBOT.L_r, ROBOT.L_f]) * np.cos(p) + ROBOT.h * np.sin(p)
        rise = path.height(centres)
        return float(rise[1] - rise[0] - ROBOT.L * np.sin(p)), centres

    for _ in range(60):
        p = (low + high) / 2
        low, high = (p, high) if place(p)[0] > 0 else (low, p)
    _, centres = place(p)
    slopes, bends = np.arctan(path.slope(centres)), path.curvature(centres)
    height = float(path.height(centres)[0] + ROBOT.L_r * np.sin(p) + ROBOT.h * np.cos(p))
    return Posture(slopes[1], slopes[0], p, (bends[0], bends[1])), height


@pytest.mark.parametrize("i", [30, 47, 90, 130, 160, 200])
def test_the_coefficients_are_those_of_the_planar_model(i: int) -> None:
    """a_z and the loads at a speed and a force; bisection leaves 1e-17 rad, the solution with P some 1e3 times that."""
    at, _ = posture(PATH, ROAD.x[i])
    model, v, F = Bicycle(ROBOT), 0.8, 170.0
    twist, traction = model.climbing_twist(at, v), np.array([F, 0.0])
    loads = model.contact_forces(at, twist, traction)
    a = model.accelerations(at, loads, traction)
    basis = np.array([1.0, v**2, F])
    assert ROAD.a_z[i] @ basis == pytest.approx(a[1], abs=1e-9)
    np.testing.assert_allclose(ROAD.normal[i] @ basis, loads, rtol=1e-9)
    assert ROAD.turn[i] * v == pytest.approx(twist[2], abs=1e-10)


def test_a_robot_without_traction_keeps_its_energy() -> None:
    """Kinetic and potential energy over the crossing; the trapezoidal rule's error falls with the spacing squared."""
    errors = []
    for spacing in (0.02, 0.01, 0.005):
        there, path = road(spacing)
        w = there.speeds(1.0, np.zeros(len(there.x)))
        energy = []
        for i in range(0, len(there.x), round(0.1 / spacing)):
            at, height = posture(path, there.x[i])
            v_x, v_z, omega = Bicycle(ROBOT).climbing_twist(at, float(np.sqrt(w[i])))
            energy.append(ROBOT.m * ((v_x**2 + v_z**2) / 2 + G * height) + ROBOT.I_y * omega**2 / 2)
        errors.append(np.ptp(energy) / (ROBOT.m / 2))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert errors[1] < 1e-3
    np.testing.assert_allclose(orders, 2.0, atol=0.2)


def test_the_jerk_of_a_constant_force_is_that_of_the_planar_model() -> None:
    """With the curvature's rate from the road; second order in the spacing, hence 1 % of the largest jerk at 1 cm."""
    F, v = 0.0, ROAD.speeds(1.0, np.zeros(len(ROAD.x))) ** 0.5
    model, found, eps = Bicycle(ROBOT), [], 1e-4
    middle = np.arange(20, 240, 10)
    for i in middle:
        speed = (v[i] + v[i + 1]) / 2
        at, _ = posture(PATH, (ROAD.x[i] + ROAD.x[i + 1]) / 2)
        held = model.jerk(at, float(speed), np.array([F, 0.0])).body[1]
        bends = [posture(PATH, (ROAD.x[i] + ROAD.x[i + 1]) / 2 + side * eps)[0].curvature for side in (-1, 1)]
        rate = (np.array(bends[1]) - bends[0]) / (2 * eps) * speed * (ROAD.rho[i] + ROAD.rho[i + 1]) / 2

        def a_z(step: float, at: Posture = at, rate: np.ndarray = rate, speed: float = float(speed)) -> float:
            moved = replace(at, curvature=tuple(np.array(at.curvature) + step * rate))
            twist = model.climbing_twist(moved, speed)
            return float(model.accelerations(moved, model.contact_forces(moved, twist, np.zeros(2)), np.zeros(2))[1])

        found.append(held + (a_z(1.0) - a_z(-1.0)) / 2)
    planned = ROAD.jerk("body", v**2, np.full(len(v), F))[middle]
    assert np.max(np.abs(planned - found)) < 0.01 * np.max(np.abs(found))


@pytest.mark.parametrize("definition", ["body", "inertial", "thesis"])
def test_a_plan_keeps_its_limits_and_beats_every_constant_force(definition: str) -> None:
    """At the same floor of the speed; limits hold to the solver's tolerance, 1e-8 of the unknowns' size."""
    plan = least_jerk(ROAD, 1.0, definition, LIMITS)
    rear, front = ROAD.loads(plan.w, plan.force)
    seconds, slack = ROAD.seconds(plan.w), 1e-4
    assert plan.w[0] == pytest.approx(1.0, abs=1e-7)
    assert np.min(plan.w) > LIMITS.speed**2 - slack
    assert plan.w[-1] > LIMITS.end_speed**2 - slack
    assert np.max(np.abs(plan.force)) < LIMITS.force + slack
    assert np.max(np.abs(np.diff(plan.force)) / seconds) < LIMITS.rate * (1 + slack)
    assert np.max(np.abs(plan.force) / rear) < LIMITS.mu + slack
    assert np.min(front) > 0
    # The plan's speed is what its force gives: the trapezoidal rule is the plan's own constraint.
    np.testing.assert_allclose(ROAD.speeds(1.0, plan.force), plan.w, atol=1e-5)
    force = best_constant_force(ROAD, 1.0, definition, 500.0, slowest=LIMITS.speed)
    w = ROAD.speeds(1.0, np.full(len(ROAD.x), force))
    constant = ROAD.jerk(definition, w, np.full(len(ROAD.x), force))
    assert np.sum(plan.jerk**2 * seconds) < 0.2 * np.sum(constant**2 * ROAD.seconds(w))


def test_the_best_constant_force_is_the_least_of_a_fine_sweep() -> None:
    """The search brackets one minimum of a grid; a sweep in steps of 1 N finds none below it."""

    def cost(force: float) -> float:
        F = np.full(len(ROAD.x), force)
        w = ROAD.speeds(1.0, F)
        return rms(ROAD, ROAD.jerk("body", w, F), w) if np.all(w > 0.36) else np.inf

    force = best_constant_force(ROAD, 1.0, "body", 100.0, slowest=0.6)
    assert cost(force) <= min(cost(trial) for trial in np.arange(-100.0, 101.0)) * (1 + 1e-6)


def test_a_crossing_that_cannot_be_is_told() -> None:
    """A floor above what the motors allow, and a start too slow for any force."""
    slow = replace(LIMITS, force=20.0, speed=0.9)
    with pytest.raises(
        ScenarioError,
        match=r"no plan crosses at 0\.9 m/s or more within 20 N, 20000 N/s and mu = 0\.72; lower the speed floor or",
    ):
        least_jerk(ROAD, 1.0, "body", slow)
    with pytest.raises(
        ScenarioError, match=r"no constant force up to 1 N brings the robot across from 0\.3 m/s; start"
    ):
        best_constant_force(ROAD, 0.3, "body", 1.0)


def test_a_plan_is_played_back_by_position() -> None:
    """Between the positions the force is interpolated, before the first it holds, from the last on there is none."""
    rows = profile_rows(np.array([0.0, 0.1, 0.3, 0.4]), np.array([50.0, 80.0, -40.0, 10.0]))
    player = ForceProfile(profile=rows, share=0.25, torque_max=1e3).instance("controller")
    player.enter_initialization(0)
    player.exit_initialization()
    for k, (x, force) in enumerate([(-1, 50), (0.05, 65), (0.1, 80), (0.25, -10), (0.399, 9.5), (0.4, 0), (9, 0)]):
        player.set("position", np.array([x, 0.0, 0.5]))
        player.step(k * 1_000_000, (k + 1) * 1_000_000)
        expected = force * np.array([0.125, 0.125, 0.375, 0.375])
        np.testing.assert_allclose(player.get("traction_demand"), expected, atol=1e-10)
        np.testing.assert_allclose(player.get("torque"), 0.1 * expected, atol=1e-11)
