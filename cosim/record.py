"""A run at hand: every input and output at every accepted point, as NumPy arrays or an xarray dataset.

It lies in memory while it is short; of a long one the older part lies in a temporary file, and only what is asked for
is read back.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from .clock import NS
from .errors import WiringError, nearest
from .observer import Block, Observer, Point, RunInfo, Summary
from .rows import LIMIT, Rows
from .variable import FLOAT, Variable

if TYPE_CHECKING:
    import xarray

    from .system import System


@dataclass(frozen=True)
class _Port:
    variable: Variable
    at: slice | None  # of the columns; None: not Float64
    values: list[Any]  # of a port that is not Float64


class Record(Observer):
    """Keeps what was accepted.  ``record["body.gap"]`` has the shape (points, *shape of the port).

    An input at a point is the value held over the step that ended there.  *names* keeps only these ports.  The
    older points of a long run lie in a temporary file, in the folder that TMPDIR names; where it takes no more, they
    stay in memory up to *limit* bytes.
    """

    def __init__(self, names: Iterable[str] | None = None, limit: int = LIMIT) -> None:
        self.names, self.limit = None if names is None else tuple(names), limit
        self._rows = Rows(2, limit)
        self._width = 0  # of the values in a row; behind them lie start and end of the step, in ns, bit by bit
        self.events: list[tuple[int, str]] = []  # (time in ns, component)
        self.rejections: list[tuple[int, int, int, str]] = []  # (start, end, reached, component)
        self.info: RunInfo | None = None
        self.summary: Summary | None = None
        self.error: BaseException | None = None
        self._ports: dict[str, _Port] = {}
        self._others: list[tuple[str, list[Any]]] = []  # the ports that are not Float64
        self._places: np.ndarray | None = None  # which values of a row are kept; None: all

    def started(self, system: System, info: RunInfo) -> None:
        self.info, self._system = info, system
        known = {
            f"{name}.{v.name}": (name, v)
            for name, instance in system.instances.items()
            for v in instance.variables.values()
            if v.causality in ("input", "output")
        }
        for port in self.names or ():
            if port not in known:
                raise WiringError(f"nothing to record is called {port!r}; {nearest(port, known)}")
        for port in self.names or known:
            name, v = known[port]
            self._ports[port] = _Port(v, system.place(name, v) if v.type == FLOAT else None, [])
        self._others = [(port, kept.values) for port, kept in self._ports.items() if kept.at is None]
        if self.names is not None:
            self._select()
        self._width = len(system.row) if self._places is None else len(self._places)
        self._rows = Rows(self._width + 2, self.limit)

    def _select(self) -> None:
        """Keep only the values of the ports recorded, in their order."""
        places, at = [np.zeros(0, int)], 0
        for port, kept in self._ports.items():
            if kept.at is not None:
                places.append(np.arange(kept.at.start, kept.at.stop))
                self._ports[port] = _Port(kept.variable, slice(at, at + len(places[-1])), kept.values)
                at += len(places[-1])
        self._places = np.concatenate(places)

    def accepted(self, point: Point) -> None:
        self._keep(point.row[None], (point.start,), (point.end,))
        for port, values in self._others:
            values.append(self._system[port])

    def accepted_block(self, block: Block) -> None:
        if self._others:
            super().accepted_block(block)
            return
        self._keep(block.rows, block.starts, block.ends)

    def _keep(self, rows: np.ndarray, starts: Sequence[int] | np.ndarray, ends: Sequence[int] | np.ndarray) -> None:
        """Copy points (n,): their rows (n, width of a row), starts and ends in ns."""
        ticks = np.array((starts, ends), np.int64).view(np.float64).T
        self._rows.extend(rows if self._places is None else rows[:, self._places], ticks)

    def rejected(self, start: int, end: int, reached: int, component: str) -> None:
        self.rejections.append((start, end, reached, component))

    def event(self, time: int, component: str) -> None:
        self.events.append((time, component))

    def finished(self, summary: Summary) -> None:
        self.summary = summary

    def failed(self, error: BaseException) -> None:
        self.error = error

    @property
    def points(self) -> list[tuple[int, int]]:
        """Start and end of every accepted step in ns, the first one being the start of the run."""
        return [(start, end) for start, end in self._tick(0, 2).tolist()]

    @property
    def time_ns(self) -> np.ndarray:
        """Ends of the accepted steps in ns, the start of the run first."""
        return self._tick(1, 2)[:, 0]

    @property
    def time(self) -> np.ndarray:
        """The same in s."""
        return self.time_ns / NS

    def _tick(self, first: int, last: int) -> np.ndarray:
        return self._rows.columns(slice(self._width + first, self._width + last)).view(np.int64)

    def __len__(self) -> int:
        return len(self._rows)

    def __contains__(self, port: object) -> bool:
        return port in self._ports

    def __iter__(self) -> Iterator[str]:
        """Yield the names of what is recorded, those that ``in`` knows; ``len`` counts points."""
        return iter(self.ports())

    def ports(self) -> tuple[str, ...]:
        """Return the names of what is recorded."""
        return tuple(self._ports)

    def __getitem__(self, port: str) -> np.ndarray:
        """Return a port's values over the run; raises WiringError if it was not recorded."""
        if port not in self._ports:
            raise WiringError(f"nothing called {port!r} was recorded; {nearest(port, self._ports)}")
        kept = self._ports[port]
        if kept.at is None:
            return np.array(kept.values)
        return self._rows.columns(kept.at).reshape(-1, *kept.variable.shape)

    def get(self, port: str) -> np.ndarray | None:
        """Return a port's values over the run, or None if it was not recorded."""
        return self[port] if port in self._ports else None

    def to_xarray(self) -> xarray.Dataset:
        """Return a dataset over ``time`` (s) with units; axes of arrays are called ``PORT.0``, ``PORT.1``, ..."""
        import xarray

        variables = {}
        for port, kept in self._ports.items():
            axes = [f"{port}.{axis}" for axis in range(len(kept.variable.shape))]
            about = {"long_name": kept.variable.meaning, "causality": kept.variable.causality}
            if kept.variable.unit is not None:
                about["units"] = kept.variable.unit
            variables[port] = (("time", *axes), self[port], about)
        attributes: dict[str, Any] = {}
        if self.info:
            attributes = {"algorithm": self.info.algorithm, "step_ns": self.info.step_ns}
        if self.error:
            attributes["failed"] = str(self.error)
        time = ("time", self.time, {"units": "s", "long_name": "simulated time"})
        return xarray.Dataset(variables, {"time": time, "time_ns": ("time", self.time_ns)}, attributes)
