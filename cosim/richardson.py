"""The error of a step estimated by taking it twice: once whole, once in two halves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from fnmatch import fnmatch
from typing import TYPE_CHECKING

import numpy as np

from .algorithms import Algorithm, GaussSeidel
from .errors import CouplingError, nearest
from .estimate import Estimate
from .wiring import End

if TYPE_CHECKING:
    from .attempt import Attempt
    from .system import System


@dataclass(frozen=True)
class Richardson:
    """Take each step of *inner* once whole, and once in two halves, which are what counts; compare.

    With an order p of *inner* the halves are wrong by (halves - whole) / (2^p - 1), up to higher orders.  Jacobi around
    a component that only feeds through hands on values two steps old: the estimate sees half of that, and nothing in a
    first step.  It covers *outputs*, patterns such as ``"body.*"``; none: all that are connected.  Leave out what is a
    mean over a step, which changes with its length.  *extrapolate* adds it to what is handed on and told; the states of
    the components stay those of the halves.  Raises CouplingError where a component cannot be taken back, needs steps
    of equal length, or steps over several macro steps, and for a pattern that no Float64 output matches.
    """

    inner: Algorithm = field(default_factory=GaussSeidel)
    order: int = 1
    extrapolate: bool = False
    outputs: tuple[str, ...] = ()

    def sequence(self, system: System) -> tuple[str, ...]:
        """Return the sequence of *inner*; raises CouplingError for who cannot take a step twice."""
        for name, instance in system.instances.items():
            if not instance.can.rollback:
                raise CouplingError(
                    f"{name} cannot be taken back to an earlier state, so Richardson cannot take its step twice; "
                    f"run without an error estimate, at a fixed step"
                )
            if not instance.can.variable_step:
                raise CouplingError(f"{name} needs steps of equal length, but Richardson takes halves of them")
            if system.every[name] > 1:
                raise CouplingError(
                    f"{name} steps every {system.every[name]} macro steps, which Richardson cannot halve; "
                    f"let it step every one"
                )
        system.memory[Richardson, *self.outputs] = judged(system, self.outputs)
        return self.inner.sequence(system)

    def delay(self, system: System, source: str, target: str) -> int:
        """Return the delay of *inner*, in half steps."""
        return self.inner.delay(system, source, target)

    def advance(self, attempt: Attempt) -> None:
        """Take the whole step, go back, take the halves; where somebody stops early, nobody has moved."""
        system, middle = attempt.system, attempt.start + (attempt.end - attempt.start) // 2
        if middle == attempt.start:  # a step of 1 ns has no halves, and no error to speak of
            self.inner.advance(attempt)
            attempt.estimate = Estimate((), *np.zeros((3, 0)))
            return
        saved = system.save(attempt.due)
        try:
            found = []
            for span in ((attempt.start, attempt.end), (attempt.start, middle), (middle, attempt.end)):
                part = replace(attempt, start=span[0], end=span[1], stepped=[], announced=[])
                self.inner.advance(part)
                attempt.announced[:] = part.announced
                if part.stopped:
                    attempt.stopped, attempt.reached, attempt.terminated = part.stopped, part.reached, part.terminated
                    attempt.discarded = part.discarded
                    system.restore(saved, attempt.due)
                    return
                found.append(system.values.copy())
                if span[1] == attempt.end and len(found) == 1:
                    system.restore(saved, attempt.due)
            attempt.terminated = part.terminated
            self._compare(attempt, saved.values, found[0], found[2])
        finally:
            system.forget(saved)

    def _compare(self, attempt: Attempt, before: np.ndarray, whole: np.ndarray, halves: np.ndarray) -> None:
        at, labels, nominal = attempt.system.memory[Richardson, *self.outputs]
        error = (halves - whole)[at] / (2**self.order - 1)
        size = np.maximum(np.abs(before[at]), np.abs(halves[at]))
        attempt.estimate = Estimate(labels, error, size, nominal)
        if self.extrapolate:
            attempt.system.values[at] += error


def judged(system: System, patterns: Sequence[str] = ()) -> tuple[np.ndarray, tuple[str, ...], np.ndarray]:
    """Return the Float64 outputs that match *patterns*, or that are connected if there are none.

    That is their places in ``System.values``, their labels, and their nominal values.
    Raises CouplingError for a pattern that matches none.
    """
    first = len(system.row) - len(system.values)
    ends = [End(name, v) for name in system.names for v in system.instances[name].outputs]
    for pattern in patterns:
        if not any(fnmatch(end.port, pattern) for end in ends):
            raise CouplingError(
                f"no output that carries numbers matches {pattern!r}; {nearest(pattern, [end.port for end in ends])}"
            )
    if patterns:
        ends = [end for end in ends if any(fnmatch(end.port, pattern) for pattern in patterns)]
    else:
        ends = [c.source for c in system.connections if c.numeric]
    found: dict[int, tuple[str, float]] = {}
    for end in ends:
        place = system.place(end.component, end.variable)
        for at in end.positions(place):
            label = f"{end.component}.{end.variable.labels()[at - place.start]}"
            found[int(at) - first] = label, abs(end.variable.nominal) or 1.0
    labels = tuple(label for label, _ in found.values())
    return np.array(list(found), int), labels, np.array([nominal for _, nominal in found.values()], float)
