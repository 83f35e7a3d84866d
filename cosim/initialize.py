"""Consistent initial values: outputs travel along the direct feedthroughs, each after the inputs it depends on."""

from __future__ import annotations

from graphlib import CycleError, TopologicalSorter
from typing import TYPE_CHECKING

from .errors import CouplingError

if TYPE_CHECKING:
    from .system import System

Port = tuple[str, str]  # component, variable


def initialize(system: System, start: int, stop: int | None, tolerance: float | None) -> None:
    """Bring every component of *system* through its initialisation at tick *start*."""
    order = TopologicalSorter(dependencies(system))
    try:
        order.prepare()
    except CycleError as error:
        raise CouplingError(_loop(system, error.args[1])) from None
    for instance in system.instances.values():
        instance.enter_initialization(start, stop, tolerance)
    while order.is_active():
        ready = order.get_ready()
        for name in system.names:
            mine = [port for component, port in ready if component == name]
            driven = [port for port in mine if system.instances[name].variable(port).causality == "input"]
            if driven:
                system.feed(name, driven)
            if len(mine) > len(driven):
                system.collect(name)
        order.done(*ready)
    for instance in system.instances.values():
        instance.exit_initialization()
    for name in system.names:
        system.collect(name)


def dependencies(system: System) -> dict[Port, set[Port]]:
    """Return what each port needs at once: an input its source, an output the connected inputs that feed through."""
    needs: dict[Port, set[Port]] = {}
    for c in system.connections:
        target = (c.target.component, c.target.variable.name)
        needs.setdefault(target, set()).add((c.source.component, c.source.variable.name))
    driven = set(needs)
    for name, instance in system.instances.items():
        for v in instance.variables.values():
            if v.causality == "output":
                needs[name, v.name] = {
                    (c, port) for c, port in driven if c == name and (v.depends_on is None or port in v.depends_on)
                }
    return needs


def _loop(system: System, path: list[Port]) -> str:
    """Write the sentence about an algebraic loop; each port of *path* feeds the next."""
    text = " -> ".join(f"{component}.{port}" for component, port in path)
    undeclared = sorted({
        f"{c}.{p}" for c, p in path
        if (v := system.instances[c].variable(p)).causality == "output" and v.depends_on is None
    })  # fmt: skip
    why = (
        f" ({', '.join(undeclared)}: dependencies not declared, so all inputs are assumed to feed through)"
        if undeclared
        else ""
    )
    return (
        f"the initial values form an algebraic loop, {text}{why}; "
        f"it breaks where one of these outputs comes from a state instead of directly from an input"
    )
