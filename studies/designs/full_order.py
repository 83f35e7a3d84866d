"""The robot of full order, its wheels and chassis as the slots of the analytical robot describe them.

Beside the component's own parameters the slot may say, in the words of those slots,

    k_w = 2.8e6             static radial stiffness of a wheel under its share of the weight, in N/m: all springs of the
                            rings are scaled until a press test finds it
    c_w = 0.0               its damping when pressed slowly, in N.s/m: the dampers likewise
    mu = 0.8                static friction; dynamic friction is at most as much.  Without limit (above 10): traction is
                            not passed by the rings, which no rubber would stand, but laid on at the ground
    chassis = {modes = 25}  modes of the chassis, as for ChassisModal; false, or without it: a rigid one
"""

from __future__ import annotations

from typing import Any

import numpy as np

from cosim import Component
from cosim.errors import ScenarioError
from plants.chassis import chassis
from plants.full_order import FullOrderRover, stable_step
from plants.full_order_ground import ground_table
from plants.ring_press import DAMPINGS, calibrated, damped
from plants.tables import G

from .context import Context

UNLIMITED = 10.0  # friction coefficient that stands for none
USUAL_STEP = 2e-5  # s, of the micro steps, where the springs allow it


def full_order(parameters: dict[str, Any], context: Context) -> Component:
    """Return a `FullOrderRover` on the ground of the run, calibrated; raises ScenarioError for what cannot be."""
    words: dict[str, Any] = {
        name: parameters.pop(name) for name in ("k_w", "c_w", "mu", "chassis") if name in parameters
    }
    given = {
        **context.robot.body_parameters(), **context.ground.tables(context.robot.R),
        "ground_left": ground_table(context.ground.left), "ground_right": ground_table(context.ground.right),
        **_friction(words), **_modes(words), **parameters,
    }  # fmt: skip
    usual = FullOrderRover(**{**given, "micro_step": 1e-12})
    scaled = _rings(words, usual)
    rover = usual.replace(**scaled)
    assert isinstance(rover, FullOrderRover)
    step = parameters.get("micro_step", min(USUAL_STEP, stable_step(rover)))
    return rover.replace(micro_step=step)


def _rings(words: dict[str, Any], rover: FullOrderRover) -> dict[str, Any]:
    """Return the springs and dampers of rings that have the stiffness and the damping asked for."""
    size = (rover.nodes, rover.points)
    load = rover.m * G / 4
    found: dict[str, Any] = {}
    if "k_w" in words:
        found |= calibrated(rover.values, *size, _number(words, "k_w"), load)
    if "c_w" in words:
        if "k_w" not in words:
            raise ScenarioError("c_w goes with k_w: the damping of a wheel is measured at the depth its stiffness has")
        wanted = _number(words, "c_w")
        depth = load / _number(words, "k_w")
        changed = {**rover.values, **found}
        found |= damped(changed, *size, wanted, depth) if wanted else dict.fromkeys(DAMPINGS, 0.0)
    return found


def _number(words: dict[str, Any], name: str) -> float:
    try:
        values = np.ravel(np.asarray(words[name], float))
    except (TypeError, ValueError):
        values = np.array([np.nan])
    if not np.all(values >= 0) or np.ptp(values) > 0 or (name == "k_w" and not values[0] > 0):
        raise ScenarioError(f"{name} is {words[name]!r}; the full-order robot takes one positive number for all wheels")
    return float(values[0])


def _friction(words: dict[str, Any]) -> dict[str, Any]:
    if "mu" not in words:
        return {}
    mu = _number(words, "mu")
    if mu > UNLIMITED:
        return {"laid_on": 1.0}
    return {"mu_s": mu, "mu_d": min(mu, float(FullOrderRover.mu_d.start))}


def _modes(words: dict[str, Any]) -> dict[str, Any]:
    asked = words.get("chassis", False)
    if asked is False:
        return {}
    if not isinstance(asked, dict):
        raise ScenarioError(f"chassis must be a table of the parameters of ChassisModal, or false, not {asked!r}")
    part = chassis(**asked)
    values = {n: part.values[n] for n in ("frequency", "damping", "wheel_shape", "station_shape")}
    return {**part.structure, **values}
