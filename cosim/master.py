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
from .errors import CouplingError, ScenarioError
from .instance import Instance
from .observer import Observer, Point, RunInfo, Summary
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
) -> Summary:
    """Run *system* from *start* to *stop* in macro steps of *step*; each is seconds if a float, ns if an int.

    *locate_events* brings everybody to the instant at which a component announces an event; *tolerance* is the relative
    one of the components' own integrators.  Raises StepError or CouplingError after the observers were told.
    """
    info = _span(step, stop, start, algorithm)
    return _Run(system, algorithm, info, observers, locate_events).execute(tolerance)


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
    ) -> None:
        self.system, self.algorithm, self.info, self.observers = system, algorithm, info, tuple(observers)
        self.sequence = algorithm.sequence(system)
        self.rewound = rewound(system, self.sequence) if locate_events else ()
        _check_steps(system, info, locating=bool(self.rewound))
        self.inputs = {name: i.u for name, i in system.instances.items()}
        self.outputs = {name: i.y for name, i in system.instances.items()}
        self.steps = self.rejected = self.events = 0
        self.now = info.start_ns
        self.pending: dict[str, int] = {}  # events met for, whose components did not say whether they are passed
        self.began = perf_counter()
        self.terminated = ""

    def execute(self, tolerance: float | None) -> Summary:
        """Run to the end; whatever breaks it off is told to the observers first."""
        try:
            self._tell(lambda o: o.started(self.system, self.info))
            self.system.initialize(self.info.start_ns, self.info.stop_ns, tolerance)
            check_periods(self.system, self.info.step_ns)
            self._accept(self.now)
            self._loop()
            self._tell_events()
        except BaseException as error:  # an interrupt, too, must leave a log that says so
            self._failed(error)
            raise
        span = seconds(self.now - self.info.start_ns)
        summary = Summary(self.steps, self.rejected, self.events, self._wall(), span, self.terminated)
        self._tell(lambda o: o.finished(summary))
        return summary

    def _loop(self) -> None:
        step, stop, start = self.info.step_ns, self.info.stop_ns, self.info.start_ns
        slow = {name: n for name, n in self.system.every.items() if n > 1}
        k = 0
        while self.now < stop and not self.terminated:
            k += 1
            end = min(start + k * step, stop)
            due = self.sequence
            if slow and end < stop:
                due = tuple(name for name in self.sequence if k % slow.get(name, 1) == 0)
            attempts = 0
            while self.now < end and not self.terminated:
                attempts = self._reach(end, due, attempts)

    def _reach(self, end: int, due: tuple[str, ...], attempts: int) -> int:
        """Advance everybody to *end* or to the first event before it; return the attempts made in this macro step."""
        start, target, culprit = self.now, end, ""
        saved = self.system.save(self.rewound) if self.rewound else None
        try:
            while True:
                attempt = Attempt(self.system, start, target, due, bool(self.rewound))
                self.algorithm.advance(attempt)
                if not attempt.stopped:
                    break
                if attempt.stopped == attempt.terminated:  # the run ends at the last point that everybody reached
                    self.terminated = attempt.terminated
                    return attempts
                assert saved is not None
                self.system.restore(saved, attempt.stepped)
                self._rejected(attempt)
                attempts += 1
                culprit, due = attempt.stopped, self.sequence
                target = self._shorter(attempt, attempts)
        finally:
            if saved is not None:
                self.system.forget(saved)
        self.terminated = attempt.terminated
        self._accept(target)
        if culprit and culprit not in attempt.announced:
            self.pending[culprit] = target
        for name in attempt.announced:
            self._event(target, name)
        return attempts

    def _shorter(self, attempt: Attempt, attempts: int) -> int:
        """Return where the next attempt is to end; at least 1 ns after the start, so that time goes on."""
        target = max(attempt.reached, attempt.start + 1)
        if target >= attempt.end or attempts > MAX_EARLY_RETURNS:
            raise CouplingError(
                f"{attempt.stopped} returned early {attempts} times in one macro step, last at "
                f"{seconds(attempt.reached):.9f} s in the step from {seconds(attempt.start):.9f} s to "
                f"{seconds(attempt.end):.9f} s: its events do not come to an end; "
                f"run with locate_events=False or look at its jump"
            )
        return target

    # observers

    def _wall(self) -> float:
        return perf_counter() - self.began

    def _tell(self, call: Callable[[Observer], Any]) -> None:
        for observer in self.observers:
            call(observer)

    def _tell_events(self) -> None:
        """Tell the events met for at the last point, now that their components went on from there."""
        met, self.pending = self.pending, {}
        for name, time in met.items():
            self._event(time, name)

    def _event(self, time: int, component: str) -> None:
        self.events += 1
        self._tell(lambda o: o.event(time, component))

    def _accept(self, end: int) -> None:
        self._tell_events()
        initial = self.steps == 0 and end == self.info.start_ns
        self.steps += not initial
        point = Point(self.steps, self.now, end, self._wall(), self.inputs, self.outputs, self.system.row)
        self.now = end
        for observer in self.observers:
            observer.accepted(point)

    def _rejected(self, attempt: Attempt) -> None:
        self.rejected += 1
        met = self.pending.get(attempt.stopped)
        if met is not None and (attempt.reached - met) * SAME_EVENT < self.info.step_ns:
            del self.pending[attempt.stopped]  # not passed yet: on the shorter step it happens a little later
        self._tell(lambda o: o.rejected(attempt.start, attempt.end, attempt.reached, attempt.stopped))

    def _failed(self, error: BaseException) -> None:
        met, self.pending = self.pending, {}
        for observer in self.observers:
            try:
                for name, time in met.items():
                    observer.event(time, name)
                observer.failed(error)
            except Exception as another:  # the others must hear of the failure, and the user of the first one
                error.add_note(f"{type(observer).__name__}.failed raised {type(another).__name__}: {another}")


def rewound(system: System, sequence: tuple[str, ...]) -> tuple[str, ...]:
    """Return who must be taken back when a component returns early: those up to the last that may, in stepping order.

    Raises CouplingError for one that cannot go back, and for one with events inside a step over several macro steps.
    """
    early = [name for name in sequence if system.instances[name].can.early_return]
    if not early:
        return ()
    for name in early:
        if system.every[name] > 1:
            raise CouplingError(
                f"{name} announces events and cannot step every {system.every[name]} macro steps, since the others "
                f"would have passed them; let it step every one, or run with locate_events=False"
            )
    names = sequence[: sequence.index(early[-1]) + 1]
    for name in names:
        if not system.instances[name].can.rollback:
            cure = "" if name in early else f"let {name} step after {early[-1]} in GaussSeidel, or "
            raise CouplingError(
                f"{name} cannot be taken back to an earlier state, which the events of {early[-1]} ask for; "
                f"{cure}run with locate_events=False"
            )
    return names


def _check_steps(system: System, info: RunInfo, *, locating: bool) -> None:
    """Refuse steps of varying length for a component that declares it cannot make them."""
    for name, instance in system.instances.items():
        own = info.step_ns * system.every[name]
        if not instance.can.variable_step and (locating or (info.stop_ns - info.start_ns) % own):
            why, cure = ("events are located", "run with locate_events=False")
            if not locating:
                why, cure = "the run is no whole number of them", f"choose a stop time in steps of {seconds(own):g} s"
            raise CouplingError(f"{name} needs steps of equal length, but {why}; {cure}")


def sample_period(instance: Instance) -> float | None:
    """Return the sample period of an instance in s, or None if it has none: a parameter ``period`` in s."""
    variable = instance.variables.get("period")
    if variable is None or variable.causality != "parameter" or variable.unit != "s":
        return None
    return float(instance.get("period"))


def check_periods(system: System, step: int) -> None:
    """Refuse a sample period whose ticks are no communication points and that does not divide the step either."""
    for name, instance in system.instances.items():
        sampled = sample_period(instance)
        if sampled is None:
            continue
        period, own = ticks(sampled, f"the period of {name}"), step * system.every[name]
        if period % own and own % period:
            raise CouplingError(
                f"{name} has a period of {seconds(period):g} s, which is neither a multiple nor a whole fraction of "
                f"its step of {seconds(own):g} s; choose a step that divides the period"
            )
