"""A row of the verdict, and what all rows are computed with."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

FRONT, REAR = slice(0, 2), slice(2, 4)
GRIP = 100.0  # coefficient of friction, from which it counts as unlimited

Signals = Callable[[str], "np.ndarray | None"]  # a port's values (n, ...) by name, or None if the run has no such port


@dataclass(frozen=True)
class Metric:
    """One row of the verdict table."""

    key: str
    label: str
    unit: str
    better: str  # "lower", "higher" or "" where neither is
    value: float | None  # None: the run has no such signal


def rms_over_time(time: np.ndarray, values: np.ndarray) -> float:
    """Return the root mean square of *values* (n,) over *time* (n,), s."""
    span = time[-1] - time[0]
    return float(np.sqrt(np.trapezoid(values**2, time) / span)) if span > 0 else float(np.abs(values[-1]))


def held(time: np.ndarray, flags: np.ndarray) -> float:
    """Return for how long *flags* (n, at the end of each step) were true, in s."""
    return float(np.sum(np.diff(time)[np.asarray(flags, bool)[1:]]))


def unlimited(limit: np.ndarray, normal: np.ndarray) -> bool:
    """Return whether friction has no limit, from that limit and the normal force (n, 4), N."""
    return bool(np.max(limit) >= GRIP * np.max(normal) > 0)
