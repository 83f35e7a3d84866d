"""One micro step of the full-order robot: half a drift, a kick by the forces in the middle, half a drift.

The scheme (position Verlet) is of second order and symplectic for what is elastic.  It keeps linear momentum, and
angular momentum about any point, to rounding, since the state of the body's rotation is its angular momentum in the
world:

    H = R (I omega + e_y J sum Omega_k)                           R: body to world, Omega_k: spins in the world

A force F of wheel k on its hub, in body axes, where the chassis has lifted the hub by phi_k q, does on body and modes

    m v' = R F,   H' = R (a_k x F + M_k),   q'' = phi_k F_z - 2 zeta w q' - w^2 q,   a_k = c_k + e_z phi_k q

so that what the wheels do is what the body, its modes and the rims get.  (The inertia of the body is that of its shape
at rest: terms of second order in the elastic displacement are left out.)
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import pi
from typing import Any

import casadi as ca

from .contact import rotation_matrix
from .ring import CONTACT, FRAME, MATERIAL, around, held, hinge, share, shifted
from .ring_contact import touch

WHEELS = range(4)
NAMES = ("fl", "fr", "rl", "rr")
_LEAST = 1e-40  # keeps the axis of no rotation finite


@lru_cache(maxsize=1)
def turning() -> ca.Function:
    """Return (q, H, spin, inertia, J) -> (R, omega): attitude and angular velocity in body axes."""
    q, H, spin, inertia, J = (ca.SX.sym(n, k) for n, k in (("q", 4), ("H", 3), ("spin", 4), ("inertia", 3), ("J", 1)))
    R = rotation_matrix(q)
    omega = (R.T @ H - ca.vertcat(0, J * ca.sum1(spin), 0)) / inertia
    return ca.Function("turning", [q, H, spin, inertia, J], ca.cse([R, omega]))


@lru_cache(maxsize=1)
def turned() -> ca.Function:
    """Return (q, omega, t) -> q after turning with *omega* (body axes) for *t*."""
    q, omega, t = ca.SX.sym("q", 4), ca.SX.sym("omega", 3), ca.SX.sym("t")
    a = omega * t / 2
    angle = ca.sqrt(ca.sumsqr(a) + _LEAST)
    w, v = ca.cos(angle), ca.sin(angle) / angle * a
    end = ca.vertcat(q[0] * w - ca.dot(q[1:], v), q[0] * v + w * q[1:] + ca.cross(q[1:], v))
    return ca.Function("turned", [q, omega, t], [end])


@lru_cache(maxsize=1)
def frames() -> ca.Function:
    """Return (R, omega, r, v, size, lift, lift_rate, spin, angle) -> (frames (FRAME, 4), arms (3, 4)) of the wheels.

    *size* is L_f, L_r, half_track and h, *lift* (4,) how far the chassis has bent at the hubs, upwards.
    """
    R, given = ca.SX.sym("R", 3, 3), {n: ca.SX.sym(n, k) for n, k in (
        ("omega", 3), ("r", 3), ("v", 3), ("size", 4), ("lift", 4), ("lift_rate", 4), ("spin", 4),
        ("angle", 4))}  # fmt: skip
    omega, r, v, size, lift, lift_rate, spin, angle = given.values()
    columns, arms = [], []
    for k in WHEELS:
        arm = ca.vertcat(size[0] if k < 2 else -size[1], size[2] * (1 if k % 2 == 0 else -1), -size[3] + lift[k])
        velocity = v + R @ (ca.cross(omega, arm) + ca.vertcat(0, 0, lift_rate[k]))
        columns.append(ca.vertcat(ca.vec(R), r + R @ arm, velocity, omega, spin[k] - omega[1], angle[k]))
        arms.append(arm)
    return ca.Function("frames", [R, *given.values()], [ca.horzcat(*columns), ca.horzcat(*arms)])


@dataclass(frozen=True)
class Ring:
    """Functions of one wheel."""

    forces: ca.Function
    energies: ca.Function


@lru_cache(maxsize=16)
def ring(nodes: int, points: int) -> Ring:
    """Return the functions of a ring of *nodes* nodes that meets the ground at *points* points.

    forces: (x, v, z, rows, frame, material, contact, dt) -> (f, f_c, f_n, f_t, z, hub, hub_c, sums): forces on the
    nodes (3, nodes), of the ring and the rim in body axes, of their dampers alone, and normal and tangential ones of
    the ground in the world; the bristles (2, points) at the end; force and moment of the ring on the hub (3, 2), and
    what of these is the dampers'; per wheel what `ring_contact.touch` sums up.
    energies: (x, v, z, rows, frame, material, contact) -> (energy of the ring, of its contact).
    """
    each = points // nodes
    shapes = {"x": (3, nodes), "v": (3, nodes), "z": (2, points), "rows": (13, points), "frame": (FRAME, 1),
              "material": (len(MATERIAL), 1), "contact": (len(CONTACT), 1), "dt": (1, 1)}  # fmt: skip
    given: dict[str, Any] = {name: ca.MX.sym(name, *shape) for name, shape in shapes.items()}
    x, v, z, rows, frame, material, contact, dt = given.values()
    cell = share(material, nodes).length / each
    d, f, f_c, e_held = held(nodes).map("held_all", "serial", nodes, [3, 4], [])(
        x, v, ca.DM(around(nodes)), frame, material)  # fmt: skip
    plane = d[[0, 2], :]
    f_before, f_here, f_after, e_hinge = hinge(nodes).map("hinges", "serial", nodes, [3], [])(
        shifted(plane, -1), plane, shifted(plane, 1), material)  # fmt: skip
    bent = shifted(f_before, 1) + f_here + shifted(f_after, -1)
    f = f + ca.vertcat(bent[0, :], ca.MX.zeros(1, nodes), bent[1, :])
    met = touch(nodes, each).map("touches", "serial", nodes, [4, 5, 6], [])(
        _four(x), _four(v), rows, z, contact, cell, dt)  # fmt: skip
    hub, hub_c = (ca.horzcat(-ca.sum2(g), -ca.sum2(_cross(d, g))) for g in (f, f_c))
    forces = ca.Function("ring", list(given.values()),
                         [f, f_c, _gathered(met[0], nodes), _gathered(met[1], nodes), met[2], hub, hub_c,
                          ca.sum2(met[3])],
                         ["x", "v", "z", "rows", "frame", "material", "contact", "dt"],
                         ["f", "f_c", "f_n", "f_t", "z_end", "hub", "hub_c", "sums"])  # fmt: skip
    stored: Any = [ca.sum2(e_held) + ca.sum2(e_hinge), ca.sum2(met[3])[3] + cell * contact[1] * ca.sumsqr(z) / 2]
    bare = ca.Function("ring_energies", list(given.values()), stored)
    at_rest: Any = [*list(given.values())[:-1], 0]
    return Ring(forces, ca.Function("energies", list(given.values())[:-1], bare.call(at_rest)))


def _four(columns: Any) -> Any:
    """Return for each node the columns of the nodes -1, 0, 1 and 2 from it, side by side."""
    n = columns.shape[1]
    return ca.reshape(ca.vertcat(*(shifted(columns, by) for by in (-1, 0, 1, 2))), 3, 4 * n)


def _gathered(columns: Any, nodes: int) -> Any:
    """Return the sums (3, nodes) of what the stretches do to the nodes -1, 0, 1 and 2 from their own."""
    rows = ca.reshape(columns, 12, nodes)
    return shifted(rows[:3, :], 1) + rows[3:6, :] + shifted(rows[6:9, :], -1) + shifted(rows[9:, :], -2)


def _cross(a: Any, b: Any) -> Any:
    """Return the cross products of the columns (3, n)."""
    return ca.vertcat(a[1, :] * b[2, :] - a[2, :] * b[1, :], a[2, :] * b[0, :] - a[0, :] * b[2, :],
                      a[0, :] * b[1, :] - a[1, :] * b[0, :])  # fmt: skip


def packed(s: Any, names: tuple[str, ...]) -> Any:
    """Return parameters as one column."""
    return ca.vertcat(*(getattr(s, name) for name in names))


def gravity(s: Any, time: Any) -> Any:
    """Return g (m/s2) at *time*: it rises from 0 along a raised cosine during the first ``gravity_time``."""
    part = ca.fmin(1, ca.fmax(0, time / ca.fmax(s.gravity_time, 1e-12)))
    return s.g * (1 - ca.cos(pi * part)) / 2


def rows_of(s: Any, k: int) -> Any:
    """Return the ground (13, points) under the points of wheel *k*: left wheels roll on the left track."""
    table = (s.ground_left if k % 2 == 0 else s.ground_right).T
    first = s.points * (k // 2)
    return table[:, first : first + s.points]


def drive_torque(s: Any, spin: Any, along: Any) -> Any:
    """Return the torques (4,) on the rims: those given, and those of a drive that is asked for traction.

    The drive gives R times the demand, at most what static friction would hold, and less where that turns the rim
    faster or slower than rolling: half of it at a slip of ``v_drive``.
    """
    limit = s.mu_s * s.pressing
    asked = ca.fmax(-limit, ca.fmin(limit, s.traction_demand))
    slip = s.R * spin - along
    away = ca.fmax(0, slip * ca.sign(asked)) / s.v_drive
    return s.torque + s.R * asked / (1 + away**2)


def micro_step(s: Any) -> dict[str, Any]:
    """Return all states a step ``s.dt`` later."""
    h, n = s.dt / 2, s.nodes
    material, contact, size = packed(s, MATERIAL), packed(s, CONTACT), packed(s, ("L_f", "L_r", "half_track", "h"))
    w = 2 * pi * s.frequency
    mass = share(material, n).mass

    # half a drift
    _, omega = turning()(s.q, s.H, s.spin, s.inertia, s.J_w)
    q, r, bend = turned()(s.q, omega, h), s.r + h * s.v, s.modal_q + h * s.modal_rate
    angle = s.angle + h * (s.spin - omega[1])
    x = [getattr(s, f"x_{k}").T + h * getattr(s, f"v_{k}").T for k in NAMES]

    # the forces in the middle
    R, omega = turning()(q, s.H, s.spin, s.inertia, s.J_w)
    frame, arms = frames()(R, omega, r, s.v, size, s.wheel_shape @ bend, s.wheel_shape @ s.modal_rate, s.spin, angle)
    of = [
        ring(n, s.points).forces(x[k], getattr(s, f"v_{NAMES[k]}").T, getattr(s, f"z_{NAMES[k]}").T, rows_of(s, k),
                                 frame[:, k], material, contact, s.dt) for k in WHEELS
    ]  # fmt: skip
    hub = [o[5] for o in of]
    along = ca.vertcat(*(ca.dot(R[:, 0], frame[12:15, k]) for k in WHEELS))
    torque = drive_torque(s, s.spin, along)
    g = gravity(s, s.time + h)
    down = ca.vertcat(0, 0, -g)

    # the kick
    v = s.v + s.dt * (R @ sum(o[:, 0] for o in hub) / s.m + s.force / s.m + down)
    moment = sum(_cross(arms[:, k], hub[k][:, 0]) + hub[k][:, 1] for k in WHEELS) + s.moment
    H = s.H + s.dt * R @ moment
    spin = s.spin + s.dt * (torque + ca.vertcat(*(o[1, 1] for o in hub))) / s.J_w
    lifted = s.wheel_shape.T @ ca.vertcat(*(o[2, 0] for o in hub))
    modal_rate = s.modal_rate + s.dt * (lifted - 2 * s.damping * w * s.modal_rate - w**2 * bend)
    pushes = [o[2] + o[3] for o in of]
    v_ring = [getattr(s, f"v_{NAMES[k]}").T + s.dt * ((R @ of[k][0] + pushes[k]) / mass + down) for k in WHEELS]

    # half a drift
    _, omega_end = turning()(q, H, spin, s.inertia, s.J_w)
    found = {
        "r": r + h * v, "q": turned()(q, omega_end, h), "v": v, "H": H, "spin": spin,
        "angle": angle + h * (spin - omega_end[1]), "modal_q": bend + h * modal_rate, "modal_rate": modal_rate,
    }  # fmt: skip
    for k, name in enumerate(NAMES):
        found |= {f"x_{name}": (x[k] + h * v_ring[k]).T, f"v_{name}": v_ring[k].T, f"z_{name}": of[k][4].T}
    return (
        found | _felt(s, of) | _accounts(s, R, arms, omega, omega_end, r, x, of, v, v_ring, spin, modal_rate, torque, g)
    )


def _felt(s: Any, of: list[Any]) -> dict[str, Any]:
    """Return what the wheels felt: the last forces, and impulses since the communication step began."""
    sums = ca.horzcat(*(o[7] for o in of))
    return {
        "pressing": sums[0, :].T,
        "normal_sum": s.normal_sum + s.dt * sums[0, :].T,
        "traction_sum": s.traction_sum + s.dt * sums[1, :].T,
        "lateral_sum": s.lateral_sum + s.dt * sums[2, :].T,
        "axle_sum": s.axle_sum + s.dt * ca.horzcat(*(o[5][:, 0] for o in of)).T,
        "elapsed": s.elapsed + s.dt,
        "push": ca.vertcat(*(_lengths(o[2]) for o in of)),
        "pull": ca.vertcat(*(_lengths(o[3]) for o in of)),
    }


def _lengths(columns: Any) -> Any:
    return ca.sqrt(ca.sum1(columns**2))


def _accounts(s: Any, R: Any, arms: Any, omega: Any, omega_end: Any, r: Any, x: list[Any], of: list[Any], v: Any,
              v_ring: list[Any], spin: Any, modal_rate: Any, torque: Any, g: Any) -> dict[str, Any]:  # fmt: skip
    """Return work and impulse since the start, force times mean velocity: exact in kinetic energy."""
    n, dt = s.nodes, s.dt
    mass, cell = share(packed(s, MATERIAL), n).mass, share(packed(s, MATERIAL), n).length * n / s.points
    turns, rate, lift_rate = (omega + omega_end) / 2, (s.v + v) / 2, s.wheel_shape @ (s.modal_rate + modal_rate) / 2
    damped, slid, fallen = -dt * 0, -dt * 0, -g * s.m * rate[2]
    push, twist = s.force - ca.vertcat(0, 0, g * s.m), ca.cross(r, s.force - ca.vertcat(0, 0, g * s.m)) + R @ s.moment
    for k, name in enumerate(NAMES):
        mean = (getattr(s, f"v_{name}").T + v_ring[k]) / 2
        hub = R.T @ rate + _cross(turns, arms[:, k]) + ca.vertcat(0, 0, lift_rate[k])
        rim = ca.vertcat(turns[0], (s.spin[k] + spin[k]) / 2, turns[2])
        damped -= ca.sum2(ca.sum1(of[k][1] * (R.T @ mean))) + ca.dot(of[k][6][:, 0], hub) + ca.dot(of[k][6][:, 1], rim)
        stored = cell * s.k_bristle * (ca.sumsqr(of[k][4]) - ca.sumsqr(getattr(s, f"z_{name}"))) / 2
        slid -= ca.sum2(ca.sum1(of[k][3] * mean)) + stored / dt
        fallen -= g * mass * ca.sum2(mean[2, :])
        total = of[k][2] + of[k][3] - ca.vertcat(ca.MX.zeros(2, n), ca.repmat(g * mass, 1, n))
        push, twist = push + ca.sum2(total), twist + ca.sum2(_cross(x[k], total))
    w = 2 * pi * s.frequency
    damped += ca.dot(2 * s.damping * w * s.modal_rate, (s.modal_rate + modal_rate) / 2)
    outside = ca.dot(s.force, rate) + ca.dot(s.moment, turns)
    driven = ca.dot(torque, (s.spin + spin) / 2 - turns[1])
    return {
        "damped": s.damped + dt * damped, "slid": s.slid + dt * slid, "fallen": s.fallen + dt * fallen,
        "worked": s.worked + dt * (driven + outside), "impulse": s.impulse + dt * push, "twist": s.twist + dt * twist,
    }  # fmt: skip
