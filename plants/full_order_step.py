"""One micro step of the full-order robot: half a drift, a kick by the forces in the middle, half a drift.

The scheme (position Verlet) is of second order and symplectic for what is elastic.  It keeps linear momentum, and
angular momentum about any point, to rounding, since the state of the body's rotation is its angular momentum in the
world:

    H = R (I omega + e_y J sum Omega_k)                           R: body to world, Omega_k: spins in the world

A force F of wheel k on its hub, in body axes, where the chassis has lifted the hub by phi_k q, does on body and modes

    m v' = R F,   H' = R (a_k x F + M_k),   q'' = phi_k F_z - 2 zeta w q' - w^2 q,   a_k = c_k + e_z phi_k q

so that what the wheels do is what the body, its modes and the rims get.  (The inertia of the body is that of its shape
at rest: terms of second order in the elastic displacement are left out.)
Steered wheels: see `full_order_steering`.
"""

from __future__ import annotations

from math import pi
from typing import Any

import casadi as ca

from .full_order_accounts import After, accounts
from .full_order_middle import Middle, middle, turned, turning
from .full_order_ports import NAMES, WHEELS, packed
from .full_order_steering import aligned, axles
from .ring import MATERIAL, crossed, share


def micro_step(s: Any) -> dict[str, Any]:
    """Return all states a step ``s.dt`` later."""
    h, at = s.dt / 2, middle(s)
    w, mass = 2 * pi * s.frequency, share(packed(s, MATERIAL), s.nodes).mass
    down = ca.vertcat(0, 0, -at.g)

    # the kick
    v = s.v + s.dt * (at.R @ ca.sum2(at.on_hub) / s.m + s.force / s.m + down)
    moment = ca.sum2(crossed(at.arms, at.on_hub)) + ca.sum2(aligned(at.steered, at.moments)) + s.moment + at.load.moment
    H = s.H + s.dt * at.R @ moment
    spin = s.spin + s.dt * (at.torque + at.moments[1, :].T) / s.J_w
    lifted = s.wheel_shape.T @ at.on_hub[2, :].T
    modal_rate = s.modal_rate + s.dt * (lifted - 2 * s.damping * w * s.modal_rate - w**2 * at.bend)
    v_ring = [
        getattr(s, f"v_{NAMES[k]}").T + s.dt * ((at.wheels[k] @ at.of[k][0] + at.of[k][2] + at.of[k][3]) / mass + down)
        for k in WHEELS
    ]

    # half a drift
    _, omega = turning()(at.q, H, spin, at.steered, s.inertia, s.J_w)
    found = {
        "r": at.r + h * v, "q": turned()(at.q, omega, h), "v": v, "H": H, "spin": spin,
        "angle": at.angle + h * (spin - axles(at.steered).T @ omega), "steered": at.steered + h * s.steer_rate,
        "modal_q": at.bend + h * modal_rate, "modal_rate": modal_rate,
    }  # fmt: skip
    for k, name in enumerate(NAMES):
        found |= {f"x_{name}": (at.x[k] + h * v_ring[k]).T, f"v_{name}": v_ring[k].T, f"z_{name}": at.of[k][4].T}
    return found | _felt(s, at) | accounts(s, at, After(v, v_ring, spin, modal_rate, omega))


def _felt(s: Any, at: Middle) -> dict[str, Any]:
    """Return what the wheels felt: the last forces, and impulses since the communication step began.

    Friction is summed along the road and across; along a wheel and to its left it is that turned by its heading.
    """
    sums = ca.horzcat(*(o[7] for o in at.of))
    across = at.along[1, :].T
    ahead = ca.sign(at.along[0, :].T) * ca.sqrt(ca.fmax(0, 1 - across**2))
    along, left = sums[1, :].T, sums[2, :].T
    passed_on = at.on_hub - at.R.T @ s.hub_force.T
    return {
        "pressing": sums[0, :].T,
        "normal_sum": s.normal_sum + s.dt * sums[0, :].T,
        "traction_sum": s.traction_sum + s.dt * (ahead * along + across * left + at.load.traction),
        "lateral_sum": s.lateral_sum + s.dt * (ahead * left - across * along),
        "sliding_sum": s.sliding_sum + s.dt * sums[4, :].T,
        "axle_sum": s.axle_sum + s.dt * passed_on.T,
        "elapsed": s.elapsed + s.dt,
        "push": ca.vertcat(*(_lengths(o[2]) for o in at.of)),
        "pull": ca.vertcat(*(_lengths(o[3]) for o in at.of)),
    }


def _lengths(columns: Any) -> Any:
    return ca.sqrt(ca.sum1(columns**2))
