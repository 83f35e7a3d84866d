"""Events across a system: at one instant, values and clocks travel between those in event mode until nothing changes.

Only instances with ``can.event_mode`` take part.  A micro step is an instant (t, i) of superdense time: clocks tick,
inputs are set and outputs read until they agree; then the discrete states are updated, which begins (t, i + 1).  Whom a
changed value or a ticking clock reaches enters event mode at the same instant; all leave it together.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from .clock import seconds
from .errors import CouplingError, WiringError
from .variable import CLOCK

if TYPE_CHECKING:
    from .system import System
    from .wiring import Connection

MAX_PASSES = 100  # over the connections in one micro step
MAX_MICRO_STEPS = 1000  # at one time
MAX_CROWDED = 1000  # time events in a row, each within a nanosecond of the one before


@dataclass(frozen=True)
class _Wires:
    """The connections into one member."""

    values: tuple[Connection, ...]
    clocks: tuple[Connection, ...]


class EventMode:
    """The event iteration of a system; *members* are those of its instances that have an event mode."""

    def __init__(self, system: System) -> None:
        self.system = system
        self.members = tuple(name for name in system.names if system.instances[name].can.event_mode)
        self.terminated = ""  # who asked to end the run
        self._wires = {name: self._wires_of(name) for name in self.members}
        self._outputs = {name: tuple(v for v in system.instances[name].variables.values() if v.causality == "output")
                         for name in self.members}  # fmt: skip
        self._present: list[str] = []  # members that are not in the midst of a step over several
        self._opened: list[str] = []  # those of them who are in event mode
        self._touched: set[str] = set()  # those of them whose discrete states are to be updated
        self._before: dict[str, list[np.ndarray]] = {}  # what the wires carried when the events began
        self._moving: dict[str, None] = {}  # ports that changed last
        self._stiff = [name for name, i in system.instances.items() if not i.can.variable_step]
        self._micro = self.rounds = self._crowded = 0

    def _wires_of(self, name: str) -> _Wires:
        mine = [c for c in self.system.connections if c.target.component == name]
        clocks = tuple(c for c in mine if c.target.variable.type == CLOCK)
        for c in clocks:
            if (kind := c.target.variable.interval) not in ("", "triggered"):
                raise WiringError(
                    f"{c.target.port} is a {kind} clock, which ticks by itself; "
                    f"connect {c.source.port} to a triggered one"
                )
        return _Wires(tuple(c for c in mine if c.target.variable.type != CLOCK), clocks)

    def next(self, now: int, end: int) -> int:
        """Return where a step from *now* to *end* has to end for time events and clocks: at *end* or before.

        Raises CouplingError if time events follow each other nanosecond by nanosecond, and for an instance that needs
        steps of equal length.
        """
        asked, by = end, ""
        for name in self.members:
            time = self.system.instances[name].next_event()
            if time is not None and time < end:
                end, by = max(time, now + 1), name
        if by and self._stiff:
            raise CouplingError(
                f"{self._stiff[0]} needs steps of equal length, but {by} has an event at t = {seconds(end):.9f} s; "
                f"choose a macro step that the times of its events are multiples of"
            )
        self._crowded = self._crowded + 1 if end <= now + 1 < asked else 0
        if self._crowded > MAX_CROWDED:
            raise CouplingError(
                f"the time events of {by} do not let time go on: {MAX_CROWDED} of them, each a nanosecond after the "
                f"one before, ended at t = {seconds(now):.9f} s"
            )
        return end

    def settle(self, time: int) -> Iterator[int]:
        """Handle the events at *time* of all who have one, or a discrete input to take; yield the micro steps' numbers.

        A micro step is yielded where something shows: a value changed or a clock ticked.  Raises CouplingError for
        events that do not come to an end.
        """
        self._micro = self.rounds = 0
        self._present = [name for name in self.members if self.system.time[name] == time]
        while chosen := {name for name in self._present if self._due(name, time) or self._outdated(name)}:
            yield from self._iterate(time, chosen)
            if self.terminated:
                return

    def _due(self, name: str, time: int) -> bool:
        next_event = self.system.instances[name].next_event()
        return next_event is not None and next_event <= time

    def _outdated(self, name: str) -> bool:
        """Whether a discrete input does not hold what its source shows; clocked ones are set when their clock ticks."""
        instance = self.system.instances[name]
        for c in self._wires[name].values:
            v = c.target.variable
            if v.name in instance.discrete and not v.clocks:
                at = instance.u_at.get(v.name)
                held = instance.get(v.name) if at is None else instance.u[c.target.positions(at)]
                if not _same(held, c.passed(self._carried(c))):
                    return True
        return False

    def _carried(self, c: Connection) -> Any:
        """Return what the source of a connection shows."""
        source = self.system.instances[c.source.component]
        at = source.y_at.get(c.source.variable.name)
        return self.system.other(c.source) if at is None else source.y[c.source.positions(at)]

    # the iteration

    def _iterate(self, time: int, chosen: set[str]) -> Iterator[int]:
        """Bring *chosen*, and whom they reach, through their events."""
        self._before = {name: [np.copy(self._carried(c)) for c in self._wires[name].values] for name in self.members}
        self._opened, self._touched = [], set()
        for name in self._present:
            if name in chosen:
                self._open(name)
        shows = False
        while True:
            if self._agree(time) or shows:
                self._micro += 1
                yield self._micro
            if not self._touched:
                break
            self.rounds += 1
            if self.rounds > MAX_MICRO_STEPS:
                raise self._endless(time, f"{MAX_MICRO_STEPS} micro steps")
            shows = self._update()
            if self.terminated:
                if shows:
                    self._micro += 1
                    yield self._micro
                return
        for name in self._opened:
            self.system.instances[name].enter_step_mode()

    def _open(self, name: str) -> None:
        self.system.instances[name].enter_event_mode()
        self._opened.append(name)
        self._touched.add(name)

    def _update(self) -> bool:
        """Update the discrete states of those that something happened to; return whether anybody shows it."""
        touched, self._touched = self._touched, set()
        for name in [n for n in self._opened if n in touched]:
            update = self.system.instances[name].update_discrete_states()
            if update.again:
                self._touched.add(name)
            if update.terminated:
                self.terminated = name
        return any([self._collect(name) for name in self._opened if name in touched])

    def _agree(self, time: int) -> bool:
        """Pass values and clocks until all who are in event mode agree; return whether anything changed or ticks."""
        shows = any(self.system.instances[name].active for name in self._opened)
        for _ in range(MAX_PASSES):
            changed = self._reach()
            for name in self._opened:
                changed |= self._feed(name)
                changed |= self._collect(name)
            if not changed:
                break
            shows = True
        else:
            raise self._endless(time, f"{MAX_PASSES} passes over the connections")
        # a clock ticks until the next update, also one that the last update made tick
        self._touched |= {name for name in self._opened if self.system.instances[name].active}
        return shows

    def _reach(self) -> bool:
        """Bring those into event mode whom a changed value or a ticking clock has reached."""
        reached = [name for name in self._present if name not in self._opened and self._is_reached(name)]
        for name in reached:
            self._open(name)
        return bool(reached)

    def _is_reached(self, name: str) -> bool:
        wires = self._wires[name]
        return any(self._ticks(c) for c in wires.clocks) or any(
            c.source.component in self._opened and not _same(self._carried(c), before)
            for c, before in zip(wires.values, self._before[name], strict=True)
        )

    def _ticks(self, c: Connection) -> bool:
        return c.source.variable.name in self.system.instances[c.source.component].active

    def _feed(self, name: str) -> bool:
        """Let clocks tick and set the inputs that can be set; return whether that changed any."""
        instance, wires = self.system.instances[name], self._wires[name]
        clocks = {c.target.variable.name for c in wires.clocks if self._ticks(c)} - instance.active
        if clocks:
            instance.tick(clocks)
        variables = {c.target.variable.name: c.target.variable for c in wires.values}
        ports = tuple(n for n, v in variables.items() if not v.clocks or not instance.active.isdisjoint(v.clocks))
        others = [n for n in ports if n not in instance.u_at]
        before = instance.u.copy(), [instance.get(n) for n in others]
        self.system.feed(name, ports)
        if not clocks and _same(before[0], instance.u) and all(map(_same, before[1], map(instance.get, others))):
            return False
        self._touched.add(name)
        return True

    def _collect(self, name: str) -> bool:
        """Take what a member shows; return whether it shows anything else than before."""
        before = self._shown(name)
        self.system.collect(name)
        after = self._shown(name)
        moved = [n for n, value in after.items() if not _same(before[n], value) and not self._ended(name, n, value)]
        if moved:
            others = (port for port in self._moving if not port.startswith(f"{name}."))
            self._moving = dict.fromkeys([*others, *(f"{name}.{n}" for n in moved)])
        return bool(moved)

    def _ended(self, name: str, port: str, value: Any) -> bool:
        """Whether a port is a clock that has ceased to tick, which changes nothing."""
        return self.system.instances[name].variables[port].type == CLOCK and not value

    def _shown(self, name: str) -> dict[str, Any]:
        """Return the outputs of a member, clocks as whether they tick."""
        instance = self.system.instances[name]
        return {
            v.name: instance.y[instance.y_at[v.name]].copy() if v.name in instance.y_at else instance.get(v.name)
            for v in self._outputs[name]
        }

    def _endless(self, time: int, much: str) -> CouplingError:
        ports = ", ".join(self._moving) or f"the discrete states of {', '.join(sorted(self._touched))}"
        return CouplingError(
            f"the events at t = {seconds(time):.9f} s do not come to an end: after {much} {ports} "
            f"still change; let one of them change at the tick of a clock only, or give it a hysteresis"
        )


def _same(a: Any, b: Any) -> bool:
    """Whether two values are equal; one that is no number is equal to itself."""
    a, b = np.ravel(a), np.ravel(b)
    numbers = a.dtype.kind == "f" and b.dtype.kind == "f"
    return bool(np.array_equal(a, b, equal_nan=numbers))
