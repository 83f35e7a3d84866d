"""The full-order-brake scenario keeps its claim: slip control on the plant of its design, and on a richer one."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from plants.tables import G
from studies.catalog import find_scenario
from studies.runner import Result, execute

FILE = find_scenario("full-order-brake")
SPEED, SLOW, MU = 2.0, 0.1, 0.3
PEAK = np.tan(np.pi / (2 * 1.65)) * 1.65 * MU / 8.0  # slip ratio of the curve that the law believes in


@cache
def run(variant: str) -> Result:
    result = execute(FILE.load(variant))
    assert result.error is None
    return result


def way(variant: str) -> float:
    """Return how far the body goes until it has slowed down to SLOW, in m."""
    record = run(variant).record
    slow = record["body.velocity"][:, 0] < SLOW
    assert np.any(slow)
    return float(record["body.position"][np.argmax(slow), 0])


@pytest.mark.parametrize("variant", ["analytical", "full-order"])
def test_on_a_slippery_floor_it_stops_as_short_as_friction_lets_it(variant: str) -> None:
    """(v^2 - v_1^2) / (2 mu g), and up to 10 mm for 10 ms in which the slip grows and half the friction is there."""
    shortest = (SPEED**2 - SLOW**2) / (2 * MU * G)
    assert shortest < way(variant) < shortest + 0.010


def test_both_robots_stop_alike() -> None:
    assert way("full-order") == pytest.approx(way("analytical"), rel=2e-3)


@pytest.mark.parametrize("variant", ["analytical", "full-order"])
def test_the_slip_is_held_at_the_peak(variant: str) -> None:
    """On average within 2 % of it: the integral time of 20 ms over the 0.65 s in which the speed falls."""
    result = run(variant)
    slip, t = result.signal("drive.slip"), result.record.time
    assert slip is not None
    np.testing.assert_allclose(slip[(t > 0.1) & (t < 0.3)].mean(axis=0), -PEAK, rtol=20 / 650)


def test_a_friction_curve_that_falls_is_not_the_one_believed_in() -> None:
    """Not friction at rest, not sliding friction: in between, where the law lets the wheels slide."""
    at_rest, sliding = ((SPEED**2 - SLOW**2) / (2 * mu * G) for mu in (0.8, 0.3))
    assert at_rest < way("analytical-grip") < 1.2 * at_rest
    assert 1.5 * way("analytical-grip") < way("full-order-grip") < sliding


def test_without_the_fall_it_agrees_again() -> None:
    assert way("full-order-grip-sliding") == pytest.approx(way("analytical-grip"), rel=0.06)


def test_both_lose_what_they_had() -> None:
    """The work of the motors and the loss in slip take the kinetic energy, m v^2 / 2 of 170 kg and of the rings."""
    for variant, mass in (("analytical", 170.0), ("full-order", 170.0 + 4 * 0.83)):
        result = run(variant)
        found = {m.key: m.value for m in result.metrics}
        lost, worked = found["slip_loss"], found["actuator_energy"]
        assert lost is not None
        assert worked is not None
        # beside it wheels that turn, 4 (J_w + m R^2) w^2 / 2 = 15 J at most, and what damping takes
        assert 0 < lost + worked - mass * SPEED**2 / 2 < 20
