"""The claim of one-wheel-step: roll, three wheels, and twist modes that an equal step under both sides leaves alone."""

import numpy as np
import pytest

from plants.tables import robot
from studies.catalog import find_scenario
from studies.runner import Result, execute

HEIGHT, ROBOT = 0.02, robot("thesis_6_1")


@pytest.fixture(scope="module")
def results() -> dict[str, Result]:
    file = find_scenario("one-wheel-step")
    even = {"ground": {"kind": "step", "start": 0.75, "height": HEIGHT}}
    return {**{v: execute(file.load(v)) for v in file.variants}, "even": execute(file.load("soft", [even]))}


def roll(result: Result) -> np.ndarray:
    """Return the angle about the body's x axis, to the right positive, rad."""
    w, x, y, z = result.record["body.orientation"].T
    return np.arctan2(2 * (w * x + y * z), 1 - 2 * (x**2 + y**2))


def modal_energy(result: Result) -> tuple[np.ndarray, np.ndarray]:
    """Return the strain energies (n,) in J of the modes whose left and right wheels move alike, and of the others."""
    chassis = result.assembly.components["chassis"]
    shape, omega = chassis.values["wheel_shape"], 2 * np.pi * chassis.values["frequency"]
    twist = np.linalg.norm(shape[0::2] + shape[1::2], axis=0) < 1e-6 * np.linalg.norm(shape, axis=0)
    energy = (omega * result.record["chassis.modal_displacement"]) ** 2 / 2
    assert 0 < np.count_nonzero(twist) < twist.size
    return energy[:, ~twist].sum(axis=1), energy[:, twist].sum(axis=1)


@pytest.mark.parametrize("variant", ["soft", "hard"])
def test_the_robot_rolls_within_what_step_and_track_allow(results: dict[str, Result], variant: str) -> None:
    """Both left wheels on the step would roll it by h / (2 half_track) = 0.034 rad; the front one alone by less."""
    angle = roll(results[variant])
    assert 0.5 * HEIGHT / (2 * ROBOT.half_track) < np.max(angle) < HEIGHT / (2 * ROBOT.half_track)
    assert np.max(angle) <= 0.026  # rad, as claimed
    assert np.max(np.abs(roll(results["even"]))) < 1e-9


def test_it_stands_on_three_wheels_or_two(results: dict[str, Result]) -> None:
    """Soft wheels for 150 ms of 600 on exactly three; hard ones hop across the diagonal, hardly ever on three."""
    shares = {}
    for variant in ("soft", "hard", "even"):
        bearing = np.sum(results[variant].record["wheels.contact"] > 0.5, axis=1).astype(int)
        shares[variant] = np.bincount(bearing, minlength=5) / bearing.size
    assert shares["soft"][3] > 0.2
    assert shares["soft"][3] + shares["soft"][2] > 0.5
    assert shares["hard"][2] > 0.5
    assert shares["soft"][0] == shares["hard"][0] == 0  # never all in the air
    assert shares["even"][4] == 1


def test_the_right_front_wheel_ends_in_the_air(results: dict[str, Result]) -> None:
    """The left front wheel is up, the centre of mass lies behind the diagonal from it to the rear right wheel.

    So the robot rests on that diagonal and the rear left wheel.  On the diagonal, x = (L_f - L_r) / 2 in the centre
    plane, 7 cm ahead of the centre of mass.
    """
    assert (ROBOT.L_f - ROBOT.L_r) / 2 == pytest.approx(0.07)
    F = results["soft"].record["wheels.normal_force"][-1]
    assert F[1] == 0
    assert np.all(F[[0, 2, 3]] > 0)


def test_twist_modes_are_excited_by_one_side_only(results: dict[str, Result]) -> None:
    """They take twice the strain energy that the crossing adds to all other modes: 1.9 J against 0.8 J."""
    for variant in ("soft", "hard"):
        alike, twist = modal_energy(results[variant])
        assert np.max(twist) > 2 * np.max(alike - alike[0])
    even_alike, even_twist = modal_energy(results["even"])
    assert np.max(even_twist) < 1e-12 * np.max(even_alike)


def test_the_edge_is_located(results: dict[str, Result]) -> None:
    """There is a point of each run where the wheel is as far in the level as in the edge: on the bisector of the kink.

    The path has its kink sqrt(2 R h - h^2) before the step and turns up by gamma there, cos gamma = 1 - h / R.  A wheel
    pressed in by d meets the bisector d tan(gamma / 2) later, but for the bend 1 / R of the path over the edge.
    """
    kink = 0.75 - np.sqrt(2 * ROBOT.R * HEIGHT - HEIGHT**2)
    turn = np.tan(np.arccos(1 - HEIGHT / ROBOT.R) / 2)
    for result in results.values():
        record = result.record
        assert len(record.events) == 1
        (at,) = np.flatnonzero(record.time_ns == record.events[0][0])
        pressed = -record["body.gap"][at, 0]
        found = record["body.wheel_centre"][at, 0, 0]
        assert found == pytest.approx(kink + pressed * turn, abs=pressed**2 / ROBOT.R + 1e-8)
