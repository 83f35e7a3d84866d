"""The functions of FMI 3.0 about clocks, one instance's."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from ctypes import byref, c_bool, c_double, c_int, c_size_t, c_uint32, c_uint64, c_void_p
from fractions import Fraction
from math import isfinite
from typing import Any

from .clocks import Clock, exact

_MANY = (c_void_p, c_void_p, c_size_t)
CLOCK_PROTOTYPES: dict[str, tuple[Any, ...]] = {
    "fmi3GetClock": (*_MANY, c_void_p),
    "fmi3SetClock": (*_MANY, c_void_p),
    "fmi3GetIntervalDecimal": (*_MANY, c_void_p, c_void_p),
    "fmi3GetIntervalFraction": (*_MANY, c_void_p, c_void_p, c_void_p),
    "fmi3GetShiftDecimal": (*_MANY, c_void_p),
    "fmi3GetShiftFraction": (*_MANY, c_void_p, c_void_p),
    "fmi3SetIntervalDecimal": (*_MANY, c_void_p),
}


class ClockCalls:
    """Clocks by name, and *call*, which calls a C function of the instance and raises for its status."""

    def __init__(self, clocks: Mapping[str, Clock], call: Callable[..., None]) -> None:
        self.clocks, self._call = clocks, call
        self.outputs = tuple(c for c in clocks.values() if c.causality == "output")

    def tick(self, names: Iterable[str]) -> None:
        """Let input clocks tick."""
        references, n = _references(self.clocks[name] for name in names)
        self._call("fmi3SetClock", references, n, (c_bool * n)(*[True] * n))

    def ticking(self) -> frozenset[str]:
        """Return the output clocks that tick."""
        references, n = _references(self.outputs)
        ticking = (c_bool * n)()
        self._call("fmi3GetClock", references, n, ticking)
        return frozenset(c.name for c, on in zip(self.outputs, ticking, strict=True) if on)

    def interval(self, clock: Clock) -> tuple[Fraction, int]:
        """Return the interval to the next tick in s, and the standard's qualifier of it."""
        (reference, n), qualifier = _references([clock]), c_int()
        if clock.fraction:
            counter, resolution = c_uint64(), c_uint64(1)
            self._call("fmi3GetIntervalFraction", reference, n, byref(counter), byref(resolution), byref(qualifier))
            return Fraction(counter.value, resolution.value or 1), qualifier.value
        interval = c_double()
        self._call("fmi3GetIntervalDecimal", reference, n, byref(interval), byref(qualifier))
        return exact(interval.value) if isfinite(interval.value) else Fraction(0), qualifier.value

    def shift(self, clock: Clock) -> Fraction:
        """Return the delay of the first tick in s."""
        reference, n = _references([clock])
        if clock.fraction:
            counter, resolution = c_uint64(), c_uint64(1)
            self._call("fmi3GetShiftFraction", reference, n, byref(counter), byref(resolution))
            return Fraction(counter.value, resolution.value or 1)
        shift = c_double()
        self._call("fmi3GetShiftDecimal", reference, n, byref(shift))
        return exact(shift.value)

    def set_interval(self, clock: Clock, interval: Fraction) -> None:
        """Tell the FMU the interval that the user chose."""
        reference, n = _references([clock])
        self._call("fmi3SetIntervalDecimal", reference, n, byref(c_double(float(interval))))


def _references(clocks: Iterable[Clock]) -> tuple[Any, int]:
    values = [c.reference for c in clocks]
    return (c_uint32 * len(values))(*values), len(values)
