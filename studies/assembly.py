"""From a scenario to components, start values and wires: the rover, or any components and FMUs wired by hand."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from cosim import Component, Variable
from cosim.algorithms import Order
from cosim.errors import ScenarioError, nearest
from cosim.scenario import LinkSpec, Scenario, Slot, describe_problem
from plants import rover
from plants.full_order import FullOrderRover
from plants.ground import Ground
from plants.tables import Robot, robot

from . import full_order
from .catalog import fill, profile
from .designs import DESIGNS, Context
from .metrics import check_groups
from .through import before, elements, rerouted


class StartSpec(BaseModel):
    """Where the rover starts: position of its centre of mass along the road in m, speed in m/s."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    x: float = 0.0
    speed: float = Field(2.0, strict=True)


class RoverSections(BaseModel):
    """The sections of a scenario that only the rover understands."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    robot: dict[str, Any]
    ground: dict[str, Any]
    start: StartSpec = StartSpec()


@dataclass(frozen=True)
class Assembly:
    """Everything a run is made of, before any FMU is loaded."""

    scenario: Scenario
    components: dict[str, Component | str]  # slot: component, or the path of a foreign FMU
    connections: dict[str, LinkSpec]  # beside those that the rover makes by itself
    order: Order
    every: dict[str, int]
    starts: dict[str, np.ndarray] = field(default_factory=dict)
    robot: Robot | None = None
    ground: Ground | None = None
    driven: bool = False  # a body with its own drive is given torques, as the drive of the scenario would be
    notes: tuple[str, ...] = field(default=())

    def wiring(self, slots: Mapping[str, Mapping[str, Variable]]) -> dict[str, str | LinkSpec]:
        """Return all connections among the *slots*, given the variables of each: the rover's own and the scenario's.

        Where something stands in a connection, it leads through it.
        """
        own = rover.wires(slots, driven=self.driven) if self.robot is not None else {}
        return rerouted({**own, **self.connections}, self.scenario.elements(), slots)


def assemble(scenario: Scenario, objects: Mapping[str, Component] = MappingProxyType({})) -> Assembly:
    """Resolve a scenario; raises ScenarioError naming the key for anything that does not exist or does not fit.

    *objects* stand in their slots instead of what the scenario says of these.
    """
    check_groups(scenario.verdict)
    _check_objects(scenario, objects)
    if scenario.assembly is None:
        made = _free(scenario, objects)
    elif scenario.assembly == "rover":
        made = _rover(scenario, objects)
    else:
        raise ScenarioError(f"{scenario.name}: there is no assembly {scenario.assembly!r}; known: rover")
    told = tuple(
        f"an object of the class {type(part).__name__} stands in the slot {name}, which a log cannot run again"
        for name, part in objects.items()
    )
    return replace(made, notes=(*made.notes, *told))


def _check_objects(scenario: Scenario, objects: Mapping[str, Component]) -> None:
    slots = dict.fromkeys([*scenario.components, *(rover.ORDER if scenario.assembly == "rover" else ())])
    for name, part in objects.items():
        if name not in slots:
            raise ScenarioError(f"{scenario.name}: there is no slot {name!r}; {nearest(name, slots)}")
        if not isinstance(part, Component):
            raise ScenarioError(f"{scenario.name}: {name} is given {part!r}, and a slot takes an object of a component")


def _free(scenario: Scenario, objects: Mapping[str, Component]) -> Assembly:
    if scenario.sections():
        key = next(iter(scenario.sections()))
        raise ScenarioError(f'{scenario.name}: {key} is not known here; did you leave out assembly = "rover"?')
    if not scenario.components:
        raise ScenarioError(f"{scenario.name}: there are no components; add [components.NAME] with a type or an fmu")
    parts = {
        name: objects[name] if name in objects else fill(slot, f"components.{name}", {})
        for name, slot in scenario.components.items()
    }
    return _complete(scenario, parts)


def _complete(scenario: Scenario, parts: dict[str, Component | str], **rest: Any) -> Assembly:
    """Return the assembly of the *parts* in their order, with what stands in connections right before its target."""
    placed = scenario.elements()
    every = {name: slot.every for name, slot in scenario.components.items()} | {e.name: e.slot.every for e in placed}
    between = elements(scenario, parts)
    order = scenario.run.order
    if order != "computed":
        order = before(order or tuple(parts), placed)
    everything = {name: {**parts, **between}[name] for name in before(tuple(parts), placed)}
    return Assembly(scenario, everything, dict(scenario.connections), order=order, every=every, **rest)


def _rover(scenario: Scenario, objects: Mapping[str, Component]) -> Assembly:
    try:
        sections = RoverSections.model_validate(scenario.sections())
    except ValidationError as error:
        raise ScenarioError(f"{scenario.name}: {describe_problem(error, RoverSections)}") from None
    changes = dict(sections.robot)
    bot = robot(str(changes.pop("table", "thesis_6_1"))).with_changes(**changes)
    road = _ground(sections.ground)
    whole = full_order.is_whole(scenario)
    believed = full_order.believed(scenario) if whole else {}
    if whole:
        scenario = full_order.merged(scenario)
    slots = {"body": Slot(), **scenario.components, **believed}
    if slots["body"].type is None and slots["body"].fmu is None:  # the scenario may give only its parameters
        slots["body"] = slots["body"].model_copy(update={"type": "RigidBody"})
    if not whole and "wheels" not in {**slots, **objects}:
        raise ScenarioError(f"{scenario.name}: components.wheels is missing; a rover needs wheels")
    parts: dict[str, Component | str] = dict(objects)
    # a design builds on the parts that need none, that of a controller on all others
    open_slots = [name for name in slots if name not in objects]
    for name in sorted(open_slots, key=lambda n: (slots[n].type in DESIGNS, n == "controller")):
        slot = slots[name]
        given = {**bot.body_parameters(), **road.tables(bot.R)} if slot.type == "RigidBody" else {}
        context = Context(bot, road, sections.start.x, sections.start.speed, scenario.run.duration, parts)
        parts[name] = fill(slot, f"components.{name}", given, context)
    parts = {name: parts[name] for name in (*rover.ORDER, *slots) if name in parts and name not in believed}
    starts: dict[str, np.ndarray] = {}
    own = {n: c for n, c in parts.items() if isinstance(c, Component)}
    stance = rover.Stance(sections.start.x, sections.start.speed)
    body = own.get("body")
    if isinstance(body, FullOrderRover):
        starts = full_order.start_values(body, road, stance)
    elif "body" in own and "wheels" in own:
        starts = rover.start_values(own, stance)
    return _complete(
        scenario, parts, starts=starts, robot=bot, ground=road, driven=bool(believed), notes=_notes(scenario)
    )


def _notes(scenario: Scenario) -> tuple[str, ...]:
    """Return what is to be said of how the reduced interface model is coupled."""
    notes = []
    if scenario.run.algorithm == "jacobi":
        notes.append(
            "Jacobi with the reduced interface model is worse than the classical coupling (0.5 m/s at a macro step of "
            "1e-4 s on the ramp): the wheels and the body then use each other's values of the step before; "
            'algorithm = "gauss-seidel" is what this assembly is made for'
        )
    if scenario.run.extrapolate:
        notes.append(
            "run.extrapolate spoils the reduced interface model (6e-3 m/s instead of 1.5e-5 over the first contact, "
            "at a macro step of 1e-4 s on the ramp): the wheels give mean forces over a step, which are no values at "
            "its end; extrapolate = 0 is what this assembly is made for"
        )
    return tuple(notes)


def _ground(spec: dict[str, Any]) -> Ground:
    sides = {"left", "right"} & set(spec)
    if not sides:
        return Ground.same(profile(spec, "ground"))
    if sides != {"left", "right"} or len(spec) != 2:
        raise ScenarioError("ground needs either one profile, or exactly ground.left and ground.right")
    return Ground(profile(spec["left"], "ground.left"), profile(spec["right"], "ground.right"))
