"""The static picture of a comparison: the decisive signals of all variants over time, units on every axis."""

from __future__ import annotations

import os
import secrets
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from logs.panels import DECISIVE, PANELS, Panel
from logs.style import colour

if TYPE_CHECKING:
    from .runner import Result

PER_ROW = 4  # variants in a row of the legend
APART = 10.0  # a peak so many times the median of all would flatten the other curves
NOISY = 0.6  # line width of a panel that would be one block of colour
SPELLING = {"m/s2": "m/s²"}


def drawable(results: list[Result]) -> bool:
    """Return whether any of the runs has a signal that a panel shows."""
    return any(p.read(r.signal) is not None for p in PANELS for r in results)


def draw(results: list[Result], path: Path) -> Path:
    """Draw all panels that any of the runs has signals for, the decisive ones first; returns the path of the PNG."""
    from matplotlib.figure import Figure  # for those who compare

    shown = [p for p in PANELS if any(p.read(r.signal) is not None for r in results)]
    rows = max(1, -(-len(shown) // 2))
    figure = Figure(figsize=(14, 2.3 * rows + 0.8), layout="constrained")  # pyplot would choose who shows it
    axes = figure.subplots(rows, 2, sharex=True, squeeze=False)
    for axis, panel in zip(axes.flat, shown, strict=False):
        _draw_panel(axis, panel, results)
    for axis in axes.flat[len(shown) :]:
        axis.set_visible(False)
    for axis in axes[-1]:
        axis.set_xlabel("time / s")
    handles, labels = axes.flat[0].get_legend_handles_labels()
    if len(labels) > 1:
        figure.legend(handles, labels, loc="outside lower center", ncols=min(len(labels), PER_ROW), frameon=False)
    names = list(dict.fromkeys(r.scenario.name for r in results))
    title = f"{names[0]}: {results[0].scenario.title}" if len(names) == 1 else f"Runs of {', '.join(names)}"
    figure.suptitle(title, x=0.01, ha="left", fontsize=12)
    part = path.with_suffix(f".{secrets.token_hex(4)}.png.part")
    try:
        figure.savefig(part, dpi=100, format="png")
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)
    return path


def _draw_panel(axis: Any, panel: Panel, results: list[Result]) -> None:
    """Draw one quantity of all runs: the first on top, since the others are compared to it."""
    width = 1.2 if panel in DECISIVE or panel.port != "chassis.acceleration" else NOISY
    peaks: list[float] = []
    for i, result in enumerate(results):
        values = panel.read(result.signal)
        if values is not None:
            tint = np.array(colour(i)) / 255
            axis.plot(result.record.time, values, color=tint, linewidth=width, alpha=0.9, label=result.scenario.variant)
            peaks.append(float(np.max(np.abs(values))))
    usual = float(np.median([p for p in peaks if p > 0] or [0.0]))
    wide = max(peaks) > APART * usual
    if wide:
        axis.set_yscale("symlog", linthresh=usual)
    axis.set_title(
        panel.title + (f"; logarithmic beyond {usual:.2g} {panel.unit}" if wide else ""), fontsize=10, loc="left"
    )
    axis.set_ylabel(SPELLING.get(panel.unit, panel.unit))
    axis.grid(alpha=0.3)
    axis.margins(x=0.01)
    if not wide:
        axis.ticklabel_format(axis="y", style="sci", scilimits=(-3, 4))
