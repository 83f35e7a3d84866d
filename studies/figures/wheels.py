"""Friction by slip and slip angle (thesis Fig 3.2), and slip by motor torque (3.16)."""

from __future__ import annotations

import numpy as np

from controllers.slip_model import slip_transfer_function
from plants.tyre import LAWS, Tyre, curves
from plants.wheel_drive import WheelDrive, tyre_of

from .claim import Claim, graded
from .entry import Entry
from .sheet import LINES, Sheet, panels

ANGLES = (0.0, 0.02, 0.05, 0.1, 0.2)  # rad
SLIDING, GENTLE = 0.05, 0.1  # slip ratio from which both curves slide; rad, below the peak of the lateral one
# of (3.16): m/s, m, kg.m2, kg and N of one wheel, slope of the curve, slip ratio
POINT = {"V_0": 2.0, "R": 0.1, "J_w": 0.01, "m": 42.5, "F_n": 417.0, "k": 8.0, "slip": 0.05}
ASSUMED = "the curves of [94] come without numbers: mu = {mu:g}, C_x = {C_x:g}, C_y = {C_y:g}/rad of our wheels"


def _tyre(law: str) -> Tyre:
    return tyre_of(WheelDrive(law=law))


def curves_figure() -> Sheet:
    """Return Fig 3.2: traction and lateral coefficients over the slip ratio, for several slip angles, by two laws."""
    slip = np.linspace(0, 1, 201)
    columns: dict[str, np.ndarray] = {"slip ratio": slip}
    figure, axes = panels(
        "Friction coefficients by slip ratio and slip angle (Fig 3.2)", 2, 2, sharex=True, sharey=True
    )
    for law, (upper, lower) in zip(LAWS, axes.T, strict=True):
        for alpha, colour in zip(ANGLES, LINES, strict=False):
            both = curves(_tyre(law), slip, alpha)
            for axis, name, values in zip((upper, lower), ("mu_a", "mu_l"), both, strict=True):
                columns[f"{law}, {name} at {alpha:g} rad"] = values
                axis.plot(slip, values, color=colour, label=f"slip angle {alpha:g} rad")
        upper.set_title({"magic": "Magic Formula", "dugoff": "Dugoff"}[law])
        lower.set_xlabel("slip ratio lambda")
    axes[0, 0].set_ylabel("traction coefficient mu_a")
    axes[1, 0].set_ylabel("lateral coefficient mu_l")
    axes[0, 0].legend(frameon=False, fontsize=8)
    return Sheet("Friction by slip", columns, figure, (ASSUMED.format(**WheelDrive().values),))


def curves_claims() -> list[Claim]:
    """Return the verdicts on section 3.2 and 3.3."""
    slips, angles = np.linspace(SLIDING, 0.95, 46), np.linspace(0, GENTLE, 21)
    found = {law: np.array([curves(_tyre(law), slips, alpha) for alpha in angles]) for law in LAWS}
    good = all(np.all(np.diff(c[:, 0], axis=0) < 0) and np.all(np.diff(c[:, 1], axis=0) > 0) for c in found.values())
    at = {law: c[:, :, np.argmin(np.abs(slips - 0.15))] for law, c in found.items()}
    right, printed = (
        float(slip_transfer_function(**POINT, as_printed=wrong).poles()[0].real) for wrong in (False, True)
    )
    return [
        Claim(
            "3.2",
            "with the slip angle the lateral coefficient grows and that of traction falls",
            f"by both laws from a slip of {SLIDING:g} on and up to {GENTLE:g} rad; at slip 0.15, 0 to {GENTLE:g} rad: "
            + "; ".join(
                f"{law} mu_a {c[0, 0]:.2f} to {c[-1, 0]:.2f}, mu_l 0 to {c[-1, 1]:.2f}" for law, c in at.items()
            ),
            graded(good),
            {f"{law} {n}": float(c[-1, k]) for law, c in at.items() for k, n in enumerate(("mu_a", "mu_l"))},
            assumption=ASSUMED.format(**WheelDrive().values),
        ),
        Claim(
            "3.3",
            "slip follows torque by (3.16)",
            f"pole at {right:.1f} 1/s: (V_0 R + w_0 J_w / m) F_n k, the sign is the other one",
            graded(abs(right - printed) < 0.01 * abs(right)),
            {"right": right, "printed": printed},
            f"{printed:.1f} 1/s",
            "one wheel of the robot at 2 m/s, slip 0.05: 42.5 kg, 417 N, J_w = 0.01 kg.m2, k = 8",
        ),
    ]


RUN = ("slip-start", "slip-control")
ENTRIES = (Entry("thesis 3.2", "friction by slip and slip angle", curves_figure, curves_claims, RUN),)
