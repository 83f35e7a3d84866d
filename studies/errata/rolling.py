"""The same robot with one coordinate: the way s of its front wheel centre.  No contact force appears at all.

The centre runs along a circle that starts at the slope theta with the curvature kappa; the rear centre stays at its
height, which gives the pitch, sin p = height / L.  What Lagrange's equation then says is an independent reference for
accelerations, for the bend of the path, and, differentiated once more along the motion, for the jerk.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import sympy as sp

from .side_view import F_f, F_r, I_y, L_f, L_r, R, g, h, in_body, kappa, m, p, theta

s, s_d = sp.symbols("s s_d")  # m along the path, m/s
_L = L_f + L_r


@dataclass(frozen=True)
class Rolling:
    """Functions of s and s'; at s = 0 of p, theta and kappa."""

    pitch: sp.Expr
    speed: sp.Matrix  # of the centre of mass, world axes
    acceleration: sp.Matrix  # the same, world axes
    s_dd: sp.Expr

    def rate(self, of: sp.Matrix | sp.Expr) -> sp.Matrix | sp.Expr:
        """Return the time derivative along the motion."""
        return sp.diff(of, s) * s_d + sp.diff(of, s_d) * self.s_dd

    def along_body(self, vector: sp.Matrix) -> sp.Matrix:
        """Return a vector of the world in the axes of the body as it is at s."""
        return in_body(vector, self.pitch)

    @staticmethod
    def now(of: sp.Matrix | sp.Expr) -> sp.Matrix | sp.Expr:
        """Return the value at s = 0."""
        return of.subs(s, 0)


@cache
def rolling(arm: sp.Expr = R) -> Rolling:
    """Derive the motion; traction acts *arm* below the wheel centres."""
    turn = theta + kappa * s
    x, z = (sp.sin(turn) - sp.sin(theta)) / kappa, (sp.cos(theta) - sp.cos(turn)) / kappa + _L * sp.sin(p)
    pitch = sp.asin(z / _L)
    sine, cosine = z / _L, sp.sqrt(1 - (z / _L) ** 2)
    X, Z = x - L_f * cosine - h * sine, L_r * sine + h * cosine
    X_s, Z_s, p_s, rear_s = (sp.diff(f, s) for f in (X, Z, pitch, x - _L * cosine))
    mass = m * (X_s**2 + Z_s**2) + I_y * p_s**2
    work = F_r * (rear_s + arm * p_s) + F_f * (1 + arm * p_s) - m * g * Z_s
    s_dd = (work - sp.diff(mass, s) * s_d**2 / 2) / mass
    speed = sp.Matrix([X_s, Z_s]) * s_d
    return Rolling(pitch, speed, sp.diff(speed, s) * s_d + sp.diff(speed, s_d) * s_dd, s_dd)
