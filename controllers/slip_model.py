"""Design of slip control: slip by torque as a transfer function, and the friction curve inverted (thesis 3.3).

For one wheel that carries a mass m (Fig 3.3), about the speed V_0 and the slip lambda_0 on the driving side,

    H = d lambda / d T = V_0 / (R w_0^2 J_w s + (V_0 R + w_0 J_w / m) F_n k),    w_0 = V_0 / (R (1 - lambda_0))

Eq 3.15 and 3.16 print a minus before w_0 J_w / m: the mass that speeds up takes slip away, as the wheel that is braked.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from cosim.errors import DeclarationError

if TYPE_CHECKING:
    import control

_POINTS = 500  # of the inverted curve, at most


def slip_transfer_function(
    V_0: float, R: float, J_w: float, m: float, F_n: float, k: float, slip: float, *, as_printed: bool = False
) -> control.TransferFunction:
    """Return H(s) from motor torque (N.m) to slip ratio (1), Eq 3.16 with its sign put right, or *as_printed*.

    *V_0* in m/s, *R* in m, *J_w* in kg.m2, *m* in kg on this wheel, *F_n* in N, *k* = d mu / d lambda at the slip ratio
    *slip*, from 0 (rolling) to below 1.  Raises DeclarationError where the curve does not rise (the slip runs away
    from there, at the rate of a positive pole) and for values without a meaning.
    """
    import control

    sizes = {"V_0": (V_0, "m/s"), "R": (R, "m"), "J_w": (J_w, "kg.m2"), "m": (m, "kg"), "F_n": (F_n, "N")}
    for name, (value, unit) in sizes.items():
        if not value > 0:
            raise DeclarationError(f"the slip transfer function needs a positive {name}, not {value:g} {unit}")
    if not 0 <= slip < 1:
        raise DeclarationError(f"the slip transfer function is that of a driven wheel, 0 <= slip < 1, not {slip:g}")
    w_0 = V_0 / (R * (1 - slip))
    inertia, sign = R * w_0**2 * J_w, -1 if as_printed else 1
    stiffness = (V_0 * R + sign * w_0 * J_w / m) * F_n * k
    if not k > 0:
        raise DeclarationError(
            f"the friction curve has no positive stiffness at slip {slip:g}: d mu / d lambda = {k:g} puts the pole of "
            f"the slip at {-stiffness / inertia:.4g} 1/s, where it runs away; choose a slip below the peak of the curve"
        )
    return control.tf([V_0], [inertia, stiffness], inputs="torque", outputs="slip", name="wheel slip")


def inverse_curve(slip: np.ndarray, mu: np.ndarray) -> np.ndarray:
    """Return the rising part of a friction curve as a table of slip by coefficient, up to its peak.

    *slip* (n,) ascending from 0 and *mu* (n,) the traction coefficients there.  Rows are (mu, slip, d slip / d mu), the
    last one the peak with no slope: what is asked beyond it gets the slip of the peak.  Raises DeclarationError if
    the curve does not rise from zero slip.
    """
    slip, mu = np.asarray(slip, float), np.asarray(mu, float)
    if slip.ndim != 1 or slip.shape != mu.shape or len(slip) < 2 or slip[0] != 0 or np.any(np.diff(slip) <= 0):
        raise DeclarationError("a friction curve needs one coefficient per slip ratio, at least two, ascending from 0")
    falling = np.flatnonzero(np.diff(mu) <= 0)
    peak = int(falling[0]) if len(falling) else len(mu) - 1
    if peak == 0:
        raise DeclarationError(
            f"the friction curve has negative stiffness from the start: d mu / d lambda = "
            f"{(mu[1] - mu[0]) / slip[1]:.3g} between slip 0 and {slip[1]:.3g}; slip control needs a curve that rises"
        )
    kept = np.unique(np.linspace(0, peak, min(_POINTS, peak + 1)).round().astype(int))
    mu, slip = mu[kept], slip[kept]
    return np.column_stack([mu, slip, np.append(np.diff(slip) / np.diff(mu), 0.0)])


def spin_gain(J_w: float, period: float, share: float = 0.3) -> float:
    """Return the gain from spin error to torque in N.m.s/rad that corrects a *share* of the error in one period.

    J_w share / period: between samples the torque K e turns the wheel by at most share e, less where friction helps, so
    0 < share <= 1 is stable at every speed and standstill; beyond the peak it holds a slip that runs away more slowly
    than share / period.  Raises DeclarationError for another share.
    """
    if not 0 < share <= 1:
        raise DeclarationError(
            f"spin control corrects a share 0 < share <= 1 of the error in one period, not {share:g}"
        )
    return share * J_w / period
