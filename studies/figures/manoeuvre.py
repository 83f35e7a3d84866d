"""The planned pitch over an obstacle and its traction (thesis Figs 5.2-5.5, smooth manoeuvre paper Figs 4-7)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache, partial

import numpy as np
from scipy.optimize import brentq

from controllers.pitch_plan import (
    Coefficients,
    PitchPlan,
    coefficients,
    pitch_for_time,
    planned_pitch,
    shortest_time_on_a_sine,
    sine_slope,
)
from plants.tables import robot

from .claim import UNKNOWN, Claim, graded
from .entry import Entry
from .printed import appendix_b
from .sheet import LINES, Sheet, panels

ROBOT = robot("thesis_5_1")
PRINTED_T = 1.38  # s
THESIS_XI, PAPER_XI = 0.5, -0.2  # rad
FAST, SLOW = (1.0, 1.2, PRINTED_T), (PRINTED_T, 1.6, 2.0, 2.5)  # s; the thesis names only 1.38
T_N = np.linspace(0, 1, 401)
RUN = ("pitch-plan", "open-loop")
_Terms = Callable[[np.ndarray, np.ndarray], Coefficients]  # of pitch and profile angle
BETA_ASSUMED = "the pitch at the end, beta, is not given: it is the one for which 1.38 s is the shortest time"


@cache
def beta(xi: float, curvature: bool = False) -> float:
    """Return the pitch at the end, rad, for which 1.38 s is the shortest manoeuvre over xi sin(pi t_n)."""
    if not curvature:
        return pitch_for_time(PRINTED_T, lambda b: shortest_time_on_a_sine(ROBOT, b, xi))
    return pitch_for_time(PRINTED_T, lambda b: PitchPlan(ROBOT, b, sine_slope(xi)).shortest_time())


@cache
def plan(xi: float) -> PitchPlan:
    """Return the manoeuvre of the thesis (0.5) or of the paper (-0.2): without the curvature term, as there."""
    return PitchPlan(ROBOT, beta(xi), sine_slope(xi), curvature=False)


def shortest(end: float, xi: float, terms: _Terms) -> float:
    """Return the shortest time, s, without a change of sign, with other coefficients, up to 1e-3 before its end."""
    t = np.linspace(1e-3, 1 - 1e-3, 2001)
    p, rate, acceleration, _ = planned_pitch(t, end)
    of = terms(p, sine_slope(xi)(t)[0])
    return float(np.sqrt(np.max((acceleration - of.Gamma * rate**2) / of.Lambda)))


def _as_body_angle(p: np.ndarray, gamma: np.ndarray) -> Coefficients:
    """The text of 5.1 to 5.9 with gamma as what its P needs it to be, the angle seen from the body."""
    return coefficients(ROBOT, p, gamma + p, 0.0)


def polynomial_figure(source: str = "Fig 5.2") -> Sheet:
    """Return the planned pitch and its derivatives over normalised time, for an end of 1 and a duration of 1."""
    names = ("p / beta", "p' T / beta", "p'' T^2 / beta", "p''' T^3 / beta")
    figure, axes = panels(f"Planned pitch and its derivatives ({source})", 2, 2, sharex=True)
    columns = {"t_n": T_N}
    for axis, name, values in zip(axes.flat, names, planned_pitch(T_N, 1.0), strict=True):
        columns[name] = values
        axis.plot(T_N, values, color=LINES[0])
        axis.set_ylabel(name)
    for axis in axes[1]:
        axis.set_xlabel("normalised time t_n")
    note = "(5.13)-(5.15) leave out the factors 1/T, 1/T^2, 1/T^3; G_i of (5.12) is C_i, listed from C_7 down to C_0"
    return Sheet("Planned pitch", columns, figure, (note,))


def polynomial_claims() -> list[Claim]:
    """Return the verdicts on the planned pitch."""
    jerk = planned_pitch(np.linspace(0, 1, 2001), 1.0).jerk
    longer = float(np.max(np.abs(planned_pitch(np.linspace(0, 1, 2001), 1.0, 2.0).jerk)))
    peak = float(np.max(np.abs(jerk)))
    return [
        Claim(
            "5.3",
            "the jerk is zero at the start and at the end, but not in between",
            f"exactly 0 at both ends; at most {peak:.1f} beta / T^3 in between",
            graded(bool(jerk[0] == jerk[-1] == 0 and peak > 1)),
            {"peak": peak},
        ),
        Claim(
            "5.3",
            "a longer manoeuvre lowers the peaks of jerk, acceleration and velocity",
            f"as 1/T^3, 1/T^2 and 1/T: twice the time leaves {longer / peak:.3f} of the jerk",
            graded(longer < peak),
            {"twice as long": longer / peak},
            "no: the derivatives of (5.13)-(5.15) do not depend on T",
        ),
    ]


def profile_figure(xi: float, source: str) -> Sheet:
    """Return the profile angle over normalised time, and the curvature that it asks of the path of the front wheels."""
    inside = T_N[1:-1]
    slope, turning = sine_slope(xi)(T_N)
    speed = plan(xi).speed(T_N)
    bend = np.full(len(T_N), np.nan)
    bend[1:-1] = turning[1:-1] / speed[1:-1]
    figure, axes = panels(f"Profile angle {xi:g} sin(pi t_n) ({source}), and the curvature it needs", 1, 2)
    axes[0, 0].plot(T_N, slope, color=LINES[0])
    axes[0, 0].set(xlabel="normalised time t_n", ylabel="profile angle gamma / rad")
    axes[0, 1].plot(inside, bend[1:-1], color=LINES[1], label="of the path of the front wheel centres")
    axes[0, 1].axhline(-1 / ROBOT.R, color="black", linewidth=0.8, linestyle=":", label="-1/R: sharpest crest")
    axes[0, 1].set(xlabel="normalised time t_n", ylabel="curvature / (1/m)", ylim=(-40, 40))
    axes[0, 1].legend(frameon=False, fontsize=8)
    columns = {"t_n": T_N, "gamma [rad]": slope, "v_t T [m]": speed, "curvature [1/m]": bend}
    note = (
        "profile, pitch and speed are not independent: with both axles on the ground v_t sin(gamma) = L cos(p) p', so "
        "that the robot starts and ends at rest"
    )
    return Sheet("Profile angle", columns, figure, (note,))


def profile_claims() -> list[Claim]:
    """Return the verdict on the profile of the thesis."""
    t = np.linspace(1e-3, 1 - 1e-3, 9981)
    bend = sine_slope(THESIS_XI)(t)[1] / plan(THESIS_XI).speed(t)
    first = float(t[np.argmax(bend < -1 / ROBOT.R)])
    return [
        Claim(
            "5.3",
            "any profile angle can be parametrised with the same time as the pitch",
            f"0.5 sin(pi t_n) asks for a path whose curvature is unbounded at both ends; from t_n = {first:.3f} on it "
            f"is a crest sharper than the radius of the wheel, {ROBOT.R:g} m: no wheel of the robot follows it",
            graded(first >= 1),
            {"from": first},
            assumption=f"{BETA_ASSUMED}, {beta(THESIS_XI):.4f} rad",
        )
    ]


def force_figure(xi: float, times: Sequence[float], source: str) -> Sheet:
    """Return the traction of the rear wheels over normalised time for several durations, and as printed."""
    figure, axes = panels(f"Traction for manoeuvres of several durations ({source})", 1, 2, sharey=True)
    columns = {"t_n": T_N}
    inside = (T_N > 2e-3) & (T_N < 1 - 2e-3)
    p, rate, acceleration, _ = planned_pitch(T_N[inside], beta(xi))
    of = appendix_b(ROBOT, p, sine_slope(xi)(T_N[inside])[0])
    for T, colour in zip(times, LINES, strict=False):
        printed = np.full(len(T_N), np.nan)
        printed[inside] = (acceleration / T**2 - of.Gamma * (rate / T) ** 2 - of.Lambda) / of.Phi
        for axis, name, force in zip(
            axes.flat, ("corrected", "printed"), (plan(xi).force(T_N, T), printed), strict=True
        ):
            columns[f"{name}, {T:g} s [N]"] = force
            axis.plot(T_N, force, color=colour, label=f"T = {T:g} s")
    for axis, name in zip(axes.flat, ("corrected", "Appendix B as printed"), strict=True):
        axis.axhline(0, color="black", linewidth=0.8)
        axis.set(title=name, xlabel="normalised time t_n")
    axes[0, 0].set_ylabel("traction of the rear wheels / N")
    axes[0, 0].legend(frameon=False, fontsize=8)
    grip = ", ".join(f"{plan(xi).friction_needed(T):.2f} at {T:g} s" for T in times)
    least = ", ".join(f"{plan(xi).force(T_N, T).min():.1f} N at {T:g} s" for T in times)
    notes = (
        f"beta = {beta(xi):.4f} rad; least traction: {least}; friction it needs at the rear axle: {grip}",
        "the corrected coefficients are those of the planar model with two axles to rounding; traction at the ground",
    )
    return Sheet("Traction of a planned pitch", columns, figure, notes)


def fast_claims() -> list[Claim]:
    """Return the verdicts on Fig 5.4."""
    end, with_curve = beta(THESIS_XI), beta(THESIS_XI, True)
    printed = shortest(end, THESIS_XI, partial(appendix_b, ROBOT))
    body = float(brentq(lambda b: shortest(b, THESIS_XI, _as_body_angle) - PRINTED_T, 0.1, 1.2))
    longer = {b: shortest_time_on_a_sine(ROBOT, b, THESIS_XI) for b in (0.1, 0.2)}
    least = {T: float(plan(THESIS_XI).force(T_N, T).min()) for T in (1.0, 1.2)}
    return [
        Claim(
            "5.3",
            "1.38 s is the shortest manoeuvre without braking",
            f"for beta = {end:.4f} rad ({np.degrees(end):.2f} deg); T grows as the root of beta: "
            f"{', '.join(f'{T:.2f} s for {b:g} rad' for b, T in longer.items())}. With the curvature of the path that "
            f"is left out beta = {with_curve:.4f} rad",
            UNKNOWN,
            {"beta": end, "with curvature": with_curve, "body angle": body, **{f"{b:g}": T for b, T in longer.items()}},
            f"{printed:.2f} s for the same beta by Appendix B; by (5.1)-(5.9), with gamma as seen from the body, "
            f"beta = {body:.3f} rad",
            "beta is not given; mass, moment of inertia and wheel radius do not matter",
        ),
        Claim(
            "5.3",
            "faster manoeuvres change the sign of the traction",
            f"least traction {', '.join(f'{F:.1f} N in {T:g} s' for T, F in least.items())}",
            graded(all(F < 0 for F in least.values())),
            {f"{T:g} s": F for T, F in least.items()},
            assumption=f"{BETA_ASSUMED}, {end:.4f} rad",
        ),
    ]


def slow_claims() -> list[Claim]:
    """Return the verdicts on Fig 5.5."""
    peaks = {T: float(plan(THESIS_XI).force(T_N, T).max()) for T in SLOW}
    least = min(float(plan(THESIS_XI).force(T_N, T).min()) for T in SLOW[1:])
    return [
        Claim(
            "5.3",
            "the largest traction falls as the manoeuvre takes longer, and is never negative from 1.38 s on",
            f"{', '.join(f'{F:.0f} N in {T:g} s' for T, F in peaks.items())}; at the least {abs(least):.0f} N beyond "
            "1.38 s",
            graded(sorted(peaks.values(), reverse=True) == list(peaks.values()) and least > -1e-6),
            {f"{T:g} s": F for T, F in peaks.items()},
            assumption=f"{BETA_ASSUMED}, {beta(THESIS_XI):.4f} rad",
        )
    ]


def paper_fast_claims() -> list[Claim]:
    """Return the verdict on Fig 6 of the paper, whose obstacle has xi = -0.2."""
    end, same = beta(PAPER_XI), shortest_time_on_a_sine(ROBOT, beta(THESIS_XI), PAPER_XI)
    printed = shortest(end, PAPER_XI, partial(appendix_b, ROBOT))
    return [
        Claim(
            "section 3",
            "1.38 s is the shortest manoeuvre without a change of sign, over -0.2 sin(pi t_n)",
            f"for beta = {end:.4f} rad; with the {beta(THESIS_XI):.4f} rad of the thesis it would be {same:.2f} s: T "
            "goes as the root of beta over |xi|, so the same time for both obstacles needs two pitches",
            UNKNOWN,
            {"beta": end, "same beta": same},
            f"{printed:.2f} s for the same beta by its Appendix A",
            "beta is not given",
        )
    ]


def paper_slow_claims() -> list[Claim]:
    """Return the verdicts on Fig 7 of the paper."""
    end = beta(PAPER_XI)
    force = {T: plan(PAPER_XI).force(T_N, T) for T in SLOW}
    down = PitchPlan(ROBOT, -end, sine_slope(PAPER_XI), curvature=False).force(T_N, 2.0)
    peaks = {T: float(np.abs(F).max()) for T, F in force.items()}
    nose_up = f"beta = {end:.4f} rad, nose-up"
    return [
        Claim(
            "section 3",
            "a longer manoeuvre avoids the shift from traction to braking",
            f"without a shift it brakes throughout: {force[2.0].min():.0f} to {abs(force[2.0].max()):.0f} N in 2 s "
            f"(a descent that pitches the nose down by as much: {down.min():.0f} to {abs(down.max()):.0f} N)",
            graded(bool(np.max(force[2.0]) > 1), bool(np.max(force[2.0]) < 1e-6)),
            {"least": float(force[2.0].min()), "largest": float(force[2.0].max())},
            assumption=nose_up,
        ),
        Claim(
            "section 3",
            "the largest traction falls as the manoeuvre takes longer",
            ", ".join(f"{F:.0f} N in {T:g} s" for T, F in peaks.items()),
            graded(bool(np.all(np.diff(list(peaks.values())) < 0))),
            {f"{T:g} s": F for T, F in peaks.items()},
            assumption=nose_up,
        ),
    ]


_PAPER = "smooth manoeuvre paper"
_UP_TO, _FROM = "traction, T up to 1.38 s", "traction, T from 1.38 s"
ENTRIES = (
    Entry("thesis 5.2", "planned pitch and its derivatives", polynomial_figure, polynomial_claims),
    Entry("thesis 5.3", "profile angle", partial(profile_figure, THESIS_XI, "Fig 5.3"), profile_claims),
    Entry("thesis 5.4", _UP_TO, partial(force_figure, THESIS_XI, FAST, "Fig 5.4"), fast_claims),
    Entry("thesis 5.5", _FROM, partial(force_figure, THESIS_XI, SLOW, "Fig 5.5"), slow_claims, RUN),
    Entry(f"{_PAPER} 4", "planned pitch", partial(polynomial_figure, "paper, Fig 4"), polynomial_claims),
    Entry(f"{_PAPER} 5", "profile angle", partial(profile_figure, PAPER_XI, "paper, Fig 5")),
    Entry(f"{_PAPER} 6", _UP_TO, partial(force_figure, PAPER_XI, FAST, "paper, Fig 6"), paper_fast_claims),
    Entry(f"{_PAPER} 7", _FROM, partial(force_figure, PAPER_XI, SLOW, "paper, Fig 7"), paper_slow_claims),
)
