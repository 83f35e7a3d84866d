"""What all wheel plants share: their ports, and the friction between tyre and ground.

F_a = clip(traction_demand, +-mu F_n)
F_l = -S / sqrt(1 + (S / room)^2),   S = C_alpha alpha,   room^2 = (mu F_n)^2 - F_a^2
alpha = atan(v_across / sqrt(v_along^2 + v_min^2))
"""

from __future__ import annotations

from typing import Any

import casadi as ca

from cosim import Component, input, output, parameter, structural

_SMALL = 1e-3  # N, forces below it bend the roots and quotients of the friction ellipse, which keeps slopes finite


class Wheels(Component):
    """Ports of a plant of four wheels: the body's contacts and reduced model in, mean forces over the step out.

    Wheels in the order front-left, front-right, rear-left, rear-right.  Traction points along the wheel's heading on
    the tangent plane, lateral force to the left of it and against a velocity to the left.  What fits these ports stands
    in for any other; a plant says what its deformation and its lost energy are.

    Sideslip is held over a step of length h, so a lateral force must not turn it round: a wheel has the slip angle of
    one that rolls at h C_alpha sideslip_mobility or faster, 0.3 m/s for the thesis' robot at a step of 1 ms.
    """

    sideslip = structural(
        "stiffness", "lateral force: by C_alpha, or as a drive asks for by slip", choices=("stiffness", "demand")
    )

    mu = parameter(0.8, "1", "friction coefficient between tyre and ground")
    C_alpha = parameter(5e3, "N/rad", "cornering stiffness of a wheel")
    v_min = parameter(0.1, "m/s", "speed below which the slip angle fades to 0, so that a standing wheel has one")

    gap = input("m", "signed distance of each wheel from the ground, negative when pressed", shape=4)
    gap_rate = input("m/s", "its time derivative", shape=4)
    contact_velocity = input("m/s", "velocity of each wheel along its heading and across, to the left", shape=(4, 2))
    P = input("1/kg", "gap acceleration of each wheel per normal force of each wheel", shape=(4, 4))
    U = input("1/kg", "gap acceleration of each wheel per traction of each wheel", shape=(4, 4))
    sideslip_mobility = input("1/kg", "most acceleration of a wheel to its left by lateral forces of 1 N", shape=4)
    b_free = input("m/s2", "gap acceleration without normal force and traction", shape=4)
    traction_demand = input("N", "traction asked of each wheel", shape=4)
    lateral_demand = input("N", "lateral force asked of each wheel, to the left; for sideslip = demand", shape=4)

    normal_force = output("N", "mean normal force over the step", shape=4)
    traction = output("N", "mean traction over the step, forward positive", shape=4)
    lateral = output("N", "mean lateral force over the step, to the left positive", shape=4)
    normal_force_end = output("N", "normal force at the end of the step; its mean where no other is known", shape=4)
    normal_impulse = output("N.s", "normal impulse delivered over the step", shape=4)
    deformation = output("m", "gap of each wheel as this plant knows it, compression negative", shape=4)
    deformation_rate = output("m/s", "its rate at the end of the step", shape=4)
    contact = output("1", "1 where the wheel pushes on the ground, else 0", shape=4)
    friction_limit = output("N", "friction available: mu times the mean normal force", shape=4)
    dissipated_energy = output("J", "energy lost in deformation or impacts since the start")
    sliding_energy = output("J", "energy dissipated by sideslip since the start")
    elastic_energy = output("J", "energy stored in the wheels")


def slowest_aside(s: Any) -> ca.SX:
    """Return the speeds (4, m/s) below which a slip angle held over the step ``s.dt`` would be turned round in it."""
    return s.dt * s.C_alpha * s.sideslip_mobility


def asked_aside(s: Any) -> Any:
    """Return the lateral force (4,) that a drive asks for, or None where the wheels make it by their stiffness."""
    return s.lateral_demand if s.sideslip == "demand" else None


def cornering(s: Any, least_speed: Any = 0) -> Any:
    """Return S, the lateral force (4, N) that sideslip asks for by the stiffness of the tyres, against the velocity.

    Reads ``contact_velocity``, ``C_alpha`` and ``v_min``.  A wheel slower than *least_speed* (4, m/s) has the slip
    angle of one at that speed.
    """
    along, across = s.contact_velocity[:, 0], s.contact_velocity[:, 1]
    return s.C_alpha * ca.atan2(across, ca.fmax(least_speed, ca.sqrt(along**2 + s.v_min**2)))


def friction(s: Any, F_n: ca.SX, stiff: Any, lateral_demand: Any = None) -> tuple[ca.SX, ca.SX]:
    """Return traction and lateral force (4 each) under the normal forces *F_n*: first the demand, then sideslip.

    Reads ``traction_demand`` and ``mu``.  The lateral force approaches what the traction leaves of the friction ellipse
    smoothly and stays inside it; *stiff* (4, N) is `cornering`.  A *lateral_demand* (4, N) takes the place of sideslip,
    cut at the ellipse.
    """
    limit = s.mu * F_n
    traction = ca.fmax(-limit, ca.fmin(limit, s.traction_demand))
    left = ca.fmax(0, limit**2 - traction**2)
    room = left / ca.sqrt(left + _SMALL**2)
    if lateral_demand is not None:
        return traction, ca.fmax(-room, ca.fmin(room, lateral_demand))
    return traction, -stiff * room / ca.sqrt(room**2 + stiff**2 + _SMALL**2)
