"""What the impact controllers share: what they know of the wheels, their limits, and the observer of z and z'."""

from __future__ import annotations

from typing import Any

import casadi as ca

from cosim import output, parameter, state, structural

from .observer import Estimate, corrected, predicted
from .traction import TractionController

FRONT, REAR = (0, 1), (2, 3)


class ImpactController(TractionController):
    """Parameters, ports and memory of a law that controls the deformations of the wheels by traction.

    Deformation and rate come from the ports ``gap`` and ``gap_rate``, or with ``feedback`` "observer" from the measured
    normal forces alone.  In the axle model every wheel moves like the mean of its axle and has half of its force.
    """

    model = structural("axles", "what is controlled: mean deformation of each axle, or every wheel",
                       choices=("axles", "wheels"))  # fmt: skip
    feedback = structural("measured", "where the deformations come from", choices=("measured", "observer"))
    limits = structural("friction", "limits of the demand: mu F_n and F_max, or F_max only",
                        choices=("friction", "motor"))  # fmt: skip

    k_w = parameter(1e5, "N/m", "stiffness of a wheel, as the law knows it")
    c_w = parameter(0.0, "N.s/m", "damping of a wheel, as the law knows it")
    mu = parameter(0.8, "1", "friction coefficient the law counts on")
    F_max = parameter(1e4, "N", "largest traction of a wheel's motor")
    cond_max = parameter(1e3, "1", "condition of the axle form of U above which the law is off")
    U_tolerance = parameter(
        1.0,
        "1",
        "largest norm of U U_model^-1 - 1 for a law of the design's P and U: below 1 no force works backwards",
    )
    F_contact = parameter(0.0, "N", "normal force above which a wheel counts as on the ground: above a sensor's noise")
    P_model = parameter([[0.0] * 4] * 4, "1/kg", "P at the posture of the design")
    U_model = parameter([[0.0] * 4] * 4, "1/kg", "U at the posture of the design")
    L_z = parameter([[0.0] * 4] * 4, "m/N", "observer gain: deformation per surprise in the normal forces")
    L_rate = parameter([[0.0] * 4] * 4, "m/(N.s)", "observer gain: rate per surprise in the normal forces")

    z_next = state([0.0] * 4, "m", "deformations predicted for the next tick", nominal=1e-3)
    z_rate_next = state([0.0] * 4, "m/s", "rates predicted for the next tick", nominal=0.1)
    z_used = state([0.0] * 4, "m", "deformations the law acted on", nominal=1e-3)
    z_rate_used = state([0.0] * 4, "m/s", "their rates", nominal=0.1)
    z_R = state([0.0] * 4, "m", "reference held between samples", nominal=1e-3)
    at_limit = state([0.0] * 4, "1", "1 where the demand is at its limit")

    reference = output("m", "reference deformation of each wheel", shape=4)
    estimate = output("m", "deformation of each wheel that the law acts on, measured or observed", shape=4)
    estimate_rate = output("m/s", "its time derivative", shape=4)
    saturated = output("1", "1 where the demand is at its limit", shape=4)

    def outputs(s: Any) -> dict[str, Any]:
        return {
            **TractionController.outputs(s),
            "reference": s.z_R, "estimate": s.z_used, "estimate_rate": s.z_rate_used, "saturated": s.at_limit,
        }  # fmt: skip


def feedback(s: Any) -> Estimate:
    """Return the deformations that a law acts on at this tick."""
    if s.feedback == "measured":
        return Estimate(s.gap, s.gap_rate)
    return corrected(s, _closed(s))


def force_limit(s: Any) -> Any:
    """Return the largest traction (4) of each wheel now, N."""
    motor = ca.SX.ones(4) * s.F_max
    return motor if s.limits == "motor" else ca.fmin(motor, s.mu * ca.fmax(0, s.normal_force))


def decided(s: Any, now: Estimate, able: Any, demand: Any, limit: Any, z_R: Any, P: Any, U: Any) -> dict[str, Any]:
    """Return the states that every impact law writes: its *demand* (4) where it is *able*, else nothing.

    *P* and *U* are those that the observer predicts with.
    """
    hold = ca.SX.zeros(4)
    given = ca.if_else(able, demand, hold)
    found = {
        "demand": given,
        "on": able,
        "z_used": now.z,
        "z_rate_used": now.rate,
        "z_R": ca.if_else(able, z_R, now.z),
        "at_limit": ca.if_else(able, ca.fabs(demand) >= limit * (1 - 1e-9), hold),
    }
    if s.feedback == "observer":
        ahead = predicted(s, now, _closed(s), P, U, given)
        found |= {"z_next": ahead.z, "z_rate_next": ahead.rate}
    return found


def _closed(s: Any) -> Any:
    """Return 1 for every wheel (4) whose force tells its deformation: in the axle model both of an axle, or none."""
    pushes = s.normal_force > s.F_contact
    if s.model == "wheels":
        return pushes
    return spread(ca.vertcat(*(pushes[i] * pushes[j] for i, j in (FRONT, REAR))))


def can_act(s: Any, designed: bool) -> Any:
    """Whether a law can act, and one *designed* at a posture may.

    Every wheel carries force, since a wheel in the air takes no traction and both axles are needed; the axle form of U
    has a condition below ``cond_max``; and for a designed law U is near that of the design.
    """
    closed = ca.mmin(s.normal_force) > s.F_contact
    U = axles(s.U)
    # |U|_F^2 / |det U| = cond + 1/cond
    able = ca.logic_and(closed, ca.sumsqr(U) < (s.cond_max + 1 / s.cond_max) * ca.fabs(_determinant(U)))
    if not designed:
        return able
    model = axles(s.U_model)
    adjugate = ca.vertcat(ca.horzcat(model[1, 1], -model[0, 1]), ca.horzcat(-model[1, 0], model[0, 0]))
    return ca.logic_and(able, ca.sumsqr((U - model) @ adjugate) < (s.U_tolerance * _determinant(model)) ** 2)


def _determinant(M: Any) -> Any:
    return M[0, 0] * M[1, 1] - M[0, 1] * M[1, 0]


def axles(M: Any) -> Any:
    """Return the axle form (front, rear) of a (4, 4): mean of an axle's rows for a force its wheels share equally."""
    block = lambda i, j: (M[i[0], j[0]] + M[i[0], j[1]] + M[i[1], j[0]] + M[i[1], j[1]]) / 4  # noqa: E731
    return ca.vertcat(*(ca.horzcat(*(block(i, j) for j in (FRONT, REAR))) for i in (FRONT, REAR)))


def means(v: Any) -> Any:
    """Return the means (front, rear) of both axles' wheels."""
    return ca.vertcat((v[0] + v[1]) / 2, (v[2] + v[3]) / 2)


def spread(v: Any) -> Any:
    """Return (front, rear) for all four wheels."""
    return ca.vertcat(v[0], v[0], v[1], v[1])
