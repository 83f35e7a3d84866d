"""The ports of an FMI 3.0 FMU that is used with event mode: which can be set and read when.

In step mode only continuous ports are set and read.  Everything else waits for event mode; a clocked variable waits
there until one of its clocks ticks.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from cosim import Variable, WiringError
from cosim.variable import CLOCK, FLOAT

from .binding import WARNING
from .clock_calls import ClockCalls
from .clocks import TRIGGERED, Clock, Schedule, exact
from .fmi3 import Fmu3
from .importer import Archive, is_discrete

BEFORE, EVENT, STEP = "before", "event", "step"


class _Part:
    """Some of the Float64 inputs or outputs: how to hand them over, and where they lie in the buffer of all."""

    def __init__(self, fmu: DiscreteFmu3, variables: Iterable[Variable], at: dict[str, slice]) -> None:
        chosen = list(variables)
        self.places = np.concatenate(
            [np.zeros(0, int)] + [np.arange(at[v.name].start, at[v.name].stop) for v in chosen]
        )
        self.values = np.zeros(len(self.places))
        self.arguments = fmu._transfer(tuple(chosen), self.values)


class DiscreteFmu3(Fmu3):
    """An instance some of whose ports change at events only; ``event_mode.EventFmu3`` handles the events."""

    def __init__(self, archive: Archive, name: str) -> None:
        self.discrete = frozenset(n for n, v in archive.variables.items() if is_discrete(v))
        self.clocks = archive.clocks
        self._begin()
        self._clocks = ClockCalls(self.clocks, self._call)
        based = tuple(c for c in self.clocks.values() if c.causality == "input" and c.kind != TRIGGERED)
        self.schedule = Schedule(based, self._clocks.interval, self._clocks.shift)
        self._other_outputs = tuple(
            v for v in archive.variables.values() if v.causality == "output" and v.type not in (FLOAT, CLOCK)
        )
        super().__init__(archive, name)

    def _begin(self) -> None:
        self.active = frozenset()
        self._mode = BEFORE
        self._others: dict[str, Any] = {}  # values of the discrete ports that are not Float64
        self._waiting: set[str] = set()  # those of the inputs among them that the FMU has not been given
        self._pending = False  # an event waits where the FMU is

    def _prepare(self) -> None:
        self._parts: dict[Any, _Part] = {}
        self._push = self._pull = ()  # of all at once, which is not allowed
        held = [np.arange(self.u_at[n].start, self.u_at[n].stop) for n in self.u_at if n in self.discrete]
        self._held_at = np.concatenate([np.zeros(0, int), *held])
        self._held = self.u[self._held_at]

    # values

    def _open(self, variable: Variable) -> bool:
        """Whether a port can be set or read now."""
        if self._mode == STEP:
            return variable.name not in self.discrete
        if self._mode == BEFORE:
            return variable.causality == "input" or not variable.clocks
        return not variable.clocks or not self.active.isdisjoint(variable.clocks)

    def _part(self, ports: tuple[Variable, ...], at: dict[str, slice]) -> _Part:
        key = (at is self.u_at, self._mode, self.active if self._mode == EVENT else None)
        if key not in self._parts:
            self._parts[key] = _Part(self, filter(self._open, ports), at)
        return self._parts[key]

    def push(self) -> None:
        """Hand over what can be set now; discrete values that changed in step mode make an input event."""
        if self._polynomials:
            self._polynomials.coefficients = []
        part = self._part(self.inputs, self.u_at)
        if part.arguments:
            self.u.take(part.places, out=part.values)
            if (status := self._set_float(*part.arguments)) > WARNING:
                self._fail("fmi3SetFloat64", status)
        if self._mode == STEP:
            self._pending |= not np.array_equal(self.u[self._held_at], self._held, equal_nan=True)
            return
        self._held = self.u[self._held_at]
        for name in sorted(self._waiting):
            if self._open(self.variables[name]):
                self._write(self.archive.references[name], self.variables[name], self._others[name])
                self._waiting.discard(name)

    def pull(self) -> None:
        """Fill ``y`` with what can be read now, and ``active`` with the output clocks that tick."""
        if self._mode == EVENT and self._clocks.outputs:
            inputs = frozenset(c for c in self.active if self.clocks[c].causality == "input")
            self.active = inputs | self._clocks.ticking()
        part = self._part(self.outputs, self.y_at)
        if part.arguments:
            if (status := self._get_float(*part.arguments)) > WARNING:
                self._fail("fmi3GetFloat64", status)
            self.y[part.places] = part.values
        for variable in self._other_outputs if self._mode != STEP else ():
            if self._open(variable):
                self._others[variable.name] = self._read(self.archive.references[variable.name], variable)

    def set(self, name: str, value: Any) -> None:
        """Set one variable: discrete inputs are handed over in event mode, a clock takes its interval in s."""
        variable = self.variable(name)
        if variable.type == CLOCK:
            self._set_interval(self.clocks[name], value)
        elif self._mode != BEFORE and name in self.discrete and variable.causality == "input":
            if variable.type == FLOAT:
                self.u[self.u_at[name]] = np.ravel(np.broadcast_to(value, variable.shape))
            elif name not in self._others or not np.array_equal(self._others[name], value):
                self._others[name] = value
                self._waiting.add(name)
            self._pending |= self._mode == STEP and (name in self._waiting or variable.type == FLOAT)
        else:
            super().set(name, value)
            if name in self.discrete and variable.type != FLOAT:
                self._others[name] = value

    def get(self, name: str) -> Any:
        """Return one variable: a discrete port as it was when it could last be read, a clock as whether it ticks."""
        variable = self.variable(name)
        if variable.type == CLOCK:
            return name in self.active
        if variable.causality not in ("input", "output"):
            return super().get(name)
        for buffer, places in ((self.u, self.u_at), (self.y, self.y_at)):
            if name in places:
                return (
                    buffer[places[name]].reshape(variable.shape).copy()
                    if variable.shape
                    else float(buffer[places[name]][0])
                )
        return self._others.get(name, variable.start)

    # clocks

    def tick(self, clocks: Iterable[str]) -> None:
        """Let input clocks tick at this instant."""
        new = sorted(set(clocks) - self.active)
        if new:
            self._clocks.tick(new)
            self.active = self.active | frozenset(new)

    def _set_interval(self, clock: Clock, interval: float) -> None:
        if clock.kind not in ("fixed", "tunable") or clock.period is None or self._mode != BEFORE:
            raise WiringError(
                f"the interval of the {clock.kind} clock {self.name}.{clock.name} cannot be set; only that of a fixed "
                f"or tunable clock which declares one can, before the initialisation"
            )
        self.schedule.periods[clock.name] = exact(interval)
