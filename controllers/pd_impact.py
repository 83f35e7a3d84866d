"""PD control of the wheel-ground impact by traction (thesis 6.3, Eq 6.9).

The deformations obey z'' = P F_n + U F_a + b_free.  The law asks for the traction that makes them follow

    z'' = z_R'' - h1 (z' - z_R') - h0 (z - z_R)                    (error dynamics e'' + h1 e' + h0 e = 0)
    U F_a = z'' - b_free - P F_n,   F_n = -k_w z - c_w z'          (6.9 with + K z: K = +P k_w, a spring that pushes)

Eq 6.8 prints K = -P k_w and 6.9 prints -K z: the two sign errors cancel in F_a, and only there.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from cosim import parameter, state, structural

from .allocation import bounded_least_squares
from .impact import ImpactController, axles, can_act, decided, feedback, force_limit, means, spread
from .observer import Estimate
from .reference import Motion, planned

if TYPE_CHECKING:
    import control


class PdImpact(ImpactController):
    """PD impact control: feedback linearisation of the wheel deformations, within friction and motor limits.

    It acts only while all wheels carry force and the tractions can move both axles independently: the axle form of U is
    singular on the flat and on a full ramp, and has condition 6 with the front wheels on a 0.3 rad ramp.  Otherwise it
    asks for nothing.  Each time it begins to act, a planned reference starts from the deformation and the rate then.
    """

    reference_kind = structural(
        "static", "reference: equilibrium at this posture, z_target at once, or the degree-7 path to z_target",
        choices=("static", "step", "planned"),
    )  # fmt: skip
    interface = structural(
        "ports", "P and U: those of the body as it stands, or those of the design", choices=("ports", "design")
    )

    h0 = parameter(1500.0, "1/s2", "proportional gain")
    h1 = parameter(70.0, "1/s", "derivative gain")
    z_target = parameter([-0.02, -0.02, -0.01, -0.01], "m", "final deformation of each wheel, for step and planned")
    T = parameter(0.1, "s", "duration of the planned path")

    began = state(0.0, "s", "when the law last began to act")
    d0 = state([0.0] * 4, "m", "deformation then", nominal=1e-3)
    v0 = state([0.0] * 4, "m/s", "its rate then")

    def sync(s: Any) -> dict[str, Any]:
        P, U = (s.P, s.U) if s.interface == "ports" else (s.P_model, s.U_model)
        able = can_act(s, designed=s.interface == "design")
        now = feedback(s)
        fresh = ca.logic_and(able, ca.logic_not(s.on))
        began = ca.if_else(fresh, s.time, s.began)
        start = Estimate(ca.if_else(fresh, now.z, s.d0), ca.if_else(fresh, now.rate, s.v0))
        target = _reference(s, began, start, P)
        wanted = target.acceleration - s.h1 * (now.rate - target.rate) - s.h0 * (now.z - target.z)
        missing = wanted - s.b_free - P @ (-s.k_w * now.z - s.c_w * now.rate)
        limit = force_limit(s)
        demand = _allocate(s, U, missing, limit)
        return {
            **decided(s, now, able, demand, limit, target.z, P, U),
            "began": began, "d0": start.z, "v0": start.rate,
        }  # fmt: skip


def _reference(s: Any, began: Any, start: Estimate, P: Any) -> Motion:
    still = ca.SX.zeros(4)
    if s.reference_kind == "step":
        return Motion(s.z_target, still, still)
    if s.reference_kind == "planned":
        t = s.time - began
        path = planned(ca.fmin(t, s.T), s.T, start.z, start.rate, s.z_target)
        under_way = t < s.T
        return Motion(path.z, ca.if_else(under_way, path.rate, 0), ca.if_else(under_way, path.acceleration, 0))
    P, b = axles(P), means(s.b_free)
    determinant = P[0, 0] * P[1, 1] - P[0, 1] * P[1, 0]
    loads = -ca.vertcat(P[1, 1] * b[0] - P[0, 1] * b[1], P[0, 0] * b[1] - P[1, 0] * b[0]) / determinant  # P F + b = 0
    return Motion(spread(-loads / (2 * s.k_w)), still, still)


def _allocate(s: Any, U: Any, missing: Any, limit: Any) -> Any:
    """Return the tractions (4,) that best give the *missing* gap accelerations (4,) within the limits."""
    if s.model == "wheels":
        return bounded_least_squares(U, missing, limit)
    axle_limit = ca.vertcat(2 * ca.fmin(limit[0], limit[1]), 2 * ca.fmin(limit[2], limit[3]))
    return spread(bounded_least_squares(axles(U), means(missing), axle_limit) / 2)


def gains_by_stiffness(k_axle: float, P_front: float, damping: float = 1.0) -> tuple[float, float]:
    """Return h0 = k P22 (1/s2) and h1 = 2 damping sqrt(h0) (1/s): the spring itself supplies h0.

    *k_axle* in N/m for the front axle, *P_front* in 1/kg the front element of the planar P.  *damping* up to 1, the
    critical one: h1 <= 2 sqrt(h0).
    """
    h0 = k_axle * P_front
    return h0, 2 * damping * float(np.sqrt(h0))


def error_dynamics(h0: float, h1: float) -> control.StateSpace:
    """Return e'' + h1 e' + h0 e = 0, what the law makes of each deformation error: states e (m), e_rate (m/s)."""
    import control

    return control.StateSpace([[0, 1], [-h0, -h1]], np.zeros((2, 1)), [[1, 0]], 0, states=["e", "e_rate"],
                              inputs=["none"], outputs=["e"], name="error")  # fmt: skip


def error_response(h0: float, h1: float, e0: float, v0: float, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return e (n,) in m and e' (n,) in m/s of e'' + h1 e' + h0 e = 0 at *t* (n,), s, from e0 (m) and v0 (m/s)."""
    slow, fast = error_dynamics(h0, h1).poles()
    if abs(slow - fast) < 1e-6 * abs(slow):  # the limit of the sums below for a double pole
        grows = v0 - slow * e0
        e, rate = (e0 + grows * t) * np.exp(slow * t), (v0 + slow * grows * t) * np.exp(slow * t)
    else:
        c = np.linalg.solve([[1, 1], [slow, fast]], np.array([e0, v0], complex))
        parts = c[:, None] * np.exp(np.outer([slow, fast], t))
        e, rate = parts[0] + parts[1], slow * parts[0] + fast * parts[1]
    return e.real, rate.real


def settling_time(h0: float, h1: float, e0: float, v0: float, band: float, horizon: float = 10.0) -> float:
    """Return when the error of e'' + h1 e' + h0 e = 0 stays within *band* (m) from e0 (m) and v0 (m/s), in s.

    To a 200000th of the *horizon* (s), which is returned for an error that has not settled by then.
    """
    t = np.linspace(0.0, horizon, 200_001)
    e, _ = error_response(h0, h1, e0, v0, t)
    outside = np.flatnonzero(np.abs(e) > band)
    if not len(outside):
        return 0.0
    return float(t[outside[-1] + 1]) if outside[-1] + 1 < len(t) else horizon
