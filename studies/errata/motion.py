"""Motions of a body with known derivatives, to test kinematics on: world vectors differentiated, seen from the body."""

from __future__ import annotations

import sympy as sp

from .algebra import numbers

t = sp.Symbol("t")


def polynomial(seed: int, start: sp.Expr | int = 0) -> sp.Expr:
    """Return a cubic in t with rational coefficients drawn at random."""
    a, b, c = numbers(3, seed)
    return start + a * t + b * t**2 + c * t**3


def rotation(roll: sp.Expr, pitch: sp.Expr, yaw: sp.Expr) -> sp.Matrix:
    """Return the rotation (3, 3) from body to world, right-handed about x, y and z."""
    return sp.rot_ccw_axis3(yaw) * sp.rot_ccw_axis2(pitch) * sp.rot_ccw_axis1(roll)


def angular_velocity(turning: sp.Matrix) -> sp.Matrix:
    """Return omega (3,) in body axes of a rotation that depends on t."""
    spin = turning.T * sp.diff(turning, t)
    return sp.Matrix([spin[2, 1], spin[0, 2], spin[1, 0]])


def now(of: sp.Matrix | sp.Expr) -> sp.Matrix | sp.Expr:
    """Return the value at t = 0."""
    return of.subs(t, 0)
