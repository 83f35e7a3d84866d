"""Named instances and the wires between them: who is connected to what, and the values under way.

The system knows no algorithm.  ``feed`` gives a component its inputs from the latest outputs of all, ``collect`` takes
its outputs; in which order that happens is the business of an algorithm.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from types import TracebackType
from typing import Any

import numpy as np

from .algorithms import Algorithm
from .errors import CouplingError, WiringError, nearest
from .event_location import located
from .initialize import initialize
from .instance import Instance
from .variable import CLOCK, FLOAT, Variable
from .wiring import Connection, End, Link, wire


@dataclass(frozen=True)
class Inlet:
    """The wires into one component: ``u[targets] = factor * values[sources] + offset``, and what is not Float64."""

    targets: np.ndarray
    sources: np.ndarray
    factor: np.ndarray | None  # None: no wire converts
    offset: np.ndarray
    complete: bool  # every element is driven, in order
    others: tuple[Connection, ...]


@dataclass(frozen=True)
class Saved:
    """Where a system was: what ``System.restore`` needs to go back there."""

    time: dict[str, int]
    values: np.ndarray
    others: dict[tuple[str, str], Any]
    snapshots: dict[str, Any]
    memory: dict[Any, Any]


class System:
    """Instances by name, connected; owns the values that travel.

    ``connections`` maps targets to sources (see ``wiring``).  ``every`` maps a component to the number of macro steps
    that it takes in one: with 4 it steps once, over all four, when the others have done the fourth.  ``events``
    maps outputs to what they do at an event, which then is located (see ``event_location``).  The names given here
    become the names of the instances.  A system runs once; ``close``, or ``with``, closes its instances.

    ``row`` is what everybody shows: the buffers of all, inputs first, that of (component, causality) at ``places``.
    ``memory`` is what algorithms remember of the past, values that are not changed in place: it is taken back, too.
    """

    def __init__(
        self,
        instances: Mapping[str, Instance],
        connections: Mapping[str, str | Link | Mapping[str, Any]],
        *,
        every: Mapping[str, int] | None = None,
        events: Mapping[str, str] | None = None,
    ) -> None:
        self.instances = located(instances, events or {})
        self.names = tuple(self.instances)
        for name, instance in self.instances.items():
            if not name or "." in name:
                raise WiringError(f"a component cannot be named {name!r}: ports are written component.port")
            instance.name = name
        self.every = self._every(every or {})
        self.connections = wire(self.instances, connections)
        self.unconnected = self._unconnected()
        self.time: dict[str, int] = {}  # ns, per component; empty until initialised
        self.memory: dict[Any, Any] = {}  # of algorithms, by theirs: what they found out here, and what lies behind
        self.row, self.places = self._bind()
        self._values = self.row[sum(len(i.u) for i in self.instances.values()) :]  # the outputs of all
        self._others: dict[tuple[str, str], Any] = {}
        self._inlets = {name: self._inlet(name) for name in self.names}
        self._some: dict[tuple[str, ...], Inlet] = {}  # into some ports of a component, made when first asked for
        self._travelling = {
            name: tuple({c.source.variable.name for c in self.connections
                         if c.source.component == name and not c.numeric and c.source.variable.type != CLOCK})
            for name in self.names
        }  # fmt: skip

    def _bind(self) -> tuple[np.ndarray, dict[tuple[str, str], slice]]:
        """Put all buffers, inputs first, into one array; return it and where each lies."""
        places, at = {}, 0
        for causality in ("input", "output"):
            for name, instance in self.instances.items():
                size = len(instance.u if causality == "input" else instance.y)
                places[name, causality] = slice(at, at + size)
                at += size
        row = np.zeros(at)
        for name, instance in self.instances.items():
            instance.bind(row[places[name, "input"]], row[places[name, "output"]])
        return row, places

    def _every(self, every: Mapping[str, int]) -> dict[str, int]:
        for name, n in every.items():
            if name not in self.instances:
                raise WiringError(f"every names no component {name!r}; {nearest(name, self.names)}")
            if not isinstance(n, int) or isinstance(n, bool) or n < 1:
                raise WiringError(f"{name} cannot step every {n!r} macro steps; give a whole number, at least 1")
        return {name: every.get(name, 1) for name in self.names}

    def _unconnected(self) -> tuple[str, ...]:
        driven: dict[tuple[str, str], set[int]] = {}
        for c in self.connections:
            elements = range(c.target.variable.size) if c.target.element is None else (c.target.element,)
            driven.setdefault((c.target.component, c.target.variable.name), set()).update(elements)
        found: list[str] = []
        for name, instance in self.instances.items():
            for v in instance.variables.values():
                if v.causality == "input" and (v.type != CLOCK or v.interval == "triggered"):
                    have = driven.get((name, v.name), set())
                    labels = v.labels() if have else [v.name]
                    found += [f"{name}.{label}" for i, label in enumerate(labels) if i not in have]
        return tuple(found)

    def _inlet(self, name: str, ports: Iterable[str] | None = None) -> Inlet:
        """Index arrays of the wires into a component: into some of its ports, or all that do not wait for events."""
        u_at, waiting = self.instances[name].u_at, self.instances[name].discrete
        wires = [c for c in self.connections if c.target.component == name and c.target.variable.type != CLOCK]
        wires = [
            c for c in wires if (v := c.target.variable.name) in (ports or ()) or (ports is None and v not in waiting)
        ]
        numeric = [(c, c.target.positions(u_at[c.target.variable.name])) for c in wires if c.numeric]
        empty = np.zeros(0, int)
        targets = np.concatenate([empty] + [p for _, p in numeric])
        sources = np.concatenate([empty] + [self._source(c) for c, _ in numeric])
        factor = np.concatenate([np.zeros(0)] + [np.full(len(p), c.factor) for c, p in numeric])
        offset = np.concatenate([np.zeros(0)] + [np.full(len(p), c.offset) for c, p in numeric])
        by_target = np.argsort(targets, kind="stable")
        targets, sources, factor, offset = targets[by_target], sources[by_target], factor[by_target], offset[by_target]
        plain = bool(np.all(factor == 1) and np.all(offset == 0))
        complete = len(targets) == len(self.instances[name].u)
        others = tuple(c for c in wires if not c.numeric)
        return Inlet(targets, sources, None if plain else factor, offset, complete, others)

    def _source(self, connection: Connection) -> np.ndarray:
        end = connection.source
        first = self.places[end.component, "output"].start - (len(self.row) - len(self._values))
        return end.positions(self.instances[end.component].y_at[end.variable.name]) + first

    # values

    def feed(self, name: str, ports: Iterable[str] | None = None) -> None:
        """Set a component's connected inputs (or only *ports*) from the latest outputs collected."""
        inlet = self._inlets[name]
        if ports is not None:
            key = (name, *ports)
            inlet = self._some[key] = self._some.get(key) or self._inlet(name, key[1:])
        instance = self.instances[name]
        if inlet.factor is not None:
            instance.u[inlet.targets] = inlet.factor * self._values[inlet.sources] + inlet.offset
        elif inlet.complete:  # "clip" never clips here: it spares take a buffer
            self._values.take(inlet.sources, out=instance.u, mode="clip")
        elif len(inlet.targets):
            instance.u[inlet.targets] = self._values[inlet.sources]
        for c in inlet.others:
            instance.set(c.target.variable.name, c.passed(self._others[c.source.component, c.source.variable.name]))
        instance.push()

    def collect(self, name: str) -> None:
        """Take a component's outputs: from here on they are what others are fed."""
        instance = self.instances[name]
        instance.pull()  # into our own array
        for port in self._travelling[name]:
            self._others[name, port] = instance.get(port)

    @property
    def values(self) -> np.ndarray:
        """The part of ``row`` that holds the outputs of all, as last collected."""
        return self._values

    def inlet(self, name: str) -> Inlet:
        """Return the wires into a component; the sources count in ``values``."""
        return self._inlets[name]

    def other(self, end: End) -> Any:
        """Return the value of an output that is not Float64, as last collected."""
        return self._others[end.component, end.variable.name]

    @property
    def numeric(self) -> bool:
        """Whether all that travels is Float64."""
        return not any(self._travelling.values())

    def place(self, name: str, variable: Variable) -> slice:
        """Return where a Float64 input or output of a component lies in ``row``."""
        instance, start = self.instances[name], self.places[name, variable.causality].start
        at = (instance.u_at if variable.causality == "input" else instance.y_at)[variable.name]
        return slice(start + at.start, start + at.stop)

    def __getitem__(self, port: str) -> Any:
        """Return the value of a port, ``system["body.gap"]``: as last fed or collected; arrays are copies."""
        name, _, variable = port.partition(".")
        if name not in self.instances:
            raise WiringError(f"{port!r} names no component; {nearest(name, self.names)}")
        instance = self.instances[name]
        v = instance.variable(variable)
        for buffer, at in ((instance.u, instance.u_at), (instance.y, instance.y_at)):
            if v.type == FLOAT and variable in at:
                return buffer[at[variable]].reshape(v.shape).copy() if v.shape else float(buffer[at[variable]][0])
        return instance.get(variable)

    # life

    def initialize(self, start: int = 0, stop: int | None = None, tolerance: float | None = None) -> None:
        """Initialise every component at tick *start*, outputs propagated in the order the feedthroughs ask for.

        Algebraic loops are solved.  Raises CouplingError for one without a solution, and for a system that has run.
        """
        if self.time:
            raise CouplingError("this system has been initialised before; build a new one from new instances")
        initialize(self, start, stop, tolerance)
        self.time = dict.fromkeys(self.names, start)

    def save(self, names: Iterable[str]) -> Saved:
        """Return what is needed to take *names* back to now; ``forget`` it when done."""
        snapshots = {name: self.instances[name].snapshot() for name in names}
        return Saved(self.time.copy(), self._values.copy(), self._others.copy(), snapshots, self.memory.copy())

    def restore(self, saved: Saved, names: Iterable[str]) -> None:
        """Take *names* (those that stepped since) back to where they were saved."""
        for name in names:
            self.instances[name].restore(saved.snapshots[name])
        self.time.update(saved.time)
        self._values[:] = saved.values
        self._others.update(saved.others)
        self.memory = saved.memory.copy()

    def forget(self, saved: Saved) -> None:
        """Free what ``save`` returned."""
        for name, snapshot in saved.snapshots.items():
            self.instances[name].forget(snapshot)

    def delays(self, algorithm: Algorithm) -> dict[str, int]:
        """Return for each connection, by its target, the steps of delay that *algorithm* implies: 0 or 1.

        0: over its step the target holds the value its source has at the end of it; 1: the one at the beginning.
        What is set at events only is passed on at the instant it changes: 0.
        Both count in macro steps; a source that steps every n of them holds its values in between.
        """
        return {
            c.target.port: 0 if c.target.variable.name in self.instances[c.target.component].discrete
            else algorithm.delay(self, c.source.component, c.target.component)
            for c in self.connections
        }  # fmt: skip

    def _repr_html_(self) -> str:
        from .show import system_html

        return system_html(self)

    def close(self) -> None:
        """Close every instance, also when closing one of them fails."""
        failures = []
        for instance in self.instances.values():
            try:
                instance.close()
            except Exception as error:
                failures.append(error)
        if failures:
            raise failures[0]

    def __enter__(self) -> System:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()
