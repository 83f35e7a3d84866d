"""Macro steps repeated until what components exchange agrees at their end: strong coupling."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from .acceleration import Acceleration, Method
from .algorithms import Algorithm, GaussSeidel
from .attempt import Attempt
from .clock import seconds
from .errors import CouplingError

if TYPE_CHECKING:
    from .system import Saved, System


@dataclass(frozen=True)
class Iterated:
    """Repeat the step of *inner*, everybody taken back each time, until the values exchanged settle: order 1, stable.

    Each target holds over the step what its source shows at the end of it.  *method* says how the next guess is made:
    ``fixed_point`` takes what the step gave, ``aitken`` relaxes that, ``quasi_newton`` combines all guesses of the step
    by least squares, ``newton`` takes differences of the whole step: one repetition more per value exchanged.  A step
    is accepted when no value differs from its guess by more than *tolerance* times the larger of it and its nominal.

    A component that cannot be taken back steps once, first, on the values of the start, which a warning says.  Raises
    CouplingError where *max_iterations* are not enough; ``unconverged = "warn"`` accepts the last one instead.
    """

    inner: Algorithm = field(default_factory=GaussSeidel)
    method: Method = "quasi_newton"
    tolerance: float = 1e-8
    max_iterations: int = 50
    unconverged: Literal["raise", "warn"] = "raise"

    def sequence(self, system: System) -> tuple[str, ...]:
        """Return the sequence of *inner*; warns of components that cannot be taken back."""
        for name in system.names:
            if not system.instances[name].can.rollback:
                warnings.warn(
                    f"{name} cannot be taken back to an earlier state: Iterated steps it once per macro step, before "
                    f"the others, on the values from its start",
                    stacklevel=2,
                )
        return self.inner.sequence(system)

    def advance(self, attempt: Attempt) -> None:
        """Iterate the step; where somebody stops early, everybody is taken back and the attempt ends there."""
        system = attempt.system
        once = tuple(name for name in attempt.due if not system.instances[name].can.rollback)
        if once:
            first = replace(attempt, due=once, stepped=[], announced=[])
            self.inner.advance(first)
            if _ended(first, attempt):
                return
        due = tuple(name for name in attempt.due if name not in once)
        saved = system.save(due)
        try:
            _Iteration(self, attempt, due, saved).run()
        finally:
            system.forget(saved)

    def delay(self, system: System, source: str, target: str) -> int:
        """Return 0, but 1 for a target that cannot be taken back."""
        return int(not system.instances[target].can.rollback)


class _Iteration:
    """The sweeps of one macro step."""

    def __init__(self, how: Iterated, attempt: Attempt, due: tuple[str, ...], saved: Saved) -> None:
        self.how, self.attempt, self.due, self.saved = how, attempt, due, saved
        self.system = attempt.system
        self.at, self.labels, nominal = _unknowns(how.inner, self.system, due)
        self.scale = np.maximum(np.abs(saved.values[self.at]), nominal)
        self.others = saved.others
        self.last = attempt

    def run(self) -> None:
        """Sweep until the residual is within the tolerance."""
        acceleration = Acceleration(self.how.method)
        x = self.saved.values[self.at].copy()
        for iteration in range(1, self.how.max_iterations + 1):
            g = self._sweep(x)
            if _ended(self.last, self.attempt):
                if self.last.stopped != self.last.terminated:
                    self.system.restore(self.saved, self.due)  # the master takes back what it saved itself
                return
            size = np.abs(g - x) / np.maximum(np.maximum(np.abs(g), np.abs(x)), self.scale)
            if np.all(size <= self.how.tolerance):
                return
            if iteration < self.how.max_iterations:
                x = self.scale * acceleration.next(x / self.scale, g / self.scale, self._scaled)
        self._unsettled(x, g, size)

    def _scaled(self, x: np.ndarray) -> np.ndarray:
        found: np.ndarray = self._sweep(self.scale * x) / self.scale
        return found

    def _sweep(self, x: np.ndarray) -> np.ndarray:
        """Step everybody from the start, on *x* as what others show at the end; return what they do show."""
        system = self.system
        values = system.values.copy()
        values[self.at] = x
        # who stands at its start is taken back, who does not iterate keeps where it is
        system.restore(replace(self.saved, values=values, others=self.others), self.due)
        self.last = replace(
            self.attempt, due=self.due, stepped=[], announced=[], stopped="", terminated="", ahead=frozenset(self.due)
        )
        self.how.inner.advance(self.last)
        self.others = system.save(()).others
        return system.values[self.at].copy()

    def _unsettled(self, x: np.ndarray, g: np.ndarray, size: np.ndarray) -> None:
        worst = int(np.argmax(np.where(np.isfinite(size), size, np.inf)))
        label, unit = self.labels[worst]
        sentence = (
            f"the coupling did not settle in the step from {seconds(self.attempt.start):.9f} s to "
            f"{seconds(self.attempt.end):.9f} s: after {self.how.max_iterations} iterations {label} still changes "
            f"from {x[worst]:.6g} to {g[worst]:.6g} {unit}, a residual of {size[worst]:.1e} against a tolerance of "
            f"{self.how.tolerance:g}; take a shorter step, more iterations, or another method than {self.how.method}"
        )
        if self.how.unconverged == "raise":
            raise CouplingError(sentence)
        warnings.warn(sentence, stacklevel=2)


def _ended(part: Attempt, whole: Attempt) -> bool:
    """Tell the whole attempt how a part of it went; return whether it stopped."""
    whole.announced[:] = dict.fromkeys([*(n for n in whole.announced if n not in part.due), *part.announced])
    whole.stopped, whole.reached, whole.discarded = part.stopped, part.reached, part.discarded
    whole.terminated = whole.terminated or part.terminated
    return bool(part.stopped)


def _unknowns(
    inner: Algorithm, system: System, due: tuple[str, ...]
) -> tuple[np.ndarray, list[tuple[str, str]], np.ndarray]:
    """Return what has to be guessed: positions in ``System.values``, labels with units, nominal values.

    These are the sources that step after one of their targets, so that *inner* alone would hand on an old value.
    """
    first = len(system.row) - len(system.values)
    found: dict[int, tuple[str, str, float]] = {}
    for c in system.connections:
        end = c.source
        inside = end.component in due and c.target.component in due and c.numeric
        if inside and inner.delay(system, end.component, c.target.component):
            labels = end.variable.labels()
            for at in end.positions(system.place(end.component, end.variable)):
                element = at - system.place(end.component, end.variable).start
                label = f"{end.component}.{labels[element]}"
                found[int(at) - first] = label, end.variable.unit or "", abs(end.variable.nominal) or 1.0
    return (
        np.array(list(found), int),
        [(label, unit) for label, unit, _ in found.values()],
        np.array([nominal for _, _, nominal in found.values()], float),
    )
