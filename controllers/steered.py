"""A steered drive: four steering angles for a curvature of the path, and traction that holds the speed (thesis 4.2).

    kappa(t) = kappa_0 min(t / t_ramp, 1) cos(2 pi f t)
    delta_k  = atan((x_k - x_c) kappa / (1 - y_k kappa)) + toe_k   the axles of all wheels meet in the turn's centre
    F_a      = clip(K_v (v_d - v_x) / 4, +-F_max),   T = R F_a

The turn's centre lies at (x_c, 1 / kappa) in body axes: x_c = 0 steers front and rear alike, x_c = -L_r only the front.
"""

from __future__ import annotations

from math import pi
from typing import Any

import casadi as ca

from cosim import Component, input, output, parameter, state


class Steered(Component):
    """Steers each wheel by its own angle along a path of given curvature and holds the speed, sampled.

    Wheels in the order front-left, front-right, rear-left, rear-right; a positive curvature and steering angle turns to
    the left.  Asks wheels for ``traction_demand``, or drives for the ``torque`` that gives it without slip.
    """

    period = parameter(1e-3, "s", "sample period")
    curvature = parameter(0.0, "1/m", "kappa_0, curvature of the path of the centre of mass")
    frequency = parameter(0.0, "Hz", "f, at which the curvature swings; 0 holds it")
    ramp = parameter(0.5, "s", "t_ramp, in which the steering grows to its full size")
    toe = parameter([0.0] * 4, "rad", "steering angle of each wheel beside that of the turn")
    centre = parameter(0.0, "m", "x_c, the turn's centre ahead of the centre of mass")
    L_f = parameter(0.6, "m", "centre of mass to front axle")
    L_r = parameter(0.46, "m", "centre of mass to rear axle")
    half_track = parameter(0.29, "m", "centre plane to a wheel")
    R = parameter(0.1, "m", "wheel radius")
    speed = parameter(1.0, "m/s", "v_d, forward speed to hold")
    K_v = parameter(500.0, "N.s/m", "traction of all wheels per error of the speed")
    F_max = parameter(200.0, "N", "largest traction asked of a wheel")

    velocity_body = input("m/s", "velocity of the centre of mass, body axes", shape=3)

    angles = state([0.0] * 4, "rad", "steering angles held between samples", nominal=0.1)
    demand = state(0.0, "N", "traction of each wheel held between samples", nominal=100.0)

    steer = output("rad", "steering angle of each wheel, to the left positive", shape=4)
    traction_demand = output("N", "traction asked of each wheel, forward positive", shape=4)
    torque = output("N.m", "motor torque of each wheel, forward positive", shape=4)

    def sync(s: Any) -> dict[str, Any]:
        grown = ca.fmin(s.time / s.ramp, 1)
        kappa = s.curvature * grown * ca.cos(2 * pi * s.frequency * s.time)
        x = ca.vertcat(s.L_f, s.L_f, -s.L_r, -s.L_r)
        y = s.half_track * ca.vertcat(1, -1, 1, -1)
        asked = s.K_v * (s.speed - s.velocity_body[0]) / 4
        return {
            "angles": ca.atan((x - s.centre) * kappa / (1 - y * kappa)) + grown * s.toe,
            "demand": ca.fmax(-s.F_max, ca.fmin(s.F_max, asked)),
        }

    def outputs(s: Any) -> dict[str, Any]:
        each = s.demand * ca.SX.ones(4)
        return {"steer": s.angles, "traction_demand": each, "torque": s.R * each}
