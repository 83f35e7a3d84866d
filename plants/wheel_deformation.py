"""Deformable wheels on the ground (thesis chapter 6): unilateral spring-dampers on the reduced model of the body.

Between communication points the wheels integrate the relative motion of the contacts that the body hands over,

    z'' = P F_n + U F_a + b_free                                   (6.5, 6.12)
    F_n = max(0, -k_w z - c_w z')  while z < 0, else 0             (6.6; z < 0 is compression, so the spring pushes)
    F_a = clip(traction_demand, +-mu F_n)
    F_l = -S / sqrt(1 + (S / room)^2),   S = C_alpha alpha,   room^2 = (mu F_n)^2 - F_a^2
    alpha = atan(v_across / sqrt(v_along^2 + v_min^2))
or  F_l = clip(lateral_demand, +-room)                             sideslip = "demand": of a drive's own curve

starting from the body's gap and gap rate, and return means over the step: momentum passed equals momentum received.
In print K = -P k_w (6.8) has the sign of a spring that pulls.
"""

from __future__ import annotations

from typing import Any

import casadi as ca

from cosim import Component, event, input, output, parameter, state, structural

_SMALL = 1e-3  # N, forces below it bend the roots and quotients of the friction ellipse, which keeps slopes finite


class WheelDeformation(Component):
    """Four unilateral spring-damper wheels, sub-stepped on the body's reduced model, with friction inside.

    Wheels in the order front-left, front-right, rear-left, rear-right.  Traction points along the wheel's heading on
    the tangent plane, lateral force to the left of it and against a velocity to the left.

    Energy: the work -F_n z' done on a wheel is the growth of k_w z^2 / 2 plus what is dissipated: c_w z'^2 while the
    wheel pushes; the relaxing spring's own energy, -k_w z z', while it returns too slowly to push.  Neither is ever
    negative.
    """

    sideslip = structural(
        "stiffness", "lateral force: by C_alpha, or as a drive asks for by slip", choices=("stiffness", "demand")
    )

    k_w = parameter([1e5, 1e5, 1e5, 1e5], "N/m", "radial stiffness of each wheel")
    c_w = parameter([0.0, 0.0, 0.0, 0.0], "N.s/m", "radial damping of each wheel")
    mu = parameter(0.8, "1", "friction coefficient between tyre and ground")
    C_alpha = parameter(5e3, "N/rad", "cornering stiffness of a wheel")
    v_min = parameter(0.1, "m/s", "speed below which the slip angle fades to 0, so that a standing wheel has one")

    gap = input("m", "signed distance of each wheel from the ground, negative when pressed", shape=4)
    gap_rate = input("m/s", "its time derivative", shape=4)
    contact_velocity = input("m/s", "velocity of each wheel along its heading and across, to the left", shape=(4, 2))
    P = input("1/kg", "gap acceleration of each wheel per normal force of each wheel", shape=(4, 4))
    U = input("1/kg", "gap acceleration of each wheel per traction of each wheel", shape=(4, 4))
    b_free = input("m/s2", "gap acceleration without normal force and traction", shape=4)
    traction_demand = input("N", "traction asked of each wheel", shape=4)
    lateral_demand = input("N", "lateral force asked of each wheel, to the left; for sideslip = demand", shape=4)

    z = state([0.0] * 4, "m", "deformation of each wheel, compression negative", nominal=1e-3)
    z_rate = state([0.0] * 4, "m/s", "its time derivative", nominal=0.1)
    normal_sum = state([0.0] * 4, "N.s", "normal impulse since the step began", nominal=0.1)
    traction_sum = state([0.0] * 4, "N.s", "traction impulse since the step began", nominal=0.1)
    lateral_sum = state([0.0] * 4, "N.s", "lateral impulse since the step began", nominal=0.1)
    elapsed = state(0.0, "s", "time since the step began")
    lost = state(0.0, "J", "energy dissipated by deformation since the start")
    slid = state(0.0, "J", "energy dissipated by sideslip since the start")

    push = event("a wheel begins or ceases to push on the ground", shape=4)

    normal_force = output("N", "mean normal force over the step", shape=4)
    traction = output("N", "mean traction over the step, forward positive", shape=4)
    lateral = output("N", "mean lateral force over the step, to the left positive", shape=4)
    normal_force_end = output("N", "normal force at the end of the step", shape=4)
    normal_impulse = output("N.s", "normal impulse delivered over the step", shape=4)
    deformation = output("m", "deformation at the end of the step, compression negative", shape=4)
    deformation_rate = output("m/s", "its time derivative", shape=4)
    contact = output("1", "1 where the wheel pushes on the ground at the end of the step, else 0", shape=4)
    friction_limit = output("N", "friction available: mu times the mean normal force", shape=4)
    dissipated_energy = output("J", "energy dissipated by deformation since the start")
    sliding_energy = output("J", "energy dissipated by sideslip since the start")
    elastic_energy = output("J", "energy stored in the wheels")

    def sync(s: Any) -> dict[str, Any]:
        none = ca.SX.zeros(4)
        return {
            "z": s.gap, "z_rate": s.gap_rate, "elapsed": 0,
            "normal_sum": none, "traction_sum": none, "lateral_sum": none,
        }  # fmt: skip

    def derivatives(s: Any) -> dict[str, Any]:
        F = _normal_force(s)
        traction, lateral = friction(s, F, lateral_demand=asked_aside(s))
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


def asked_aside(s: Any) -> Any:
    """Return the lateral force (4,) that a drive asks for, or None where the wheels make it by their stiffness."""
    return s.lateral_demand if s.sideslip == "demand" else None


def friction(s: Any, F_n: ca.SX, least_speed: Any = 0, lateral_demand: Any = None) -> tuple[ca.SX, ca.SX]:
    """Return traction and lateral force (4 each) under the normal forces *F_n*: first the demand, then sideslip.

    Reads ``traction_demand``, ``contact_velocity``, ``mu``, ``C_alpha`` and ``v_min``.  The lateral force approaches
    what the traction leaves of the friction ellipse smoothly and stays inside it.  A wheel slower than *least_speed*
    (4, m/s) has the slip angle of one at that speed.  A *lateral_demand* (4, N) takes the place of sideslip, cut at the
    ellipse.
    """
    limit = s.mu * F_n
    traction = ca.fmax(-limit, ca.fmin(limit, s.traction_demand))
    left = ca.fmax(0, limit**2 - traction**2)
    room = left / ca.sqrt(left + _SMALL**2)
    if lateral_demand is not None:
        return traction, ca.fmax(-room, ca.fmin(room, lateral_demand))
    along, across = s.contact_velocity[:, 0], s.contact_velocity[:, 1]
    stiff = s.C_alpha * ca.atan2(across, ca.fmax(least_speed, ca.sqrt(along**2 + s.v_min**2)))
    return traction, -stiff * room / ca.sqrt(room**2 + stiff**2 + _SMALL**2)
