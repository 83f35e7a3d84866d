"""The pitch rows of the verdict: how closely a planned pitch was followed, and what is off where the plan ends."""

from __future__ import annotations

import numpy as np

from .metric import Metric, Signals


def figures(time: np.ndarray, read: Signals, obstacle: float | None = None) -> list[Metric]:
    """Return the rows of a run; their values are None without a pitch plan, or where the run ends before it does."""
    error, active, rate = read("controller.pitch_error"), read("controller.active"), read("body.rate")
    largest = arrival = turning = None
    if error is not None and active is not None and rate is not None and np.any(active > 0.5):
        on = np.ravel(active) > 0.5
        largest = 1e3 * float(np.max(np.abs(error[on])))
        last = int(np.flatnonzero(on)[-1])
        if 0 < last < len(on) - 1:  # a controller's row holds what it saw at the point before
            arrival, turning = 1e3 * float(abs(error[last])), 1e3 * float(abs(rate[last - 1, 1]))
    return [
        Metric("pitch_error", "largest error of the planned pitch", "mrad", "lower", largest),
        Metric("pitch_arrival_error", "error of the pitch where the plan ends", "mrad", "lower", arrival),
        Metric("pitch_arrival_rate", "pitch rate where the plan ends at rest", "mrad/s", "lower", turning),
    ]
