"""Figures of the impact chapter: verdicts, and the numbers that decide them against closed forms written out here."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

from studies.catalog import find_scenario
from studies.figures.claim import CONTRADICTED, REPRODUCED, TREND
from studies.figures.entry import Entry
from studies.figures.impact import ENTRIES
from studies.figures.impact_gains import overshoot

M, I_Y, L_F, L_R, H, G = 170.0, 47.0, 0.6, 0.46, 0.4, 9.81  # Table 6.1
S, C = np.sin(0.3), np.cos(0.3)
RN, RA = np.array([L_R, H * S - L_F * C]), np.array([-H, -(H * C + L_F * S)])
P = np.array([[1, C], [C, 1]]) / M + np.outer(RN, RN) / I_Y
U = np.array([[0, S], [-S, 0]]) / M + np.outer(RN, RA) / I_Y
B = -G * np.array([1, C])
K, SOFT = 5.6e6, 4.1e6
E0, V0 = 0.02, -0.6  # error and rate of the front axle at the impact, with the target at once

BY_KEY = {entry.key: entry for entry in ENTRIES}
VERDICTS = {
    "thesis 6.5": [REPRODUCED, TREND, CONTRADICTED, REPRODUCED],
    "thesis 6.6": [REPRODUCED, CONTRADICTED, REPRODUCED, REPRODUCED],
    "thesis 6.7": [REPRODUCED, CONTRADICTED, REPRODUCED, REPRODUCED, TREND],
    "thesis 6.8": [CONTRADICTED, CONTRADICTED],
    "thesis 6.9": [TREND, REPRODUCED, TREND],
    "thesis 6.10": [REPRODUCED, CONTRADICTED, CONTRADICTED],
    "thesis 6.11": [REPRODUCED, CONTRADICTED],
    "thesis 6.16 poles": [CONTRADICTED, CONTRADICTED, CONTRADICTED],
    "wheel impact paper 4": [REPRODUCED, TREND, CONTRADICTED],
    "wheel impact paper 5": [REPRODUCED, TREND, CONTRADICTED],
    "wheel impact paper 6": [CONTRADICTED, CONTRADICTED],
    "wheel impact paper 7": [CONTRADICTED, CONTRADICTED],
    "wheel impact paper 8": [REPRODUCED, CONTRADICTED],
}


def numbers(key: str, claim: int) -> dict[str, float]:
    """Return the numbers of a claim, counted from 0."""
    return BY_KEY[key].claims()[claim].numbers


def extremes(h0: float, h1: float) -> tuple[float, float]:
    """Return the error at its first and second extreme: e' = 0 at tan(w t) = v0 w / (a v0 + h0 e0), then pi/w later."""
    a, w = h1 / 2, np.sqrt(h0 - h1**2 / 4)
    first = (np.arctan2(V0 * w, a * V0 + h0 * E0) % np.pi) / w
    t = np.array([first, first + np.pi / w])
    e = np.exp(-a * t) * (E0 * np.cos(w * t) + (V0 + a * E0) / w * np.sin(w * t))
    return float(e[0]), float(e[1])


@pytest.mark.parametrize("key", VERDICTS)
def test_every_claim_has_its_verdict(key: str) -> None:
    claims = BY_KEY[key].claims()
    assert [c.verdict for c in claims] == VERDICTS[key]
    assert all(c.where and c.text and c.found and c.numbers for c in claims)


def test_every_entry_is_judged_here() -> None:
    assert list(VERDICTS) == [entry.key for entry in ENTRIES]


@pytest.mark.parametrize("entry", ENTRIES, ids=lambda entry: entry.key)
def test_every_figure_has_data_and_units(entry: Entry, tmp_path: Path) -> None:
    sheet = entry.make()
    assert len({len(c) for c in sheet.columns.values()}) == 1
    assert all(np.all(np.isfinite(c)) for c in sheet.columns.values() if c.dtype.kind == "f")
    labels = [axis.get_xlabel() for axis in sheet.figure.axes] + [axis.get_ylabel() for axis in sheet.figure.axes]
    assert any(" / " in label for label in labels)
    if entry.key in ("thesis 6.5", "thesis 6.16 poles"):
        sheet.save(tmp_path / "sheet")
        assert (tmp_path / "sheet.png").stat().st_size > 5000
        assert len((tmp_path / "sheet.csv").read_text().splitlines()) == 1 + len(next(iter(sheet.columns.values())))
    if entry.run is not None:
        assert entry.run[1] in find_scenario(entry.run[0]).variants


def test_overshoot_and_rebound_of_the_error_equation() -> None:
    """Closed form, to the 0.1 ms of the samples: a quadratic top, so about (w 5e-5)^2 / 2 of it."""
    assert numbers("thesis 6.5", 1)["critical"] == pytest.approx(2 * np.sqrt(1500), rel=1e-12)
    assert numbers("wheel impact paper 5", 1)["critical"] == pytest.approx(35.0**2, rel=1e-12)
    for h0, h1, printed in ((1500.0, 65.0, 0.017), (1550.0, 70.0, 0.005)):
        passed = -extremes(h0, h1)[0] / E0
        assert overshoot(h0, h1) == pytest.approx(passed, rel=1e-4)
        assert passed == pytest.approx(printed, abs=5e-4)
    leaves = brentq(lambda h1: extremes(1500.0, h1)[1] - E0, 1.0, 10.0)
    assert numbers("thesis 6.5", 2)["gain"] == pytest.approx(leaves, abs=2e-3)  # the search ends at 1e-3
    assert leaves < 3.0
    for h0 in (1550.0, 1e4, 1e5, 1e6):
        assert extremes(h0, 70.0)[1] < E0  # never back to 0, however large h0


def test_an_integral_is_the_third_order_loop() -> None:
    """Overshoot by SciPy's matrix exponential of (D^3 + h1 D^2 + h0 D + h_I) y = 0, e = D y; without h_I as above."""
    found = numbers("thesis 6.6", 3)
    assert found["overshoot, 0"] == pytest.approx(-extremes(1500.0, 70.0)[0] / E0, rel=1e-3)  # samples of 1 ms
    step = expm(1e-3 * np.array([[0, 1, 0], [0, 0, 1], [-2e4, -1500, -70.0]]))
    state, errors = np.array([0.0, E0, V0]), []
    for _ in range(1000):
        state = step @ state
        errors.append(state[1])
    assert found["overshoot, 20000"] == pytest.approx(-min(errors) / E0, rel=1e-6)


def test_settling_times_of_the_axles() -> None:
    found = numbers("thesis 6.7", 2)
    assert found["front"] == pytest.approx(0.087, abs=5e-4)
    assert found["rear"] == pytest.approx(0.122, abs=5e-4)
    slow = numbers("thesis 6.7", 1)
    assert slow["pole"] == pytest.approx(-750 + np.sqrt(750.0**2 - 70), rel=1e-6)
    assert slow["settling"] == pytest.approx(np.log(50) / -slow["pole"], rel=1e-3)  # one slow pole: 2 % after ln 50


def test_tractions_that_hold_the_final_deformations() -> None:
    """U F = P k z_R - b with every sign of the planar model written out above."""
    for k, key, names in ((K, "thesis 6.8", ("rear", "front")), (SOFT, "thesis 6.9", ("rear soft", "front soft"))):
        F = np.linalg.solve(U, P @ (k * np.array([-0.01, -0.02])) - B)
        found = numbers(key, 0 if key == "thesis 6.8" else 1)
        assert [found[name] for name in names] == pytest.approx(F, rel=1e-9)
    held = numbers("thesis 6.8", 0)
    assert [held["rear"], held["front"]] == pytest.approx([628.9e3, -470.9e3], abs=50)
    assert [held["rear share"], held["front share"]] == pytest.approx([11.2, 4.2], abs=0.05)
    started = np.linalg.solve(U, np.array([-15.0, -30.0 + 42.0]) - B)  # -h0 (0 - z_R) - h1 z'
    assert [held["rear at once"], held["front at once"]] == pytest.approx(started, rel=1e-9)
    engaged = numbers("thesis 6.11", 1)
    assert [engaged["rear at once"], engaged["front at once"]] == pytest.approx(np.linalg.solve(U, -B), rel=1e-9)


def test_poles_right_and_as_printed() -> None:
    mean, half = K * np.trace(P) / 2, K * np.hypot((P[0, 0] - P[1, 1]) / 2, P[0, 1])
    low, high = np.sqrt(mean - half), np.sqrt(mean + half)
    found = numbers("thesis 6.16 poles", 0)
    assert [found["low"], found["high"], found["as printed"]] == pytest.approx([low, high, high], rel=1e-9)
    assert [low, high] == pytest.approx([226.6, 253.8], abs=0.05)
    growth = -35 + np.sqrt(35.0**2 - 1500 + 2 * high**2)  # s^2 + h1 s + h0 - 2 k lambda = 0
    assert numbers("thesis 6.16 poles", 1)["as printed"] == pytest.approx(growth, rel=1e-9)
    assert growth == pytest.approx(323.6, abs=0.05)


def test_hard_wheels_hit_harder() -> None:
    """A mass of 1/P22 on a spring: v sqrt(k / P22)."""
    found = numbers("thesis 6.9", 2)
    for name, k in (("hit hard", K), ("hit soft", SOFT)):
        assert found[name] == pytest.approx(2 * S * np.sqrt(k / (1 / M + RN[1] ** 2 / I_Y)), rel=1e-9)


def test_the_planned_path_and_its_misprint() -> None:
    """The polynomial of the eight conditions, by NumPy; the wrong sign of v0 T in C7 adds -20 v0 T at the end."""
    jerks, ends, deepest = (numbers("thesis 6.10", i) for i in range(3))
    derivatives = [np.polynomial.polynomial.polyder(np.eye(8), n, axis=0) for n in range(4)]
    for T, force in ((0.1, (628.9, 470.9)), (0.15, (632.4, 512.4)), (0.2, (700.7, 611.1))):
        conditions = [x ** np.arange(len(D)) @ D for x in (0.0, T) for D in derivatives]
        path = np.polynomial.Polynomial(np.linalg.solve(conditions, [0, V0, 0, 0, -E0, 0, 0, 0]))
        t = np.linspace(0, T, 4001)
        # differences over T/1000 of a curve that bends with 40 / T^2
        assert jerks[f"T = {T:g}"] == pytest.approx(np.max(np.abs(path.deriv(3)(t))), rel=1e-4)
        assert 1e-3 * deepest[f"deepest, T = {T:g}"] == pytest.approx(np.min(path(t)), abs=1e-6)
        assert ends[f"T = {T:g}"] == pytest.approx(-E0 - 20 * V0 * T, rel=1e-9)
        assert [1e-3 * deepest[f"{axle}, T = {T:g}"] for axle in ("rear", "front")] == pytest.approx(force, abs=0.05)


def test_co_simulated_runs_bear_the_verdicts() -> None:
    grip = numbers("thesis 6.7", 4)
    assert grip["rebounds"] >= 1
    assert grip["off within friction"] > 100  # of 200 ms
    assert grip["friction needed"] > 11.2  # the frozen model's steady share of the rear is not the most
    tracking = numbers("thesis 6.11", 0)
    assert tracking["planned"] < tracking["step"] / 10
    columns = BY_KEY["thesis 6.7"].make().columns
    for axle, target in (("rear", -0.01), ("front", -0.02)):
        assert columns[f"z {axle}, co-simulated [m]"][-1] == pytest.approx(target, rel=0.02)  # settled by 0.176 s
        assert columns[f"z {axle} [m]"][-1] == pytest.approx(target, rel=0.02)


def test_within_friction_the_law_of_the_thesis_hits_harder_than_none() -> None:
    """Its peak is above v sqrt(k / P22) plus twice the load, the most of a free impact."""
    grip = numbers("thesis 6.7", 4)
    most = 2 * S * np.sqrt(K / P[1, 1]) + 2 * M * G * L_R / (L_F + L_R)
    assert grip["peak within friction"] > most > grip["peak without control"]
