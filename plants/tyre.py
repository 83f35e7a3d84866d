"""Friction between tyre and ground by slip (thesis chapter 3, Fig 3.2): Dugoff's curve and the Magic Formula, combined.

Slip is the sliding velocity of the contact over the larger of wheel and ground speed, so that one definition drives and
brakes:

    lambda = (R w - V) / max(|R w|, |V|)                           (3.1 driving, 3.2 braking)
    sigma  = V_across / max(|R w|, |V|)                            (braking tan alpha, driving (1 - lambda) tan alpha)

The speed below is at least v_min / 2: under v_min it is (v^2 / v_min + v_min) / 2, which continues v with its slope.
Above v_min the printed definitions hold to the bit; at rest both slips are 0, and a loaded wheel creeps.

Both curves turn the slip that a linear tyre would answer with p = (C_x lambda, C_y sigma) into the coefficients

    (mu_a, -mu_l) = p / |p| g(|p|),    g <= mu,    g'(0) = 1

    Dugoff:         g = u while u <= mu / 2 (stick), else mu - mu^2 / (4 u) (slide);   u = |p| max(|R w|, |V|) / |R w|
    Magic Formula:  g = mu sin(C atan(x - E (x - atan x))),   x = |p| / (C mu)

so the resultant never exceeds mu, and each force takes from the other.  Dugoff's slips are those of the tread through
the contact, hence the quotient of speeds; his curve rises for ever, the Magic Formula has a peak if C > 1.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

LAWS = ("dugoff", "magic")
_STILL = 1e-9  # of p, far below any slip of interest: keeps the direction p / |p| defined at rest


@dataclass(frozen=True)
class Slip:
    """Slip of wheels: numbers or CasADi expressions of equal shape."""

    ratio: Any  # lambda, positive when it drives forwards
    side: Any  # sigma, positive when the wheel moves to its left
    speed: Any  # m/s, what both are measured against
    rolling: Any  # |R w| over that speed, 1 while driving and at rest, 0 with the wheel locked


@dataclass(frozen=True)
class Tyre:
    """Parameters of a friction curve, per unit of normal force: numbers or CasADi expressions."""

    law: str  # of LAWS
    mu: Any  # 1, largest coefficient
    C_x: Any  # 1, slope d mu_a / d lambda at rest
    C_y: Any  # 1/rad, cornering stiffness over normal force
    C: Any = 1.65  # 1, shape of the Magic Formula: where it goes for large slip
    E: Any = 0.0  # 1, curvature of the Magic Formula about its peak


def wheel_slip(rim: Any, along: Any, across: Any, v_min: Any) -> Slip:
    """Return the slip at the rim speed R w, of a wheel centre that moves *along* its heading and *across*, to the left.

    All in m/s; defined for every state, standstill and locked wheel included.
    """
    larger = ca.fmax(ca.fabs(rim), ca.fabs(along))
    speed = ca.if_else(larger > v_min, larger, (larger**2 / v_min + v_min) / 2)
    return Slip((rim - along) / speed, across / speed, speed, 1 - ca.fmax(0, ca.fabs(along) - ca.fabs(rim)) / speed)


def friction_coefficients(tyre: Tyre, slip: Slip) -> tuple[Any, Any]:
    """Return the coefficients F_a / F_n of traction (forward) and F_l / F_n of lateral force (to the left), CasADi."""
    px, py = tyre.C_x * slip.ratio, tyre.C_y * slip.side
    size = ca.sqrt(px**2 + py**2 + _STILL**2)
    if tyre.law == "dugoff":
        stick = size <= tyre.mu * slip.rolling / 2
        value = ca.if_else(stick, size / ca.fmax(slip.rolling, _STILL),
                           tyre.mu * (1 - tyre.mu * slip.rolling / (4 * size)))  # fmt: skip
    else:
        x = size / (tyre.C * tyre.mu)
        value = tyre.mu * ca.sin(tyre.C * ca.atan(x - tyre.E * (x - ca.atan(x))))
    return px * value / size, -py * value / size


def curves(tyre: Tyre, slip: np.ndarray, alpha: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Return mu_a and mu_l (n,) over the slip ratio (n,) at the slip angle *alpha* in rad, as Fig 3.2 draws them.

    A positive angle is a wheel that moves to its right, so that mu_l is positive, to the left.
    """
    ratio = ca.SX.sym("slip")
    rolling = 1 - ca.fmax(0, -ratio)
    forward = 1 - ca.fmax(0, ratio)  # ground speed over the larger one
    at = Slip(ratio, -np.tan(alpha) * forward, 1.0, rolling)
    both = ca.Function("curves", [ratio], [ca.vertcat(*friction_coefficients(tyre, at))])
    found = np.array(both(np.asarray(slip, float)[None, :]))
    return found[0], found[1]


def slope(tyre: Tyre, slip: float) -> float:
    """Return k = d mu_a / d lambda at a slip ratio, without slip angle (3.13)."""
    ratio = ca.SX.sym("slip")
    at = Slip(ratio, 0.0, 1.0, 1 - ca.fmax(0, -ratio))
    mu_a, _ = friction_coefficients(tyre, at)
    return float(ca.Function("slope", [ratio], [ca.jacobian(mu_a, ratio)])(slip))
