"""The shock-collision scenario keeps its claim: corners, one wheel against two, modes, damping; the exact replay."""

from __future__ import annotations

import numpy as np
import pytest

from studies.shock.cases import CORNERS, INNER, at, platform
from studies.shock.claims_collision import impulses
from studies.shock.collision import (
    ONE,
    ONE_HARD,
    TWO,
    TWO_HARD,
    VARIANTS,
    collide,
    collision_figure,
    replayed,
    row,
    sensitivity,
    sensitivity_figure,
    sentence,
)


@pytest.mark.parametrize("variant", VARIANTS)
def test_replay_drives_the_modes_as_the_fmu_was_driven(variant: str) -> None:
    """The FMU starts from forces that its wheels were solved for, equal to those of the first step to 1e-6 of them."""
    impact = collide(variant)
    off = np.abs(replayed(impact, platform()) - impact.recorded)
    assert np.max(off) < 1e-5 * np.max(np.abs(impact.recorded))


def test_a_corner_is_no_place_for_a_sensor() -> None:
    peak = row(ONE).peak
    assert peak[0] == pytest.approx(16, abs=0.6)
    np.testing.assert_allclose(at(peak, CORNERS[1:]), 8, atol=0.5)
    assert at(peak, INNER).max() == pytest.approx(3.2, abs=0.05)
    rows = [*sensitivity(ONE), *sensitivity(TWO)]
    assert all(r.worst in CORNERS for r in rows)
    assert min(at(r.peak, CORNERS).max() / at(r.peak, INNER).max() for r in rows) > 2


def test_both_wheels_are_not_milder_than_one() -> None:
    assert np.all(row(TWO).peak > row(ONE).peak)
    assert np.sum(row(TWO_HARD).peak > row(ONE_HARD).peak) == 17


def test_the_rear_hardly_reacts() -> None:
    shares = impulses(collide(TWO))
    assert shares[2] / shares[0] == pytest.approx(0.02, abs=0.005)


@pytest.mark.parametrize("variant", [ONE, TWO])
def test_peaks_diverge_but_what_equipment_feels_settles(variant: str) -> None:
    few, many = row(variant, 25), row(variant, 200)
    assert many.peak[0] > 10 * few.peak[0]
    assert many.felt[0] == pytest.approx(few.felt[0], rel=0.06)


@pytest.mark.parametrize("variant", [ONE_HARD, TWO_HARD])
def test_peaks_settle_where_the_force_does_not_jump(variant: str) -> None:
    """From 100 to 200 modes by less than a twentieth, from 25 by more than a half."""
    found = {n: row(variant, n).peak.max() for n in (25, 100, 200)}
    assert found[200] == pytest.approx(found[100], rel=0.05)
    assert found[200] > 1.5 * found[25]


def test_two_wheels_shake_both_sides_alike() -> None:
    peak = row(TWO).peak.reshape(5, 4)
    np.testing.assert_allclose(peak, peak[:, ::-1], rtol=1e-6)


def test_sheets_and_sentence() -> None:
    table = collision_figure().columns
    assert sorted(table[f"{ONE}, rank"]) == list(range(1, 21))
    assert table[f"{ONE}, rank"][0] == 1
    assert set(sensitivity_figure().columns["collision"]) == set(VARIANTS)
    assert sentence().startswith("Do not mount a sensor at a corner: a front wheel on the ramp at 2 m/s gives 16.5 g")
