"""The planned paths of the deformations (thesis Figs 6.10 and 6.11, wheel impact paper Figs 6 to 8)."""

from __future__ import annotations

import numpy as np

from controllers.reference import planned
from controllers.state_space import static_deflection

from .claim import Claim, graded
from .impact_case import (
    APPROACH,
    FRONT_WHEELS,
    HARD,
    PERIODS,
    SECONDS,
    TARGET,
    axles,
    both_planned,
    both_stepped,
    cosimulated,
    measured,
    since_impact,
    times,
    traction,
)
from .impact_printed import printed_path
from .impact_response import FROZEN, SIDES, friction_claim
from .sheet import LINES, Sheet, panels

D, RATE = float(TARGET[1]), float(APPROACH[1])  # of the front axle
QUANTITIES = ("deformation [mm]", "rate [m/s]", "acceleration [m/s²]", "jerk [m/s³]")


def path(T: float, t_n: np.ndarray) -> dict[str, np.ndarray]:
    """Return the planned path of the front axle in *T* seconds at t / T = *t_n* (n,), and its time derivatives."""
    found = planned(t_n * T, T, 0.0, RATE, D)
    jerk = np.gradient(found.acceleration, t_n * T, edge_order=2)
    return dict(zip(QUANTITIES, (1e3 * found.z, found.rate, found.acceleration, jerk), strict=True))


def path_figure() -> Sheet:
    """Return Fig 6.10: deformation, rate, acceleration and jerk of the plan in three durations."""
    t_n = np.linspace(0, 1, 1001)
    figure, axes = panels("The planned path of the front wheels (Fig 6.10)", 2, 2, sharex=True)
    columns = {"t/T": t_n}
    for T, colour in zip(PERIODS, LINES, strict=False):
        found = path(T, t_n)
        columns |= {f"{name}, T = {T:g} s": values for name, values in found.items()}
        columns[f"as printed [mm], T = {T:g} s"] = 1e3 * printed_path(t_n * T, T, RATE, D)
        for axis, (name, values) in zip(axes.flat, found.items(), strict=True):
            axis.plot(t_n, values, color=colour, label=f"T = {T:g} s")
            axis.set_ylabel(name.replace("[", "/ ").replace("]", ""))
    axes[0, 0].legend(frameon=False, fontsize=8)
    for axis in axes[-1]:
        axis.set_xlabel("t / T")
    note = "derivatives by real time: 6.18 leaves out 1/T, 1/T², 1/T³, and 6.19 holds them in its coefficients"
    return Sheet("The planned path of the front wheels", columns, figure, (note,))


def path_claims(where: str = "6.5, Fig 6.10", equation: str = "6.19") -> list[Claim]:
    """Return what 6.5 says about the planned path."""
    t_n = np.linspace(0, 1, 1001)
    jerks = [float(np.max(np.abs(path(T, t_n)["jerk [m/s³]"]))) for T in PERIODS]
    deepest = [float(np.min(path(T, t_n)["deformation [mm]"])) for T in PERIODS]
    ends = [float(printed_path(np.array([T]), T, RATE, D)[0]) for T in PERIODS]
    right = [float(planned(T, T, 0.0, RATE, D).z) for T in PERIODS]
    forces = [np.max(np.abs(plan_traction(T, times(T))), axis=0) for T in PERIODS]
    words = ", ".join(f"{F[0] / 1e3:.0f}/{F[1] / 1e3:.0f} kN in {T:g} s" for F, T in zip(forces, PERIODS, strict=True))
    return [
        Claim(
            where,
            "the jerk decreases as the time T allowed increases",
            f"at most {', '.join(f'{j:.0f}' for j in jerks)} m/s³ for T = 0.1, 0.15, 0.2 s",
            graded(bool(np.all(np.diff(jerks) < 0))),
            {f"T = {T:g}": j for T, j in zip(PERIODS, jerks, strict=True)},
        ),
        Claim(
            equation,
            "these coefficients end the path at d with neither rate, acceleration nor jerk",
            f"only with C7 = -10 (2 d - v0 T) / T^7: as printed, with + v0 T, it ends at "
            f"{', '.join(f'{z:+.2f}' for z in ends)} m for d = {D:g} m",
            graded(max(abs(z - D) for z in ends) < 1e-6),
            {f"T = {T:g}": z for T, z in zip(PERIODS, ends, strict=True)} | {"right": right[0]},
            as_printed=f"{', '.join(f'{z:+.2f}' for z in ends)} m",
        ),
        Claim(
            where,
            "the effort required is inversely proportional to the time of the trajectory",
            f"a slower plan needs more, rear/front {words}: it goes down to "
            f"{', '.join(f'{z:.2f}' for z in deepest)} mm on the way to -20",
            graded(bool(np.all(np.diff(forces, axis=0) < 0))),
            {f"front, T = {T:g}": float(F[1]) for T, F in zip(PERIODS, forces, strict=True)}
            | {f"rear, T = {T:g}": float(F[0]) for T, F in zip(PERIODS, forces, strict=True)}
            | {f"deepest, T = {T:g}": z for T, z in zip(PERIODS, deepest, strict=True)},
            assumption=FROZEN,
        ),
    ]


def paper_path_claims() -> list[Claim]:
    """Return what section 4 of the paper says about the plan."""
    _, ends, effort = path_claims("wheel impact paper, section 4", "wheel impact paper, below 17")
    return [ends, effort]


def plan_traction(T: float, t: np.ndarray) -> np.ndarray:
    """Return the tractions (n, 2), N, along the planned path of *T* seconds."""
    return traction(axles(), both_planned(T, t))


def plan_force_figure() -> Sheet:
    """Return Fig 7 of the paper: the tractions along the planned paths and with the target at once."""
    t = times()
    title = "Tractions along a plan (solid) and to the target at once (broken), k = 5.6e6 N/m"
    figure, axes = panels(title, 2, 1, sharex=True)
    step = traction(axles(), both_stepped(t))
    columns = {"time [s]": t} | {f"F {side}, step [N]": step[:, k] for k, side in enumerate(SIDES)}
    for T, colour in zip(PERIODS, LINES, strict=False):
        plan = plan_traction(T, t)
        for k, side in enumerate(SIDES):
            columns[f"F {side}, T = {T:g} s [N]"] = plan[:, k]
            axes[k, 0].plot(t, 1e-3 * plan[:, k], color=colour, label=f"T = {T:g} s")
    for k, side in enumerate(SIDES):
        axes[k, 0].plot(t, 1e-3 * step[:, k], "--", color="black", linewidth=1, label="at once")
        axes[k, 0].set_ylabel(f"{side} axle / kN")
    axes[0, 0].legend(frameon=False, fontsize=8)
    axes[1, 0].set_xlabel("time since the impact / s")
    return Sheet("Tractions along the planned path", columns, figure, (FROZEN,))


def plan_force_claims() -> list[Claim]:
    """Return what section 4 of the paper asks of the tractions of Fig 7."""
    return [friction_claim("wheel impact paper, section 4"), paper_path_claims()[1]]


def _errors(variant: str) -> tuple[np.ndarray, np.ndarray]:
    """Return times since the impact (n,), s, and the front tracking error (n,), m, of a co-simulated run."""
    run = cosimulated(variant)
    t, rows = since_impact(run)
    acts = run.record["controller.active"][rows].ravel() > 0.5  # before its first tick it follows what there is
    t, rows = t[acts], rows[acts]
    error = run.record["body.gap"][rows] - run.record["controller.reference"][rows]
    return t, error[:, FRONT_WHEELS].mean(axis=1)


def tracking_figure() -> Sheet:
    """Return Fig 6.11: the front tracking error of a step and of a plan, by the thesis' model and co-simulated."""
    t = times()
    step, plan = both_stepped(t).z[:, 1] - D, np.zeros_like(t)
    figure, axes = panels("Tracking error of the front deformation (Fig 6.11)", figsize=(8.5, 4.2))
    columns = {"time [s]": t, "step [m]": step, "planned, exact [m]": plan}
    for name, variant in (("step, co-simulated [m]", "pd"), ("planned, co-simulated [m]", "pd-planned")):
        columns[name] = np.interp(t, *_errors(variant))
    styles = ((LINES[1], "-"), (LINES[0], "-"), (LINES[1], "--"), (LINES[0], "--"))
    for (name, values), (colour, style) in zip(list(columns.items())[1:], styles, strict=True):
        axes[0, 0].plot(t, 1e3 * values, style, color=colour, label=name[:-4])
    axes[0, 0].set(xlabel="time since the impact / s", ylabel="z - z_R / mm")
    axes[0, 0].legend(frameon=False, fontsize=8)
    note = "an exact model that starts on its plan has no error at all; what is left is the model's mismatch"
    return Sheet("Tracking error of the front deformation", columns, figure, (note, FROZEN))


def tracking_claims(where: str = "6.5, Fig 6.11") -> list[Claim]:
    """Return what 6.5 says about the tracking error and the actuators."""
    rms = {variant: measured(variant, "tracking_error") for variant in ("pd", "pd-planned")}
    F, model = plan_traction(PERIODS[0], np.array([0.0, SECONDS])), axles()
    rest = static_deflection(model.P, model.b, model.k_w)
    return [
        Claim(
            where,
            "a planned trajectory greatly reduces the tracking error of a step",
            f"a step begins {1e3 * abs(D):.0f} mm off, the plan on the spot and stays there; co-simulated "
            f"{rms['pd']:.2f} and {rms['pd-planned']:.2f} mm rms over all wheels",
            graded(rms["pd-planned"] < rms["pd"] / 3, rms["pd-planned"] < rms["pd"]),
            {"step": rms["pd"], "planned": rms["pd-planned"]},
        ),
        Claim(
            where,
            "zero initial and final jerk of the plan lets the actuators engage and disengage smoothly",
            f"{F[0, 0] / 1e3:+.1f} and {F[0, 1] / 1e3:+.1f} kN (rear, front) at once, against gravity, and "
            f"{F[1, 0] / 1e3:+.0f} and {F[1, 1] / 1e3:+.0f} kN for good; none for good only at the static "
            f"{1e3 * rest[0]:.2f} and {1e3 * rest[1]:.2f} mm",
            graded(bool(np.max(np.abs(F)) < 1.0)),
            {"rear at once": float(F[0, 0]), "front at once": float(F[0, 1]), "rear": float(F[1, 0]),
             "front": float(F[1, 1])},
            assumption=f"{FROZEN}; k = {HARD / 1e6:g}e6 N/m",
        ),
    ]  # fmt: skip


def paper_tracking_claims() -> list[Claim]:
    """Return what section 4 of the paper says about the tracking error and the actuators."""
    return tracking_claims("wheel impact paper, section 4, Fig 8")
