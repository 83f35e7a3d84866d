"""Consistent initial values: outputs travel along the direct feedthroughs, each after the inputs it depends on."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .propagate import Propagation

if TYPE_CHECKING:
    from .system import System


def initialize(system: System, start: int, stop: int | None, tolerance: float | None) -> None:
    """Bring every component of *system* through its initialisation at tick *start*, algebraic loops solved.

    Both versions of FMI allow outputs to be read after inputs were set as often as needed in initialisation mode.
    """
    propagation = Propagation(system)
    for instance in system.instances.values():
        instance.enter_initialization(start, stop, tolerance)
    propagation.run("at initialisation")
    for instance in system.instances.values():
        instance.exit_initialization()
    for name in system.names:
        system.collect(name)
