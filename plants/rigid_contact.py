"""Rigid wheels on the ground: contact forces and impacts from one complementarity problem per step (thesis chapter 4).

With the contact velocities v = gap' at the start of a step of length h and the reduced model of the body, the impulses
of the step and the velocities at its end solve

    v+ = v + h (U F_a + V (F_l - F_l-) + b_free) + P Lam
    0 <= Lam - given  _|_  v+ + eps Lam - target >= 0              (4.33 in velocities, with impacts)

    target = -gap / h               apart: it may come as close as touching
           = rate of recovery       touching or pressed

``given`` is the restitution of an impact, once no wheel closes any more: e times the impulses since the first one did,
or less where that would give back more than e^2 of the energy they took.  Where the same wheels push throughout that
is 0 <= Lam _|_ P Lam + (1 + e) v >= 0.  F_a and F_l are the friction of `wheels` under F_n = Lam / h; b_free
knows the lateral forces of the step before, F_l-.
"""

from __future__ import annotations

from typing import Any

import casadi as ca

from cosim import input, parameter, state

from .lcp import solve_lcp
from .wheels import Wheels, asked_aside, cornering, friction, slowest_aside

_RESTING = 2  # an approach no faster than this many steps of free fall is no impact: a contact at rest does not chatter
_NOTHING = 1e-30  # J, keeps a quotient of zeros at zero
_SPLIT = 1e-5  # least eps over |P|: left and right share a load evenly, rounding in the gaps moves less than 1e-3 N


class RigidContact(Wheels):
    """Four rigid wheels, stepped in velocities.

    Normal forces are known in the mean only; ``deformation`` is the gap at the start of the step.

    The body spreads an impulse over the step, so a contact that closes at a speed v sinks in by h v / 2 during its
    impact, wherever in a step it lands.  Undoing that within a step (a target of -gap / h) would throw the body back at
    v / 2, even from a plastic impact.  The contacts rise instead with the velocity from which ``recovery`` brings them
    to rest at the surface, all with the same factor, which keeps the wheels of a rigid body compatible.
    """

    e = parameter(0.0, "1", "coefficient of restitution: 0 plastic, 1 elastic")
    k_split = parameter(1e13, "N/m", "stiffness of a contact: shares the load where P leaves it open")
    recovery = parameter(1.0, "m/s2", "deceleration with which contacts rise to the surface; well below gravity's")

    V = input("1/kg", "gap acceleration of each wheel per lateral force of each wheel", shape=(4, 4))

    force = state([0.0] * 4, "N", "mean normal force over the step", nominal=100.0)
    along = state([0.0] * 4, "N", "traction over the step", nominal=100.0)
    across = state([0.0] * 4, "N", "lateral force over the step", nominal=100.0)
    elapsed = state(0.0, "s", "length of the step")
    clearance = state([0.0] * 4, "m", "gap at the start of the step", nominal=1e-3)
    clearance_rate = state([0.0] * 4, "m/s", "gap rate at the end of the step", nominal=0.1)
    stored = state([0.0] * 4, "N.s", "normal impulse of an impact so far, 0 when it is over", nominal=0.1)
    taken = state(0.0, "J", "energy that the impulses of an impact took so far, 0 when it is over")
    lost = state(0.0, "J", "energy taken from the body by the normal forces since the start")
    slid = state(0.0, "J", "energy dissipated by sideslip since the start")

    def flow(s: Any) -> dict[str, Any]:
        h = s.dt
        closing = ca.logic_and(-s.gap_rate > _RESTING * h * ca.fabs(s.b_free), s.gap + h * s.gap_rate < 0)
        impact = ca.mmax(closing)  # 1 while any wheel closes
        given = ca.if_else(impact, 0, _restitution(s))
        target = _target(s)
        size = ca.mmax(ca.fabs(s.P))
        eps = ca.fmax(1 / (s.k_split * h**2), _SPLIT * size)
        compliant = s.P + eps * ca.SX.eye(4)
        stiff = cornering(s, slowest_aside(s))

        def pushed(F_n: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
            """Return the gap rates that friction under *F_n* and all but the ground leave, and that friction."""
            traction, lateral = friction(s, F_n, stiff, asked_aside(s))
            other = s.U @ traction + s.V @ (lateral - s.across)
            return s.gap_rate + h * (s.b_free + other), traction, lateral

        def impulses(F_n: ca.SX) -> ca.SX:
            return given + ca.fmax(0, solve_lcp(compliant, pushed(F_n)[0] + compliant @ given - target))

        # Each pass turns an error of F_n into -g times it: g is 0.4 for brakes at their limit, 0.7 for one wheel that
        # slips sideways, beyond 1 where P hardly says which wheels bear.  The last one leaves g^2 (1 - g) / 2.
        first = impulses(s.force) / h
        impulse = impulses((first + impulses(first) / h) / 2)
        force = impulse / h
        free, traction, lateral = pushed(force)
        reached = free + s.P @ impulse
        taken = -ca.dot(impulse, s.gap_rate + reached) / 2
        return {
            "force": force, "along": traction, "across": lateral, "elapsed": h,
            "clearance": s.gap, "clearance_rate": reached,
            "stored": ca.if_else(ca.logic_and(impact, impulse > 0), s.stored + impulse, 0),
            "taken": ca.if_else(impact, s.taken + taken, 0),
            "lost": s.lost + taken,
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


def _target(s: Any) -> ca.SX:
    """Return the least velocities at the end of the step (4)."""
    deepest = -ca.mmin(s.gap)
    # From rest at the surface backwards in time, depth = v^2 / (2 recovery); the last bit within one step.
    rate = ca.sqrt(2 * s.recovery / ca.fmax(deepest, 2 * s.recovery * s.dt**2))
    return -s.gap * ca.if_else(s.gap > 0, 1 / s.dt, rate)


def _restitution(s: Any) -> ca.SX:
    """Return the impulses (4) that an impact gives back: f e stored, with the largest f <= 1 that gains no energy.

    They change the energy by f e v . stored + (f e)^2 stored . P stored / 2, which is not to exceed e^2 of what the
    impact took.  Wheels that landed one after the other would otherwise gain where the later one lifted the first.
    """
    whole = s.e * s.stored
    linear, square = ca.dot(whole, s.gap_rate), ca.dot(whole, s.P @ whole)
    limit = 2 * s.e**2 * ca.fmax(0, s.taken)
    return whole * ca.fmin(1, limit / (linear + ca.sqrt(linear**2 + square * limit) + _NOTHING))
