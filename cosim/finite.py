"""Numbers that travel between components are finite: a run ends where one is not, and says whose it is.

An output that nobody takes may be what it likes: some FMUs show NaN for what they do not know.
"""

from __future__ import annotations

import numpy as np

from .clock import seconds
from .errors import StepError
from .system import System


class Finite:
    """Looks at what *system* shows."""

    def __init__(self, system: System) -> None:
        self._wires = tuple(c for c in system.connections if c.numeric)
        positions = [c.source.positions(system.place(c.source.component, c.source.variable)) for c in self._wires]
        self._at = np.concatenate([np.zeros(0, int), *positions])
        self._whose = np.repeat(np.arange(len(positions)), [len(p) for p in positions])

    def good(self, rows: np.ndarray) -> int:
        """Return how many of *rows*, each ``System.row`` at a point, come before the first with a bad number."""
        if np.isfinite(rows).all():  # quick, and nearly always so
            return len(rows)
        good = np.isfinite(rows[:, self._at]).all(axis=1)
        return len(rows) if good.all() else int(np.argmin(good))

    def error(self, row: np.ndarray, time: int) -> StepError:
        """Return what to say of a bad *row* at *time* in ns."""
        at = int(np.argmin(np.isfinite(row[self._at])))
        wire, value = self._wires[self._whose[at]], row[self._at[at]]
        source = wire.source
        name = source.variable.name
        if source.element is None:
            name = source.variable.labels()[int(np.sum(self._whose[:at] == self._whose[at]))]
        return StepError(
            source.component, seconds(time), f"its output {name} is {value:g}, which {wire.target.port} is to take"
        )
