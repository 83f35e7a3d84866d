"""The force at which a_z does not change with the slope, over the dimensions and the speed (the second Fig 4.8)."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from plants.planar import Bicycle, Posture

from .claim import Claim, graded
from .entry import Entry
from .sheet import LINES, Sheet, panels
from .traction import ROBOT, SPEED, STATES

STEEP = np.radians(17)
# what the second Fig 4.8 varies: panel, unit, range
VARIED = {
    "L_f": ("a", "m", np.linspace(0.3, 1.0, 36)), "L_r": ("b", "m", np.linspace(0.2, 0.8, 31)),
    "h": ("c", "m", np.linspace(0.1, 0.7, 31)), "m": ("d", "kg", np.linspace(50.0, 300.0, 26)),
    "I_y": ("e", "kg.m2", np.linspace(20.0, 100.0, 41)), "v": ("f", "m/s", np.linspace(0.25, 3.0, 56)),
}  # fmt: skip


def varied(name: str, values: Iterable[float], state: str = "no pitch rate") -> np.ndarray:
    """Return the force, N, at which a_z is stationary in the slope of 17 degrees, for values of one dimension or v."""
    found = []
    for value in values:
        bot = ROBOT if name == "v" else ROBOT.with_changes(**{name: float(value)})
        model = Bicycle(bot, "centre")
        v = float(value) if name == "v" else SPEED
        found.append(model.stationary_force(Posture(STEEP), float(STATES[state](model, STEEP, v)[2])))
    return np.array(found)


def dimensions_figure() -> Sheet:
    """Return the second Fig 4.8: the ideal force over the dimensions and the speed, at 17 degrees."""
    figure, axes = panels("Force at which a_z is stationary, 17 degrees (Fig 4.8 a-f)", 2, 3, figsize=(12, 6))
    rows: dict[str, list[np.ndarray]] = {k: [] for k in ("varied", "value", "no pitch rate [N]", "climbing, 2 m/s [N]")}
    for axis, (name, (panel, unit, values)) in zip(axes.flat, VARIED.items(), strict=True):
        still, climb = varied(name, values), varied(name, values, "climbing")
        axis.plot(values, still, color=LINES[0], label="no pitch rate")
        axis.plot(values, climb, color=LINES[1], label="climbing" if name == "v" else "climbing at 2 m/s")
        axis.set(title=f"{panel}) {name}", xlabel=f"{name} / {f'({unit})' if '/' in unit else unit}")
        for column, part in zip(rows.values(), (np.full(len(values), name), values, still, climb), strict=True):
            column.append(part)
    for axis in axes[:, 0]:
        axis.set_ylabel("rear traction / N")
    axes[0, 0].legend(frameon=False, fontsize=8)
    notes = (
        "the thesis numbers two figures 4.8; they contradict each other about the speed: this one has a minimum, the "
        "other grows from 0.5 m/s on",
        "(4.54) with gamma' = 0, 1, 2, 5 1/m gives no minimum over the speed either",
    )
    return Sheet("Force over dimensions", {k: np.concatenate(c) for k, c in rows.items()}, figure, notes)


def dimensions_claims() -> list[Claim]:
    """Return the verdicts on the second Fig 4.8."""
    found = {name: varied(name, values) for name, (_, _, values) in VARIED.items()}
    ends = {name: (float(f[0]), float(f[-1])) for name, f in found.items()}
    climb = varied("v", VARIED["v"][2], "climbing")
    low, high = VARIED["v"][2][[0, -1]]
    sagging = bool(np.min(climb) < min(climb[0], climb[-1]))
    slight = ends["I_y"][1] / ends["I_y"][0] - 1
    assumed = "force at which a_z is stationary in gamma, no pitch rate: (4.54) cannot be evaluated (see Fig 4.7)"
    return [
        Claim(
            "4.6", "the closer the centre of mass to the rear axle, the less traction it takes (a, b)",
            f"{_ends(ends, 'L_f')} as L_f grows, {_ends(ends, 'L_r')} as L_r grows",
            graded(bool(np.all(np.diff(found["L_f"]) < 0) and np.all(np.diff(found["L_r"]) > 0))),
            {"L_f": ends["L_f"][1] - ends["L_f"][0], "L_r": ends["L_r"][1] - ends["L_r"][0]}, assumption=assumed,
        ),
        Claim(
            "4.6", "the lower the centre of mass, the less traction it takes (c)",
            f"the more: {_ends(ends, 'h')} from h = 0.1 to 0.7 m", graded(bool(np.all(np.diff(found["h"]) > 0))),
            {"0.1": ends["h"][0], "0.7": ends["h"][1]}, assumption=assumed,
        ),
        Claim(
            "4.6", "the moment of inertia matters little (e)", f"{100 * slight:+.0f} % from 20 to 100 kg.m2",
            graded(abs(slight) < 0.1), {"I_y": slight}, assumption=assumed,
        ),
        Claim(
            "4.6", "over the speed it falls slightly to a minimum, then grows (f)",
            f"{climb[0]:.0f} to {climb[-1]:.0f} N from {low:g} to {high:g} m/s, growing all the way; without pitch rate"
            " the same at every speed", graded(sagging), {"0.25": float(climb[0]), "3": float(climb[-1])},
            assumption=assumed.replace("no pitch rate", "climbing"),
        ),
    ]  # fmt: skip


def _ends(ends: dict[str, tuple[float, float]], name: str) -> str:
    return "{:.0f} to {:.0f} N".format(*ends[name])


ENTRIES = (
    Entry("thesis 4.8 dimensions", "ideal force over dimensions and speed", dimensions_figure, dimensions_claims),
)
