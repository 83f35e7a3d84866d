"""What a jerk law is worth where it can act: against the best constant force over the same stretch of road."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from controllers.jerk_design import Crossing, best_constant_force
from cosim.errors import ScenarioError

from .designs import Context
from .designs.jerk import road_of
from .metrics.jerk import NormalJerk, normal_jerk, rms
from .runner import Result

_BOUND = 500.0  # N, within which the constant force is sought
_LONGER = 1.1  # the time a rival is given, over the time the planar model takes


@dataclass(frozen=True)
class Rival:
    """A constant force to compare a law with."""

    force: float  # N
    duration: float  # s, in which it crosses

    def override(self) -> Mapping[str, Any]:
        """Return what makes a scenario with a law one with this force."""
        controller = {"type": "ForceProfile", "force": self.force}
        return {"components": {"controller": controller}, "run": {"duration": self.duration}}


def free_stretch(result: Result) -> np.ndarray:
    """Return (n,): where the robot is on the obstacle and its law unlimited; raises ScenarioError without a law."""
    free = result.signal("controller.unlimited")
    if free is None:
        raise ScenarioError(f"{result.scenario.name}, {result.scenario.variant}: no jerk law runs there")
    return _jerk(result).crossing & (np.ravel(free) > 0.5)


def share(result: Result, where: np.ndarray) -> float:
    """Return the part of the time on the obstacle that is spent *where* (n,) is true."""
    step = np.diff(result.record.time)
    return float(np.sum(step * where[1:]) / np.sum(step * _jerk(result).crossing[1:]))


def best_rival(result: Result, definition: str, where: np.ndarray, until: float) -> Rival:
    """Return the constant force with the least jerk of a *definition* over the positions *where* (n,) a law was.

    Sought on the planar model, from the start to *until* (m) and without a floor to the speed: a slow crossing has
    little jerk, what it must not do is stall.
    """
    road, speed = _road(result, until)
    there = np.interp((road.x[1:] + road.x[:-1]) / 2, _positions(result), where.astype(float)) > 0.5
    force = best_constant_force(road, speed, definition, _BOUND, where=there)
    seconds = np.sum(road.seconds(road.speeds(speed, np.full(len(road.x), force))))
    return Rival(round(force, 2), round(_LONGER * float(seconds), 2))


def held_jerk(result: Result, definition: str, law: Result, where: np.ndarray) -> float:
    """Return the RMS normal jerk with the traction held, m/s3, over the positions *where* (n,) a *law* was."""
    there = np.interp(_positions(result), _positions(law), where.astype(float), right=0.0) > 0.5
    found = rms(result.record.time, _jerk(result).held[definition], there)
    if found is None:
        raise ScenarioError(f"{result.scenario.name}: the run never comes to the stretch it is compared on")
    return found


def _road(result: Result, until: float) -> tuple[Crossing, float]:
    assembly, start = result.assembly, result.scenario.sections()["start"]
    assert assembly.robot is not None
    assert assembly.ground is not None
    duration = result.scenario.run.duration
    context = Context(assembly.robot, assembly.ground, start["x"], start["speed"], duration, assembly.components)
    return road_of(context, assembly.robot, 0.0, until), start["speed"]


def _jerk(result: Result) -> NormalJerk:
    found = normal_jerk(result.record.time, result.record.get)
    if found is None:
        raise ScenarioError(f"{result.scenario.name}: jerks need the outputs of a rover's body and wheels")
    return found


def _positions(result: Result) -> np.ndarray:
    return result.record["body.position"][:, 0]
