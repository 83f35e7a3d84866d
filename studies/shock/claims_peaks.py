"""Claims about peaks at the stations (thesis 8.4 and 8.6)."""

from __future__ import annotations

import numpy as np

from plants.chassis_modes import ModalData
from plants.pulses import Pulse
from plants.shock import GRAVITY, peaks
from plants.shock_fourier import fourier_response
from plants.shock_loads import free_amplitude
from studies.figures.claim import EQUAL, Claim, graded

from .cases import CASES, CORNERS, EDGES, FORCE, INNER, LONG, SHORT, acceleration, at, times


def station_1_is_worst(data: ModalData) -> Claim:
    """8.4: the station above the struck wheel."""
    exact, series = peaks(acceleration(data)), peaks(acceleration(data, method=fourier_response))
    worst, by_series = int(np.argmax(exact)) + 1, int(np.argmax(series)) + 1
    return Claim(
        "8.4",
        "station 1 sustains the largest peak acceleration (single wheel, 0.05 s)",
        f"exact: station {worst} with {exact.max():.1f} g; the thesis' series to 200 Hz: station {by_series} with "
        f"{series.max():.1f} g, station 1 with {series[0]:.1f} g",
        graded(worst == 1),
        {"exact": float(exact[0]), "series": float(series[0]), "worst by series": by_series},
    )


def other_corners_5_g(data: ModalData) -> Claim:
    """8.4: the other three corners."""
    a = acceleration(data)
    others = at(peaks(a), CORNERS[1:])
    rms = at(np.sqrt(np.mean(a**2, axis=0)) / GRAVITY, CORNERS[1:])
    few = at(peaks(acceleration(data.first(5))), CORNERS[1:])
    return Claim(
        "8.4",
        "stations 4, 17 and 20 have peaks of about 5 g",
        f"{', '.join(f'{p:.1f}' for p in others)} g, {others.mean() / 5:.1f} times as much; similar to each other "
        f"(rms {rms.min():.1f} to {rms.max():.1f} g; with 5 modes {few.min():.1f} to {few.max():.1f} g)",
        graded(bool(np.all(np.abs(others - 5) < 1)), bool(others.max() < 1.5 * others.min())),
        {"least": float(others.min()), "most": float(others.max())},
    )


def corners_edges_interior(data: ModalData) -> Claim:
    """8.4: the trend over the platform."""
    found = peaks(acceleration(data))
    corners, edges, inner = (at(found, group) for group in (CORNERS, EDGES, INNER))
    groups = zip(("corners", "edges", "inside"), (corners, edges, inner), strict=True)
    return Claim(
        "8.4",
        "corners respond most, then the edges, least the interior",
        ", ".join(f"{name} {values.min():.1f} to {values.max():.1f} g" for name, values in groups),
        graded(
            bool(corners.min() > edges.max() and edges.min() > inner.max()),
            bool(corners.mean() > edges.mean() > inner.mean()),
        ),
        {"least corner": float(corners.min()), "worst edge": float(edges.max()), "worst inner": float(inner.max())},
    )


def station_10(data: ModalData) -> Claim:
    """8.4: the middle of the platform."""
    found = peaks(acceleration(data))
    share = float(found[9] / found[0])
    return Claim(
        "8.4",
        "the peak at station 10 is 23 % less than at station 1",
        f"{100 * (1 - share):.0f} % less: it is {100 * share:.0f} % of it, so '23 % of' is the likely meaning",
        graded(abs(1 - share - 0.23) < 0.05),
        {"share": share},
    )


def shorter_is_harsher(data: ModalData) -> Claim:
    """8.4, Fig 8.11: higher peaks, and for longer."""
    wins, words = 0, []
    numbers: dict[str, float] = {}
    for case in CASES:
        (top, after), (top_long, after_long) = (_peak_and_rest(data, case, d) for d in (SHORT, LONG))
        wins += top > 1.01 * top_long and after > after_long
        words.append(f"{case} {top:.1f} and {top_long:.1f} g, rms after it {after:.2f} and {after_long:.2f} g")
        numbers |= {f"{case} 0.05": top, f"{case} 0.08": top_long, f"{case} rms": after, f"{case} rms 0.08": after_long}
    factors = [free_amplitude(Pulse("rectangular", d), data.frequency[:3]).round(2).tolist() for d in (SHORT, LONG)]
    return Claim(
        "8.4",
        "the 0.05 s pulse gives higher and longer sustained peaks at station 1 than the 0.08 s pulse",
        f"{'; '.join(words)}. 2|sin(pi f T)| decides, mode by mode: {factors[0]} and {factors[1]} in the first three",
        graded(wins == len(CASES), wins > 0),
        numbers,
    )


def _peak_and_rest(data: ModalData, case: str, duration: float) -> tuple[float, float]:
    """Return the peak at station 1 and the rms after the pulse, in g."""
    t = times()
    a = acceleration(data, case, duration, t=t)[:, 0] / GRAVITY
    return float(np.max(np.abs(a))), float(np.sqrt(np.mean(a[t > duration] ** 2)))


def diagonal_is_worse_than_four(data: ModalData) -> Claim:
    """8.6, Fig 8.14."""
    wheel = [peaks(acceleration(data, case)) for case in ("diagonal", "four")]
    even = [peaks(acceleration(data, case, total=FORCE)) for case in ("diagonal", "four")]
    more, more_even = (int(np.sum(d > f * (1 + EQUAL))) for d, f in (wheel, even))
    alike = int(np.sum(np.abs(even[0] - even[1]) <= EQUAL * even[0]))
    return Claim(
        "8.6",
        "four-wheel excitation gives less severe peaks than diagonal excitation",
        f"with 1000 N in all at {more_even} stations and equal ones at {alike} (station 1: {even[0][0]:.1f} and "
        f"{even[1][0]:.1f} g); with 1000 N per wheel at {more} of 20 (station 1: {wheel[0][0]:.1f} and "
        f"{wheel[1][0]:.1f} g)",
        graded(more == len(wheel[0]), more_even + alike == len(even[0])),
        {"more per wheel": more, "more in all": more_even, "alike in all": alike},
    )
