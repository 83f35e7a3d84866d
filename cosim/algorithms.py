"""How coupled components advance together by one macro step: small, interchangeable strategies.

An algorithm decides in which order components are fed, stepped and collected; ``Attempt`` does the rest.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, Protocol

from .errors import CouplingError, nearest
from .order import computed_order

if TYPE_CHECKING:
    from .attempt import Attempt
    from .system import System

Order = tuple[str, ...] | Literal["computed"]


class Algorithm(Protocol):
    """What the master asks of an algorithm."""

    def sequence(self, system: System) -> tuple[str, ...]:
        """Return all components in the order they step."""

    def advance(self, attempt: Attempt) -> None:
        """Step every component that is due, or return as soon as ``attempt.step`` says that one stopped early."""

    def delay(self, system: System, source: str, target: str) -> int:
        """Return how many steps old the values of *source* are that *target* holds at the end of its step."""


@dataclass(frozen=True)
class Jacobi:
    """Everybody steps on the outputs from the start of the step: order 1, whatever the order of the components."""

    def sequence(self, system: System) -> tuple[str, ...]:
        """Return those that may return early first: then nobody else has to be taken back."""
        return tuple(sorted(system.names, key=lambda name: not system.instances[name].can.early_return))

    def advance(self, attempt: Attempt) -> None:
        """Feed all whose step begins, then step and collect all whose step ends."""
        for name in attempt.beginning:
            attempt.feed(name)
        for name in attempt.due:
            if not attempt.step(name):
                return
        for name in attempt.due:
            attempt.system.collect(name)

    def delay(self, system: System, source: str, target: str) -> int:
        """Return 1: every value is from the start of the step."""
        return 1


@dataclass(frozen=True)
class GaussSeidel:
    """Components step in turn, each on the newest outputs of those before it and the old ones of those behind it.

    Order 1 in general; the *order* (empty: the system's own) decides which connections are delayed.  ``"computed"`` is
    the one with the fewest.
    """

    order: Order = ()

    def __post_init__(self) -> None:
        if self.order != "computed":
            object.__setattr__(self, "order", tuple(self.order))

    def sequence(self, system: System) -> tuple[str, ...]:
        """Return the order; raises CouplingError unless it names every component once."""
        if self.order == "computed":
            return computed_order(system)
        order = self.order or system.names
        for name in order:
            if name not in system.instances:
                raise CouplingError(
                    f"the order of GaussSeidel names no component {name!r}; {nearest(name, system.names)}"
                )
        for name in system.names:
            if (times := order.count(name)) != 1:
                raise CouplingError(f"the order of GaussSeidel names {name} {times} times; name every component once")
        return order

    def advance(self, attempt: Attempt) -> None:
        """Feed, step and collect in turn."""
        for name in attempt.due:
            attempt.feed(name)
            if not attempt.step(name):
                return
            attempt.system.collect(name)

    def delay(self, system: System, source: str, target: str) -> int:
        """Return 0 for a source that steps before its target, 1 otherwise."""
        order = self.sequence(system)
        return int(order.index(source) >= order.index(target))
