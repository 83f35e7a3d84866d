"""The degree-7 path of a deformation from its state at impact to rest at its final value (thesis 6.5, Eq 6.17-6.19)."""

from __future__ import annotations

from typing import Any, NamedTuple


class Motion(NamedTuple):
    """A reference deformation with its first two time derivatives: m, m/s, m/s2."""

    z: Any
    rate: Any
    acceleration: Any


def planned(t: Any, T: Any, d0: Any, v0: Any, d: Any) -> Motion:
    """Return the reference at time *t* in [0, T] after the impact; NumPy and CasADi alike.

    Starts at d0 (m) with v0 (m/s) and no acceleration or jerk, ends at rest at d.  In real time, so the derivatives
    carry the factors 1/T that Eq 6.18 leaves out, and with C7 = -10 (2 D - V) / T^7, D = d - d0, V = v0 T, where Eq
    6.19 prints the opposite sign of V.  It overshoots d where V is large against D: -32 mm for T = 0.2 s, v0 = -0.6
    m/s, d = -20 mm.
    """
    D, V = d - d0, v0 * T
    C4, C5 = 5 * (7 * D - 4 * V) / T**4, -3 * (28 * D - 15 * V) / T**5
    C6, C7 = 2 * (35 * D - 18 * V) / T**6, -10 * (2 * D - V) / T**7
    return Motion(
        d0 + v0 * t + t**4 * (C4 + t * (C5 + t * (C6 + t * C7))),
        v0 + t**3 * (4 * C4 + t * (5 * C5 + t * (6 * C6 + t * 7 * C7))),
        t**2 * (12 * C4 + t * (20 * C5 + t * (30 * C6 + t * 42 * C7))),
    )
