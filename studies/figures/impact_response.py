"""Deformations and tractions of the controlled impact (thesis Figs 6.7 to 6.9)."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from controllers.off_line import AxleModel
from controllers.pd_impact import error_dynamics, settling_time
from controllers.reference import Motion
from plants.planar import Posture
from plants.tables import G

from .claim import Claim, graded
from .impact_case import (
    APPROACH,
    BAND,
    FRICTION,
    FRONT_WHEELS,
    H0,
    H1,
    HARD,
    REAR_WHEELS,
    ROBOT,
    SECONDS,
    SLOPE,
    SPEED,
    TARGET,
    axles,
    both_stepped,
    cosimulated,
    deformations,
    measured,
    normal,
    since_impact,
    times,
    traction,
)
from .printed import PrintedBicycle
from .sheet import LINES, Sheet, panels

SIDES = ("rear", "front")
FROZEN = "posture frozen, axles undeformed at the impact, springs always closed, traction at the wheel centres"


def deformation_figure() -> Sheet:
    """Return Fig 6.7: the deformations of both axles, by the model of the thesis and co-simulated."""
    t = times()
    z, printed = both_stepped(t).z, both_stepped(t, H1, H0).z
    clock, found = deformations(cosimulated("pd"))
    figure, axes = panels("Wheel deformations under the impact law, h0 = 1500 1/s², h1 = 70 1/s (Fig 6.7)",
                          figsize=(8.5, 4.6))  # fmt: skip
    columns = {"time [s]": t}
    for k, side in enumerate(SIDES):
        columns |= {
            f"z {side} [m]": z[:, k],
            f"z {side}, co-simulated [m]": np.interp(t, clock, found[:, k]),
            f"z {side}, gains as printed [m]": printed[:, k],
        }
        for name, style in ((f"z {side} [m]", "-"), (f"z {side}, co-simulated [m]", "--"),
                            (f"z {side}, gains as printed [m]", ":")):  # fmt: skip
            axes[0, 0].plot(t, 1e3 * columns[name], style, color=LINES[k], label=name[2:-4])
    axes[0, 0].axhline(0, color="black", linewidth=0.8)
    axes[0, 0].set(xlabel="time since the impact / s", ylabel="deformation / mm")
    axes[0, 0].legend(frameon=False, fontsize=8, ncols=2, loc="upper right", bbox_to_anchor=(1, 0.9))
    notes = (FROZEN, "co-simulated: scenario ramp-impact, variant pd, on a ground whose friction never limits")
    return Sheet("Wheel deformations under the impact law", columns, figure, notes)


def settled(k: int, h0: float = H0, h1: float = H1, rate: float | None = None, horizon: float = 10.0) -> float:
    """Return when axle *k* stays within 2 % of its target, s; from *rate* (m/s) in place of its own."""
    target = abs(float(TARGET[k]))
    return settling_time(h0, h1, target, float(APPROACH[k]) if rate is None else rate, BAND * target, horizon)


def _cosimulated_settling(k: int) -> float:
    t, z = deformations(cosimulated("pd"))
    outside = np.flatnonzero(np.abs(z[:, k] - TARGET[k]) > BAND * abs(TARGET[k]))
    return float(t[outside[-1]])


def _approach() -> Claim:
    run = cosimulated("pd")
    _, rows = since_impact(run)
    met = -float(run.record["body.gap_rate"][rows[0]][FRONT_WHEELS].mean())
    speed = SPEED * float(np.sin(SLOPE))
    return Claim(
        "6.3",
        "the front wheels approach a ramp of 0.3 rad at 0.6 m/s when the robot drives at 2 m/s",
        f"2 sin 0.3 = {speed:.3f} m/s; {met:.3f} m/s co-simulated",
        graded(round(speed, 1) == 0.6 and round(met, 1) == 0.6),
        {"speed": speed, "co-simulated": met},
    )


def _printed_gains() -> Claim:
    pole = float(np.max(error_dynamics(H1, H0).poles().real))
    slow = settled(0, H1, H0, horizon=200.0)
    return Claim(
        "6.3",
        "h0 = 70.0 and h1 = 1500 is an optimal set of gains",
        f"they give a pole at {pole:.3f} 1/s, and the rear settles in {slow:.0f} s; the two numbers are interchanged",
        graded(slow < SECONDS),
        {"pole": pole, "settling": slow, "interchanged": settled(0)},
    )


def _grip() -> Claim:
    kept = measured("pd", "front_off") == measured("pd", "rear_off") == 0
    needed = measured("pd", "friction_needed")
    off, rebounds, peak = (measured("pd-friction", n) for n in ("front_off", "front_rebounds", "front_normal_peak"))
    loose, idle = (measured("uncontrolled", n) for n in ("front_off", "front_normal_peak"))
    return Claim(
        "6.3, 6.8",
        "wheel-ground grip is attained immediately after the impact on all wheels, without rebound",
        f"where friction never limits no wheel leaves the ground, but one pushes {needed:.0f} times as hard as it is "
        f"pressed; within mu = {FRICTION:g} the fronts are off the ground for {off:.0f} of the first 200 ms, "
        f"rebound {rebounds:.0f} times and hit with {peak / 1e3:.1f} kN; without control {loose:.0f} ms and "
        f"{idle / 1e3:.1f} kN",
        graded(kept and not off, kept),
        {"off within friction": off, "rebounds": rebounds, "friction needed": needed, "peak within friction": peak,
         "off without control": loose, "peak without control": idle},
    )  # fmt: skip


def deformation_claims() -> list[Claim]:
    """Return what 6.3 says about Fig 6.7."""
    rear, front = settled(0), settled(1)
    slow, quick = _cosimulated_settling(0), _cosimulated_settling(1)
    same = settled(1, rate=0.0)
    return [
        _approach(),
        _printed_gains(),
        Claim(
            "6.3",
            "the desired deformations are attained in about one tenth of a second",
            f"within 2 %: front {front:.3f} s, rear {rear:.3f} s; co-simulated {quick:.3f} and {slow:.3f} s",
            graded(round(front, 1) == round(rear, 1) == 0.1),
            {"front": front, "rear": rear, "front co-simulated": quick, "rear co-simulated": slow},
            as_printed=f"h0 = 70, h1 = 1500: {settled(0, H1, H0, horizon=200.0):.0f} s",
        ),
        Claim(
            "6.3",
            "the rear wheels approach their deformation slower than the front ones, as these start with a rate",
            f"rear {rear:.3f} s, front {front:.3f} s, and a front that starts at rest {same:.3f} s, like the rear",
            graded(rear > front and abs(same - rear) < 1e-3),
            {"rear": rear, "front": front, "front at rest": same},
        ),
        _grip(),
    ]


@cache
def _run_forces() -> tuple[np.ndarray, np.ndarray]:
    """Return times since the impact (n,), s, and the tractions of rear and front axle (n, 2), N, co-simulated."""
    run = cosimulated("pd")
    t, rows = since_impact(run)
    force = run.record["wheels.traction"][rows]
    return t, np.column_stack([force[:, REAR_WHEELS].sum(axis=1), force[:, FRONT_WHEELS].sum(axis=1)])


def force_figure() -> Sheet:
    """Return Fig 6.8: the tractions of both axles, and what friction transmits of them."""
    t, model = times(), axles()
    motion = both_stepped(t)
    F, limit = traction(model, motion), FRICTION * normal(model, motion)
    clock, found = _run_forces()
    figure, axes = panels("Tractions that the impact law asks for, k = 5.6e6 N/m (Fig 6.8)", 2, 1, sharex=True)
    columns = {"time [s]": t}
    for k, (side, axis) in enumerate(zip(SIDES, axes.flat, strict=True)):
        columns |= {
            f"F {side} [N]": F[:, k],
            f"F {side}, co-simulated [N]": np.interp(t, clock, found[:, k]),
            f"0.8 F_n {side} [N]": limit[:, k],
        }
        axis.plot(t, 1e-3 * F[:, k], color=LINES[k], label="asked for")
        axis.plot(clock, 1e-3 * found[:, k], "--", color=LINES[k], linewidth=1, label="co-simulated")
        axis.fill_between(t, -1e-3 * limit[:, k], 1e-3 * limit[:, k], color="black", alpha=0.15,
                          label="within 0.8 F_n")  # fmt: skip
        axis.set_ylabel(f"{side} axle / kN")
        axis.legend(frameon=False, fontsize=8, ncols=3)
    axes[-1, 0].set(xlabel="time since the impact / s", xlim=(0, SECONDS))
    notes = (FROZEN, "co-simulated: scenario ramp-impact, variant pd, traction at the ground and a robot that moves")
    return Sheet("Tractions of the impact law", columns, figure, notes)


def held(model: AxleModel) -> np.ndarray:
    """Return the tractions (2,), N, that hold the final deformations."""
    still = np.zeros((1, 2))
    return np.asarray(traction(model, Motion(TARGET[None, :], still, still))[0])


def friction_claim(where: str = "6.5") -> Claim:
    """Return the criterion of 6.5 and of the paper that the traction stays within friction."""
    F, F_n = held(axles()), -HARD * TARGET
    began = traction(axles(), both_stepped(np.array([0.0])))[0]
    share, weights = np.abs(F) / F_n, np.abs(F) / (ROBOT.m * G)
    wrong = held(replace(axles(), P=PrintedBicycle(ROBOT).P(Posture(front=SLOPE))))
    ground = held(axles(arm="ground"))
    return Claim(
        where,
        "the actuation effort should not exceed what the friction between wheels and ground can carry",
        f"rear {F[0] / 1e3:+.1f} kN and front {F[1] / 1e3:+.1f} kN for good, {weights[0]:.0f} and {weights[1]:.0f} "
        f"times the weight, {share[0]:.1f} and {share[1]:.1f} times the normal forces (mu = {FRICTION:g}); "
        f"{began[0] / 1e3:+.1f} and {began[1] / 1e3:+.1f} kN at the impact",
        graded(bool(np.all(share <= FRICTION))),
        {"rear": float(F[0]), "front": float(F[1]), "rear share": float(share[0]), "front share": float(share[1]),
         "rear at once": float(began[0]), "front at once": float(began[1])},
        as_printed=f"P of 4.44: {wrong[0] / 1e3:+.1f} and {wrong[1] / 1e3:+.1f} kN",
        assumption=f"{FROZEN}, k_w of an axle; at the ground {ground[0] / 1e3:+.1f} and {ground[1] / 1e3:+.1f} kN",
    )  # fmt: skip


def force_claims() -> list[Claim]:
    """Return what chapter 6 says about the tractions of Fig 6.8."""
    t, model = times(), axles()
    work = float(np.trapezoid(np.sum(np.abs(traction(model, both_stepped(t))), axis=1) * SPEED, t))
    energy = float(APPROACH[1] ** 2 / (2 * model.P[1, 1]))
    return [
        friction_claim(),
        Claim(
            "6.6",
            "the work of the control forces is mainly in damping the oscillations of the wheels",
            f"at {SPEED:g} m/s rear and front do {work / 1e3:.0f} kJ against each other in {SECONDS:g} s; the "
            f"impact brings v² / (2 P22) = {energy:.1f} J",
            graded(work < 2 * energy),
            {"work": work, "impact": energy},
            assumption="the wheels keep rolling at the speed of the approach",
        ),
    ]
