"""Deformable wheels on the ground (thesis chapter 6): unilateral spring-dampers on the reduced model of the body.

Between communication points the wheels integrate the relative motion of the contacts that the body hands over,

    z'' = P F_n + U F_a + b_free                                   (6.5, 6.12)
    F_n = max(0, -k_w z - c_w z')  while z < 0, else 0             (6.6; z < 0 is compression, so the spring pushes)

with the friction F_a, F_l of `wheels` under F_n, starting from the body's gap and gap rate, and return means over the
step: momentum passed equals momentum received.
In print K = -P k_w (6.8) has the sign of a spring that pulls.
"""

from __future__ import annotations

from typing import Any

import casadi as ca

from cosim import event, parameter, state, structural

from .wheels import Wheels, asked_aside, cornering, friction, slowest_aside


class WheelDeformation(Wheels):
    """Four unilateral spring-damper wheels, sub-stepped on the body's reduced model, with friction inside.

    ``deformation`` and ``normal_force_end`` are those at the end of the step.

    Energy: the work -F_n z' done on a wheel is the growth of k_w z^2 / 2 plus what is dissipated: c_w z'^2 while the
    wheel pushes; the relaxing spring's own energy, -k_w z z', while it returns too slowly to push.  Neither is ever
    negative.
    """

    located = structural(
        0, "1: a step ends where a wheel begins or ceases to push, and everybody meets there; 0: it does not"
    )

    k_w = parameter([1e5, 1e5, 1e5, 1e5], "N/m", "radial stiffness of each wheel")
    c_w = parameter([0.0, 0.0, 0.0, 0.0], "N.s/m", "radial damping of each wheel")

    z = state([0.0] * 4, "m", "deformation of each wheel, compression negative", nominal=1e-3)
    z_rate = state([0.0] * 4, "m/s", "its time derivative", nominal=0.1)
    normal_sum = state([0.0] * 4, "N.s", "normal impulse since the step began", nominal=0.1)
    traction_sum = state([0.0] * 4, "N.s", "traction impulse since the step began", nominal=0.1)
    lateral_sum = state([0.0] * 4, "N.s", "lateral impulse since the step began", nominal=0.1)
    elapsed = state(0.0, "s", "time since the step began")
    stiff = state([0.0] * 4, "N", "lateral force that sideslip asks for, held over the step")
    lost = state(0.0, "J", "energy dissipated by deformation since the start")
    slid = state(0.0, "J", "energy dissipated by sideslip since the start")

    push = event("a wheel begins or ceases to push on the ground", shape=4, announce="located")

    def sync(s: Any) -> dict[str, Any]:
        none = ca.SX.zeros(4)
        return {
            "z": s.gap, "z_rate": s.gap_rate, "elapsed": 0,
            "normal_sum": none, "traction_sum": none, "lateral_sum": none, "stiff": cornering(s, slowest_aside(s)),
        }  # fmt: skip

    def derivatives(s: Any) -> dict[str, Any]:
        F = _normal_force(s)
        traction, lateral = friction(s, F, s.stiff, asked_aside(s))
        stored_rate = s.k_w * ca.fmin(s.z, 0) * s.z_rate
        return {
            "z": s.z_rate,
            "z_rate": _by_axles(s.P, F) + _by_axles(s.U, traction) + s.b_free,
            "normal_sum": F,
            "traction_sum": traction,
            "lateral_sum": lateral,
            "elapsed": 1,
            "lost": ca.sum1(-F * s.z_rate - stored_rate),
            "slid": -ca.dot(lateral, s.contact_velocity[:, 1]),
        }

    def crossings(s: Any) -> dict[str, Any]:
        # Positive while F_n is: a wheel that approaches pushes as soon as it touches, whatever its damper does.
        return {"push": -s.k_w * s.z - s.c_w * ca.fmax(s.z_rate, 0)}

    def outputs(s: Any) -> dict[str, Any]:
        F = _normal_force(s)
        began = s.elapsed > 0  # before the first step there is no mean
        span = ca.if_else(began, s.elapsed, 1)
        mean = ca.if_else(began, s.normal_sum / span, F)
        return {
            "normal_force": mean,
            "traction": s.traction_sum / span,
            "lateral": s.lateral_sum / span,
            "normal_force_end": F,
            "normal_impulse": s.normal_sum,
            "deformation": s.z,
            "deformation_rate": s.z_rate,
            "contact": F > 0,
            "friction_limit": s.mu * mean,
            "dissipated_energy": s.lost,
            "sliding_energy": s.slid,
            "elastic_energy": ca.sum1(s.k_w * ca.fmin(s.z, 0) ** 2) / 2,
        }


def _normal_force(s: Any) -> ca.SX:
    """Return F_n (4) of the current deformation: it pushes and never pulls."""
    return ca.if_else(s.z < 0, ca.fmax(0, -s.k_w * s.z - s.c_w * s.z_rate), 0)


def _by_axles(matrix: ca.SX, forces: ca.SX) -> ca.SX:
    """Return the product, summed axle by axle: equal forces left and right then give equal motions to the bit."""
    return matrix[:, :2] @ forces[:2] + matrix[:, 2:] @ forces[2:]
