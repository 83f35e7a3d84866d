"""Normal jerk over slope and traction, and what the traction without it depends on (DYMAC paper Figs 3 and 4)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from plants.planar import Bicycle, Posture
from plants.tables import Robot

from .claim import Claim, graded
from .jerk_case import STRAIGHT, Climber, flat
from .sheet import LINES, Sheet, panels

DYMAC = Climber("dymac_paper")
SPEED, PRINTED, SEVENTEEN = 2.0, 380.0, float(np.radians(17))  # m/s, N, rad
LEVELS = (-1.0, 0.0, 1.0, 2.0, 3.0)  # m/s3, of Fig 3
SHOWN = 1000.0  # N
WHERE = "DYMAC paper, 3.2"
# what Fig 4 varies: its panels, units and ranges, which the text does not give
VARIED = {
    "L_f": ("a) front axle to centre of mass", "m", (0.4, 1.2)),
    "L_r": ("b) rear axle to centre of mass", "m", (0.4, 1.2)),
    "h": ("c) height of the centre of mass", "m", (0.1, 0.7)),
    "m": ("d) mass", "kg", (50.0, 250.0)),
    "I_y": ("e) pitch moment of inertia", "kg.m2", (20.0, 100.0)),
    "v_x": ("f) speed", "m/s", (0.25, 3.0)),
}
POINTS = 12


def contour_figure() -> Sheet:
    """Return DYMAC Fig 3: the change of the normal acceleration with the slope, from -1 to 3 m/s3."""
    slopes, forces = np.linspace(-0.5, 0.5, 61), np.linspace(-SHOWN, SHOWN, 41)
    jerk = np.column_stack([DYMAC.changes(float(slope)).at(forces)[:, 1] for slope in slopes])
    figure, axes = panels("Normal jerk over slope and rear traction, 120 kg (DYMAC Fig 3)", figsize=(8.5, 4.8))
    axis = axes[0, 0]
    lines = axis.contour(slopes, forces, jerk, levels=LEVELS, colors=LINES[: len(LEVELS)])
    axis.clabel(lines, fontsize=8)
    axis.plot(0.3, PRINTED, "k*", markersize=10, label="0.3 rad, 380 N")
    axis.set(xlabel="slope γ under the fronts / rad", ylabel="rear traction / N")
    axis.legend(fontsize=8, loc="lower right")
    notes = ("contours in m/s³ for dγ/dt = 1 rad/s, which is not given; the zero line is free of it", STRAIGHT)
    return Sheet("Normal jerk over slope and traction", flat(slopes, forces, **{"J [m/s³]": jerk}), figure, notes)


def contour_claims() -> list[Claim]:
    """Return what the DYMAC paper says about Fig 3."""
    force, angle = DYMAC.changes(0.3).zero("normal"), DYMAC.changes(SEVENTEEN).zero("normal")
    rolling = DYMAC.changes(0.3, DYMAC.pitch_rate(0.3, SPEED)).zero("normal")
    down, hold = DYMAC.changes(-0.3).zero("normal"), DYMAC.accelerations(0.3).zero("normal")
    lost = [DYMAC.changes(g).zero("normal") for g in np.linspace(-0.5, -0.02, 25)]
    return [
        Claim(
            "DYMAC paper, 3.3",
            "jerk-free motion on 17° (0.3 rad) needs a traction of about 380 N",
            f"{force:.1f} N at 0.3 rad ({100 * (force / PRINTED - 1):+.0f} %), {angle:.1f} N at 17°, {rolling:.1f} "
            f"N with the pitch rate of a robot that climbs at 2 m/s; {hold:.1f} N hold it at rest",
            graded(abs(force - PRINTED) <= 5, abs(force / PRINTED - 1) < 0.1),
            {"0.3 rad": force, "17 degrees": angle, "climbing": rolling, "static": hold},
            assumption=STRAIGHT,
        ),
        Claim(
            "DYMAC paper, 3.1",
            "the traction without jerk is negative, braking, for negative profile angles",
            f"{down:.1f} N at -0.3 rad, and at all slopes from -0.5 to 0 rad",
            graded(max(lost) < 0),
            {"-0.3 rad": down},
            assumption=STRAIGHT,
        ),
    ]


def ideal(bot: Robot, slope: float, v_x: float = 0.0) -> float:
    """Return the traction, N, at which a_z does not change with the slope; at *v_x* with the pitch rate of a climb."""
    model, at = Bicycle(bot, "centre"), Posture(slope)
    return float(model.stationary_force(at, float(model.climbing_twist(at, v_x)[2])))


def series(name: str, slope: float = SEVENTEEN) -> tuple[list[float], list[float]]:
    """Return values of one of `VARIED` and the tractions, N, with them on a *slope* (rad)."""
    bot, values = DYMAC.model.robot, np.linspace(*VARIED[name][2], POINTS).tolist()
    if name == "v_x":
        return values, [ideal(bot, slope, v) for v in values]
    return values, [ideal(bot.with_changes(**{name: v}), slope) for v in values]


def properties_figure() -> Sheet:
    """Return DYMAC Fig 4: the traction over the dimensions and the speed of the robot, on 17 degrees."""
    figure, axes = panels("Traction without normal jerk at 17°, 120 kg (DYMAC Fig 4)", 3, 2, figsize=(10, 8))
    columns: dict[str, np.ndarray] = {}
    for axis, (name, (words, unit, _)) in zip(axes.flat, VARIED.items(), strict=True):
        values, force = series(name)
        columns |= {f"{name} [{unit}]": np.array(values), f"F({name}) [N]": np.array(force)}
        axis.plot(values, force, color=LINES[0])
        axis.set(title=words, xlabel=f"{name} / {unit}", ylabel="F / N")
        axis.title.set_size(9)
    note = "f) with the pitch rate of a robot that climbs; without it the traction does not depend on the speed"
    return Sheet("Traction without normal jerk over dimensions and speed", columns, figure, (note, STRAIGHT))


def _monotone(values: Sequence[float], direction: int) -> bool:
    return bool(np.all(direction * np.diff(values) > 0))


def _dips(values: Sequence[float]) -> bool:
    """Whether the values have a minimum between their ends."""
    return 0 < int(np.argmin(values)) < len(values) - 1


def _axles() -> Claim:
    front, rear = series("L_f")[1], series("L_r")[1]
    return Claim(
        WHERE,
        "the closer the centre of mass is to the rear axle, the less traction is needed to minimise the normal jerk",
        f"from {front[0]:.0f} N down to {front[-1]:.0f} N for L_f = 0.4 to 1.2 m, and from {rear[-1]:.0f} N down to "
        f"{rear[0]:.0f} N for L_r = 1.2 to 0.4 m",
        graded(_monotone(front, -1) and _monotone(rear, 1)),
        {"L_f 0.4": front[0], "L_f 1.2": front[-1], "L_r 0.4": rear[0], "L_r 1.2": rear[-1]},
        assumption=STRAIGHT,
    )


def _height() -> Claim:
    force, down = series("h")[1], series("h", -SEVENTEEN)[1]
    return Claim(
        WHERE,
        "the lower the centre of mass, the less traction is needed",
        f"more: {force[0]:.0f} N at h = 0.1 m and {force[-1]:.0f} N at 0.7 m. The printed order is that of the braking "
        f"on -17°: {down[0]:.0f} and {down[-1]:.0f} N",
        graded(_monotone(force, 1)),
        {"h 0.1": force[0], "h 0.7": force[-1], "down 0.1": down[0], "down 0.7": down[-1]},
        assumption=STRAIGHT,
    )


def _inertia() -> Claim:
    force = series("I_y")[1]
    growth = float(force[-1] / force[0] - 1)
    return Claim(
        WHERE,
        "the traction varies relatively little with the pitch moment of inertia",
        f"{100 * growth:+.1f} % from 20 to 100 kg.m2, {force[0]:.0f} to {force[-1]:.0f} N",
        graded(abs(growth) < 0.1),
        {"I_y 20": force[0], "I_y 100": force[-1]},
        assumption=STRAIGHT,
    )


def _speed() -> Claim:
    force = series("v_x")[1]
    return Claim(
        WHERE,
        "with the speed the traction decreases slightly to a minimum and increases from there on",
        f"no minimum: constant without a pitch rate, and {force[0]:.1f} to {force[-1]:.1f} N from 0.25 to 3 m/s with "
        "that of a climb, c0 + c2 v²",
        graded(_dips(force)),
        {"0.25 m/s": force[0], "3 m/s": force[-1]},
        assumption="pitch rate and v_z of a robot that climbs",
    )


def properties_claims() -> list[Claim]:
    """Return what the DYMAC paper says about Fig 4."""
    front, rear = (np.abs(series(name, -SEVENTEEN)[1]).tolist() for name in ("L_f", "L_r"))
    axles, height, inertia, speed = (make() for make in (_axles, _height, _inertia, _speed))
    only = Claim(
        WHERE,
        "that holds for positive gradients only",
        f"at -17° the braking falls from {front[0]:.0f} to {front[-1]:.0f} N for L_f = 0.4 to 1.2 m and rises from "
        f"{rear[0]:.0f} to {rear[-1]:.0f} N for L_r likewise",
        graded(not (_monotone(front, -1) and _monotone(rear, 1))),
        {"L_f 0.4": front[0], "L_f 1.2": front[-1], "L_r 0.4": rear[0], "L_r 1.2": rear[-1]},
        assumption=STRAIGHT,
    )
    return [axles, only, height, inertia, speed]
