"""The robot seen from its left at decisive instants: ground, body, wheels and contact forces, to scale in metres."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon

from logs.style import colour as tint
from plants.tables import G

from .runner import Result

_QUARTER, _LONGEST = 0.12, 0.5  # m, the arrow of a quarter of the weight, and the longest one


def instants(result: Result) -> dict[str, float]:
    """Return the times worth a look, in s, by what happens then; empty for a run that is no rover."""
    forces, gap = result.signal("wheels.normal_force"), result.signal("body.gap")
    if forces is None or gap is None or result.signal("body.wheel_centre") is None:
        return {}
    t = result.record.time
    found = {"start": float(t[0]), "largest front force": float(t[np.argmax(forces[:, :2].sum(axis=1))])}
    height = gap[:, :].max(axis=1)
    if np.max(height) > 1e-6:
        found["highest wheel"] = float(t[np.argmax(height)])
    found["end"] = float(t[-1])
    return dict(sorted(found.items(), key=lambda item: item[1]))


def sketch(results: list[Result], index: int = 0) -> Any:
    """Return a figure with a row per variant, a column per instant of variant *index*; None if there is no rover."""
    shown = [r for r in results if instants(r)]
    if not shown:
        return None
    moments = instants(shown[min(index, len(shown) - 1)])
    figure = Figure(figsize=(3.6 * len(moments), 2.5 * len(shown)), layout="constrained")
    axes = figure.subplots(len(shown), len(moments), squeeze=False)
    for i, (row, result) in enumerate(zip(axes, shown, strict=True)):
        colour = [c / 255 for c in tint(results.index(result))]
        for axis, (what, time) in zip(row, moments.items(), strict=True):
            _draw(axis, result, time, colour)
            if i == 0:
                axis.set_title(f"{what}: {time:.3f} s", fontsize=9)
        row[0].set_ylabel(result.scenario.variant or result.scenario.name, color=colour, fontsize=10)
    return figure


def _draw(axis: Any, result: Result, time: float, colour: list[float]) -> None:
    record, bot, ground = result.record, result.assembly.robot, result.assembly.ground
    assert bot is not None
    assert ground is not None
    at = int(np.argmin(np.abs(record.time - time)))
    centre = record["body.position"][at]
    view = max(bot.L, 0.8)
    x = np.linspace(centre[0] - view, centre[0] + view, 400)
    axis.fill_between(x, ground.left.elevation(x), ground.left.elevation(x) - 2, color="#d8d2c6", linewidth=0)
    pitch = float(np.ravel(record["body.pitch"][at])[0])
    c, s = np.cos(pitch), np.sin(pitch)
    hull = np.array(
        [(-bot.L_r - 0.08, -bot.h * 0.6), (bot.L_f + 0.08, -bot.h * 0.6), (bot.L_f + 0.08, 0), (-bot.L_r - 0.08, 0)]
    )
    axis.add_patch(Polygon(hull @ np.array([[c, s], [-s, c]]) + centre[[0, 2]], color=colour, alpha=0.55, linewidth=0))
    wheels, normals = record["body.wheel_centre"][at], record["body.contact_normal"][at]
    forces = result.signal("wheels.normal_force")
    assert forces is not None
    for k in (1, 3, 0, 2):  # the right side behind the left one
        axis.add_patch(Circle(wheels[k, [0, 2]], bot.R, facecolor="#3a3a40", edgecolor="white", linewidth=0.6))
        size = min(_LONGEST, 4 * _QUARTER * forces[at, k] / (bot.m * G))
        push = size * normals[k, [0, 2]]
        foot = wheels[k, [0, 2]] - bot.R * normals[k, [0, 2]]
        if size > 0.02:
            axis.annotate("", foot + push, foot, arrowprops={"arrowstyle": "-|>", "color": "#2f9e44", "linewidth": 1.6})
    level = float(np.mean(wheels[:, 2]))
    axis.set_xlim(centre[0] - view, centre[0] + view)
    axis.set_ylim(level - 0.45, level + 0.85)
    axis.set_aspect("equal")
    axis.set_xticks([])
    axis.set_yticks([])
    for side in axis.spines.values():
        side.set_visible(False)
