"""The robot of full order in a scenario of the analytical one: one line swaps the plant.

    [components.body]
    type = "FullOrderRover"

What the scenario says of wheels, chassis and drive then describes the rings, the modes and the rims, and these slots
fall away; what it puts into the connections of wheels and drive stands in those of the body.  With a drive the rims are
given the torques of the controller, without one the robot's own drive gives the traction it asks for.  The friction
curve of the drive is then what a controller believes in: the rings have their own.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from cosim.errors import ScenarioError
from cosim.scenario import Scenario, Slot
from plants.full_order import FullOrderRover
from plants.full_order_start import rolling, settled
from plants.ground import Ground
from plants.rover import Stance

TYPE = FullOrderRover.__name__
_TAKEN = {"wheels": ("k_w", "c_w", "mu"), "drive": ("J_w", "v_min")}  # from these slots; J_w: of rims, without rings
_LEVEL = 1e-9  # m
_FOOT = 0.2  # of the radius: the ground there is level under a standing wheel


def is_whole(scenario: Scenario) -> bool:
    """Return whether the robot of a scenario is the one of full order."""
    return "body" in scenario.components and scenario.components["body"].type == TYPE


def believed(scenario: Scenario) -> dict[str, Slot]:
    """Return the slot of the drive, if there is one, by its name: no part of the run, but designs build on it."""
    return {name: slot for name, slot in scenario.components.items() if name == "drive"}


def merged(scenario: Scenario) -> Scenario:
    """Return the scenario with its wheels, its drive and its chassis in the slot of the body."""
    slots = dict(scenario.components)
    found: dict[str, Any] = {}
    for name in ("wheels", "chassis", "drive"):
        slot = slots.pop(name, None)
        if slot is None:
            continue
        if slot.fmu is not None:
            raise ScenarioError(f"components.{name} is the FMU {slot.fmu}, but a {TYPE} has its own {name}")
        if name == "chassis":
            found["chassis"] = slot.parameters()
        else:
            found |= {key: value for key, value in slot.parameters().items() if key in _TAKEN[name]}
    body = slots["body"]
    slots["body"] = Slot.model_validate({**found, **body.model_dump(exclude_unset=True)})
    through = {_at_body(target): chain for target, chain in scenario.through.items()}
    return scenario.model_copy(update={"components": slots, "through": through})


def _at_body(target: str) -> str:
    slot, _, port = target.partition(".")
    return f"body.{port}" if slot in _TAKEN else target


def start_values(rover: FullOrderRover, ground: Ground, stance: Stance) -> dict[str, np.ndarray]:
    """Return ``body.state`` at the start: settled on level ground, or on round wheels where gravity is yet to come.

    Raises ScenarioError where the wheels are not on level ground.
    """
    hubs = stance.x + np.array([rover.L_f, -rover.L_r])
    offset = rover.R * np.linspace(-1, 1, 201)
    heights = np.array([side.elevation(x + offset) for side in (ground.left, ground.right) for x in hubs])
    level = float(heights[0, 100])
    below = level + rover.R - np.sqrt(rover.R**2 - offset**2)  # a round wheel that stands at that level
    foot = np.abs(offset) <= _FOOT * rover.R
    if np.ptp(heights[:, foot]) > _LEVEL or np.any(heights > below + _LEVEL):
        raise ScenarioError(
            f"a {TYPE} starts with all wheels on level ground, but at start.x = {stance.x:g} m the wheels at "
            f"{hubs[0]:.4g} and {hubs[1]:.4g} m meet something else; change start.x, or move the obstacle"
        )
    if rover.gravity_time > 0:
        found = rolling(rover, stance.x, level + rover.R + rover.h, stance.speed)
    else:
        found = settled(rover, stance.x, level, stance.speed)
    return {f"body.{name}": value for name, value in found.items()}
