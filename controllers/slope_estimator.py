"""Slope of the ground from the force of a wheel on its axle (thesis 4.6, Eq 4.56), and its rates by a tracking filter.

A massless wheel passes the ground's force on to the axle: (R_x, R_z) = F_t A + F_n n in the axes of the load cell, so

    F_n = sqrt(R_x^2 + R_z^2 - F_t^2)                              (the minus root of 4.56)
    gamma = atan2(F_t R_z - F_n R_x, F_t R_x + F_n R_z)

4.56 as printed is 0/0 at F_t = -R_x, as at an idle wheel on the flat; this form is not, unless nothing pushes at all.
The load cells are fixed to the body, so gamma is the slope seen from the body: theta = gamma + pitch.
"""

from __future__ import annotations

from typing import Any

import casadi as ca


def body_slope(R_x: Any, R_z: Any, F_t: Any) -> Any:
    """Return gamma, rad, climbing positive, relative to the body: numbers or CasADi expressions.

    *R_x*, *R_z* are the force of the wheel on the body, body axes, N; *F_t* its part along the ground, forward
    positive, N: the traction, less a rolling resistance if there is one.  A measured F_t beyond the measured force
    counts as all of it.
    """
    F_n = ca.sqrt(ca.fmax(R_x**2 + R_z**2 - F_t**2, 0))
    return ca.atan2(F_t * R_z - F_n * R_x, F_t * R_x + F_n * R_z)


def track(value: Any, rate: Any, bending: Any, measured: Any, period: Any, bandwidth: Any) -> tuple[Any, Any, Any]:
    """Return value, first and second rate after one sample of a critically damped tracking filter.

    A measurement that moves with a constant second rate is followed without lag; noise faster than *bandwidth* (1/s) is
    held back.  All three poles lie at exp(-bandwidth period): the fading-memory filter of degree 2.
    """
    forget = ca.exp(-bandwidth * period)
    ahead = value + period * rate + period**2 / 2 * bending
    off = measured - ahead
    return (
        ahead + (1 - forget**3) * off,
        rate + period * bending + 1.5 * (1 - forget) ** 2 * (1 + forget) / period * off,
        bending + (1 - forget) ** 3 / period**2 * off,
    )
