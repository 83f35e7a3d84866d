"""The gains of the impact law (thesis Figs 6.5 and 6.6, wheel impact paper Figs 4 and 5)."""

from __future__ import annotations

from functools import cache

import control
import numpy as np
from scipy.optimize import brentq

from controllers.pd_impact import settling_time

from .claim import Claim, graded
from .impact_case import APPROACH, BAND, H0, H1, TARGET, stepped, times
from .sheet import LINES, Sheet, panels

D, RATE = float(TARGET[1]), float(APPROACH[1])  # of the front axle
H1_SHOWN, H0_SHOWN = (20.0, 40.0, 65.0, 77.46, 100.0, 150.0), (300.0, 700.0, 1225.0, 1550.0, 3000.0, 10_000.0)
H1_ABOVE = (65.0, 70.0, 80.0, 100.0, 150.0, 200.0)  # from the printed critical gains on, where nothing swings
H0_BELOW = (100.0, 300.0, 700.0, 1000.0, 1225.0, 1550.0)
INTEGRAL = (0.0, 5000.0, 20_000.0, 50_000.0)  # 1/s3; from 105000 = h0 h1 on it is unstable
CRITICAL_H1, CRITICAL_H0 = 65.0, 1550.0  # as printed, the latter in the paper alone
NO_P = "any P, U and k_w, with the signs right or as printed: the law cancels them"


def settled(h0: float, h1: float) -> float:
    """Return when the front axle stays within 2 % of its target, s."""
    return settling_time(h0, h1, -D, RATE, BAND * abs(D))


def overshoot(h0: float, h1: float) -> float:
    """Return how far the front axle passes its target, in parts of it."""
    return float(max(0.0, np.max(stepped(h0, h1, D, RATE, times(1.0)).z / D - 1)))


def swing_back(h0: float, h1: float) -> float:
    """Return the highest deformation after the deepest, m: above 0 the front axle has left the ground."""
    z = stepped(h0, h1, D, RATE, times(1.0, 1e-5)).z
    return float(np.max(z[np.argmin(z) :]))


@cache
def rebound_gain() -> float:
    """Return the h1 below which the front axle leaves the ground again, 1/s (h0 = 1500)."""
    return float(brentq(lambda h1: swing_back(H0, h1), 1.0, 10.0, xtol=1e-3))


def _sheet(title: str, gains: list[tuple[float, float, str]]) -> Sheet:
    t = times()
    figure, axes = panels(title, figsize=(8.5, 4.6))
    axis = axes[0, 0]
    columns = {"time [s]": t}
    for (h0, h1, label), colour in zip(gains, LINES, strict=True):
        z = stepped(h0, h1, D, RATE, t).z
        columns[f"z front, {label} [m]"] = z
        axis.plot(t, 1e3 * z, color=colour, label=label)
    axis.axhline(0, color="black", linewidth=0.8)
    axis.axhspan(1e3 * D * (1 - BAND), 1e3 * D * (1 + BAND), color="black", alpha=0.1, label="within 2 %")
    axis.set(xlabel="time since the impact / s", ylabel="front deformation / mm")
    axis.legend(frameon=False, fontsize=8, ncols=2)
    return Sheet(title, columns, figure, (f"{NO_P}; above 0 the wheels would be off the ground",))


def damping_gain() -> Sheet:
    """Return Fig 6.5: the front deformation for several h1, h0 = 1500."""
    gains = [(H0, h1, f"h1 = {h1:g} 1/s") for h1 in H1_SHOWN]
    return _sheet("The damping gain h1 and the front deformation after the impact, h0 = 1500 1/s² (Fig 6.5)", gains)


def proportional_gain() -> Sheet:
    """Return Fig 6.6: the front deformation for several h0, h1 = 70."""
    gains = [(h0, H1, f"h0 = {h0:g} 1/s²") for h0 in H0_SHOWN]
    return _sheet("The proportional gain h0 and the front deformation after the impact, h1 = 70 1/s (Fig 6.6)", gains)


def _slower(where: str) -> Claim:
    found = [settled(H0, h1) for h1 in H1_ABOVE]
    below = [settled(H0, h1) for h1 in (20.0, 40.0)]
    return Claim(
        where,
        "as the damping gain h1 increases the desired deformation is attained slower",
        f"within 2 % in {found[0]:.3f} s at h1 = {H1_ABOVE[0]:g} and {found[-1]:.3f} s at {H1_ABOVE[-1]:g}; below it "
        f"the other way round, {below[1]:.3f} s at 40 and {below[0]:.3f} s at 20",
        graded(bool(np.all(np.diff(found) > 0))),
        {"at 65": found[0], "at 200": found[-1], "at 20": below[0]},
    )


def _critical(where: str, printed: float, critical: float, passed: float, name: str, side: str) -> Claim:
    return Claim(
        where,
        f"the critical {name} is {printed:g}, {side} which the wheel oscillates",
        f"critical damping is at {name} = {critical:.4g}; at {printed:g} the front passes its target by "
        f"{100 * passed:.1f} %, which a plot hardly shows: an eye reading",
        graded(abs(critical / printed - 1) < 0.005, abs(critical / printed - 1) < 0.3),
        {"critical": critical, "overshoot at the printed gain": passed},
        as_printed="the same: the loop does not depend on P",
    )


def _rebound_h1(where: str) -> Claim:
    gain, left = rebound_gain(), swing_back(H0, 20.0)
    return Claim(
        where,
        "an oscillation below the critical h1 is a rebound of the wheel",
        f"it swings about -20 mm without leaving the ground (at h1 = 20 it comes back to {1e3 * left:.1f} mm): z > 0 "
        f"only for h1 < {gain:.1f}",
        graded(gain > 0.9 * CRITICAL_H1),
        {"gain": gain},
    )


def damping_claims(where: str = "6.3, Fig 6.5") -> list[Claim]:
    """Return what 6.3 says about h1, and section 3 of the paper in the same words."""
    critical = 2 * float(np.sqrt(H0))
    stable = [overshoot(H0, h1) for h1 in H1_SHOWN]
    return [
        _slower(where),
        _critical(where, CRITICAL_H1, critical, overshoot(H0, CRITICAL_H1), "h1", "below"),
        _rebound_h1(where),
        Claim(
            where,
            "a derivative control increases the stability and reduces the overshoot",
            f"the overshoot falls from {100 * stable[0]:.0f} % at h1 = 20 to {100 * stable[2]:.1f} % at 65 and 0 from "
            f"{critical:.1f} on",
            graded(bool(np.all(np.diff(stable) <= 0)) and stable[-1] == 0),
            {"at 20": stable[0], "at 65": stable[2]},
        ),
    ]


def _rebound_h0(where: str) -> Claim:
    backs = {h0: swing_back(h0, H1) for h0 in (CRITICAL_H0, 3000.0, 10_000.0, 100_000.0)}
    highest = max(backs.values())
    return Claim(
        where,
        "an oscillation at higher h0 is a rebound of the wheel",
        f"none up to h0 = 100000: the front swings back to {1e3 * highest:.1f} mm at most, and the ground is at 0",
        graded(highest > 0),
        {"highest": highest},
    )


def _rise(h0: float) -> float:
    z, t = stepped(h0, H1, D, RATE, times(4.0)).z, times(4.0)
    return float(t[np.argmax(z < 0.9 * D)])


def integral_error(h_I: float, t: np.ndarray) -> np.ndarray:
    """Return the front error (n,) in m at *t* (n,), s, with - *h_I* (1/s3) times its integral in the law as well."""
    loop = control.StateSpace([[0, 1, 0], [0, 0, 1], [-h_I, -H0, -H1]], np.zeros((3, 1)), [[0, 1, 0]], 0)
    return np.asarray(control.initial_response(loop, t, [0.0, -D, RATE]).outputs)


def _integral(where: str) -> Claim:
    t = times(2.0, 1e-3)
    errors = [integral_error(h_I, t) for h_I in INTEGRAL]
    passed = [float(np.max(-e) / -D) for e in errors]
    late = [float(t[np.flatnonzero(np.abs(e) > BAND * abs(D))[-1]]) for e in errors]
    words = "; ".join(f"{100 * p:.1f} % and {s:.2f} s" for p, s in zip(passed, late, strict=True))
    return Claim(
        where,
        "an integral control makes the transient response worse, though it eliminates the steady-state error",
        f"overshoot and settling for {', '.join(f'{h:g}' for h in INTEGRAL)} 1/s³: {words}. The model leaves no steady "
        "error to eliminate",
        graded(bool(np.all(np.diff(passed) > 0)) and min(late[1:]) > late[0]),
        {f"overshoot, {h:g}": p for h, p in zip(INTEGRAL, passed, strict=True)},
        assumption="integral gains; none are given",
    )


def proportional_claims(where: str = "6.3, Fig 6.6") -> list[Claim]:
    """Return what 6.3 says about h0."""
    found = [settled(h0, H1) for h0 in H0_BELOW]
    beyond = [settled(h0, H1) for h0 in (3000.0, 10_000.0)]
    rises = [_rise(h0) for h0 in H0_SHOWN]
    left = [abs(float(stepped(h0, H1, D, RATE, times(4.0)).z[-1] / D - 1)) for h0 in H0_BELOW[1:]]
    return [
        Claim(
            where,
            "as the proportional gain h0 increases the settling time decreases",
            f"within 2 % in {found[0]:.2f} s at h0 = {H0_BELOW[0]:g} and {found[-1]:.3f} s at {H0_BELOW[-1]:g}; "
            f"no longer where it swings: {beyond[0]:.3f} s at 3000, {beyond[1]:.3f} s at 10000",
            graded(bool(np.all(np.diff(found) < 0))),
            {"at 100": found[0], "at 1550": found[-1], "at 10000": beyond[1]},
        ),
        _rebound_h0(where),
        Claim(
            where,
            "a proportional control reduces the rise time and the steady-state error",
            f"nine tenths of the way in {rises[0]:.3f} s at h0 = 300 and {rises[-1]:.3f} s at 10000; there is no "
            f"steady error at any h0 ({max(left):.0e} of the target after 4 s)",
            graded(bool(np.all(np.diff(rises) < 0)) and max(left) < 1e-3, bool(np.all(np.diff(rises) < 0))),
            {"rise at 300": rises[0], "rise at 10000": rises[-1]},
        ),
        _integral(where),
    ]


def paper_damping_claims() -> list[Claim]:
    """Return what section 3 of the paper says about h1."""
    return damping_claims("wheel impact paper, section 3, Fig 4")[:3]


def paper_proportional_claims() -> list[Claim]:
    """Return what section 3 of the paper says about h0: with a number that the thesis leaves out."""
    where = "wheel impact paper, section 3, Fig 5"
    settling, rebound = proportional_claims(where)[:2]
    return [settling, _critical(where, CRITICAL_H0, H1**2 / 4, overshoot(CRITICAL_H0, H1), "h0", "above"), rebound]
