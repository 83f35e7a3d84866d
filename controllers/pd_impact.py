"""PD control of the wheel-ground impact by traction (thesis 6.3, Eq 6.9).

The deformations obey z'' = P F_n + U F_a + b_free.  The law asks for the traction that makes them follow

    z'' = z_R'' - h1 (z' - z_R') - h0 (z - z_R)                    (error dynamics e'' + h1 e' + h0 e = 0)
    U F_a = z'' - b_free - P F_n,   F_n = -k_w z - c_w z'          (6.9 with + K z: K = +P k_w, a spring that pushes)

Eq 6.8 prints K = -P k_w and 6.9 prints -K z: the two sign errors cancel in F_a, and only there.
"""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from cosim import output, parameter, state, structural

from .allocation import bounded_least_squares
from .reference import Motion, planned
from .traction import TractionController

FRONT, REAR = (0, 1), (2, 3)


class PdImpact(TractionController):
    """PD impact control: feedback linearisation of the wheel deformations, within friction and motor limits.

    It acts only while all wheels carry force and the tractions can move both axles independently: the axle form of U is
    singular on the flat and on a full ramp, and has condition 25 with the front wheels on a 0.3 rad ramp.  Otherwise it
    asks for nothing.
    """

    allocation = structural(
        "axles", "who is controlled: mean deformation of each axle, or every wheel", choices=("axles", "wheels")
    )
    reference_kind = structural(
        "static", "reference: equilibrium at this posture, z_target at once, or the degree-7 path to z_target",
        choices=("static", "step", "planned"),
    )  # fmt: skip
    limits = structural(
        "friction", "limits of the demand: mu F_n and F_max, or F_max only", choices=("friction", "motor")
    )

    h0 = parameter(1500.0, "1/s2", "proportional gain")
    h1 = parameter(70.0, "1/s", "derivative gain")
    k_w = parameter(1e5, "N/m", "stiffness of a wheel, as the law knows it")
    c_w = parameter(0.0, "N.s/m", "damping of a wheel, as the law knows it")
    z_target = parameter([-0.02, -0.02, -0.01, -0.01], "m", "final deformation of each wheel, for step and planned")
    T = parameter(0.1, "s", "duration of the planned path")
    mu = parameter(0.8, "1", "friction coefficient the law counts on")
    F_max = parameter(1e4, "N", "largest traction of a wheel's motor")
    cond_max = parameter(1e3, "1", "condition of the axle form of U above which the law is off")

    z_R = state([0.0] * 4, "m", "reference held between samples", nominal=1e-3)
    at_limit = state([0.0] * 4, "1", "1 where the demand is at its limit")
    began = state(-1.0, "s", "when the law could first act, -1 before")
    d0 = state([0.0] * 4, "m", "deformation then", nominal=1e-3)
    v0 = state([0.0] * 4, "m/s", "its rate then")

    reference = output("m", "reference deformation of each wheel", shape=4)
    saturated = output("1", "1 where the demand is at its limit", shape=4)

    def outputs(s: Any) -> dict[str, Any]:
        return {**TractionController.outputs(s), "reference": s.z_R, "saturated": s.at_limit}

    def sync(s: Any) -> dict[str, Any]:
        able = _able(s)
        fresh = ca.logic_and(able, s.began < 0)
        began = ca.if_else(fresh, s.time, s.began)
        d0, v0 = ca.if_else(fresh, s.gap, s.d0), ca.if_else(fresh, s.gap_rate, s.v0)
        target = _reference(s, began, d0, v0)
        wanted = target.acceleration - s.h1 * (s.gap_rate - target.rate) - s.h0 * (s.gap - target.z)
        spring = -s.k_w * s.gap - s.c_w * s.gap_rate
        missing = wanted - s.b_free - s.P @ spring
        limit = ca.SX.ones(4) * s.F_max
        if s.limits == "friction":
            limit = ca.fmin(limit, s.mu * ca.fmax(0, s.normal_force))
        demand = _allocate(s, missing, limit)
        hold = ca.SX.zeros(4)
        return {
            "demand": ca.if_else(able, demand, hold),
            "on": able,
            "z_R": ca.if_else(able, target.z, s.gap),
            "at_limit": ca.if_else(able, ca.fabs(demand) >= limit * (1 - 1e-9), hold),
            "began": began, "d0": d0, "v0": v0,
        }  # fmt: skip


def _axles(M: Any) -> Any:
    """Return the axle form (2, 2) of a (4, 4): mean of an axle's rows for a force its wheels share equally."""
    block = lambda i, j: (M[i[0], j[0]] + M[i[0], j[1]] + M[i[1], j[0]] + M[i[1], j[1]]) / 4  # noqa: E731
    return ca.vertcat(*(ca.horzcat(*(block(i, j) for j in (FRONT, REAR))) for i in (FRONT, REAR)))


def _means(v: Any) -> Any:
    return ca.vertcat((v[0] + v[1]) / 2, (v[2] + v[3]) / 2)


def _spread(v: Any) -> Any:
    return ca.vertcat(v[0], v[0], v[1], v[1])


def _able(s: Any) -> Any:
    """Whether the law can act: every wheel carries force, and cond(U) of the axles stays below ``cond_max``.

    For a 2 x 2 matrix |U|_F^2 / |det U| = cond + 1/cond.
    """
    U = _axles(s.U)
    determined = ca.sumsqr(U) < (s.cond_max + 1 / s.cond_max) * ca.fabs(U[0, 0] * U[1, 1] - U[0, 1] * U[1, 0])
    return ca.logic_and(ca.mmin(s.normal_force) > 0, determined)


def _reference(s: Any, began: Any, d0: Any, v0: Any) -> Motion:
    still = ca.SX.zeros(4)
    if s.reference_kind == "step":
        return Motion(s.z_target, still, still)
    if s.reference_kind == "planned":
        t = s.time - began
        path = planned(ca.fmin(t, s.T), s.T, d0, v0, s.z_target)
        under_way = t < s.T
        return Motion(path.z, ca.if_else(under_way, path.rate, 0), ca.if_else(under_way, path.acceleration, 0))
    P, b = _axles(s.P), _means(s.b_free)
    determinant = P[0, 0] * P[1, 1] - P[0, 1] * P[1, 0]
    loads = -ca.vertcat(P[1, 1] * b[0] - P[0, 1] * b[1], P[0, 0] * b[1] - P[1, 0] * b[0]) / determinant  # P F + b = 0
    return Motion(_spread(-loads / (2 * s.k_w)), still, still)


def _allocate(s: Any, missing: Any, limit: Any) -> Any:
    """Return the tractions (4,) that best give the *missing* gap accelerations (4,) within the limits."""
    if s.allocation == "wheels":
        return bounded_least_squares(s.U, missing, limit)
    axle_limit = ca.vertcat(2 * ca.fmin(limit[0], limit[1]), 2 * ca.fmin(limit[2], limit[3]))
    return _spread(bounded_least_squares(_axles(s.U), _means(missing), axle_limit) / 2)


def gains_by_stiffness(k_axle: float, P_front: float) -> tuple[float, float]:
    """Return h0 = k P22 (1/s2) and h1 = 2 sqrt(h0) (1/s): the spring supplies h0, and the error is critically damped.

    *k_axle* in N/m for the front axle, *P_front* in 1/kg the front element of the planar P.
    """
    h0 = k_axle * P_front
    return h0, 2 * float(np.sqrt(h0))


def settling_time(h0: float, h1: float, e0: float, v0: float, band: float, horizon: float = 10.0) -> float:
    """Return when the error of e'' + h1 e' + h0 e = 0 stays within *band* (m) from e0 (m) and v0 (m/s), in s."""
    t = np.linspace(0.0, horizon, 200_001)
    roots = np.roots([1.0, h1, h0]).astype(complex)
    if abs(roots[0] - roots[1]) < 1e-9 * abs(roots[0]):
        e = (e0 + (v0 - roots[0] * e0) * t) * np.exp(roots[0] * t)
    else:
        c = np.linalg.solve(np.array([[1, 1], roots]), np.array([e0, v0], complex))
        e = c[0] * np.exp(roots[0] * t) + c[1] * np.exp(roots[1] * t)
    outside = np.flatnonzero(np.abs(e.real) > band)
    return (
        float(t[outside[-1] + 1]) if len(outside) and outside[-1] + 1 < len(t) else 0.0 if not len(outside) else horizon
    )
