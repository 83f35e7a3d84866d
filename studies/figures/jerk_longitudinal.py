"""Longitudinal jerk, and which axle to drive (ASME paper Figs 3 and 4, TIMR paper Fig 3)."""

from __future__ import annotations

import numpy as np

from .claim import Claim, graded
from .jerk_case import QUANTITIES, STRAIGHT, Climber, flat
from .sheet import LINES, Sheet, panels

ASME, TIMR = Climber("asme_paper"), Climber("timr_paper")
SLOPES = np.linspace(0.0, 0.5, 51)
RAMP = float(np.radians(25))  # of the ASME paper's case study


def _figure(rolling: Climber, force_max: float, title: str) -> Sheet:
    forces = np.linspace(0.0, force_max, 51)
    changes = np.stack([rolling.changes(float(g)).at(forces)[:, 0] for g in SLOPES], axis=1)
    a_x = np.stack([rolling.accelerations(float(g)).at(forces)[:, 0] for g in SLOPES], axis=1)
    normal = np.array([rolling.changes(float(g)).zero("normal") for g in SLOPES])
    hold = np.array([rolling.accelerations(float(g)).zero("normal") for g in SLOPES[1:]])
    figure, axes = panels(title, 1, 2, sharey=True, figsize=(11, 4.6))
    for axis, values, name in zip(axes.flat, (changes, a_x), ("a) longitudinal jerk / (m/s³)",
                                  "b) longitudinal acceleration / (m/s²)"), strict=True):  # fmt: skip
        axis.clabel(axis.contour(SLOPES, forces, values, levels=12, colors="0.5", linewidths=0.8), fontsize=7)
        axis.set(title=name, xlabel="slope γ under the fronts / rad", ylim=(0, force_max))
    axes[0, 0].plot(SLOPES, normal, color=LINES[1], label="no normal and no pitch jerk")
    axes[0, 1].plot(SLOPES[1:], hold, color=LINES[0], label="no acceleration")
    axes[0, 0].set_ylabel("rear traction / N")
    for axis in axes.flat:
        axis.legend(frameon=False, fontsize=8, loc="upper left")
    note = "jerk for dγ/dt = 1 rad/s, which is not given; where it would vanish is free of it, and lies outside"
    return Sheet(title, flat(SLOPES, forces, **{"J_x [m/s³]": changes, "a_x [m/s²]": a_x}), figure, (note, STRAIGHT))


def asme_figure() -> Sheet:
    """Return ASME Fig 3: longitudinal jerk and acceleration over slope and traction."""
    return _figure(ASME, 500.0, "Longitudinal jerk and acceleration, 80 kg (ASME Fig 3)")


def timr_figure() -> Sheet:
    """Return TIMR Fig 3: the same for another robot."""
    return _figure(TIMR, 250.0, "Longitudinal jerk and acceleration, 50 kg (TIMR Fig 3)")


def _coincide(where: str, rolling: Climber) -> Claim:
    at = rolling.changes(0.2)
    found, hold = {q: at.zero(q) for q in QUANTITIES}, {q: rolling.accelerations(0.2).zero(q) for q in QUANTITIES}
    off = float(np.ptp(list(found.values())))
    return Claim(
        where,
        "the zero-jerk lines of longitudinal, normal and pitch motion are identical, so one traction avoids all jerk",
        f"normal and pitch, {found['normal']:.1f} N at 0.2 rad, since a_z = -L_r α - h ω²; longitudinal "
        f"{found['longitudinal']:.0f} N. It is without acceleration that the three coincide, {hold['normal']:.1f} N",
        graded(off < 1.0),
        found | {"static": hold["longitudinal"], "static, apart": float(np.ptp(list(hold.values())))},
        assumption=STRAIGHT,
    )


def asme_claims() -> list[Claim]:
    """Return what section 3 of the ASME paper says about Fig 3."""
    return [_coincide("ASME paper, section 3", ASME)]


def timr_claims() -> list[Claim]:
    """Return what section 3 of the TIMR paper says about Fig 3."""
    slopes = SLOPES[5:]
    normal = np.array([TIMR.changes(float(g)).zero("normal") for g in slopes])
    hold = np.array([TIMR.accelerations(float(g)).zero("longitudinal") for g in slopes])
    a_x = [float(TIMR.accelerations(float(g)).at(F)[0]) for g, F in zip(slopes, normal, strict=True)]
    at = {g: TIMR.changes(g).zero("normal") for g in (0.2, 0.3)}
    still = {g: TIMR.accelerations(g).zero("normal") for g in (0.2, 0.3)}
    words = ", ".join(f"{at[g]:.1f} and {still[g]:.1f} N at {g:g} rad" for g in at)
    apart = float(np.min(normal / hold))
    along = np.array([TIMR.changes(float(g)).zero("longitudinal") for g in slopes])
    return [
        _coincide("TIMR paper, section 3", TIMR),
        Claim(
            "TIMR paper, section 3",
            "longitudinal jerk and longitudinal acceleration can not be zero at once",
            f"no jerk (normal and pitch) and no acceleration: {words}, {apart:.2f} times as much or more; "
            f"the longitudinal jerk vanishes nowhere between 0 and 250 N, at 0.5 rad at {along[-1]:.0f} N",
            graded(apart > 1.01 and bool(np.all((along < 0) | (along > 250)))),
            {f"jerk, {g:g}": F for g, F in at.items()} | {f"static, {g:g}": F for g, F in still.items()},
            assumption=STRAIGHT,
        ),
        Claim(
            "TIMR paper, section 3",
            "motion without jerk requires a positive longitudinal acceleration",
            f"{min(a_x):.2f} to {max(a_x):.2f} m/s² from {slopes[0]:g} to {slopes[-1]:g} rad, for the traction without "
            "normal and pitch jerk",
            graded(min(a_x) > 0),
            {"least": min(a_x), "most": max(a_x)},
            assumption=STRAIGHT,
        ),
    ]


def drive_figure() -> Sheet:
    """Return ASME Fig 4: a) the force without jerk and the one that holds, b) front and rear drive."""
    slopes = SLOPES[1:]
    rear, front = (np.array([Climber("asme_paper", d).changes(float(g)).zero("normal") for g in slopes])
                   for d in ("rear", "front"))  # fmt: skip
    hold = np.array([ASME.accelerations(float(g)).zero("normal") for g in slopes])
    figure, axes = panels("Traction without normal jerk, fronts on the slope (ASME Fig 4)", 1, 2, sharey=True,
                          figsize=(11, 4.6))  # fmt: skip
    for axis, lines in zip(axes.flat, ((("no jerk", rear), ("no acceleration", hold)),
                           (("rear drive", rear), ("front drive", front))), strict=True):  # fmt: skip
        for (name, values), colour in zip(lines, LINES, strict=False):
            axis.plot(slopes, values, color=colour, label=name)
        axis.plot(RAMP, 350, "k*") if lines[1][0] == "no acceleration" else None
        axis.set_xlabel("slope γ under the fronts / rad")
    axes[0, 0].plot([0.2, 0.2], [160, 70], "k*", label="as printed: 160, 70 and 350 N")
    axes[0, 0].set_ylabel("traction / N")
    for axis in axes.flat:
        axis.legend(frameon=False, fontsize=8)
    columns = {"gamma [rad]": slopes, "no jerk, rear drive [N]": rear, "no jerk, front drive [N]": front,
               "no acceleration, rear drive [N]": hold}  # fmt: skip
    return Sheet("Traction without normal jerk", columns, figure, (STRAIGHT,))


def _reading(where: str, text: str, printed: float, found: float, words: str) -> Claim:
    """Return the verdict on a force, N, that is read off a figure to tens."""
    off = found / printed - 1
    return Claim(where, text, f"{words} ({100 * off:+.0f} %)", graded(abs(found - printed) <= 5, abs(off) < 0.2),
                 {"found": found}, assumption=STRAIGHT)  # fmt: skip


def drive_claims() -> list[Claim]:
    """Return what the ASME paper reads off Fig 4."""
    jerk, hold = ASME.changes(0.2).zero("normal"), ASME.accelerations(0.2).zero("normal")
    ramp = ASME.changes(RAMP).zero("normal")
    where = "ASME paper, section 3"
    return [
        _reading(where, "at 0.2 an ideal total traction of 160 N avoids the onset of jerk", 160.0, jerk,
                 f"{jerk:.1f} N for normal and pitch jerk"),
        _reading(where, "of these about 70 N are the traction at zero acceleration", 70.0, hold,
                 f"{hold:.1f} N, m g (L_r/L) tan γ"),
        _reading(where, "and 90 N compensate the jerk", 90.0, jerk - hold, f"{jerk - hold:.1f} N"),
        _reading("ASME paper, section 4", "on a ramp of 25° the ideal traction is 350 N", 350.0, ramp, f"{ramp:.1f} N"),
        _choice(),
        _mirrored(),
    ]  # fmt: skip


def _zeros(climbs: str, slope: float) -> tuple[float, float]:
    """Return the tractions without normal jerk, N, with rear and with front drive."""
    rear, front = (Climber("asme_paper", drive, climbs).changes(slope).zero("normal") for drive in ("rear", "front"))
    return rear, front


def _choice() -> Claim:
    found = {g: _zeros("front", g) for g in (0.1, 0.2, RAMP)}
    less = all(_zeros("front", float(g))[1] < _zeros("front", float(g))[0] for g in np.linspace(0.2, 0.5, 7))
    apart = {g: 1 - front / rear for g, (rear, front) in found.items()}
    words = ", ".join(f"{front:.1f} against {rear:.1f} N at {g:.3g} rad" for g, (rear, front) in found.items())
    return Claim(
        "ASME paper, Fig 4b",
        "which axle is driven is unimportant below 0.2; above, front-wheel traction needs less",
        f"front against rear: {words}; "
        f"{100 * apart[0.1]:.1f}, {100 * apart[0.2]:.1f} and {100 * apart[RAMP]:.0f} % apart",
        graded(less and apart[0.2] < 0.1, less),
        {"rear, 0.2": found[0.2][0], "front, 0.2": found[0.2][1], "rear, 25": found[RAMP][0],
         "front, 25": found[RAMP][1]},
        assumption=STRAIGHT,
    )  # fmt: skip


def _mirrored() -> Claim:
    (rear, front), (rear_25, front_25) = _zeros("rear", 0.2), _zeros("rear", RAMP)
    return Claim(
        "ASME paper, Fig 4b",
        "the results are similar for the rear wheels on the same obstacle",
        f"rear drive {rear:.1f} and front drive {front:.1f} N at 0.2 rad, {rear_25:.1f} and {front_25:.1f} N at 25°: "
        f"similar forces, but now the rear drive needs less; the axle to drive is the one on the obstacle",
        graded(front_25 < rear_25, abs(rear_25 / _zeros("front", RAMP)[1] - 1) < 0.2),
        {"rear, 0.2": rear, "front, 0.2": front, "rear, 25": rear_25, "front, 25": front_25},
        assumption=STRAIGHT,
    )
