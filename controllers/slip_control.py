"""Slip control: the torque with which each wheel reaches a demanded traction (thesis 3.3).

At every sample, for each wheel with the demand F_d (its sign put aside):

    F   = min(F_d, mu_peak F_n)                                    what the curve can give
    l_R = min(slip(F / F_n) + trim, slip of the peak)              inverse friction curve (3.3), never beyond the peak
    e   = (l_R - lambda) v_s / R                                   slip error as a spin error; v_s: see `slip_speed`
    T   = T_F + K (e + sum e dt / T_i)                             PI, within +-T_max
    T_F = min(R F + J_w a / R, R mu_peak F_n)                      3.5 and 3.4, a = sum F / m: what friction can hold
    trim grows by k_F (F - F_a) / (C_x F_n) dt                     what the curve that is believed in has wrong

The spin error and not the slip error is fed back, since it is what torque changes at a rate that neither speed nor load
matters to.  A wheel at its torque limit integrates nothing, one without load is held at the slip of the peak and does
not race.
"""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from cosim import Component, input, output, parameter, state, table

from .slip_model import inverse_curve

_LEAST = 1.0  # N, normal force below which a wheel counts as unloaded


class SlipControl(Component):
    """Torque of each wheel for a demanded traction, by its slip, sampled.

    Wheels in the order front-left, front-right, rear-left, rear-right; positive drives forwards.  The demand is the
    parameter ``demand`` plus what an outer law asks for at the input ``outer_demand``.
    """

    period = parameter(1e-3, "s", "sample period")
    demand = parameter([0.0] * 4, "N", "traction asked of each wheel")
    R = parameter(0.1, "m", "wheel radius")
    J_w = parameter(0.01, "kg.m2", "moment of inertia of a wheel about its axle, motor included")
    m = parameter(170.0, "kg", "mass that the four wheels drive")
    C_x = parameter(8.0, "1", "slope of the friction curve at zero slip, as the law knows it")
    mu_peak = parameter(0.8, "1", "largest friction coefficient, as the law knows it")
    slip_peak = parameter(0.2, "1", "slip ratio there")
    K = parameter(3.0, "N.m.s/rad", "torque per spin error")
    T_i = parameter(0.02, "s", "integral time of the spin error")
    k_F = parameter(10.0, "1/s", "rate at which a wrong traction trims the slip that is asked for")
    T_max = parameter(50.0, "N.m", "largest torque of a wheel's motor")
    curve = table(3, "slip ratio by friction coefficient: mu, slip, d slip / d mu; up to the peak",
                  start=inverse_curve(np.array([0.0, 0.2]), np.array([0.0, 0.8])))  # fmt: skip

    outer_demand = input("N", "traction an outer law asks of each wheel, added to the parameter", shape=4)
    slip = input("1", "measured slip ratio of each wheel", shape=4)
    slip_speed = input("m/s", "speed that the slip ratio is measured against", shape=4)
    normal_force = input("N", "measured normal force of each wheel", shape=4)
    traction = input("N", "measured traction of each wheel", shape=4)

    held = state([0.0] * 4, "N.m", "torque held between samples")
    sum = state([0.0] * 4, "rad", "integral of the spin error", nominal=1e-2)
    trim = state([0.0] * 4, "1", "slip added to that of the curve", nominal=1e-2)
    possible = state([0.0] * 4, "N", "demand within the friction of the peak", nominal=100.0)
    wanted = state([0.0] * 4, "1", "slip ratio asked for", nominal=1e-2)

    torque = output("N.m", "motor torque of each wheel", shape=4)
    traction_demand = output("N", "traction asked of each wheel, cut at the peak of the curve", shape=4)
    slip_reference = output("1", "slip ratio asked of each wheel", shape=4)

    def lookups(s: Any) -> dict[str, Any]:
        return {"curve": _coefficient(s)}

    def sync(s: Any) -> dict[str, Any]:
        mu = _coefficient(s)
        sign = ca.sign(s.demand + s.outer_demand)
        at = s.curve[:, 1] + s.curve[:, 2] * (mu - s.curve[:, 0])  # slip of the curve
        possible = mu * ca.fmax(0, s.normal_force)
        missing = (possible - sign * s.traction) / (s.C_x * ca.fmax(_LEAST, s.normal_force))
        loaded = s.normal_force > _LEAST
        trim = ca.if_else(loaded, s.trim + s.period * s.k_F * missing, s.trim)
        size = ca.fmax(0, ca.fmin(s.slip_peak, at + trim))
        e = (sign * size - s.slip) * s.slip_speed / s.R
        total = s.sum + s.period * e
        full = _forward(s, sign * possible) + s.K * (e + total / s.T_i)
        torque = ca.fmax(-s.T_max, ca.fmin(s.T_max, full))
        free = ca.logic_or(torque == full, (full - torque) * e < 0)  # or on its way back from the limit
        return {
            "held": torque,
            "sum": ca.if_else(free, total, s.sum),
            "trim": ca.if_else(free, ca.fabs(sign) * (size - at), s.trim),
            "possible": sign * possible,
            "wanted": sign * size,
        }

    def outputs(s: Any) -> dict[str, Any]:
        return {"torque": s.held, "traction_demand": s.possible, "slip_reference": s.wanted}


def _forward(s: Any, traction: Any) -> Any:
    """Return the torque (4,) that holds the slip of wheels with this *traction* while the robot gains speed."""
    torque = s.R * traction + s.J_w * ca.sum1(traction) / (s.m * s.R)
    most = s.R * s.mu_peak * ca.fmax(0, s.normal_force)
    return ca.fmax(-most, ca.fmin(most, torque))


def _coefficient(s: Any) -> Any:
    """Return the friction coefficient (4,) that the demand needs, at most that of the peak."""
    return ca.fmin(s.mu_peak, ca.fabs(s.demand + s.outer_demand) / ca.fmax(_LEAST, s.normal_force))
