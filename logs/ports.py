"""The ports of the components as log entities: what each is called, and a chunk of their values on its way to the file.

A Float64 port goes into the log bit by bit.  One of another type is logged as it is (``value_int32``,
``value_string``, ...), and where it is a number also as a series to plot.
"""

from __future__ import annotations

import fnmatch
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import rerun as rr

from cosim.instance import Instance
from cosim.observer import Point
from cosim.system import System
from cosim.variable import FLOAT, Variable

from .style import WHEEL_COLOURS, WHEELS, Colour, colour

EXACT = "value_"  # begins the component that holds the values of a port that is not Float64
_TEXT = ("String", "Binary")
_TYPES = {"Float32": np.float32, "Boolean": np.bool_, "Enumeration": np.int64, "String": str, "Binary": bytes}


def chosen(
    instances: Mapping[str, Instance], patterns: Iterable[str], causality: str = "output"
) -> dict[str, Variable]:
    """Return the ports by name (``wheels.normal_force``) that match any of *patterns*; all, if there are none."""
    patterns = tuple(patterns)
    return {
        port: v
        for name, instance in instances.items()
        for v in instance.variables.values()
        if v.causality == causality and v.type != "Clock" and v.size
        if (port := f"{name}.{v.name}") and (not patterns or any(fnmatch.fnmatch(port, p) for p in patterns))
    }


def entity(port: str, causality: str = "output") -> str:
    """Return where a port lies in the log: ``plant/wheels/normal_force``, ``plant/wheels/in/gap``."""
    component, _, name = port.partition(".")
    spelt = [rr.escape_entity_path_part(part) for part in (component, name)]
    return f"plant/{spelt[0]}/{'in/' if causality == 'input' else ''}{spelt[1]}"


def index(ns: np.ndarray, step: np.ndarray) -> list[Any]:
    """Return the two timelines as columns; integers, since a float duration would be truncated to ns."""
    return [rr.TimeColumn("sim_time", duration=ns.astype("timedelta64[ns]")), rr.TimeColumn("step", sequence=step)]


def scalars(values: np.ndarray) -> Any:
    """Return columns of series, *values* (n, width)."""
    return rr.Scalars.columns(scalars=values.ravel()).partition(np.full(len(values), values.shape[1]))


def describe(recording: Any, path: str, v: Variable, port: str) -> None:
    """Write what does not change about a port: names with units, shape, meaning."""
    unit = v.unit or "1"
    labels = v.labels()
    if v.type not in _TEXT:
        style(recording, path, labels, unit)
    recording.log(path, rr.AnyValues(signal_name=labels, signal_unit=unit, signal_shape=list(v.shape) or [0], port=port,
                                     meaning=v.meaning, signal_type=v.type), static=True)  # fmt: skip


def style(recording: Any, path: str, labels: list[str], unit: str) -> None:
    """Name the series of an entity, each with its unit, and give them colours."""
    names = [f"{label} [{unit}]" if unit != "1" else label for label in labels]
    colours: list[Colour] = [colour(i) for i in range(len(names))]
    if len(names) == len(WHEELS):
        colours = list(WHEEL_COLOURS)
    recording.log(path, rr.SeriesLines(names=names, colors=colours, widths=[1.2] * len(names)), static=True)


@dataclass(frozen=True)
class _Port:
    """One port and, if it is Float64, where it lies in its component's buffer."""

    name: str
    entity: str
    variable: Variable
    at: slice


class Chunk:
    """The rows of all ports between two flushes; its memory is allocated once."""

    def __init__(self, system: System, patterns: tuple[str, ...], rows: int) -> None:
        self.n, self.rows = 0, rows
        self.ns, self.step = np.empty(rows, np.int64), np.empty(rows, np.int64)
        self._system = system
        self._buffers: dict[tuple[str, str], np.ndarray] = {}
        self._ports: dict[str, _Port] = {}
        self._others: dict[str, list[Any]] = {}
        self.logged: list[_Port] = []
        for name, instance in system.instances.items():
            for causality, width in (("input", len(instance.u)), ("output", len(instance.y))):
                self._buffers[name, causality] = np.empty((rows, width))
                places = instance.u_at if causality == "input" else instance.y_at
                wanted = chosen({name: instance}, patterns, causality)
                for port, v in chosen({name: instance}, (), causality).items():
                    held = _Port(port, entity(port, causality), v, places.get(v.name, slice(0, 0)))
                    self._ports[port] = held
                    if port in wanted:
                        self.logged.append(held)
                        if v.type != FLOAT:
                            self._others[port] = []

    def append(self, point: Point) -> None:
        """Copy what everybody shows at *point*."""
        n = self.n
        self.ns[n], self.step[n] = point.end, point.number
        for (name, causality), buffer in self._buffers.items():
            buffer[n] = (point.inputs if causality == "input" else point.outputs)[name]
        for port, values in self._others.items():
            values.append(self._system[port])
        self.n = n + 1

    def read(self, port: str) -> np.ndarray | None:
        """Return the buffered values (n, *shape) of a Float64 port, logged or not, or None."""
        held = self._ports.get(port)
        if held is None or held.variable.type != FLOAT:
            return None
        name = port.partition(".")[0]
        rows = self._buffers[name, held.variable.causality][: self.n, held.at]
        return rows.reshape(self.n, *held.variable.shape)

    def send(self, send: Callable[[str, Any], None]) -> None:
        """Hand the columns of every logged port to *send*, by entity."""
        for held in self.logged:
            if held.variable.type == FLOAT:
                name = held.name.partition(".")[0]
                send(held.entity, scalars(self._buffers[name, held.variable.causality][: self.n, held.at]))
                continue
            rows = [np.ravel(np.asarray(v, dtype=object)) for v in self._others[held.name]]
            flat = [_typed(v, held.variable.type) for row in rows for v in row]
            lengths = np.array([len(row) for row in rows])
            send(held.entity, rr.AnyValues.columns(**{_component(held.variable): flat}).partition(lengths))
            if held.variable.type not in _TEXT:
                send(held.entity, rr.Scalars.columns(scalars=[float(v) for v in flat]).partition(lengths))

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
