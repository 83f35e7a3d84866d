"""Algorithms that know power bonds: the energy residual as an estimate of the error, impulses paid back."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .algorithms import Algorithm
from .bonds import Bond, Signal, Wired, wired
from .clock import seconds
from .errors import CouplingError
from .estimate import Estimate

if TYPE_CHECKING:
    from .attempt import Attempt
    from .system import System


@dataclass(frozen=True)
class _Bonded:
    """An algorithm around another one that knows some of its connections to be power bonds."""

    inner: Algorithm
    bonds: tuple[Bond, ...]

    def sequence(self, system: System) -> tuple[str, ...]:
        """Return the sequence of *inner*; raises CouplingError for bonds that are none."""
        system.memory[_Bonded, *self.bonds] = wired(system, self.bonds, self.inner)
        return self.inner.sequence(system)

    def _wired(self, system: System) -> tuple[Wired, ...]:
        """Return the bonds as they lie in the connections of a system."""
        found: tuple[Wired, ...] = system.memory[_Bonded, *self.bonds]
        return found

    def delay(self, system: System, source: str, target: str) -> int:
        """Return the delay of *inner*."""
        return self.inner.delay(system, source, target)


class EnergyError(_Bonded):
    """*inner*, each step judged by the energy that the coupling made at the *bonds* (ECCO, Sadjina et al. 2016).

    For ``PI`` in place of ``Richardson``: it costs no second step, sees only what passes through the bonds, and is
    measured by the *energy* of a bond: a tolerance of 1e-4 allows 1e-4 of it per step.  Nobody has to be taken back
    for the estimate itself.
    """

    def advance(self, attempt: Attempt) -> None:
        """Advance, and estimate."""
        system, length = attempt.system, attempt.end - attempt.start
        before = system.row.copy()
        self.inner.advance(attempt)
        if not attempt.stopped:
            found = self._wired(system)
            error = np.array([w.residual(before, system.row, length) for w in found])
            energy = np.array([w.bond.energy for w in found])
            attempt.estimate = Estimate(tuple(w.bond.label for w in found), error, energy, energy)


class Conserving(_Bonded):
    """*inner*, with impulses conserved at the *bonds*: what a held value missed over a step is added to the next one.

    So the integral of what a target holds follows that of what its source shows (the nearly energy-preserving coupling
    element of Benedikt, Watzenig, Hofer 2013, for held inputs), and energy drifts at order 2 instead of 1.  After an
    event nothing is owed.  Where a short step follows a long one, the debt is paid over as long a time as it arose in.
    It goes around ``Iterated``, and into ``Richardson``; raises CouplingError otherwise.
    """

    def advance(self, attempt: Attempt) -> None:
        """Advance with what is owed from before, and find what is owed then."""
        if attempt.ahead:
            raise CouplingError("Conserving cannot be inside Iterated; write Conserving(Iterated(...), bonds)")
        system, length = attempt.system, seconds(attempt.end - attempt.start)
        debts = self._debts(attempt)[0]
        before = system.row.copy()
        attempt.feeders = (*attempt.feeders, self._feed)
        self.inner.advance(attempt)
        if not attempt.stopped:
            missed = [
                debt + length * ((s.passed(before) + s.passed(system.row)) / 2 - system.row[s.held])
                for debt, s in zip(debts, self._signals(system), strict=True)
            ]
            system.memory[Conserving] = missed, length

    def _signals(self, system: System) -> list[Signal]:
        return [signal for w in self._wired(system) for signal in (w.effort, w.flow)]

    def _debts(self, attempt: Attempt) -> tuple[list[np.ndarray], float]:
        """Return what is owed for each signal (its unit times s), and over how long a step (s) it arose."""
        system = attempt.system
        if Conserving not in system.memory or attempt.since == attempt.start:
            return [np.zeros(len(s.held)) for s in self._signals(system)], 0.0
        debts: tuple[list[np.ndarray], float] = system.memory[Conserving]
        return debts

    def _feed(self, attempt: Attempt, name: str) -> None:
        """Add what is owed to the inputs of a component."""
        debts, arose = self._debts(attempt)
        over = max(seconds(attempt.end - attempt.start), arose)
        instance, first = attempt.system.instances[name], attempt.system.places[name, "input"].start
        for debt, signal in zip(debts, self._signals(attempt.system), strict=True):
            if signal.target == name:
                instance.u[signal.held - first] += debt / over
        instance.push()
