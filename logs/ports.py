"""The ports of the components as log entities: what each is called, and a chunk of their values on its way to the file.

A Float64 port goes into the log bit by bit.  One of another type is logged as it is (``value_int32``,
``value_string``, ...), and where it is a number also as a series to plot.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from copy import copy
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyarrow as pa
import rerun as rr

from cosim.instance import Instance
from cosim.observer import Block, Point
from cosim.system import System
from cosim.variable import FLOAT, Variable

from .parts import like
from .style import WHEEL_COLOURS, WHEELS, Colour, colour

EXACT = "value_"  # begins the component that holds the values of a port that is not Float64
_TEXT = ("String", "Binary")
_SCALARS = next(iter(rr.Scalars.columns(scalars=[0.0]))).component_descriptor()
_TYPES = {
    "Float32": np.float32, "Boolean": np.bool_, "Clock": np.bool_, "Enumeration": np.int64, "String": str,
    "Binary": bytes,
}  # fmt: skip


def chosen(
    instances: Mapping[str, Instance], patterns: Iterable[str], causality: str = "output"
) -> dict[str, Variable]:
    """Return the ports by name (``wheels.normal_force``) that match any of *patterns*; all, if there are none."""
    found = {
        f"{name}.{v.name}": v
        for name, instance in instances.items()
        for v in instance.variables.values()
        if v.causality == causality and v.size
    }
    return {port: found[port] for port in like(found, patterns)}


def entity(port: str, causality: str = "output") -> str:
    """Return where a port lies in the log: ``plant/wheels/normal_force``, ``plant/wheels/in/gap``."""
    component, _, name = port.partition(".")
    spelt = [rr.escape_entity_path_part(part) for part in (component, name)]
    return f"plant/{spelt[0]}/{'in/' if causality == 'input' else ''}{spelt[1]}"


def index(ns: np.ndarray, step: np.ndarray) -> list[Any]:
    """Return the two timelines as columns; integers, since a float duration would be truncated to ns."""
    return [rr.TimeColumn("sim_time", duration=ns.astype("timedelta64[ns]")), rr.TimeColumn("step", sequence=step)]


def scalars(values: np.ndarray) -> list[rr.ComponentColumn]:
    """Return columns of series, *values* (n, width)."""
    return _series(values.ravel(), values.shape[1])


def _series(values: np.ndarray, width: int) -> list[rr.ComponentColumn]:
    """Return columns of series from row-major values; Rerun's own way there copies and counts, at twice the price."""
    offsets = np.arange(0, len(values) + 1, width, dtype=np.int32)
    return [rr.ComponentColumn(_SCALARS, _Batch(values), offsets=offsets)]


class _Batch:
    """Values as Rerun asks for them, not copied."""

    def __init__(self, values: np.ndarray) -> None:
        self.values = values

    def as_arrow_array(self) -> pa.Array:
        return pa.array(self.values)


def describe(recording: Any, path: str, v: Variable, port: str) -> None:
    """Write what does not change about a port: names with units, shape, meaning."""
    unit = v.unit or "1"
    labels = v.labels()
    about = rr.AnyValues(signal_name=labels, signal_unit=unit, signal_shape=list(v.shape) or [0], port=port,
                         meaning=v.meaning, signal_type=v.type)  # fmt: skip
    recording.log(path, *([style(labels, unit)] if v.type not in _TEXT else []), about, static=True)


def style(labels: list[str], unit: str) -> rr.SeriesLines:
    """Return the names of the series of an entity, each with its unit, and their colours."""
    names = [f"{label} [{unit}]" if unit != "1" else label for label in labels]
    colours: list[Colour] = [colour(i) for i in range(len(names))]
    if len(names) == len(WHEELS):
        colours = list(WHEEL_COLOURS)
    return rr.SeriesLines(names=names, colors=colours, widths=[1.2] * len(names))


@dataclass(frozen=True)
class _Port:
    """One port and, if it is Float64, where it lies in the row of its system."""

    name: str
    entity: str
    variable: Variable
    at: slice | None


class Chunk:
    """The rows of all ports on their way to the file; its memory is allocated once."""

    def __init__(self, system: System, patterns: tuple[str, ...], rows: int) -> None:
        self.n, self.rows = 0, rows
        self._system = system
        self._ports: dict[str, _Port] = {}
        self._others: dict[str, list[Any]] = {}
        self.logged: list[_Port] = []
        for name, instance in system.instances.items():
            for causality in ("input", "output"):
                wanted = chosen({name: instance}, patterns, causality)
                for port, v in chosen({name: instance}, (), causality).items():
                    at = system.place(name, v) if v.type == FLOAT else None
                    held = _Port(port, entity(port, causality), v, at)
                    self._ports[port] = held
                    if port in wanted:
                        self.logged.append(held)
                        if v.type != FLOAT:
                            self._others[port] = []
        # of each port a row is one item, which is faster than number by number
        self._whole = {p.name: np.empty(rows, f"V{8 * p.variable.size}") for p in self.logged if p.at is not None}
        self._allocate()

    def _allocate(self) -> None:
        self._row = np.empty((self.rows, len(self._system.row)))
        self._start, self._ns, self._step = (np.empty(self.rows, np.int64) for _ in range(3))
        self._wall, self._before = np.empty(self.rows), 0.0  # s

    def another(self) -> Chunk:
        """Return an empty chunk to be filled while this one is sent; both send from the same memory."""
        other = copy(self)
        other.n, other._others = 0, {port: [] for port in self._others}
        other._allocate()
        return other

    @property
    def numeric(self) -> bool:
        """Whether all that is logged lies in the row of the system."""
        return not self._others

    @property
    def full(self) -> bool:
        """Whether it takes no more."""
        return self.n == self.rows

    def append(self, point: Point) -> None:
        """Copy what everybody shows at *point*."""
        n = self.n
        self._row[n] = point.row
        self._start[n], self._ns[n], self._step[n], self._wall[n] = point.start, point.end, point.number, point.wall
        for port, values in self._others.items():
            values.append(self._system[port])
        self.n = n + 1

    def extend(self, block: Block, first: int) -> int:
        """Copy the points of a numeric *block* from *first* on, as many as there is room for; return how many."""
        n = min(len(block.rows) - first, self.rows - self.n)
        mine, its = slice(self.n, self.n + n), slice(first, first + n)
        self._row[mine] = block.rows[its]
        self._start[mine], self._ns[mine], self._wall[mine] = block.starts[its], block.ends[its], block.walls[its]
        self._step[mine] = np.arange(block.first + first, block.first + first + n)
        self.n += n
        return n

    @property
    def ns(self) -> np.ndarray:
        """Ends of the buffered steps in ns."""
        return self._ns[: self.n]

    @property
    def step(self) -> np.ndarray:
        """Their numbers."""
        return self._step[: self.n]

    def durations(self) -> dict[str, np.ndarray]:
        """Return how long each step is and how long it took, by name with unit."""
        size = (self._ns[: self.n] - self._start[: self.n]) * 1e-9
        return {"step_size [s]": size, "wall [s]": np.diff(self._wall[: self.n], prepend=self._before)}

    def read(self, port: str) -> np.ndarray | None:
        """Return the buffered values (n, *shape) of a Float64 port, logged or not, or None."""
        held = self._ports.get(port)
        if held is None or held.at is None:
            return None
        return self._row[: self.n, held.at].reshape(self.n, *held.variable.shape)

    def send(self, send: Callable[[str, Any], None]) -> None:
        """Hand the columns of every logged port to *send*, by entity; they are overwritten by the next chunk sent."""
        for held in self.logged:
            if held.at is not None:
                whole = self._whole[held.name][: self.n]
                whole[:] = self._row[: self.n, held.at].view(whole.dtype)[:, 0]
                send(held.entity, _series(whole.view(np.float64), held.variable.size))
                continue
            rows = [np.ravel(np.asarray(v, dtype=object)) for v in self._others[held.name]]
            flat = [_typed(v, held.variable.type) for row in rows for v in row]
            lengths = np.array([len(row) for row in rows])
            send(held.entity, rr.AnyValues.columns(**{_component(held.variable): flat}).partition(lengths))
            if held.variable.type not in _TEXT:
                send(held.entity, rr.Scalars.columns(scalars=[float(v) for v in flat]).partition(lengths))

    def follow(self, before: Chunk) -> None:
        """Go on where a chunk ends: the first step's wall time counts from its last."""
        self._before = before._wall[before.n - 1]

    def clear(self) -> None:
        """Forget the rows, keep the memory."""
        self.n = 0
        for values in self._others.values():
            values.clear()


def _component(v: Variable) -> str:
    """Return what the values of a port are called in the log: Rerun knows one type only for each name."""
    return f"{EXACT}{v.type.lower()}"


def _typed(value: Any, type_name: str) -> Any:
    kind = _TYPES.get(type_name) or np.dtype(type_name.lower()).type
    return kind(value)
