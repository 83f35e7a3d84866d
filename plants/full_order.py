"""The robot of full order: rims, rubber rings of many nodes, a body and its elastic modes, on the ground itself.

It stands where the thesis used LS-DYNA (6.7, table 6.2): wheels with distributed mass and stiffness that roll, stick
and slide, a chassis that bends, gravity that rises before the collision.  The equations are in `ring`, `ring_contact`
and `full_order_step`; between communication points the harness takes micro steps no longer than ``micro_step``.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import casadi as ca
import numpy as np

from cosim import DeclarationError, parameter, state, structural, table

from .contact import COLUMNS as PATH_COLUMNS
from .full_order_accounts import energies, momenta
from .full_order_middle import frames, rotation, turning
from .full_order_outputs import chassis_seen, measured, rings_seen
from .full_order_ports import NAMES, FullOrderPorts, packed, seen
from .full_order_steering import rate
from .full_order_step import micro_step
from .rigid_body import LEVEL, wheel_arms, wheel_centres
from .ring import MATERIAL, UNLIMITED, share, shifted
from .ring_contact import COLUMNS, keys

_LEVEL = [[-1e9, *3 * (0, 0, 0, 0)]]
_SAFETY = 0.5  # of the longest stable micro step


class FullOrderRover(FullOrderPorts):
    """Body, four rims with rubber rings, and chassis modes.

    World: x along the road, z up.  Wheels front-left, front-right, rear-left, rear-right; the left ones roll on the
    left track.  ``m`` and ``inertia`` are those of the body with the rims, but without the rings and without the
    inertia of the rims about their axles.  Forces are means over the communication step unless said otherwise.

    Raises DeclarationError for points that are no multiple of the nodes, and for a micro step that is not stable.
    """

    symbols = ca.MX  # functions of one node are mapped over all of them: loops in C

    nodes = structural(32, "nodes of each ring")
    points = structural(128, "points of each ring that meet the ground, a multiple of the nodes")
    modes = structural(1, "number of elastic modes of the chassis")
    stations = structural(0, "stations on the chassis whose acceleration is an output")
    seen = structural(0, "nodes of each ring whose places and forces are outputs: none or all of them")

    m = parameter(170.0, "kg", "mass of the body, rims included")
    inertia = parameter([20.0, 47.0, 55.0], "kg.m2", "principal moments of inertia: roll, pitch, yaw")
    L_f = parameter(0.6, "m", "centre of mass to front axle")
    L_r = parameter(0.46, "m", "centre of mass to rear axle")
    half_track = parameter(0.29, "m", "centre plane to a wheel")
    h = parameter(0.4, "m", "centre of mass above the wheel centres")
    R = parameter(0.1, "m", "radius of the rings")
    g = parameter(9.81, "m/s2", "gravity, along -z of the world")
    gravity_time = parameter(0.0, "s", "how long gravity takes to rise from 0 at t = 0; 0: it is there")
    J_w = parameter(0.01, "kg.m2", "moment of inertia of a rim about its axle, motor included")
    ring_mass = parameter(0.83, "kg", "mass of a ring")
    k_radial = parameter(2e6, "N/m2", "radial stiffness between rim and ring, per length of ring")
    k_tangential = parameter(7e5, "N/m2", "tangential and lateral stiffness, per length of ring")
    c_radial = parameter(200.0, "N.s/m2", "radial damping, per length of ring")
    c_tangential = parameter(70.0, "N.s/m2", "tangential and lateral damping, per length of ring")
    EA = parameter(6e3, "N", "stiffness of a ring against stretching")
    EI = parameter(0.11, "N.m2", "stiffness of a ring against bending")
    k_contact = parameter(2e7, "N/m2", "stiffness of the contact, per length of ring")
    k_bristle = parameter(1e7, "N/m2", "tangential stiffness of a contact that sticks, per length of ring")
    mu_s = parameter(0.8, "1", "coefficient of static friction")
    mu_d = parameter(0.3, "1", "coefficient of dynamic friction")
    v_slip = parameter(0.2, "m/s", "speed of sliding at which the difference of the two has fallen to 1/e")
    laid_on = parameter(0.0, "1", "share of the traction asked for that is laid on at the ground, without limit")
    v_min = parameter(0.1, "m/s", "speed below which slip is measured against a part of it, so that rest has one")
    steer_speed = parameter(10.0, "rad/s", "rate at which a wheel is steered, at most")
    v_drive = parameter(0.5, "m/s", "slip at which a drive that is asked for traction gives half of it")
    frequency = parameter(25.0, "Hz", "undamped natural frequencies", shape="modes")
    damping = parameter(5e-5, "1", "damping ratios", shape="modes")
    wheel_shape = parameter(0.0, "1", "vertical mode shapes at the hubs, mass-normalised (kg^-1/2)", shape=(4, "modes"))
    station_shape = parameter(0.0, "1", "the same at the stations", shape=("stations", "modes"))
    micro_step = parameter(1e-5, "s", "longest step inside a communication step")
    ground_left = table(COLUMNS, "ground of the left track", start=_LEVEL)
    ground_right = table(COLUMNS, "ground of the right track", start=_LEVEL)
    left = table(PATH_COLUMNS, "path of a round wheel's centre on the left track", start=LEVEL)
    right = table(PATH_COLUMNS, "path of a round wheel's centre on the right track", start=LEVEL)

    r = state([0.0, 0.0, 0.5], "m", "position of the body's centre of mass, world")
    q = state([1.0, 0.0, 0.0, 0.0], "1", "attitude quaternion (w, x, y, z), body to world")
    v = state([0.0, 0.0, 0.0], "m/s", "its velocity, world")
    H = state([0.0, 0.0, 0.0], "N.m.s", "angular momentum of body and rims about it, world")
    spin = state([0.0] * 4, "rad/s", "spin of each rim about its axle, in the world")
    angle = state([0.0] * 4, "rad", "how far each rim has turned in the body")
    steered = state([0.0] * 4, "rad", "steering angle of each wheel")
    steer_rate = state([0.0] * 4, "rad/s", "rate of steering in this step")
    modal_q = state(0.0, "m", "modal coordinates (m kg^1/2)", shape="modes", nominal=1e-3)
    modal_rate = state(0.0, "m/s", "their time derivatives (m kg^1/2 / s)", shape="modes", nominal=1e-2)
    x_fl = state(0.0, "m", "nodes of the front left ring, world", shape=("nodes", 3))
    x_fr = state(0.0, "m", "nodes of the front right ring, world", shape=("nodes", 3))
    x_rl = state(0.0, "m", "nodes of the rear left ring, world", shape=("nodes", 3))
    x_rr = state(0.0, "m", "nodes of the rear right ring, world", shape=("nodes", 3))
    v_fl = state(0.0, "m/s", "their velocities", shape=("nodes", 3))
    v_fr = state(0.0, "m/s", "their velocities", shape=("nodes", 3))
    v_rl = state(0.0, "m/s", "their velocities", shape=("nodes", 3))
    v_rr = state(0.0, "m/s", "their velocities", shape=("nodes", 3))
    z_fl = state(0.0, "m", "bristles of the front left ring, along and to the left", shape=("points", 2))
    z_fr = state(0.0, "m", "bristles of the front right ring", shape=("points", 2))
    z_rl = state(0.0, "m", "bristles of the rear left ring", shape=("points", 2))
    z_rr = state(0.0, "m", "bristles of the rear right ring", shape=("points", 2))
    pressing = state([0.0] * 4, "N", "normal force of each wheel in the last micro step", nominal=100.0)
    normal_sum = state([0.0] * 4, "N.s", "normal impulse since the step began", nominal=0.1)
    traction_sum = state([0.0] * 4, "N.s", "impulse of friction along the ground since the step began", nominal=0.1)
    lateral_sum = state([0.0] * 4, "N.s", "lateral impulse since the step began", nominal=0.1)
    sliding_sum = state([0.0] * 4, "N.s", "normal impulse of what slid since the step began", nominal=0.1)
    axle_sum = state([[0.0] * 3] * 4, "N.s", "impulse of each wheel on the body since then, body axes", nominal=0.1)
    elapsed = state(0.0, "s", "time since the step began")
    v_begun = state([0.0] * 3, "m/s", "velocity when the step began")
    rate_begun = state([0.0] * 3, "rad/s", "angular velocity then, body axes")
    modal_begun = state(0.0, "m/s", "modal rates then (m kg^1/2 / s)", shape="modes")
    push = state(0.0, "N", "normal force of the ground on each node", shape=(4, "nodes"))
    pull = state(0.0, "N", "friction on each node", shape=(4, "nodes"))
    damped = state(0.0, "J", "energy lost in dampers since the start")
    slid = state(0.0, "J", "energy lost in friction since the start")
    fallen = state(0.0, "J", "work of gravity since the start")
    worked = state(0.0, "J", "work of motors and external forces since the start")
    impulse = state([0.0] * 3, "N.s", "impulse of all external forces since the start, world")
    twist = state([0.0] * 3, "N.m.s", "angular impulse of all external forces about the world's origin")

    def __init__(self, **values: Any) -> None:
        super().__init__(**values)
        nodes, points = self.structure["nodes"], self.structure["points"]
        if not isinstance(nodes, int) or not isinstance(points, int) or nodes < 8 or points < nodes or points % nodes:
            raise DeclarationError(
                f"FullOrderRover has {nodes} nodes and {points} points on each ring; give at least 8 nodes, and a "
                "multiple of the nodes as points"
            )
        if self.structure["seen"] not in (0, nodes):
            raise DeclarationError(
                f"FullOrderRover.seen is {self.structure['seen']}, but of {nodes} nodes none or all are outputs; give "
                f"0 or {nodes}"
            )
        limit = stable_step(self)
        if self.micro_step > limit:
            raise DeclarationError(
                f"FullOrderRover.micro_step is {self.micro_step:g} s, but these springs and masses are stable up to "
                f"{limit:.3g} s only; take a shorter one"
            )

    def constants(s: Any) -> dict[str, Any]:
        return {"arms": wheel_arms(s)}

    def lookups(s: Any) -> dict[str, Any]:
        found = []
        for name in NAMES:
            x = (getattr(s, f"x_{name}").T + s.dt / 2 * getattr(s, f"v_{name}").T)[0, :]
            four = ca.vertcat(*(shifted(x, by) for by in (-1, 0, 1, 2)))
            found.append(ca.vec(keys(s.nodes, s.points // s.nodes).map(s.nodes)(four)))
        hubs = wheel_centres(s, rotation()(s.q))[:, 0]
        return {"ground_left": ca.vertcat(found[0], found[2]), "ground_right": ca.vertcat(found[1], found[3]),
                "left": hubs[[0, 2]], "right": hubs[[1, 3]]}  # fmt: skip

    def sync(s: Any) -> dict[str, Any]:
        none = ca.MX.zeros(4)
        _, omega = turning()(s.q, s.H, s.spin, s.steered, s.inertia, s.J_w)
        return {"q": s.q / ca.norm_2(s.q), "normal_sum": none, "traction_sum": none, "lateral_sum": none,
                "sliding_sum": none, "steer_rate": rate(s),
                "axle_sum": ca.MX.zeros(4, 3), "elapsed": 0, "v_begun": s.v, "rate_begun": omega,
                "modal_begun": s.modal_rate}  # fmt: skip

    def flow(s: Any) -> dict[str, Any]:
        return micro_step(s)

    def outputs(s: Any) -> dict[str, Any]:
        began = s.elapsed > 0
        span = ca.if_else(began, s.elapsed, 1)
        R, omega = turning()(s.q, s.H, s.spin, s.steered, s.inertia, s.J_w)
        lift, lift_rate = s.wheel_shape @ s.modal_q, s.wheel_shape @ s.modal_rate
        size = packed(s, ("L_f", "L_r", "half_track", "h"))
        frame, _ = frames()(R, omega, s.r, s.v, size, lift, lift_rate, s.spin, s.angle, s.steered, s.steer_rate)
        normal, axle = ca.if_else(began, s.normal_sum / span, s.pressing), s.axle_sum / span
        found = seen(s, omega, lift, lift_rate, s.lateral_sum / span)
        return {
            "position": s.r, "orientation": s.q, "velocity": s.v, "velocity_body": R.T @ s.v, "rate": omega,
            "pitch": ca.asin(ca.fmax(-1, ca.fmin(1, R[2, 0]))),
            "acceleration": R.T @ ca.if_else(began, (s.v - s.v_begun) / span, 0),
            "angular_acceleration": ca.if_else(began, (omega - s.rate_begun) / span, 0),
            "wheel_spin": frame[18, :].T, "steer_angle": s.steered, **measured(s, found["contact_velocity"]),
            "normal_force": normal, "normal_force_end": s.pressing,
            "sliding": s.sliding_sum / ca.fmax(s.normal_sum, 1e-9),
            "friction_limit": ca.if_else(s.laid_on >= 1, UNLIMITED, s.mu_s) * normal,
            "traction": s.traction_sum / span, "lateral": s.lateral_sum / span,
            "axle_force": axle, "wheel_force": axle[:, 2],
            "contact": s.pressing > 0, "wheel_centre": frame[9:12, :].T, "stable_step": _stable(s),
            **found, "deformation": found["gap"], "deformation_rate": found["gap_rate"],
            **energies(s, omega, frame), **momenta(s), **chassis_seen(s, ca.if_else(began, 1 / span, 0)),
            **rings_seen(s, frame),
        }  # fmt: skip


def _stable(s: Any) -> Any:
    """Return the longest stable micro step (s): half of that of the fastest oscillator, bounded by a node's row sums.

    A damper acts on the velocity before the kick: the step h of w^2 and g = c / m is stable while w^2 h^2 + 2 g h < 4.
    """
    of = share(packed(s, MATERIAL), s.nodes)
    at_ground = of.length * ca.fmax(s.k_contact, s.k_bristle) * 1.5  # 1.5: weights of either sign
    stiffness = ca.fmax(of.k[0], of.k[1]) + at_ground + 4 * of.stretch + 16 * of.bend / of.length**2
    arm = s.nodes * s.R**2 / s.J_w
    squares = ca.vertcat(stiffness / of.mass, of.k[1] * arm, (2 * np.pi * ca.mmax(s.frequency)) ** 2)
    rates = ca.vertcat(ca.fmax(of.c[0], of.c[1]) / of.mass, of.c[1] * arm, 0)
    return _SAFETY * ca.mmin((ca.sqrt(rates**2 + 4 * squares) - rates) / squares)


def stable_step(rover: FullOrderRover) -> float:
    """Return the longest micro step (s) that is stable for the parameters of *rover*, with a margin of two."""
    s = SimpleNamespace(**{n: ca.DM(v) for n, v in rover.values.items()}, nodes=rover.nodes)
    return float(_stable(s))
