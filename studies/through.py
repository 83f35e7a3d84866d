"""What stands in connections: components with an input ``u`` and an output ``y``, between a source and its target.

A sensor then takes its sample right before the controller that reads it, and an actuator acts right before the wheels:
each is placed immediately before its target in the order of the steps, so that it adds no delay of its own.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

from cosim import Component, Variable
from cosim.errors import ScenarioError, nearest
from cosim.scenario import Element, LinkSpec, Scenario
from fmus.importer import read

from .catalog import COMPONENTS, fill

Parts = Mapping[str, Component | str]


def elements(scenario: Scenario, parts: Parts) -> dict[str, Component | str]:
    """Return what stands in the connections of *parts*, by slot, fitted to the ports that they drive.

    Where the scenario does not say otherwise, an element has the shape and the unit of its target's port and, if it is
    sampled, the period of its target, or the macro step.  Raises ScenarioError for a port that does not exist.
    """
    found: dict[str, Component | str] = {}
    for element in scenario.elements():
        if element.name in parts or element.name in found:
            raise ScenarioError(
                f"{element.where} is to be called {element.name}, like another component; rename that one"
            )
        found[element.name] = _element(element, parts, scenario.run.step)
    return found


def _element(element: Element, parts: Parts, step: float) -> Component | str:
    slot, given = element.slot, element.slot.parameters()
    shape, unit = _port(element, parts)
    if slot.type not in COMPONENTS:
        return fill(slot, element.where, {})
    roles = {name: d.role for name, d in COMPONENTS[slot.type].declarations.items()}
    if (roles.get("u"), roles.get("y")) != ("input", "output"):
        raise ScenarioError(
            f"{element.where} cannot be a {slot.type}: what stands in a connection has an input u and an output y"
        )
    if unit is None and "unit" in roles and "unit" not in given:
        raise ScenarioError(f"{element.where}: {element.target} declares no unit; give that of its source as unit")
    fitting: dict[str, Any] = {"shape": shape, "unit": unit, "period": _period(element, parts, step)}
    return fill(slot, element.where, {n: v for n, v in fitting.items() if n in roles and v is not None})


def _port(element: Element, parts: Parts) -> tuple[tuple[int, ...], str | None]:
    """Return shape and unit of the port that an element drives."""
    name, _, port = element.target.partition(".")
    if name not in parts:
        raise ScenarioError(f"{element.where}: there is no component {name!r}; {nearest(name, parts)}")
    part = parts[name]
    ports: dict[str, tuple[tuple[int, ...], str | None]]
    if isinstance(part, Component):
        ports = {n: (part.shape_of(d), part.unit_of(d)) for n, d in part.declared("input").items()}
    else:
        ports = {n: (v.shape, v.unit) for n, v in read(part).variables.items() if v.causality == "input"}
    if port not in ports:
        raise ScenarioError(f"{element.where}: {name} has no input {port!r}; {nearest(port, ports)}")
    return ports[port]


def _period(element: Element, parts: Parts, step: float) -> float:
    target = parts[element.target.partition(".")[0]]
    return float(target.values["period"]) if isinstance(target, Component) and "period" in target.values else step


def before(order: Sequence[str], placed: Sequence[Element]) -> tuple[str, ...]:
    """Return the *order* of the steps with the elements that it does not name put right before their targets."""
    found = list(order)
    for element in placed:
        if element.name not in order:
            target = element.target.partition(".")[0]
            found.insert(found.index(target) if target in found else 0, element.name)
    return tuple(found)


def rerouted(
    connections: Mapping[str, str | LinkSpec], placed: Sequence[Element], slots: Mapping[str, Mapping[str, Variable]]
) -> dict[str, str | LinkSpec]:
    """Return the *connections* with those of the elements' targets led through them, converted where they enter.

    Raises ScenarioError for a target that nothing drives.
    """
    found = dict(connections)
    for target in dict.fromkeys(e.target for e in placed):
        chain = [e for e in placed if e.target == target]
        wires = {t: found.pop(t) for t in connections if t == target or t.startswith(f"{target}[")}
        if not wires:
            raise ScenarioError(f"{chain[0].where}: nothing drives {target}; connect it, or leave the element out")
        name, _, port = target.partition(".")
        found |= {f"{chain[0].name}.u{t.removeprefix(target)}": source for t, source in wires.items()}
        for one, other in pairwise(chain):
            found[f"{other.name}.u"] = f"{one.name}.y"
        last = f"{chain[-1].name}.y"
        # what the element gives a port without a unit is the number that the connection meant
        found[target] = LinkSpec(source=last, factor=1.0) if slots[name][port].unit is None else last
    return found
