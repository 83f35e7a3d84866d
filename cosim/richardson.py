"""The error of a step estimated by taking it twice: once whole, once in two halves."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from .algorithms import Algorithm, GaussSeidel
from .errors import CouplingError

if TYPE_CHECKING:
    from .attempt import Attempt
    from .system import System


@dataclass(frozen=True)
class Estimate:
    """Estimated errors of outputs at the end of a step, with what they are measured by; all arrays have one length."""

    labels: tuple[str, ...]
    error: np.ndarray  # exact minus what was found, in the units of the outputs
    size: np.ndarray  # the larger magnitude at start and end
    nominal: np.ndarray

    def worst(self, relative: float, absolute: float) -> tuple[float, str]:
        """Return the largest error against ``absolute * nominal + relative * size``, and whose it is."""
        if not self.labels:
            return 0.0, ""
        share = np.abs(self.error) / (absolute * self.nominal + relative * self.size)
        i = int(np.argmax(np.where(np.isfinite(share), share, np.inf)))
        return float(share[i]), self.labels[i]


@dataclass(frozen=True)
class Richardson:
    """Take each step of *inner* once whole, and once in two halves, which are what counts; compare.

    With an order p of *inner* the halves are wrong by (halves - whole) / (2^p - 1), up to higher orders.  Jacobi around
    a component that only feeds through hands on values two steps old: the estimate sees half of that, and nothing in a
    first step.  It covers the outputs that are connected.  *extrapolate* adds it to what is handed on and told; the
    states of the components stay those of the halves.  Raises CouplingError where a component cannot be taken back,
    needs steps of equal length, or steps over several macro steps.
    """

    inner: Algorithm = field(default_factory=GaussSeidel)
    order: int = 1
    extrapolate: bool = False

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
        return self.inner.sequence(system)

    def delay(self, system: System, source: str, target: str) -> int:
        """Return the delay of *inner*, in half steps."""
        return self.inner.delay(system, source, target)

    def advance(self, attempt: Attempt) -> None:
        """Take the whole step, go back, take the halves; where somebody stops early, nobody has moved."""
        system, middle = attempt.system, attempt.start + (attempt.end - attempt.start) // 2
        if middle == attempt.start:  # a step of 1 ns has no halves
            self.inner.advance(attempt)
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
        at, labels, nominal = connected(attempt.system)
        error = (halves - whole)[at] / (2**self.order - 1)
        size = np.maximum(np.abs(before[at]), np.abs(halves[at]))
        attempt.estimate = Estimate(labels, error, size, nominal)
        if self.extrapolate:
            attempt.system.values[at] += error


def connected(system: System) -> tuple[np.ndarray, tuple[str, ...], np.ndarray]:
    """Return the connected Float64 outputs: positions in ``System.values``, labels, nominal values."""
    first = len(system.row) - len(system.values)
    found: dict[int, tuple[str, float]] = {}
    for c in system.connections:
        if c.numeric:
            end = c.source
            place = system.place(end.component, end.variable)
            for at in end.positions(place):
                label = f"{end.component}.{end.variable.labels()[at - place.start]}"
                found[int(at) - first] = label, abs(end.variable.nominal) or 1.0
    labels = tuple(label for label, _ in found.values())
    return np.array(list(found), int), labels, np.array([nominal for _, nominal in found.values()], float)
