"""The clocks an FMI 3.0 FMU declares, and when each ticks next.

Times are exact: rationals in seconds, since a period of 1/3 s is no whole number of ns.  A tick happens at the first
nanosecond at or after its time; the next one is counted from the exact time, so nothing drifts.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from cosim import ExportError
from cosim.clock import NS

TRIGGERED = "triggered"
PERIODIC = ("constant", "fixed", "tunable")
NOT_YET_KNOWN, UNCHANGED, CHANGED = range(3)  # fmi3IntervalQualifier


@dataclass(frozen=True)
class Clock:
    """A clock: its kind is one of constant, fixed, tunable, changing, countdown or triggered."""

    name: str
    reference: int
    causality: str
    kind: str
    period: Fraction | None = None  # s; None: the FMU has to be asked
    shift: Fraction = Fraction(0)  # s, from the start to the first tick
    fraction: bool = False  # intervals are told as rationals


def declared_clocks(root: Any) -> dict[str, Clock]:
    """Return the clocks in a modelDescription.xml by name; raises ExportError for one that contradicts itself."""
    types = {t.get("name"): t for t in root.iter("ClockType")}
    found = {}
    for element in root.findall("ModelVariables/Clock"):
        about = dict(types[element.get("declaredType")].attrib) if element.get("declaredType") in types else {}
        about |= element.attrib
        clock = Clock(
            about["name"],
            int(about["valueReference"]),
            about.get("causality", "local"),
            about.get("intervalVariability", TRIGGERED),
            _time(about, "intervalCounter", "intervalDecimal"),
            _time(about, "shiftCounter", "shiftDecimal") or Fraction(0),
            about.get("supportsFraction") in ("true", "1"),
        )
        if clock.kind == "constant" and not clock.period:
            raise ExportError(f"the constant clock {clock.name} declares no interval")
        found[clock.name] = clock
    return found


def _time(about: dict[str, str], counter: str, decimal: str) -> Fraction | None:
    if counter in about and "resolution" in about:
        return Fraction(int(about[counter]), int(about["resolution"]))
    return Fraction(about[decimal]) if decimal in about else None


def exact(value: float) -> Fraction:
    """Return the rational that a float means: the shortest decimal that is nearest to it, so that 0.1 is 1/10."""
    return Fraction(repr(float(value)))


def tick_of(time: Fraction) -> int:
    """Return the first ns at or after *time* in s."""
    return -(-time.numerator * NS // time.denominator)


@dataclass
class Schedule:
    """When the time-based clocks of one instance tick.

    *ask* returns the interval of a clock in s and its qualifier, *ask_shift* the delay of its first tick.
    """

    clocks: tuple[Clock, ...]
    ask: Callable[[Clock], tuple[Fraction, int]]
    ask_shift: Callable[[Clock], Fraction]
    due: dict[str, Fraction | None] = field(default_factory=dict)  # when each ticks next
    periods: dict[str, Fraction] = field(default_factory=dict)  # of the periodic ones; those given by the user stay

    def begin(self, start: Fraction) -> None:
        """Learn the intervals in initialisation mode."""
        for clock in self.clocks:
            if clock.kind not in PERIODIC:
                interval, qualifier = self.ask(clock)
                self.due[clock.name] = None if qualifier == NOT_YET_KNOWN else start + interval
                continue
            shift = clock.shift
            if clock.period is None:
                if clock.name not in self.periods:
                    self.periods[clock.name] = self.ask(clock)[0]
                shift = self.ask_shift(clock)
            self.periods.setdefault(clock.name, clock.period or Fraction(0))
            if self.periods[clock.name] <= 0:
                raise ValueError(f"its clock {clock.name} has an interval of {float(self.periods[clock.name]):g} s")
            self.due[clock.name] = start + shift

    def next(self) -> Fraction | None:
        """Return the time of the next tick of any clock."""
        return min((t for t in self.due.values() if t is not None), default=None)

    def at(self, tick: int) -> tuple[str, ...]:
        """Return the clocks that tick at or before a tick."""
        return tuple(name for name, t in self.due.items() if t is not None and tick_of(t) <= tick)

    def go_on(self, now: Fraction, ticked: Iterable[str]) -> None:
        """Plan what follows an event at *now*, in which the clocks *ticked* ticked."""
        ticked = set(ticked)
        for clock in self.clocks:
            name = clock.name
            if clock.kind in PERIODIC:
                last = self.due[name]
                if name in ticked and last is not None:
                    self.due[name] = last + self.periods[name]
                if clock.kind == "tunable" and clock.period is None:
                    interval, qualifier = self.ask(clock)
                    if qualifier == CHANGED:
                        self.periods[name], self.due[name] = interval, now + interval
            elif clock.kind == "changing":
                if name in ticked:
                    self.due[name] = now + self.ask(clock)[0]
            else:  # countdown: asked at every event
                interval, qualifier = self.ask(clock)
                if qualifier == CHANGED:
                    self.due[name] = now + interval
                elif name in ticked:
                    self.due[name] = None
