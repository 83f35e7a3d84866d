"""What a figure or a table is: a picture, its data as columns, and what to know when reading it."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

LINES = ("#1f5ac8", "#d6281e", "#2b8a3e", "#e08a00", "#7a3fb0", "#555555")


@dataclass(frozen=True)
class Sheet:
    """A figure and its data: columns of equal length, their names with units."""

    title: str
    columns: dict[str, np.ndarray]
    figure: Figure
    notes: tuple[str, ...] = ()

    def save(self, path: Path) -> None:
        """Write the picture as *path*.png and the data as *path*.csv."""
        self.figure.savefig(path.with_suffix(".png"), dpi=110)
        with path.with_suffix(".csv").open("w", newline="", encoding="utf-8") as file:
            csv.writer(file).writerows([self.columns, *zip(*self.columns.values(), strict=True)])


def panels(title: str, rows: int = 1, columns: int = 1, **given: Any) -> tuple[Figure, np.ndarray]:
    """Return a figure with a title and its axes (rows, columns)."""
    size = given.pop("figsize", (5.2 * columns + 1, 2.6 * rows + 0.8))
    figure = Figure(figsize=size, layout="constrained")  # pyplot would choose who shows it
    figure.suptitle(title, x=0.01, ha="left", fontsize=11)
    axes = figure.subplots(rows, columns, squeeze=False, **given)
    for axis in axes.flat:
        axis.grid(alpha=0.3)
    return figure, axes
