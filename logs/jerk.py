"""The jerk of a body that does not give it: difference quotients of the velocity that its accelerations add up to.

The acceleration is a mean over each step, of a robot on rubber rings, whose contacts shake it at hundreds of hertz.
Over a window of 10 ms, as the verdict takes it, what is left is what a passenger would call jerk.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import rerun as rr

from .drawing import Drawing
from .parts import Read
from .ports import index, scalars
from .style import colour

JERK = "derived/jerk"
WINDOW = 0.01  # s, on either side


class MeanJerk(Drawing):
    """The mean jerk at every step of a run that has ended; *time* and *signal* give the whole run."""

    def __init__(self, time: Callable[[], np.ndarray], signal: Read) -> None:
        self.time, self.signal = time, signal

    def finished(self, recording: Any) -> None:
        time, a = self.time(), self.signal("body.acceleration")
        if a is None:
            return
        at, values = jerk(time, a)
        if not len(at):
            return  # the run is shorter than the window
        colours, names = [colour(i) for i in range(3)], [f"{axis} [m/s3]" for axis in "xyz"]
        about = rr.AnyValues(signal_name=["x", "y", "z"], signal_unit="m/s3")
        recording.log(JERK, rr.SeriesLines(names=names, colors=colours, widths=[1.2] * 3), about, static=True)
        columns = index(np.round(time[at] * 1e9).astype(np.int64), at)
        recording.send_columns(JERK, columns, scalars(values))


def jerk(time: np.ndarray, acceleration: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the steps (m,) that have a whole window around them, and the jerk (m, 3) in m/s3 there.

    *time* (n,) in s, *acceleration* (n, 3) in m/s2, each the mean over the step that ends then.
    """
    gained = np.vstack([np.zeros(3), np.cumsum(acceleration[1:] * np.diff(time)[:, None], axis=0)])
    at = np.flatnonzero((time >= time[0] + WINDOW) & (time <= time[-1] - WINDOW))
    before, now, after = (
        np.column_stack([np.interp(time[at] + shift, time, column) for column in gained.T])
        for shift in (-WINDOW, 0.0, WINDOW)
    )
    return at, (after - 2 * now + before) / WINDOW**2
