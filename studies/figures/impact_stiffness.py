"""What the stiffness of the wheels does to the tractions of the impact law (thesis Fig 6.9)."""

from __future__ import annotations

import numpy as np

from .claim import Claim, graded
from .impact_case import FRICTION, HARD, SLOPE, SOFT, SPEED, TARGET, axles, both_stepped, measured, times, traction
from .impact_response import FROZEN, SIDES, held
from .sheet import LINES, Sheet, panels


def stiffness_figure() -> Sheet:
    """Return Fig 6.9: the tractions for a stiff and a soft wheel."""
    t = times()
    figure, axes = panels("Tractions of the impact law on stiff and soft wheels (Fig 6.9)", 2, 1, sharex=True)
    columns = {"time [s]": t}
    for k_w, style in ((HARD, "-"), (SOFT, "--")):
        F = traction(axles(k_w), both_stepped(t))
        for k, (side, axis) in enumerate(zip(SIDES, axes.flat, strict=True)):
            columns[f"F {side}, k = {k_w / 1e6:g}e6 N/m [N]"] = F[:, k]
            axis.plot(t, 1e-3 * F[:, k], style, color=LINES[k], label=f"k = {k_w / 1e6:g}e6 N/m")
            axis.set_ylabel(f"{side} axle / kN")
            axis.legend(frameon=False, fontsize=8)
    axes[-1, 0].set_xlabel("time since the impact / s")
    return Sheet("Tractions on stiff and soft wheels", columns, figure, (FROZEN,))


def _lower_forces() -> Claim:
    hard, soft = held(axles(HARD)), held(axles(SOFT))
    t = times()
    peaks = {k: np.max(np.abs(traction(axles(k), both_stepped(t))), axis=0) for k in (HARD, SOFT)}
    power = {k: 1e-6 * SPEED * float(np.sum(np.abs(F))) for k, F in ((HARD, hard), (SOFT, soft))}
    words = [f"rear {F[0] / 1e3:+.1f}, front {F[1] / 1e3:+.1f} kN" for F in (hard, soft)]
    return Claim(
        "6.3, Fig 6.9",
        "soft wheels demand a lower magnitude of traction forces, and thus less power",
        f"held for good: {words[0]} on stiff and {words[1]} on soft wheels, {soft[0] / hard[0]:.2f} times as much, "
        f"like the stiffness; {power[HARD]:.2f} and {power[SOFT]:.2f} MW at {SPEED:g} m/s",
        graded(bool(np.all(peaks[SOFT] < peaks[HARD])) and power[SOFT] < power[HARD]),
        {"rear hard": float(hard[0]), "front hard": float(hard[1]), "rear soft": float(soft[0]),
         "front soft": float(soft[1]), "power hard": power[HARD], "power soft": power[SOFT]},
        assumption=FROZEN,
    )  # fmt: skip


def _easier() -> Claim:
    share = {k: np.abs(held(axles(k))) / (-k * TARGET) for k in (HARD, SOFT)}
    hit = {k: SPEED * float(np.sin(SLOPE) * np.sqrt(k / axles(k).P[1, 1])) for k in (HARD, SOFT)}
    peak = {k: measured("pd-friction", "front_normal_peak", k) for k in (HARD, SOFT)}
    off = {k: measured("pd-friction", "front_off", k) for k in (HARD, SOFT)}
    return Claim(
        "6.3, 6.8",
        "soft wheels make the impact control easier than hard ones",
        f"the forces are lower, but not against the normal forces: {share[HARD][0]:.1f} and {share[HARD][1]:.1f} times "
        f"these (rear, front) on stiff, {share[SOFT][0]:.1f} and {share[SOFT][1]:.1f} times on soft wheels. "
        f"Within mu = {FRICTION:g} the fronts hit with {peak[HARD] / 1e3:.1f} and {peak[SOFT] / 1e3:.1f} kN, and are "
        f"off the ground for {off[HARD]:.0f} and {off[SOFT]:.0f} of the first 200 ms; v sqrt(k/P22) is "
        f"{hit[HARD] / 1e3:.1f} and {hit[SOFT] / 1e3:.1f} kN",
        graded(bool(np.all(share[SOFT] <= FRICTION)) and not off[SOFT], peak[SOFT] < peak[HARD]),
        {"share hard": float(share[HARD][0]), "share soft": float(share[SOFT][0]), "hit hard": hit[HARD],
         "hit soft": hit[SOFT], "off hard": off[HARD], "off soft": off[SOFT]},
    )  # fmt: skip


def stiffness_claims() -> list[Claim]:
    """Return what 6.3 says about soft wheels."""
    three_quarters = Claim(
        "6.3",
        "the soft wheel has 75 % of the stiffness of the hard one",
        f"4.1e6 N/m of the caption is {100 * SOFT / HARD:.1f} % of 5.6e6 N/m; 75 % would be 4.2e6 N/m",
        graded(round(100 * SOFT / HARD) == 75, abs(SOFT / HARD - 0.75) < 0.05),
        {"share": SOFT / HARD},
    )
    return [three_quarters, _lower_forces(), _easier()]
