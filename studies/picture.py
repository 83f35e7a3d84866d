"""The static picture of a comparison: the decisive signals of all variants over time, units on every axis."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt

if TYPE_CHECKING:
    from .runner import Result

COLOURS = ("#1f78d1", "#f08020", "#2a9d4a", "#a83ec4", "#c0392b", "#7f6a55")  # variant A blue, B orange, ...

# title, unit, what is drawn (n,) from the signals of a run
Panel = tuple[str, str, Callable[["Result"], "np.ndarray | None"]]


def _port(name: str, column: int | slice | None = None, scale: float = 1.0) -> Callable[[Result], np.ndarray | None]:
    def read(result: Result) -> np.ndarray | None:
        values = result.signal(name)
        if values is None:
            return None
        picked = values if column is None else values[:, column]
        return scale * (picked.sum(axis=1) if isinstance(column, slice) else picked)

    return read


PANELS: tuple[Panel, ...] = (
    ("normal force, front axle", "N", _port("wheels.normal_force", slice(0, 2))),
    ("normal force, rear axle", "N", _port("wheels.normal_force", slice(2, 4))),
    ("deformation, front left (below 0: pressed)", "mm", _port("wheels.deformation", 0, 1e3)),
    ("traction, rear axle", "N", _port("wheels.traction", slice(2, 4))),
    ("vertical speed of the centre of mass", "m/s", _port("body.velocity", 2)),
    ("pitch (nose up)", "deg", _port("body.pitch", None, 180 / np.pi)),
    ("forward speed", "m/s", _port("body.velocity_body", 0)),
    ("acceleration at station 1", "m/s²", _port("chassis.acceleration", 0)),
)


def draw(results: list[Result], path: Path) -> Path:
    """Draw all panels that any of the runs has signals for; returns the path of the PNG."""
    present = [p for p in PANELS if any(p[2](r) is not None for r in results)]
    rows = -(-len(present) // 2)
    figure, axes = plt.subplots(rows, 2, figsize=(14, 2.6 * rows), sharex=True, layout="constrained", squeeze=False)
    for axis, (title, unit, read) in zip(axes.flat, present, strict=False):
        for result, colour in zip(results, COLOURS, strict=False):
            values = read(result)
            if values is not None:
                axis.plot(
                    result.record.time, values, color=colour, linewidth=1.1, alpha=0.85, label=result.scenario.variant
                )
        axis.set_title(title, fontsize=10, loc="left")
        axis.set_ylabel(unit)
        axis.grid(alpha=0.3)
        axis.ticklabel_format(axis="y", style="sci", scilimits=(-3, 4))
    for axis in axes.flat[len(present) :]:
        axis.set_visible(False)
    for axis in axes[-1]:
        axis.set_xlabel("time / s")
    handles, labels = axes.flat[0].get_legend_handles_labels()
    if len(labels) > 1:
        figure.legend(handles, labels, loc="outside upper right", ncols=len(labels), frameon=False)
    scenario = results[0].scenario
    figure.suptitle(f"{scenario.name}: {scenario.title}", x=0.01, ha="left", fontsize=12)
    figure.savefig(path, dpi=110)
    plt.close(figure)
    return path
