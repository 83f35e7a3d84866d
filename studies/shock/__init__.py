"""The shock response of the chassis (thesis chapters 7 and 8, the shock paper), and what a co-simulated collision adds.

`FIGURES` names the figures and tables: each is a function of modal data that returns a `Sheet`, figure and data.
`claims.judged` gives a verdict on each claim; `collision` drives the chassis by the wheel forces of a run.
"""

from __future__ import annotations

from collections.abc import Callable

from plants.chassis_modes import ModalData
from studies.figures.sheet import Sheet

from .loads import coefficients_figure, integral_figure, pulses_figure
from .modes import frequencies_figure, shapes_figure
from .paper import amplitudes_figure, factors_figure, station_figure, table_1
from .participation import participation_figure
from .responses import cutoff_figure, durations_figure, map_figure, methods_figure, spectra_figure

FIGURES: dict[str, Callable[[ModalData], Sheet]] = {
    "7.3": lambda data: integral_figure(),
    "8.2": frequencies_figure,
    "8.3-8.5": shapes_figure,
    "8.6": lambda data: pulses_figure(),
    "8.7-8.8": lambda data: coefficients_figure(),
    "8.9": lambda data: map_figure(data, ("single",), 0.05),
    "8.10": lambda data: map_figure(data, ("single",), 0.08),
    "8.11": durations_figure,
    "8.12": lambda data: map_figure(data, ("diagonal",), 0.05),
    "8.13": lambda data: participation_figure(data, ("single", "diagonal")),
    "8.14": lambda data: map_figure(data, ("four", "diagonal"), 0.05),
    "8.15": lambda data: participation_figure(data, ("diagonal", "four")),
    "methods": methods_figure,
    "cut-off": cutoff_figure,
    "spectra": spectra_figure,
    "paper table 1": table_1,
    "paper 3": lambda data: amplitudes_figure(),
    "paper 4": lambda data: factors_figure(),
    "paper 5": station_figure,
}

__all__ = ["FIGURES", "Sheet"]
