"""Following a planned pitch by rear-wheel traction: feed-forward and feedback on pitch (thesis chapter 5).

With the planned force F_r(t) from the inverse dynamics (5.17) and its gain Phi(t), the pitch acceleration per traction,

    F = F_r + Phi / (Phi^2 + Phi_0^2) (h1 (p_r' - p') + h0 (p_r - p))         (error dynamics e'' + h1 e' + h0 e = 0)

Where the slope vanishes, at both ends, traction does not turn the body: the feedback fades out there by Phi_0.
"""

from __future__ import annotations

from typing import Any

import casadi as ca

from cosim import Component, input, output, parameter, state, table

from .pitch_plan import planned_pitch


class PitchTrajectory(Component):
    """Traction of the rear wheels, equal left and right, that pitches the robot along the degree-7 plan.

    Sampled: inputs are read at the ticks of ``period`` and the outputs held in between.  It asks for nothing before
    ``t_start`` and after ``t_start + T``.  Pitch is nose-up and counts from what it is when the manoeuvre begins: soft
    wheels sag unevenly.  The plan is made by `controllers.pitch_plan`.
    """

    period = parameter(1e-3, "s", "sample period")
    beta = parameter(0.0, "rad", "pitch at the end of the manoeuvre, from 0 at its start")
    T = parameter(1.0, "s", "duration of the manoeuvre")
    t_start = parameter(0.0, "s", "when it starts")
    h0 = parameter(0.0, "1/s2", "feedback gain on the pitch error; 0: open loop")
    h1 = parameter(0.0, "1/s", "feedback gain on the error of the pitch rate; 0: open loop")
    Phi_0 = parameter(1e-4, "1/(kg.m)", "gain Phi below which the feedback fades out")
    F_max = parameter(1e4, "N", "largest traction of a wheel's motor")
    plan = table(5, "normalised time | F_r in N and its slope | Phi in 1/(kg.m) and its slope")

    pitch = input("rad", "measured pitch, nose-up")
    rate = input("rad/s", "measured angular velocity, body axes; its y component is nose-down", shape=3)

    demand = state([0.0] * 4, "N", "traction demand held between samples", nominal=100.0)
    on = state(0.0, "1", "1 during the manoeuvre, else 0")
    p_r = state(0.0, "rad", "planned pitch held between samples", nominal=0.1)
    level = state(0.0, "rad", "measured pitch when the manoeuvre began", nominal=1e-3)
    lag = state(0.0, "rad", "pitch error held between samples", nominal=1e-3)

    traction_demand = output("N", "traction asked of each wheel, forward positive", shape=4)
    active = output("1", "1 during the manoeuvre, else 0")
    planned = output("rad", "planned pitch, nose-up")
    pitch_error = output("rad", "planned minus measured pitch, both from the start of the manoeuvre")

    def lookups(s: Any) -> dict[str, Any]:
        return {"plan": _normalised(s, s.time + s.period / 2)}

    def sync(s: Any) -> dict[str, Any]:
        t = _normalised(s, s.time)
        middle = _normalised(s, s.time + s.period / 2)  # of the period over which the force is held: its mean
        on = ca.logic_and(s.time >= s.t_start, s.time <= s.t_start + s.T)
        wanted = planned_pitch(t, s.beta, s.T)
        start, force, force_slope, gain, gain_slope = ca.horzsplit(s.plan)
        Phi = gain + gain_slope * (middle - start)
        level = ca.if_else(ca.logic_and(on, s.on < 0.5), s.pitch, s.level)
        lag = wanted.p - (s.pitch - level)
        feedback = s.h1 * (wanted.rate + s.rate[1]) + s.h0 * lag
        F = force + force_slope * (middle - start) + Phi / (Phi**2 + s.Phi_0**2) * feedback
        wheel = ca.fmax(-s.F_max, ca.fmin(s.F_max, F / 2))
        return {
            "demand": ca.if_else(on, ca.vertcat(0, 0, wheel, wheel), ca.SX.zeros(4)),
            "on": on, "p_r": wanted.p, "level": level, "lag": lag,
        }  # fmt: skip

    def outputs(s: Any) -> dict[str, Any]:
        return {"traction_demand": s.demand, "active": s.on, "planned": s.p_r, "pitch_error": s.lag}


def _normalised(s: Any, time: Any) -> Any:
    """Return a *time* in units of the manoeuvre, 0 before and 1 after it."""
    return ca.fmax(0, ca.fmin(1, (time - s.t_start) / s.T))


def gains(bandwidth: float) -> tuple[float, float]:
    """Return h0 (1/s2) and h1 (1/s) that put both poles of the error dynamics at -*bandwidth* rad/s."""
    return bandwidth**2, 2 * bandwidth
