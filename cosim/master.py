"""The loop: initialise, advance by macro steps, locate events, tell the observers.

Time is a whole number of nanoseconds.  Macro step k goes from ``start + k * step`` to ``start + (k + 1) * step``; the
last one may be shorter.  Where a component returns early, everybody who stepped is taken back to the start of the step
and all step to that instant; what is left of the macro step is a step of its own, so the grid stays where it was.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from numbers import Integral
from time import perf_counter
from typing import Any

from .algorithms import Algorithm
from .attempt import Attempt
from .clock import seconds, ticks
from .compiled import compiled_loop
from .control import PI, Fixed, Pace
from .errors import CouplingError, ScenarioError, StepError
from .event_mode import EventMode
from .finite import Finite
from .observer import Block, Observer, Point, RunInfo, Summary
from .step_checks import check_periods, check_steps, rewound, sample_period
from .system import System

MAX_EARLY_RETURNS = 1000  # in one macro step; a run with more has events that accumulate
SAME_EVENT = 10  # an event that comes again within that fraction of a step is the same one, moved by new forces


def run(
    system: System,
    algorithm: Algorithm,
    *,
    step: float | int,
    stop: float | int,
    start: float | int = 0,
    observers: Sequence[Observer] = (),
    locate_events: bool = True,
    tolerance: float | None = None,
    compiled: bool | None = None,
    control: Fixed | PI = Fixed(),  # noqa: B008
) -> Summary:
    """Run *system* from *start* to *stop* in macro steps of *step*; each is seconds if a float, ns if an int.

    *locate_events* brings everybody to the instant at which a component announces an event; *tolerance* is the relative
    one of the components' own integrators.  *compiled* has the macro steps made without Python (True), by the readable
    loop (False), or without Python where that is possible (None): the bits are the same.  *control* lets the steps
    vary: *step* is the first one then.  Raises StepError or CouplingError after the observers were told.
    """
    info = _span(step, stop, start, algorithm)
    return _Run(system, algorithm, info, observers, locate_events, compiled, control).execute(tolerance)


def _span(step: float | int, stop: float | int, start: float | int, algorithm: Algorithm) -> RunInfo:
    step_ns, stop_ns = _ns(step, "the step"), _ns(stop, "the stop time")
    start_ns = _ns(start, "the start time") if start else 0
    if stop_ns - start_ns < step_ns:
        raise ScenarioError(
            f"the run from {seconds(start_ns):g} s to {seconds(stop_ns):g} s is shorter than its step of "
            f"{seconds(step_ns):g} s (an int is in nanoseconds, a float in seconds)"
        )
    return RunInfo(step_ns, stop_ns, start_ns, repr(algorithm))


def _ns(value: float | int, what: str) -> int:
    if isinstance(value, Integral):
        if value <= 0:
            raise ScenarioError(f"{what} is {value} ns; it must be positive")
        return int(value)
    return ticks(value, what)


class _Run:
    """One run: what changes while it lasts."""

    def __init__(
        self,
        system: System,
        algorithm: Algorithm,
        info: RunInfo,
        observers: Sequence[Observer],
        locate_events: bool,
        compiled: bool | None,
        control: Fixed | PI,
    ) -> None:
        self.system, self.algorithm, self.info, self.observers = system, algorithm, info, tuple(observers)
        self.sequence = algorithm.sequence(system)
        self.rewound = rewound(system, self.sequence) if locate_events else ()
        self.locating = bool(self.rewound)
        self.pace = Pace(control, info.step_ns) if isinstance(control, PI) else None
        if isinstance(control, PI):
            control.check(system, compiled)
            self.rewound, compiled = self.sequence, False
        self.hybrid, self.finite = EventMode(system), Finite(system)
        check_steps(system, info, locating=self.locating)
        self.fast = compiled_loop(compiled, system, algorithm, info, self.sequence, self.rewound, self.observers)
        self.inputs = {name: i.u for name, i in system.instances.items()}
        self.outputs = {name: i.y for name, i in system.instances.items()}
        self.steps = self.rejected = self.events = 0
        self.now = info.start_ns
        self.pending: dict[str, int] = {}  # events met for, whose components did not say whether they are passed
        self.began = perf_counter()
        self.terminated = ""
        self.event_at = info.start_ns  # the last event, or the start

    def execute(self, tolerance: float | None) -> Summary:
        """Run to the end; whatever breaks it off is told to the observers first."""
        try:
            self._tell(lambda o: o.started(self.system, self.info))
            self.system.initialize(self.info.start_ns, self.info.stop_ns, tolerance)
            if self.pace is None:
                check_periods(self.system, self.info.step_ns)
            self.accept(self.now)
            self._settle()
            if self.pace is None:
                self._loop()
            else:
                self._paced(self.pace)
            self._tell_events()
        except BaseException as error:  # an interrupt, too, must leave a log that says so
            self._failed(error)
            raise
        span = seconds(self.now - self.info.start_ns)
        summary = Summary(self.steps, self.rejected, self.events, self.wall(), span, self.terminated)
        self._tell(lambda o: o.finished(summary))
        return summary

    def _loop(self) -> None:
        step, stop, start = self.info.step_ns, self.info.stop_ns, self.info.start_ns
        slow = {name: n for name, n in self.system.every.items() if n > 1}
        k = 0
        while self.now < stop and not self.terminated:
            if self.fast is not None:
                k = self.fast.advance(self, k)
                if self.now == stop or self.terminated:
                    break
            k += 1
            end = min(start + k * step, stop)
            due = self.sequence
            if slow and end < stop:
                due = tuple(name for name in self.sequence if k % slow.get(name, 1) == 0)
            attempts = 0
            while self.now < end and not self.terminated:
                attempts = self._reach(end, due, attempts)

    def _paced(self, pace: Pace) -> None:
        """Step as far as the errors allow, and never over the tick of a sampled component."""
        stop = self.info.stop_ns
        sampled = {n: p for n, i in self.system.instances.items() if (p := sample_period(i)) is not None}
        periods = [ticks(p, f"the period of {name}") for name, p in sampled.items()]
        while self.now < stop and not self.terminated:
            limit = min([stop, *((self.now // period + 1) * period for period in periods)])
            self._reach(pace.next(self.now, limit), self.sequence, 0)

    def _reach(self, end: int, due: tuple[str, ...], attempts: int) -> int:
        """Advance everybody to *end* or to the first event before it; return the attempts made in this macro step."""
        start, target, culprit, discarded = self.now, self.hybrid.next(self.now, end), "", False
        if target < end:
            due = self.sequence
        saved = self.system.save(self.rewound) if self.rewound else None
        try:
            while True:
                attempt = Attempt(self.system, start, target, due, self.locating, since=self.event_at)
                self.algorithm.advance(attempt)
                if not attempt.stopped:
                    if self.pace is None or self.pace.accepts(attempt):
                        break
                    assert saved is not None
                    self.system.restore(saved, self.sequence)
                    self._too_wrong(attempt, self.pace.worst)
                    target, culprit = self.pace.shorter(start), ""
                    continue
                if attempt.stopped == attempt.terminated:  # the run ends at the last point that everybody reached
                    self.terminated = attempt.terminated
                    return attempts
                assert saved is not None
                self.system.restore(saved, attempt.stepped)
                self._rejected(attempt)
                attempts += 1
                culprit, discarded, due = attempt.stopped, attempt.discarded, self.sequence
                target = self._shorter(attempt, attempts)
        finally:
            if saved is not None:
                self.system.forget(saved)
        self.terminated = attempt.terminated
        self.accept(target)
        if (culprit and not discarded) or attempt.announced:
            self.event_at = target
        if culprit and not discarded and culprit not in attempt.announced:
            self.pending[culprit] = target
        for name in attempt.announced:
            self.event(target, name)
        self._settle()
        return attempts

    def _settle(self) -> None:
        """Handle the events where everybody is, and tell of each micro step that shows."""
        for micro in self.hybrid.settle(self.now):
            self.accept(self.now, micro)
        if self.hybrid.rounds:
            self.event_at = self.now
        self.terminated = self.terminated or self.hybrid.terminated

    def _shorter(self, attempt: Attempt, attempts: int) -> int:
        """Return where the next attempt is to end; at least 1 ns after the start, so that time goes on."""
        target = max(attempt.reached, attempt.start + 1)
        if attempt.discarded and attempts > MAX_EARLY_RETURNS:
            raise CouplingError(
                f"{attempt.stopped} discarded {attempts} steps in one macro step, the last from "
                f"{seconds(attempt.start):.9f} s to {seconds(attempt.end):.9f} s; choose a macro step that it takes"
            )
        if target >= attempt.end or attempts > MAX_EARLY_RETURNS:
            raise CouplingError(
                f"{attempt.stopped} returned early {attempts} times in one macro step, last at "
                f"{seconds(attempt.reached):.9f} s in the step from {seconds(attempt.start):.9f} s to "
                f"{seconds(attempt.end):.9f} s: its events do not come to an end; "
                f"run with locate_events=False or look at its jump"
            )
        return target

    # observers

    def wall(self) -> float:
        """Return the seconds of wall clock since the run began."""
        return perf_counter() - self.began

    def _tell(self, call: Callable[[Observer], Any]) -> None:
        for observer in self.observers:
            call(observer)

    def _tell_events(self) -> None:
        """Tell the events met for at the last point, now that their components went on from there."""
        met, self.pending = self.pending, {}
        for name, time in met.items():
            self.event(time, name)

    def event(self, time: int, component: str) -> None:
        """Count and tell an event that everybody was brought to."""
        self.events += 1
        self._tell(lambda o: o.event(time, component))

    def accept(self, end: int, micro: int = 0) -> None:
        """Accept what was computed from now to *end*, or in a micro step there, and tell of it."""
        self._tell_events()
        initial = self.steps == 0 and end == self.info.start_ns and not micro
        if not initial and not self.finite.good(self.system.row[None]):  # some know nothing before their first step
            raise self.finite.error(self.system.row, end)
        self.steps += not initial
        point = Point(self.steps, self.now, end, self.wall(), self.inputs, self.outputs, self.system.row, micro)
        self.now = end
        for observer in self.observers:
            observer.accepted(point)

    def accept_many(self, n: int, end: int, block: Block | None) -> None:
        """Accept *n* macro steps, the last to *end*, and tell of them if there is a *block*."""
        self._tell_events()
        if block is None:
            if not self.finite.good(self.system.row[None]):
                raise self.finite.error(self.system.row, end)
        elif (good := self.finite.good(block.rows)) < n:
            if good:
                self.accept_many(good, int(block.ends[good - 1]), block.until(good))
            raise self.finite.error(block.rows[good], int(block.ends[good]))
        self.steps += n
        self.now = end
        if block is not None:
            self._tell(lambda o: o.accepted_block(block))

    def _rejected(self, attempt: Attempt) -> None:
        self.rejected += 1
        met = self.pending.get(attempt.stopped)
        if met is not None and not attempt.discarded and (attempt.reached - met) * SAME_EVENT < self.info.step_ns:
            del self.pending[attempt.stopped]  # not passed yet: on the shorter step it happens a little later
        self._tell(lambda o: o.rejected(attempt.start, attempt.end, attempt.reached, attempt.stopped))

    def _too_wrong(self, attempt: Attempt, port: str) -> None:
        self.rejected += 1
        component = port.partition(".")[0]
        self._tell(lambda o: o.rejected(attempt.start, attempt.end, attempt.start, component))

    def _failed(self, error: BaseException) -> None:
        if isinstance(error, StepError) and self.system.time:
            error.step = self.steps + 1
        met, self.pending = self.pending, {}
        for observer in self.observers:
            try:
                for name, time in met.items():
                    observer.event(time, name)
                observer.failed(error)
            except Exception as another:  # the others must hear of the failure, and the user of the first one
                error.add_note(f"{type(observer).__name__}.failed raised {type(another).__name__}: {another}")
