"""The claim of hump: no kink, no event; contact kept below and lost above the speed that the planar model gives."""

import numpy as np
import pytest
from rigid_checks import assert_keeps_the_laws_of_contact, touchdowns
from scipy.signal import lfilter

from cosim.record import Record
from plants.contact_loss import speed_at_loss
from plants.ground import Hump
from plants.planar import Bicycle, Posture
from plants.tables import robot
from plants.wheel_path import rolling_path
from studies.catalog import find_scenario
from studies.runner import Result, execute

ROBOT = robot("thesis_6_1")
BICYCLE = Bicycle(ROBOT)
STEP = 2e-4


@pytest.fixture(scope="module")
def results() -> dict[str, Result]:
    file = find_scenario("hump")
    return {variant: execute(file.load(variant)) for variant in file.variants}


def axles(record: Record) -> np.ndarray:
    """Return the normal forces of the rear and the front axle, (n, 2), N."""
    return record["wheels.normal_force"].reshape(-1, 2, 2).sum(axis=2)[:, ::-1]


def rolling_forces(record: Record) -> np.ndarray:
    """Return what the planar model gives for the postures and velocities of a run, (n, 2), N; negative: it pulls."""
    found = []
    for slope, bend, pitch, v, rate in zip(
        record["body.slope"], record["body.curvature"], record["body.pitch"], record["body.velocity_body"],
        record["body.rate"], strict=True,
    ):  # fmt: skip
        at = Posture(slope[0], slope[2], pitch, (bend[2], bend[0]))
        found.append(BICYCLE.contact_forces(at, np.array([v[0], v[2], rate[1]]), np.zeros(2)))
    return np.array(found)


def test_there_is_no_event_to_locate(results: dict[str, Result]) -> None:
    for result in results.values():
        assert result.record.events == []
        assert result.record.rejections == []


def test_the_crest_is_left_at_3_3_metres_per_second() -> None:
    path = rolling_path(Hump(start=0.8, length=1.0, height=0.05), ROBOT.R)
    crest = Posture(0.0, curvature=(0.0, float(path.curvature(1.3))))
    assert speed_at_loss(BICYCLE, crest)[1] == pytest.approx(3.30, abs=5e-3)


@pytest.mark.parametrize("variant", ["damped", "undamped", "rigid"])
def test_at_1_metre_per_second_no_wheel_leaves_the_ground(results: dict[str, Result], variant: str) -> None:
    record = results[variant].record
    assert np.min(record["wheels.normal_force"]) > 0
    metrics = {m.key: m.value for m in results[variant].metrics}
    assert metrics["front_off"] == metrics["rear_off"] == 0
    assert record["body.position"][-1, 0] > 1.0  # the hump ends at 1.8 m, the rear axle is 0.46 m behind


def test_springs_at_most_double_the_changes_of_the_axle_forces(results: dict[str, Result]) -> None:
    """A load put on an undamped spring at once shows twice, one that comes gradually less."""
    rigid = axles(results["rigid"].record)[1:]
    for variant in ("damped", "undamped"):
        change = axles(results[variant].record)[1:] - rigid[0]
        assert np.all(np.max(change, axis=0) < 2 * np.max(rigid - rigid[0], axis=0))
        assert np.all(np.min(change, axis=0) > 2 * np.min(rigid - rigid[0], axis=0))


@pytest.mark.parametrize("variant", ["rigid", "rigid-fast"])
def test_rigid_wheels_carry_what_the_planar_model_says(results: dict[str, Result], variant: str) -> None:
    """Up to the first loss of contact, and that comes where the model would have to pull, within two steps.

    A force that changes within a step is missed by its change; the gap and velocity that this leaves are undone in
    waves that shrink by sqrt(1/2) a step.  1e-3 of the weight beside is for what the body moves within a step.
    """
    record = results[variant].record
    expected, found = rolling_forces(record), axles(record)
    lost = np.any(record["wheels.contact"][1:] < 0.5, axis=1)
    last = int(np.argmax(lost)) if np.any(lost) else len(lost)
    change = np.abs(np.diff(expected, axis=0))[:last]
    bound = lfilter([1.0], [1.0, -np.sqrt(0.5)], change, axis=0) + 1e-3 * ROBOT.m * 9.81
    assert np.all(np.abs(found[1:] - expected[:-1])[:last] <= bound)
    pulled = np.any(expected < 0, axis=1)
    if variant == "rigid":
        assert last == len(lost)
        assert not np.any(pulled)
    else:
        assert record.time[last + 1] - record.time[np.argmax(pulled)] == pytest.approx(0, abs=2 * STEP)


def test_at_4_metres_per_second_the_rigid_fronts_fly_and_land(results: dict[str, Result]) -> None:
    record = results["rigid-fast"].record
    assert_keeps_the_laws_of_contact(record, STEP)
    assert np.all(touchdowns(record) >= 1)
    assert np.all(record["wheels.contact"][-1] > 0.5)
    metrics = {m.key: m.value for m in results["rigid-fast"].metrics}
    assert metrics["front_off"] == pytest.approx(163, abs=10)  # ms, as claimed
