"""Slalom on a rough road: the claim of ``steered-rough``."""

import numpy as np
import pytest

from plants.tables import G
from studies.catalog import find_scenario
from studies.runner import Result, execute

CURVATURE, FREQUENCY, RAMP = 0.5, 0.5, 0.5  # 1/m, Hz, s


@pytest.fixture(scope="module")
def results() -> dict[str, Result]:
    """The variants; the one with Dugoff's curve for its first half only."""
    scenario = find_scenario("steered-rough")
    shorter = {"driven-dugoff": [{"run": {"duration": 2.0}}]}
    found = {name: execute(scenario.load(name, shorter.get(name, ()))) for name in scenario.variants}
    assert all(result.error is None for result in found.values())
    return found


@pytest.mark.parametrize("variant", ["direct", "driven", "driven-dugoff"])
def test_no_force_leaves_its_friction_ellipse(results: dict[str, Result], variant: str) -> None:
    """Forces and limit are means over the step of what keeps it at every instant, so they keep it, but for rounding.

    It is no easy one: on average some wheel uses more of its friction than v^2 kappa / (mu g) = 0.34, what the sharpest
    bend takes on level ground.
    """
    read = results[variant].record
    force = np.hypot(read["wheels.traction"], read["wheels.lateral"])
    limit = read["wheels.friction_limit"]
    assert np.all(force <= limit * (1 + 1e-12) + 1e-9)
    share = force[1:] / np.maximum(limit[1:], 1.0)
    assert np.mean(np.max(share, axis=1)) > 2.0**2 * CURVATURE / (0.6 * G)


def test_each_wheel_has_its_own_angle_and_lateral_force(results: dict[str, Result]) -> None:
    """Four different angles whenever the robot turns, and lateral forces that carry the turn."""
    read = results["direct"].record
    angles = np.sort(read["controller.steer"], axis=1)
    turning = np.max(np.abs(angles), axis=1) > 0.1
    assert np.mean(turning) > 0.5
    assert np.min(np.diff(angles, axis=1)[turning]) > 1e-3
    for wheel in range(4):
        assert np.sqrt(np.mean(read["wheels.lateral"][:, wheel] ** 2)) > 50.0


def wanted_rate(result: Result) -> np.ndarray:
    t = result.record.time
    kappa = CURVATURE * np.minimum(t / RAMP, 1) * np.cos(2 * np.pi * FREQUENCY * t)
    return kappa * result.record["body.velocity_body"][:, 0]


@pytest.mark.parametrize("variant", ["direct", "driven"])
def test_the_robot_follows_the_steered_path(results: dict[str, Result], variant: str) -> None:
    """The yaw rate is kappa v up to the sideslip that makes the lateral forces, a tenth of the steering angles.

    2 m/s2 on 170 kg take 85 N a wheel, at 5e3 N/rad a slip angle of 0.017 rad beside steering angles up to 0.34 and
    0.26 rad; on a bumpy road twice of it.
    """
    rate, wanted = results[variant].record["body.rate"][:, 2], wanted_rate(results[variant])
    assert np.sqrt(np.mean((rate - wanted) ** 2)) < 0.1 * np.sqrt(np.mean(wanted**2))


def test_the_ground_is_uneven_enough_to_lift_wheels(results: dict[str, Result]) -> None:
    read = results["direct"].record
    assert np.any(read["wheels.normal_force"] == 0)
    assert np.max(np.abs(read["body.slope"])) > 0.05


def test_wheels_that_drive_by_slip_follow_the_same_path(results: dict[str, Result]) -> None:
    """Over 7.5 m: the tractions differ by what spinning wheels take up, a few newtons on average."""
    ends = [results[name].record["body.position"][-1, :2] for name in ("direct", "driven")]
    assert np.hypot(*(ends[0] - ends[1])) < 0.02
    assert np.hypot(*(ends[0] - [0.0, 0.0])) > 7.0


def test_both_forces_are_those_of_the_drives_curve(results: dict[str, Result]) -> None:
    """The drive makes them for the load at the begin of a step: the wheels cut them where the load falls within it."""
    read = results["driven"].record
    for name in ("traction", "lateral"):
        given, asked = read[f"wheels.{name}"], read[f"drive.{name}_demand"]
        assert np.sqrt(np.mean((given - asked) ** 2)) < 1e-3 * np.sqrt(np.mean(asked**2))


def test_the_wheels_of_a_drive_roll_when_the_run_starts(results: dict[str, Result]) -> None:
    np.testing.assert_allclose(results["driven"].record["drive.spin"][0], 2.0 / 0.1, rtol=1e-12)
    np.testing.assert_allclose(results["driven"].record["drive.slip"][0], 0, atol=1e-12)


def test_the_speed_is_held(results: dict[str, Result]) -> None:
    for name in ("direct", "driven"):
        speed = results[name].record["body.velocity_body"][:, 0]
        assert np.all(np.abs(speed - 2.0) < 0.1)
