"""Inputs that are polynomials within a step: through what their sources showed at the last communication points."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field
from math import factorial
from typing import TYPE_CHECKING

import numpy as np

from .algorithms import Algorithm, Jacobi
from .clock import NS
from .errors import CouplingError

if TYPE_CHECKING:
    from .attempt import Attempt
    from .system import System

MAX_DEGREE = 2  # FMI 2.0 FMUs and our own take two derivatives


@dataclass(frozen=True)
class Extrapolated:
    """*inner*, with inputs that follow polynomials of *degree* 0, 1 or 2 over a step: order ``degree + 1`` with Jacobi.

    Each goes through the newest values of its source at different times: from the start of the step and before
    (extrapolated) where the source steps later; from its end on (interpolated) where it stepped first, as in
    Gauss-Seidel, or is a guess of that, as in ``Iterated``.  From the start, and after an event, the degree grows by
    one a step; a first step on held inputs is wrong by O(h^2) unless what is exchanged stands still there.  Who takes
    fewer derivatives of its inputs has a lower degree, down to holding them; a warning says so.

    What a source shows has to be its value at the end of its step: a mean over the step is none, and is spoilt.

    It goes around ``Iterated``, and into ``Richardson``.  Raises CouplingError otherwise, and for another degree.
    """

    inner: Algorithm = field(default_factory=Jacobi)
    degree: int = 1

    def sequence(self, system: System) -> tuple[str, ...]:
        """Return the sequence of *inner*; warns of components that take fewer derivatives of their inputs."""
        if self.degree not in range(MAX_DEGREE + 1):
            raise CouplingError(f"Extrapolated takes a degree of 0, 1 or 2, not {self.degree!r}")
        for name, instance in system.instances.items():
            if _sources(system, name) and (takes := instance.can.input_derivatives) < self.degree:
                warnings.warn(
                    f"{name} takes {takes or 'no'} derivatives of its inputs: over its steps they are "
                    f"{'of a lower degree' if takes else 'held'}, not of degree {self.degree}, which limits the order",
                    stacklevel=2,
                )
        return self.inner.sequence(system)

    def delay(self, system: System, source: str, target: str) -> int:
        """Return the delay of *inner*: how old the newest value is that a polynomial goes through."""
        return self.inner.delay(system, source, target)

    def advance(self, attempt: Attempt) -> None:
        """Remember what everybody shows, and advance on polynomials."""
        if attempt.ahead:
            raise CouplingError("Extrapolated cannot be inside Iterated; write Extrapolated(Iterated(...))")
        for name in attempt.system.names:
            self._note(attempt, name)
        attempt.feeders = (*attempt.feeders, self._feed)
        self.inner.advance(attempt)

    def _note(self, attempt: Attempt, name: str) -> tuple[tuple[int, np.ndarray], ...]:
        """Remember what a component shows, and at which tick; return that and what is remembered of before."""
        system, key = attempt.system, (Extrapolated, name)
        time = attempt.end if name in attempt.ahead else system.time[name]
        known = [p for p in system.memory.get(key, ()) if attempt.since <= p[0] < time]
        shown = system.row[system.places[name, "output"]].copy()
        system.memory[key] = points = (*known[len(known) - min(self.degree, len(known)) :], (time, shown))
        return points

    def _feed(self, attempt: Attempt, name: str) -> None:
        """Set the inputs of a component, and their derivatives, where its step begins."""
        system, instance = attempt.system, attempt.system.instances[name]
        degree, sources = min(self.degree, instance.can.input_derivatives), _sources(system, name)
        if not degree or not sources:
            return
        start, inlet = system.time[name], system.inlet(name)
        first = len(system.row) - len(system.values)
        rows = np.zeros((degree + 1, len(system.row)))
        for source in sources:
            points = self._note(attempt, source)[-degree - 1 :]
            rows[: len(points), system.places[source, "output"]] = _derivatives(points, start)
        slopes = np.zeros((degree + 1, len(instance.u)))
        slopes[:, inlet.targets] = rows[:, first + inlet.sources] * (1.0 if inlet.factor is None else inlet.factor)
        instance.u[inlet.targets] = slopes[0, inlet.targets] + inlet.offset
        instance.push()
        instance.set_input_derivatives(list(slopes[1:]))


def _sources(system: System, name: str) -> set[str]:
    """Return the components that drive Float64 inputs of *name*."""
    return {c.source.component for c in system.connections if c.numeric and c.target.component == name}


def _derivatives(points: tuple[tuple[int, np.ndarray], ...], at: int) -> np.ndarray:
    """Return value and derivatives (in s) at the tick *at* of the polynomials through *points*: (n, n values)."""
    times = np.array([float(time - at) for time, _ in points])
    scale = max(float(np.max(np.abs(times))), 1.0)
    powers = np.vander(times / scale, increasing=True)
    found = np.linalg.solve(powers, np.array([values for _, values in points]))
    per_order = [factorial(k) * (NS / scale) ** k for k in range(len(points))]
    return np.asarray(found * np.array(per_order)[:, None])
