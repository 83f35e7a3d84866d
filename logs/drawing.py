"""What is drawn into a log beside the series of its ports: a scene, states, maps, a diagram."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from cosim.system import System

from .parts import Read, by_parts


class Drawing:
    """Something that is drawn while a run goes; does nothing by itself."""

    def started(self, recording: Any, system: System) -> None:
        """Draw what does not move."""

    def emit(self, recording: Any, ns: np.ndarray, step: np.ndarray, read: Read) -> None:
        """Draw a chunk of n steps that end at *ns*, numbered *step*; *read* gives a port's values in it, (n, ...)."""

    def finished(self, recording: Any) -> None:
        """Draw what is known only when the run has ended, or failed."""


class Drawings(Drawing):
    """Several at once."""

    def __init__(self, parts: Sequence[Drawing]) -> None:
        self.parts = tuple(parts)

    def started(self, recording: Any, system: System) -> None:
        for part in self.parts:
            part.started(recording, system)

    def emit(self, recording: Any, ns: np.ndarray, step: np.ndarray, read: Read) -> None:
        for part in self.parts:
            part.emit(recording, ns, step, by_parts(read))

    def finished(self, recording: Any) -> None:
        for part in self.parts:
            part.finished(recording)


__all__ = ["Drawing", "Drawings", "Frames", "Read", "nice"]


class Frames:
    """Chooses the steps that are drawn: the first, and then one as soon as *interval* (s) has passed."""

    def __init__(self, interval: float) -> None:
        self.interval = round(interval * 1e9)
        self._next = -(2**62)

    def of(self, ns: np.ndarray) -> np.ndarray:
        """Return the positions in *ns* to draw, (k,)."""
        chosen: list[int] = []
        at = int(np.searchsorted(ns, self._next))
        while at < len(ns):
            chosen.append(at)
            self._next = int(ns[at]) + self.interval
            at = int(np.searchsorted(ns, self._next))
        return np.array(chosen, int)


def summed(before: Any, more: np.ndarray) -> np.ndarray:
    """Return the sums of all *before* and of the rows of *more* up to each, (n, ...), in the order of the rows.

    The clock decides where a run is cut into chunks: what adds up goes on with the same roundings wherever that is.
    """
    return np.cumsum(np.concatenate([np.asarray(before)[None], more]), axis=0)[1:]


def nice(value: float) -> float:
    """Return the next of 1, 2, 5, 10, ... that is not below *value* (above 0)."""
    decade = 10.0 ** np.floor(np.log10(value))
    return float(next(m * decade for m in (1, 2, 5, 10) if m * decade >= value * (1 - 1e-9)))
