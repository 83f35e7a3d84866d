"""Outputs brought up to date at every communication point, algebraic loops solved: an addition to any algorithm.

Without it an output that an input reaches at once shows, after a step, what the input was during the step.  With it
the inputs are set to what their sources have now, and the outputs are read again, before anybody is told of the point.

FMI 3.0 lets inputs be set and outputs be read in step mode; FMI 2.0 forbids to read after setting without a step in
between.  So a component that does not promise it takes part only if it is named, and whoever takes part is tried once:
one that goes on showing its old outputs is left as it is.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .algorithms import Algorithm
from .clock import seconds
from .errors import CouplingError, nearest
from .propagate import Propagation
from .structure import Loop, feedthrough_graph, loop_of, stages

if TYPE_CHECKING:
    from .attempt import Attempt
    from .system import System

MOVED = 1e-3  # of an input or its nominal: how far it is moved to see whether the outputs follow


@dataclass(frozen=True)
class Consistent:
    """*algorithm*, and after each of its steps every output that follows from what is connected at that instant.

    *trusted* names components that may be read after setting although they do not promise it, as FMUs of FMI 2.0.
    Raises CouplingError for an algebraic loop through a component that cannot be read, or without a solution.
    """

    algorithm: Algorithm
    trusted: tuple[str, ...] = ()

    def sequence(self, system: System) -> tuple[str, ...]:
        """Return the sequence of the algorithm; raises CouplingError for a loop that must not be solved."""
        for name in self.trusted:
            if name not in system.instances:
                raise CouplingError(f"Consistent trusts no component {name!r}; {nearest(name, system.names)}")
        system.memory[Consistent, *self.trusted] = _Points(system, self.trusted)
        return self.algorithm.sequence(system)

    def advance(self, attempt: Attempt) -> None:
        """Advance, then bring those up to date that are at the end of the step."""
        self.algorithm.advance(attempt)
        if not attempt.stopped and not attempt.terminated:
            there = frozenset(name for name, time in attempt.system.time.items() if time == attempt.end)
            attempt.system.memory[Consistent, *self.trusted].update(there, f"at t = {seconds(attempt.end):.9g} s")

    def delay(self, system: System, source: str, target: str) -> int:
        """Return the delay of the algorithm: over a step inputs are held as ever."""
        return self.algorithm.delay(system, source, target)


class _Points:
    """The communication points of one system: who is brought up to date there, found out at the first of them."""

    def __init__(self, system: System, trusted: tuple[str, ...]) -> None:
        self.system = system
        self.follows = {name: i.can.get_after_set or name in trusted for name, i in system.instances.items()}
        self.tried: set[str] = set()
        self.made: dict[frozenset[str], Propagation] = {}
        self._refuse("does not promise outputs for inputs that are set between steps (FMI 2.0 forbids to ask); "
                     "name it in trusted to have it tried")  # fmt: skip

    def update(self, there: frozenset[str], when: str) -> None:
        """Carry the values of now through those who are *there*, in the middle of no step of their own."""
        if there not in self.made:
            for name in sorted(there - self.tried):
                self.follows[name] = self.follows[name] and follows(self.system, name)
            self.tried |= there
            self._refuse("goes on showing the outputs of its last step after its inputs were set")
            among = [name for name in there if self.follows[name]]
            self.made[there] = Propagation(self.system, among, numeric=True)
        self.made[there].run(when)

    def _refuse(self, why: str) -> None:
        """Refuse a loop through a component that does not follow; others are left as they are."""
        for loop in numeric_loops(self.system):
            for name in loop.components:
                if not self.follows[name]:
                    raise CouplingError(
                        f"the algebraic loop {loop} cannot be solved at communication points: {name} {why}; "
                        f"without Consistent each of its connections is delayed instead"
                    )


def numeric_loops(system: System) -> list[Loop]:
    """Return the algebraic loops that communication points have: of Float64 connections."""
    needs = feedthrough_graph(system, numeric=True)
    return [loop_of(system, needs, group) for stage in stages(needs) for group in stage if len(group) > 1]


def follows(system: System, name: str) -> bool:
    """Try whether the outputs of a component follow its inputs at once, as it declares; all is as before afterwards.

    True also where nothing feeds through, and where its own derivatives say that the outputs stand still here.
    """
    instance = system.instances[name]
    needs = feedthrough_graph(system, [name], numeric=True)
    outputs = [port for (_, port), found in needs.items() if found and port in instance.y_at]
    inputs = list(dict.fromkeys(port for output in outputs for _, port in needs[name, output]))
    if not outputs:
        return True
    u, y = instance.u.copy(), instance.y.copy()
    for port in inputs:
        at = instance.u_at[port]
        instance.u[at] += MOVED * np.maximum(np.abs(u[at]), abs(instance.variable(port).nominal) or 1.0)
    seed = np.concatenate([instance.u[instance.u_at[port]] - u[instance.u_at[port]] for port in inputs])
    instance.push()
    instance.pull()
    moved = any(np.any(instance.y[instance.y_at[port]] != y[instance.y_at[port]]) for port in outputs)
    instance.u[:] = u
    instance.push()
    instance.pull()
    if moved or not instance.can.directional_derivatives:
        return moved
    return not np.any(instance.directional_derivative(outputs, inputs, seed))
