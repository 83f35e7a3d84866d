"""The full-order robot in the middle of a micro step: where it is, and every force on it there."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import pi
from types import SimpleNamespace
from typing import Any

import casadi as ca

from .contact import COLUMNS, rotation_matrix
from .full_order_ports import NAMES, WHEELS, packed, path_rows, rows_of
from .full_order_steering import aligned, axles
from .rigid_body import contacts, place, wheel_arms
from .ring import CONTACT, MATERIAL, crossed
from .ring_wheel import ring

_LEAST = 1e-40  # keeps the axis of no rotation finite


@lru_cache(maxsize=1)
def rotation() -> ca.Function:
    """Return q -> R, body to world, for use in MX."""
    q = ca.SX.sym("q", 4)
    return ca.Function("rotation", [q], [rotation_matrix(q)])


@lru_cache(maxsize=1)
def turning() -> ca.Function:
    """Return (q, H, spin, steered, inertia, J) -> (R, omega): attitude and angular velocity in body axes."""
    q, H, spin, steered, inertia, J = (ca.SX.sym(n, k) for n, k in (
        ("q", 4), ("H", 3), ("spin", 4), ("steered", 4), ("inertia", 3), ("J", 1)))  # fmt: skip
    R = rotation_matrix(q)
    omega = (R.T @ H - J * axles(steered) @ spin) / inertia
    return ca.Function("turning", [q, H, spin, steered, inertia, J], ca.cse([R, omega]))


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
    """Return (R, omega, r, v, size, lift, lift_rate, spin, angle, steered, rate) -> (frames (FRAME, 4), arms (3, 4)).

    Of the wheels: *size* is L_f, L_r, half_track and h, *lift* (4,) how far the chassis has bent at the hubs, upwards,
    *rate* that of steering.
    """
    R, given = ca.SX.sym("R", 3, 3), {n: ca.SX.sym(n, k) for n, k in (
        ("omega", 3), ("r", 3), ("v", 3), ("size", 4), ("lift", 4), ("lift_rate", 4), ("spin", 4),
        ("angle", 4), ("steered", 4), ("rate", 4))}  # fmt: skip
    omega, r, v, size, lift, lift_rate, spin, angle, steered, rate = given.values()
    ahead, turns = aligned(steered, ca.repmat(ca.DM([1, 0, 0]), 1, 4)), aligned(-steered, ca.repmat(omega, 1, 4))
    columns, arms = [], []
    for k in WHEELS:
        arm = ca.vertcat(size[0] if k < 2 else -size[1], size[2] * (1 if k % 2 == 0 else -1), -size[3] + lift[k])
        velocity = v + R @ (ca.cross(omega, arm) + ca.vertcat(0, 0, lift_rate[k]))
        wheel = R @ ca.horzcat(ahead[:, k], axles(steered)[:, k], ca.DM([0, 0, 1]))
        turn = turns[:, k] + ca.vertcat(0, 0, rate[k])
        columns.append(ca.vertcat(ca.vec(wheel), r + R @ arm, velocity, turn, spin[k] - turn[1], angle[k]))
        arms.append(arm)
    return ca.Function("frames", [R, *given.values()], ca.cse([ca.horzcat(*columns), ca.horzcat(*arms)]))


@lru_cache(maxsize=1)
def headings() -> ca.Function:
    """Return (q, r, steered, size, R, rows (4, 16)) -> directions of traction and normals where round wheels touch."""
    q, r, steered, size = ca.SX.sym("q", 4), ca.SX.sym("r", 3), ca.SX.sym("steered", 4), ca.SX.sym("size", 4)
    R, rows = ca.SX.sym("R"), ca.SX.sym("rows", 4, COLUMNS)
    body = SimpleNamespace(q=q, r=r, R=R, left=rows, right=rows, steer=steered,
                           **dict(zip(("L_f", "L_r", "half_track", "h"), ca.vertsplit(size), strict=True)))  # fmt: skip
    body.arms = wheel_arms(body)
    where = place(body)
    at = contacts(body, where, where.feet())
    found: Any = [ca.horzcat(*(where.rotation @ getattr(c, name) for c in at)) for name in ("along", "normal")]
    return ca.Function("headings", [q, r, steered, size, R, rows], ca.cse(found))


def gravity(s: Any, time: Any) -> Any:
    """Return g (m/s2) at *time*: it rises from 0 along a raised cosine during the first ``gravity_time``."""
    part = ca.fmin(1, ca.fmax(0, time / ca.fmax(s.gravity_time, 1e-12)))
    return s.g * (1 - ca.cos(pi * part)) / 2


def drive_torque(s: Any, spin: Any, along: Any) -> Any:
    """Return the torques (4,) on the rims: those given, and of a drive that is asked for the rest of the traction.

    The drive gives R times the demand, at most what static friction would hold, and less where that turns the rim
    faster or slower than rolling: half of it at a slip of ``v_drive``.
    """
    limit = s.mu_s * s.pressing
    asked = ca.fmax(-limit, ca.fmin(limit, (1 - s.laid_on) * s.traction_demand))
    slip = s.R * spin - along
    away = ca.fmax(0, slip * ca.sign(asked)) / s.v_drive
    return s.torque + s.R * asked / (1 + away**2)


@dataclass(frozen=True)
class Load:
    """What is laid on the hubs from outside, at one instant."""

    force: Any  # (3, 4) N, world
    moment: Any  # (3,) N.m, of all, body axes, beside that of the forces at the hubs
    traction: Any  # (4,) N, the part of it that was asked for as traction


def load(s: Any, R: Any, along: Any, normal: Any) -> Load:
    """Return the external forces on the hubs, and the share of the traction that is laid on where wheels press.

    That acts along the ground in the point where a round wheel would touch, c_k - R n_k, as in the reduced model: the
    unlimited traction of an analysis, which no rubber would pass on.
    """
    asked = (s.pressing > 0) * s.laid_on * s.traction_demand
    laid = along * ca.repmat(asked.T, 3, 1)
    return Load(s.hub_force.T + laid, -s.R * R.T @ ca.sum2(crossed(normal, laid)), asked)


@dataclass(frozen=True)
class Middle:
    """The robot in the middle of a micro step, and what acts on it there."""

    R: Any  # body to world
    omega: Any
    r: Any
    q: Any
    bend: Any  # modal coordinates
    angle: Any
    steered: Any
    x: list[Any]  # nodes of each ring (3, n)
    wheels: list[Any]  # axes of each wheel, to world
    along: Any  # (3, 4) directions of traction, world
    arms: Any  # (3, 4) of the hubs, body axes
    of: list[Any]  # results of `Ring.forces`, wheel by wheel, in the axes of the wheels
    moments: Any  # (3, 4) of the rings on the hubs, axes of the wheels
    load: Load
    torque: Any
    g: Any

    @property
    def on_hub(self) -> Any:
        """Force (3, 4) on the body at each hub, body axes: of the ring, and from outside."""
        return aligned(self.steered, ca.horzcat(*(o[5][:, 0] for o in self.of))) + self.R.T @ self.load.force


def middle(s: Any) -> Middle:
    """Return the robot half a drift on, with all forces."""
    h, size = s.dt / 2, packed(s, ("L_f", "L_r", "half_track", "h"))
    _, omega = turning()(s.q, s.H, s.spin, s.steered, s.inertia, s.J_w)
    q, r, bend = turned()(s.q, omega, h), s.r + h * s.v, s.modal_q + h * s.modal_rate
    angle = s.angle + h * (s.spin - axles(s.steered).T @ omega)
    steered = s.steered + h * s.steer_rate
    x = [getattr(s, f"x_{k}").T + h * getattr(s, f"v_{k}").T for k in NAMES]
    R, omega = turning()(q, s.H, s.spin, steered, s.inertia, s.J_w)
    frame, arms = frames()(R, omega, r, s.v, size, s.wheel_shape @ bend, s.wheel_shape @ s.modal_rate, s.spin, angle,
                           steered, s.steer_rate)  # fmt: skip
    of = [
        ring(s.nodes, s.points).forces(
            x[k], getattr(s, f"v_{NAMES[k]}").T, getattr(s, f"z_{NAMES[k]}").T, rows_of(s, k), frame[:, k],
            packed(s, MATERIAL), packed(s, CONTACT), s.dt) for k in WHEELS
    ]  # fmt: skip
    speed = ca.sum1(frame[:3, :] * frame[12:15, :]).T
    along, normal = headings()(q, r, steered, size, s.R, path_rows(s))
    wheels, moments = [ca.reshape(frame[:9, k], 3, 3) for k in WHEELS], ca.horzcat(*(o[5][:, 1] for o in of))
    return Middle(R, omega, r, q, bend, angle, steered, x, wheels, along, arms, of, moments,
                  load(s, R, along, normal), drive_torque(s, s.spin, speed), gravity(s, s.time + h))  # fmt: skip
