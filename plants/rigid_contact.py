"""Rigid wheels on the ground: contact forces and impacts from one complementarity problem per step (thesis chapter 4).

With the contact velocities v = gap' at the start of a step of length h and the reduced model of the body, the impulses
of the step and the velocities at its end solve

    v+ = v + h (U F_a + b_free) + P Lam
    0 <= Lam  _|_  v+ + eps Lam - target >= 0                      (4.33 in velocities, with impacts)

    target = -gap / h                                   apart: it may come as close as touching
           = max(e approach, rate of recovery)          touching or pressed

``approach`` is the velocity with which the contact closed: an impact with restitution e, as in
0 <= Lam _|_ P Lam + (1 + e) v >= 0.  F_a = clip(traction_demand, +-mu Lam / h) by a few passes.
"""

from __future__ import annotations

from typing import Any

import casadi as ca

from cosim import Component, input, output, parameter, state

from .lcp import solve_lcp
from .wheel_deformation import friction

_PASSES = 3  # each shrinks the error of the friction by mu |P^-1 U|, about 0.4, from what it was a step ago
_RESTING = 2  # an approach no faster than this many steps of free fall is no impact: a contact at rest does not chatter
_SPLIT = 1e-5  # least eps over |P|: left and right share a load evenly, rounding in the gaps moves less than 1e-3 N


class RigidContact(Component):
    """Four rigid wheels, stepped in velocities: the ports of `WheelDeformation`, so that either fits in its place.

    Wheels in the order front-left, front-right, rear-left, rear-right.  The body spreads an impulse over the step, so a
    contact that closes at a speed v sinks in by (1 - e) h v / 2 during its impact.  Undoing that within a step (a
    target of -gap / h) would throw the body back at v / 2, even from a plastic impact.  The contacts rise instead with
    the velocity from which ``recovery`` brings them to rest at the surface, all with the same factor, which keeps the
    wheels of a rigid body compatible.
    """

    e = parameter(0.0, "1", "coefficient of restitution: 0 plastic, 1 elastic")
    mu = parameter(0.8, "1", "friction coefficient between tyre and ground")
    C_alpha = parameter(5e3, "N/rad", "cornering stiffness of a wheel")
    v_min = parameter(0.1, "m/s", "speed below which the slip angle fades to 0, so that a standing wheel has one")
    k_split = parameter(1e13, "N/m", "stiffness of a contact: shares the load where P leaves it open")
    recovery = parameter(1.0, "m/s2", "deceleration with which contacts rise to the surface; well below gravity's")

    gap = input("m", "signed distance of each wheel from the ground, negative when pressed", shape=4)
    gap_rate = input("m/s", "its time derivative", shape=4)
    contact_velocity = input("m/s", "velocity of each wheel along its heading and across, to the left", shape=(4, 2))
    P = input("1/kg", "gap acceleration of each wheel per normal force of each wheel", shape=(4, 4))
    U = input("1/kg", "gap acceleration of each wheel per traction of each wheel", shape=(4, 4))
    b_free = input("m/s2", "gap acceleration without normal force and traction", shape=4)
    traction_demand = input("N", "traction asked of each wheel", shape=4)

    force = state([0.0] * 4, "N", "mean normal force over the step", nominal=100.0)
    along = state([0.0] * 4, "N", "traction over the step", nominal=100.0)
    across = state([0.0] * 4, "N", "lateral force over the step", nominal=100.0)
    elapsed = state(0.0, "s", "length of the step")
    clearance = state([0.0] * 4, "m", "gap at the start of the step", nominal=1e-3)
    clearance_rate = state([0.0] * 4, "m/s", "gap rate at the end of the step", nominal=0.1)
    approach = state([0.0] * 4, "m/s", "speed at which a contact closed whose impact is not over, else 0", nominal=0.1)
    lost = state(0.0, "J", "energy taken from the body by the normal forces since the start")
    slid = state(0.0, "J", "energy dissipated by sideslip since the start")

    normal_force = output("N", "mean normal force over the step", shape=4)
    traction = output("N", "mean traction over the step, forward positive", shape=4)
    lateral = output("N", "mean lateral force over the step, to the left positive", shape=4)
    normal_force_end = output("N", "the same as normal_force: it is known in the mean only", shape=4)
    normal_impulse = output("N.s", "normal impulse delivered over the step", shape=4)
    deformation = output("m", "gap at the start of the step", shape=4)
    deformation_rate = output("m/s", "gap rate at the end of the step", shape=4)
    contact = output("1", "1 where the wheel pushed on the ground in the step, else 0", shape=4)
    friction_limit = output("N", "friction available: mu times the mean normal force", shape=4)
    dissipated_energy = output("J", "energy lost in impacts since the start")
    sliding_energy = output("J", "energy dissipated by sideslip since the start")
    elastic_energy = output("J", "energy stored in the wheels: none")

    def flow(s: Any) -> dict[str, Any]:
        h = s.dt
        impact = -s.gap_rate > _RESTING * h * ca.fabs(s.b_free)
        approach = ca.fmax(s.approach, ca.if_else(impact, -s.gap_rate, 0))
        target = _target(s, approach)
        size = ca.mmax(ca.fabs(s.P))
        eps = ca.fmax(1 / (s.k_split * h**2), _SPLIT * size)
        compliant = s.P + eps * ca.SX.eye(4)

        force = s.force
        for _ in range(_PASSES):
            traction, _lateral = friction(s, force)
            free = s.gap_rate + h * (s.b_free + s.U @ traction)
            impulse = ca.fmax(0, solve_lcp(compliant, free - target))
            force = impulse / h
        reached = free + s.P @ impulse
        traction, lateral = friction(s, force)
        unfinished = ca.logic_and(impulse > 0, reached < s.e * approach)
        return {
            "force": force, "along": traction, "across": lateral, "elapsed": h,
            "clearance": s.gap, "clearance_rate": reached,
            "approach": ca.if_else(unfinished, approach, 0),
            "lost": s.lost - ca.dot(impulse, s.gap_rate + reached) / 2,
            "slid": s.slid - h * ca.dot(lateral, s.contact_velocity[:, 1]),
        }  # fmt: skip

    def outputs(s: Any) -> dict[str, Any]:
        return {
            "normal_force": s.force,
            "traction": s.along,
            "lateral": s.across,
            "normal_force_end": s.force,
            "normal_impulse": s.force * s.elapsed,
            "deformation": s.clearance,
            "deformation_rate": s.clearance_rate,
            "contact": s.force > 0,
            "friction_limit": s.mu * s.force,
            "dissipated_energy": s.lost,
            "sliding_energy": s.slid,
            "elastic_energy": 0,
        }


def _target(s: Any, approach: ca.SX) -> ca.SX:
    """Return the least velocities at the end of the step (4)."""
    deepest = -ca.mmin(s.gap)
    # From rest at the surface backwards in time, depth = v^2 / (2 recovery); the last bit within one step.
    rate = ca.sqrt(2 * s.recovery / ca.fmax(deepest, 2 * s.recovery * s.dt**2))
    return ca.if_else(s.gap > 0, -s.gap / s.dt, ca.fmax(s.e * approach, -rate * s.gap))
