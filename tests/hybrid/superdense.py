"""What runs with events are looked at with."""

from __future__ import annotations

import numpy as np

from cosim import Point, Record


class Superdense(Record):
    """A record that keeps the micro steps' numbers."""

    def __init__(self) -> None:
        super().__init__()
        self.micro: list[int] = []
        self.numbers: list[int] = []

    def accepted(self, point: Point) -> None:
        super().accepted(point)
        self.micro.append(point.micro)
        self.numbers.append(point.number)

    def when(self, port: str) -> np.ndarray:
        """Return the times in ns at which a clock ticks."""
        return self.time_ns[np.flatnonzero(self[port])]
