"""Jerk at insufficient, ideal and excessive traction on the full-order robot (DYMAC paper Fig 5, ASME paper Fig 6)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .claim import Claim, graded
from .full_case import run
from .sheet import LINES, Sheet, panels

SCENARIO = "full-order-jerk"
LEVELS = ("insufficient", "ideal", "excessive")
WINDOW = 0.05  # s, of the difference quotients: five times as long as a node takes to pass the ground at 2 m/s
_LEVEL = 1e-3  # rad
ASSUMED = (
    "wheels of 1e5 N/m and 1000 N.s/m, on which the robot bounces, and a ramp with a fillet of 1 m, none of which "
    "is given (on a sharp foot the impact is all that there is); forces laid on at the ground"
)


@dataclass(frozen=True)
class Case:
    """One of the two papers: its forces in N by level, its slope in rad, and which jerk it shows."""

    name: str
    forces: tuple[float, float, float]
    slope: float
    axis: int  # of the body: 0 longitudinal, 2 normal
    what: str


DYMAC = Case("dymac", (230.0, 380.0, 530.0), 0.3, 2, "normal")
ASME = Case("asme", (200.0, 350.0, 500.0), 0.4363, 0, "longitudinal")


def jerk(case: Case, level: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return time (n,) in s, jerk (n,) in m/s3, and (n,) whether the fronts are on the slope and the rears are not."""
    record = run(f"{case.name}-{level}", SCENARIO).record
    time, a, slope = record.time, record["body.acceleration"][:, case.axis], record["body.slope"]
    total = np.concatenate([[0.0], np.cumsum(a[1:] * np.diff(time))])  # means over the step that ended
    t = np.arange(time[0] + WINDOW, time[-1] - WINDOW, 1e-3)
    speed = [np.interp(t + shift, time, total) for shift in (-WINDOW, 0.0, WINDOW)]
    at = np.searchsorted(time, t)
    on = (np.abs(slope[at, 0] - case.slope) < _LEVEL) & (np.abs(slope[at, 2]) < _LEVEL)
    return t, (speed[2] - 2 * speed[1] + speed[0]) / WINDOW**2, on


def rms(case: Case, level: str) -> float:
    """Return the RMS jerk (m/s3) while the fronts are on the slope and the rears on the level."""
    _, values, on = jerk(case, level)
    return float(np.sqrt(np.mean(values[on] ** 2)))


def _figure(case: Case, title: str) -> Sheet:
    figure, axes = panels(title, 1, 1, figsize=(9, 4))
    columns: dict[str, np.ndarray] = {}
    shortest = min(len(jerk(case, level)[0]) for level in LEVELS)
    for level, force, colour in zip(LEVELS, case.forces, LINES, strict=False):
        t, values, on = (v[:shortest] for v in jerk(case, level))
        columns |= {"time [s]": t, f"{level}, {force:g} N [m/s3]": values}
        axes[0, 0].plot(t, values, color=colour, lw=0.8, alpha=0.4)
        axes[0, 0].plot(t, np.where(on, values, np.nan), color=colour, label=f"{level}, {force:g} N")
    axes[0, 0].set(xlabel="time / s", ylabel=f"{case.what} jerk / (m/s³)")
    axes[0, 0].legend(frameon=False, fontsize=8)
    note = f"quotients over {WINDOW:g} s; bold while the fronts are on the slope and the rears on the level"
    return Sheet(title, columns, figure, (note, ASSUMED))


def dymac_figure() -> Sheet:
    """Return Fig 5 of the DYMAC paper: normal jerk at three tractions."""
    return _figure(DYMAC, "Normal jerk at three tractions, full-order robot (DYMAC paper, Fig 5)")


def asme_figure() -> Sheet:
    """Return Fig 6 of the ASME paper: longitudinal jerk at three tractions."""
    return _figure(ASME, "Longitudinal jerk at three tractions, full-order robot (ASME paper, Fig 6)")


def _least(case: Case, where: str, text: str) -> Claim:
    found = {level: rms(case, level) for level in LEVELS}
    words = ", ".join(f"{f:g} N {found[level]:.3g}" for level, f in zip(LEVELS, case.forces, strict=True))
    return Claim(
        where, text,
        f"RMS {case.what} jerk, m/s3: {words}; it grows with the traction" if _grows(found) else
        f"RMS {case.what} jerk, m/s3: {words}",
        graded(found["ideal"] < min(found["insufficient"], found["excessive"])),
        found, assumption=ASSUMED,
    )  # fmt: skip


def _grows(found: dict[str, float]) -> bool:
    return found["insufficient"] < found["ideal"] < found["excessive"]


def dymac_claims() -> list[Claim]:
    """Return the verdicts on Fig 5 of the DYMAC paper."""
    record = run("dymac-excessive-friction", SCENARIO).record
    on = jerk(DYMAC, "excessive")
    time = record.time
    passed = float(
        np.mean(record["body.traction"][(time > on[0][on[2]][0]) & (time < on[0][on[2]][-1]), 2:].sum(axis=1))
    )
    return [
        _least(DYMAC, "DYMAC paper, 3.3, Fig 5", "380 N gives an almost jerk-free motion, more or less jerks a lot"),
        Claim(
            "DYMAC paper, Fig 5",
            "an excessive traction can be applied at the rear wheels",
            f"with friction of 0.8, and 0.3 where they slide, they pass on {passed:.0f} of {DYMAC.forces[2]:g} N",
            graded(passed > 0.95 * DYMAC.forces[2], passed > 0.8 * DYMAC.forces[2]),
            {"passed": passed},
            assumption="friction of section 6.7; the paper gives none",
        ),
    ]  # fmt: skip


def asme_claims() -> list[Claim]:
    """Return the verdicts on Fig 6 of the ASME paper."""
    text = "at the ideal traction of 350 N the longitudinal jerk is close to zero, at 200 and 500 N it is not"
    found = {level: jerk(ASME, level) for level in LEVELS}
    means = {level: float(np.mean(values[on])) for level, (_, values, on) in found.items()}
    return [
        _least(ASME, "ASME paper, section 4, Fig 6", text),
        Claim(
            "ASME paper, section 4",
            "too much traction jerks the robot forward, too little the opposite",
            "mean longitudinal jerk, m/s3: " + ", ".join(f"{level} {value:.2f}" for level, value in means.items()),
            graded(means["insufficient"] < 0 < means["excessive"], means["insufficient"] < means["excessive"]),
            means,
            assumption=ASSUMED,
        ),
    ]
