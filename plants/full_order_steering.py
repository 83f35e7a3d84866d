"""Steered wheels of the full-order robot: each hub frame turns about the body's z axis, at a rate that is held.

The frame W = R Z(delta) of a wheel takes the place of R, its axle is e = Z e_y, and with the spins Omega_k in the world

    H = R (I omega + J sum e_k Omega_k),    e_k = (-sin delta_k, cos delta_k, 0)

What holds an angle against ring and rim, tau = -M_z - J Omega omega . de/d delta, works with the rate of steering, and
that work is accounted for.  A rim has no other inertia about this axis than its part of the body's; a ring has.

An input may jump, wheels with rings do not: in a communication step the angle goes evenly to the one asked for, at
``steer_speed`` at most.  On the ground nothing is assumed: every point meets the profile where it is, so a steered
wheel climbs an obstacle aslant.  The left wheels stay on the left track, however far the robot strays.
"""

from __future__ import annotations

from typing import Any

import casadi as ca


def aligned(steer: Any, columns: Any) -> Any:
    """Return the columns (3, 4), each in the axes of its wheel, in body axes; with -*steer* (4,) the way back."""
    c, s = ca.cos(steer).T, ca.sin(steer).T
    x, y = columns[0, :], columns[1, :]
    return ca.vertcat(c * x - s * y, s * x + c * y, columns[2, :])


def axles(steer: Any) -> Any:
    """Return the axles (3, 4), body axes, to the left."""
    return ca.vertcat(-ca.sin(steer).T, ca.cos(steer).T, 0 * steer.T)


def rate(s: Any) -> Any:
    """Return the rates (4, rad/s) at which the wheels are steered over the communication step ``s.dt`` that begins."""
    return ca.fmax(-s.steer_speed, ca.fmin(s.steer_speed, (s.steer - s.steered) / s.dt))
