"""Jerk traction: the force that makes the normal jerk vanish, and the torque for it (thesis 4.5 to 4.7, Fig 4.9).

    J = J_0 + J_1 F                                      of the definition chosen, see `planar_jerk`
    F* = min over F of J^2 + J_1min^2 (F - F_v)^2 = (J_1min^2 F_v - J_0 J_1) / (J_1^2 + J_1min^2)
    F_v = k_v (speed - v_x)

which is -J_0/J_1, but holds the speed where no force changes the jerk: on flat ground, and at the poles of -J_0/J_1.

Slope and curvature are known (read from the body), or estimated from axle forces: the closed scheme of Fig 4.9.  Either
way the rate of the curvature is told from successive samples: without it the jerk on a curved road is another one.
"""

from __future__ import annotations

from typing import Any

import casadi as ca

from cosim import Component, input, output, parameter, state, structural

from .planar_jerk import DEFINITIONS, Frame, jerk, motion, rolling
from .slope_estimator import body_slope, track

_SLOW = 0.05  # m/s, below which curvature is no longer told from the rate of the slope


class JerkTraction(Component):
    """Asks for the traction without normal jerk (along the body's z axis) if it is held, within motor and friction.

    The law sees the robot from the side: mean slope of each axle, both axles on the ground, the force shared equally by
    the wheels of an axle.  Wheels in the order front-left, front-right, rear-left, rear-right.  It asks for nothing
    while an axle carries no load.
    """

    definition = structural("body", "which jerk is to vanish", choices=DEFINITIONS)
    slope_source = structural(
        "known", "slope and curvature: read, or estimated from axle forces", choices=("known", "estimated")
    )
    limits = structural(
        "friction", "limits of the demand: mu F_n and the motor, or the motor only", choices=("friction", "motor")
    )
    traction_arm = structural("ground", "where traction acts, as the law knows it", choices=("ground", "centre"))

    period = parameter(1e-3, "s", "sample period")
    m = parameter(170.0, "kg", "mass, as the law knows it")
    I_y = parameter(47.0, "kg.m2", "pitch moment of inertia, as the law knows it")
    L_f = parameter(0.6, "m", "centre of mass to front axle, as the law knows it")
    L_r = parameter(0.46, "m", "centre of mass to rear axle, as the law knows it")
    h = parameter(0.4, "m", "centre of mass above the wheel centres, as the law knows it")
    R = parameter(0.1, "m", "wheel radius, as the law knows it")
    share = parameter(0.0, "1", "part of the force on the front axle: 0 rear, 0.5 four-wheel, 1 front drive")
    mu = parameter(0.8, "1", "friction coefficient the law counts on")
    torque_max = parameter(40.0, "N.m", "largest torque of a wheel's motor")
    rate_max = parameter(2e4, "N/s", "largest rate of the force of all wheels")
    J_1_min = parameter(1e-3, "m/(N.s3)", "jerk per force below which speed counts more (partial: 1/s read as 1/rad)")
    speed = parameter(1.0, "m/s", "speed to hold where the jerk leaves the force open")
    k_v = parameter(0.0, "N.s/m", "force per speed error there")
    bandwidth = parameter(100.0, "1/s", "of the filter that tracks the estimated slope")

    pitch = input("rad", "measured pitch angle, nose-up positive")
    velocity_body = input("m/s", "measured velocity of the centre of mass, body axes", shape=3)
    slope = input("rad", "slope of the ground under each wheel, absolute, climbing positive", shape=4)
    curvature = input("1/m", "curvature of each wheel-centre path, concave up positive", shape=4)
    normal_force = input("N", "measured normal force of each wheel", shape=4)
    traction = input("N", "measured traction of each wheel", shape=4)
    axle_force = input("N", "measured force of each wheel on the body, body axes", shape=(4, 3))

    demand = state([0.0] * 4, "N", "traction demand held between samples", nominal=100.0)
    on = state(0.0, "1", "1 while the law acts, else 0")
    free = state(0.0, "1", "1 while the force is what the law wants: no limit, no pole")
    ideal = state(0.0, "N", "the force without normal jerk, before limits", nominal=100.0)
    expected = state(0.0, "m/s3", "jerk expected under the demand if it is held")
    theta = state([0.0, 0.0], "rad", "slope of the ground at rear and front axle")
    theta_rate = state([0.0, 0.0], "rad/s", "its rate")
    theta_bend = state([0.0, 0.0], "rad/s2", "its second rate")
    bend = state([0.0, 0.0], "1/m", "curvature at rear and front axle")
    bend_rate = state([0.0, 0.0], "1/(m.s)", "its rate")
    begun = state(0.0, "1", "0 before the first sample, 1 after it")

    traction_demand = output("N", "traction asked of each wheel, forward positive", shape=4)
    torque = output("N.m", "motor torque asked of each wheel, forward positive", shape=4)
    active = output("1", "1 while the law acts, else 0")
    unlimited = output("1", "1 while the demand is the ideal force: within limits, away from poles")
    ideal_force = output("N", "traction of all wheels without normal jerk, before limits")
    jerk_expected = output("m/s3", "normal jerk expected under the demand if it is held (partial: m/(s2.rad))")
    axle_slope = output("rad", "slope of the ground that the law counts on, rear and front", shape=2)
    axle_curvature = output("1/m", "curvature that the law counts on, rear and front", shape=2)

    def outputs(s: Any) -> dict[str, Any]:
        return {
            "traction_demand": s.demand, "torque": s.R * s.demand, "active": s.on, "unlimited": s.free,
            "ideal_force": s.ideal, "jerk_expected": s.expected, "axle_slope": s.theta, "axle_curvature": s.bend,
        }  # fmt: skip

    def sync(s: Any) -> dict[str, Any]:
        ground = _known(s) if s.slope_source == "known" else _estimated(s)
        theta, bend, bend_rate = (_pair(ground[name]) for name in ("theta", "bend", "bend_rate"))
        J_0, J_1 = jerk(_robot(s), s.definition, s.pitch, theta, bend, bend_rate, s.velocity_body[0])
        able = ca.mmin(_axles(s.normal_force)) > 0
        weight, F_v = s.J_1_min**2, s.k_v * (s.speed - s.velocity_body[0])
        ideal = ca.if_else(able, (weight * F_v - J_0 * J_1) / (J_1**2 + weight), 0)
        limit = _limit(s)
        before, step = ca.sum1(s.demand), s.rate_max * s.period
        reached = ca.fmax(before - step, ca.fmin(before + step, ideal))
        force = ca.if_else(able, ca.fmax(-limit, ca.fmin(limit, reached)), 0)
        within = ca.logic_and(force == ideal, ca.fabs(J_1) > 3 * s.J_1_min)
        front, rear = s.share * force / 2, (1 - s.share) * force / 2
        return {
            **ground,
            "demand": ca.vertcat(front, front, rear, rear),
            "on": able,
            "free": ca.logic_and(able, within),
            "ideal": ideal,
            "expected": ca.if_else(able, J_0 + J_1 * force, 0),
            "begun": 1,
        }  # fmt: skip


def _robot(s: Any) -> Frame:
    arm = 1.0 if s.traction_arm == "ground" else 0.0
    return Frame(s.m, s.I_y, s.L_f, s.L_r, s.h, s.R, share=s.share, arm=arm)


def _axles(v: Any) -> Any:
    """Return the means of rear and front axle (2,) of values at the wheels (4,)."""
    return ca.vertcat((v[2] + v[3]) / 2, (v[0] + v[1]) / 2)


def _pair(v: Any) -> list[Any]:
    return [v[0], v[1]]


def _limit(s: Any) -> Any:
    """Return the largest force of all wheels, N: what the first axle to reach its limit allows."""
    room = ca.SX.ones(2) * s.torque_max / s.R
    if s.limits == "friction":
        # Means of an axle: on four rigid wheels the split between left and right is open, and a limit that followed it
        # would feed it.
        room = ca.fmin(room, s.mu * ca.fmax(_axles(s.normal_force), 0))
    shares = ca.vertcat(1 - s.share, s.share)
    return ca.mmin(2 * room / ca.fmax(shares, 1e-9))


def _known(s: Any) -> dict[str, Any]:
    """Slope and curvature as read; the rate of the curvature from two samples."""
    bend = _axles(s.curvature)
    rate = ca.if_else(s.begun > 0.5, (bend - s.bend) / s.period, 0)
    return {"theta": _axles(s.slope), "bend": bend, "bend_rate": rate}


def _estimated(s: Any) -> dict[str, Any]:
    """Slope of each axle from its force and traction; curvature and its rate from the tracked slope and the speed."""
    force_x, force_z, F_t = (_axles(v) for v in (s.axle_force[:, 0], s.axle_force[:, 2], s.traction))
    gamma = ca.vertcat(*(body_slope(force_x[k], force_z[k], F_t[k]) for k in range(2)))
    carries = _axles(s.normal_force) > 0
    measured = ca.if_else(carries, gamma + s.pitch, s.theta)
    value, rate, bending = track(s.theta, s.theta_rate, s.theta_bend, measured, s.period, s.bandwidth)
    begun, v_x, none = s.begun > 0.5, s.velocity_body[0], ca.SX.zeros(2)
    theta, rate = ca.if_else(begun, value, measured), ca.if_else(begun, rate, none)
    bending = ca.if_else(begun, bending, none)
    robot = _robot(s)
    along = ca.vertcat(*rolling(robot, s.pitch, _pair(theta), v_x)[2])
    speed = ca.if_else(along < 0, -1, 1) * ca.fmax(ca.fabs(along), _SLOW)
    bend = rate / speed
    now = motion(robot, s.pitch, _pair(theta), _pair(bend), v_x, ca.sum1(s.traction))
    speed_rate = (now.a_x - now.omega * now.v_z) * speed / ca.fmax(ca.fabs(v_x), _SLOW)
    return {
        "theta": theta, "theta_rate": rate, "theta_bend": bending,
        "bend": bend, "bend_rate": (bending - bend * speed_rate) / speed,
    }  # fmt: skip
