"""What a run tells those who watch it.  The master calls observers and knows nothing about what they do.

The order of the calls of one run::

    started
      accepted            number 0: the initial values, start == end
      rejected ...        any number of attempts that were taken back
      accepted            one accepted step
      event ...           components whose event that step ended at
      ...
    finished | failed

A step that was taken back is never seen as accepted: time in the accepted points only grows.

A compiled loop tells many accepted points at once, as a ``Block``; who does not care hears of them one by one.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from .system import System


@dataclass(frozen=True)
class RunInfo:
    """What was asked for: the macro step and the span in ns, and the algorithm spelt out."""

    step_ns: int
    stop_ns: int
    start_ns: int
    algorithm: str


class Point(NamedTuple):
    """A communication point that everybody reached.

    ``inputs`` and ``outputs`` hold, by component, the flat Float64 buffers ``u`` and ``y`` of the instances (the ports
    lie at ``u_at`` and ``y_at``): the inputs held over [start, end], the outputs at end.  ``row`` is all of them in one
    array, ``System.row``.  They are the live buffers, overwritten by the next step: copy what you keep.
    """

    number: int
    start: int  # ns
    end: int  # ns
    wall: float  # s of wall clock since the run began
    inputs: Mapping[str, np.ndarray]
    outputs: Mapping[str, np.ndarray]
    row: np.ndarray
    micro: int = 0  # of superdense time: 0, or the how manyth instant at ``end``, which then is ``start``, too


class Block(NamedTuple):
    """Accepted points in a row, as ``Point`` has them: n of each, ``rows`` (n, width of ``System.row``).

    The arrays are overwritten by the next block: copy what you keep.  ``places`` says where the buffer of (component,
    "input" or "output") lies in a row.
    """

    first: int  # number of the first point
    starts: np.ndarray  # (n,), ns
    ends: np.ndarray  # (n,), ns
    walls: np.ndarray  # (n,), s
    rows: np.ndarray  # (n, width)
    places: Mapping[tuple[str, str], slice]

    def until(self, n: int) -> Block:
        """Return the first *n* points."""
        return self._replace(starts=self.starts[:n], ends=self.ends[:n], walls=self.walls[:n], rows=self.rows[:n])

    def points(self) -> Iterator[Point]:
        """Yield the points one by one, as views of the rows."""
        names = list(dict.fromkeys(name for name, _ in self.places))
        for i, row in enumerate(self.rows):
            inputs = {name: row[self.places[name, "input"]] for name in names}
            outputs = {name: row[self.places[name, "output"]] for name in names}
            start, end, wall = int(self.starts[i]), int(self.ends[i]), float(self.walls[i])
            yield Point(self.first + i, start, end, wall, inputs, outputs, row)


@dataclass(frozen=True)
class Summary:
    """How a run went."""

    steps: int  # accepted, those cut at events included
    rejected: int
    events: int
    wall: float  # s
    simulated: float  # s
    terminated_by: str = ""  # the component that asked to end the run before its stop time


class Observer:
    """Base of all observers: does nothing; override what you want to know."""

    def started(self, system: System, info: RunInfo) -> None:
        """Tell that a run begins, before the components are initialised."""

    def accepted(self, point: Point) -> None:
        """Tell that everybody reached ``point.end``."""

    def accepted_block(self, block: Block) -> None:
        """Tell of several accepted points at once: nothing was rejected and no event lies between them."""
        if type(self).accepted is not Observer.accepted:  # else nobody looks: a third of a step of the rover
            for point in block.points():
                self.accepted(point)

    def rejected(self, start: int, end: int, reached: int, component: str) -> None:
        """Tell that [start, end] was taken back (all ns).

        Either *component* returned early, at *reached*; or ``reached == start``: ``PI`` found the error of one of its
        outputs (or of one of its bonds) above the tolerance.
        """

    def event(self, time: int, component: str) -> None:
        """Tell that everybody was brought to *time* (ns) for an event of *component*; follows that accepted point."""

    def finished(self, summary: Summary) -> None:
        """Tell that the run ended as it should."""

    def failed(self, error: BaseException) -> None:
        """Tell that the run broke off; everything accepted so far is valid."""
