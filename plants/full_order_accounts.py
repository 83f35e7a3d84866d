"""What the robot of full order keeps account of: energies, momenta, and work and impulse since the start.

Work is force times mean velocity of a micro step, which is exact in kinetic energy: what is missing in a balance is
what the scheme itself loses or makes.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import Any

import casadi as ca

from .full_order_middle import Middle
from .full_order_ports import NAMES, WHEELS, packed, rows_of
from .full_order_steering import aligned
from .ring import CONTACT, MATERIAL, crossed, share
from .ring_wheel import ring


@dataclass(frozen=True)
class After:
    """Velocities at the end of a micro step."""

    v: Any
    v_ring: list[Any]
    spin: Any
    modal_rate: Any
    omega: Any


def accounts(s: Any, at: Middle, after: After) -> dict[str, Any]:
    """Return work and impulse since the start, after a micro step."""
    dt, rate, turns = s.dt, (s.v + after.v) / 2, (at.omega + after.omega) / 2
    lost = [_wheel(s, at, after, k) for k in WHEELS]
    w = 2 * pi * s.frequency
    modes = ca.dot(2 * s.damping * w * s.modal_rate, (s.modal_rate + after.modal_rate) / 2)
    lift_rate = s.wheel_shape @ (s.modal_rate + after.modal_rate) / 2
    hubs = [_hub_velocity(at, rate, turns, lift_rate, k) for k in WHEELS]
    laid = at.R.T @ at.load.force
    outside = ca.dot(s.force, rate) + ca.dot(s.moment + at.load.moment, turns)
    outside += sum(ca.dot(laid[:, k], hubs[k]) for k in WHEELS)
    spin, across = (s.spin + after.spin) / 2, aligned(-at.steered, ca.repmat(turns, 1, 4))
    driven = ca.dot(at.torque, spin - across[1, :].T)
    driven += ca.dot(s.J_w * spin * across[0, :].T - at.moments[2, :].T, s.steer_rate)  # what holds the angles
    weight = ca.vertcat(0, 0, -at.g * s.m)
    on_body = s.force + weight + ca.sum2(at.load.force)
    turning = ca.cross(at.r, on_body) + at.R @ (s.moment + at.load.moment + ca.sum2(crossed(at.arms, laid)))
    return {
        "damped": s.damped + dt * (modes + sum(w.damped for w in lost)),
        "slid": s.slid + dt * sum(w.slid for w in lost),
        "fallen": s.fallen + dt * (weight[2] * rate[2] + sum(w.fallen for w in lost)),
        "worked": s.worked + dt * (driven + outside),
        "impulse": s.impulse + dt * (on_body + sum(w.push for w in lost)),
        "twist": s.twist + dt * (turning + sum(w.twist for w in lost)),
    }


@dataclass(frozen=True)
class _Wheel:
    """Powers (W), force (N) and moment (N.m, about the world's origin) of one ring."""

    damped: Any
    slid: Any
    fallen: Any
    push: Any
    twist: Any


def _hub_velocity(at: Middle, rate: Any, turns: Any, lift_rate: Any, k: int) -> Any:
    """Return the mean velocity of a hub in a micro step, body axes."""
    return at.R.T @ rate + ca.cross(turns, at.arms[:, k]) + ca.vertcat(0, 0, lift_rate[k])


def _wheel(s: Any, at: Middle, after: After, k: int) -> _Wheel:
    of, n, material = at.of[k], s.nodes, share(packed(s, MATERIAL), s.nodes)
    cell, rate, turns = material.length * n / s.points, (s.v + after.v) / 2, (at.omega + after.omega) / 2
    mean = (getattr(s, f"v_{NAMES[k]}").T + after.v_ring[k]) / 2
    lift_rate = s.wheel_shape @ (s.modal_rate + after.modal_rate) / 2
    hub = at.wheels[k].T @ at.R @ _hub_velocity(at, rate, turns, lift_rate, k)
    across = aligned(-at.steered[k], turns)
    rim = ca.vertcat(across[0], (s.spin[k] + after.spin[k]) / 2, turns[2] + s.steer_rate[k])
    by_dampers = ca.sum2(ca.sum1(of[1] * (at.wheels[k].T @ mean))) + ca.dot(of[6][:, 0], hub) + ca.dot(of[6][:, 1], rim)
    stored = cell * s.k_bristle * (ca.sumsqr(of[4]) - ca.sumsqr(getattr(s, f"z_{NAMES[k]}"))) / 2
    total = of[2] + of[3] - ca.vertcat(ca.MX.zeros(2, n), ca.repmat(at.g * material.mass, 1, n))
    return _Wheel(
        damped=-by_dampers,
        slid=-ca.sum2(ca.sum1(of[3] * mean)) - stored / s.dt,
        fallen=-at.g * material.mass * ca.sum2(mean[2, :]),
        push=ca.sum2(total),
        twist=ca.sum2(crossed(at.x[k], total)),
    )


def energies(s: Any, omega: Any, frame: Any) -> dict[str, Any]:
    """Return the energy outputs."""
    material, contact = packed(s, MATERIAL), packed(s, CONTACT)
    of = [
        ring(s.nodes, s.points).energies(getattr(s, f"x_{NAMES[k]}").T, getattr(s, f"v_{NAMES[k]}").T,
                                         getattr(s, f"z_{NAMES[k]}").T, rows_of(s, k), frame[:, k], material, contact)
        for k in WHEELS
    ]  # fmt: skip
    moving = (
        s.m * ca.sumsqr(s.v) + ca.dot(omega, s.inertia * omega) + s.J_w * ca.sumsqr(s.spin) + ca.sumsqr(s.modal_rate)
    )
    rings = share(material, s.nodes).mass * sum(ca.sumsqr(getattr(s, f"v_{n}")) for n in NAMES)
    modal = ca.sumsqr(2 * pi * s.frequency * s.modal_q) / 2
    return {
        "kinetic_energy": (moving + rings) / 2,
        "elastic_energy": modal + sum(o[0] for o in of),
        "contact_energy": sum(o[1] for o in of),
        "potential_energy": -s.fallen,
        "dissipated_energy": s.damped + s.slid,
        "slip_energy": s.slid,
        "work": s.worked,
    }


def momenta(s: Any) -> dict[str, Any]:
    """Return the outputs of linear and angular momentum."""
    mass = share(packed(s, MATERIAL), s.nodes).mass
    linear, angular = s.m * s.v, s.H + s.m * ca.cross(s.r, s.v)
    for name in NAMES:
        x, v = getattr(s, f"x_{name}").T, getattr(s, f"v_{name}").T
        linear, angular = linear + mass * ca.sum2(v), angular + mass * ca.sum2(crossed(x, v))
    return {"momentum": linear, "angular_momentum": angular}
