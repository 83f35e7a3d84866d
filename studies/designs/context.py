"""What a design may build on."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from cosim import Component
from plants.full_order import FullOrderRover
from plants.ground import Ground
from plants.ring_press import pressed
from plants.tables import Robot


@dataclass(frozen=True)
class Context:
    """What a design may build on: the robot, the ground, the start, and the parts that need no design, by slot."""

    robot: Robot
    ground: Ground
    x: float  # m, position of the centre of mass at the start
    speed: float  # m/s
    duration: float  # s
    parts: Mapping[str, Component | str]

    def wheels(self) -> Mapping[str, Any]:
        """Return the parameters of the wheels by name, those of rings from a press test; empty for a foreign FMU."""
        body, wheels = self.parts.get("body"), self.parts.get("wheels")
        if isinstance(body, FullOrderRover):
            return pressed(body)
        return wheels.values if isinstance(wheels, Component) else {}

    def traction_arm(self) -> str:
        """Return where traction acts, ``ground`` or ``centre``."""
        body = self.parts.get("body")
        return str(body.structure.get("traction_arm", "ground")) if isinstance(body, Component) else "ground"

    def believed(self, parameters: dict[str, Any]) -> Robot:
        """Return the robot that a design believes in: takes ``robot`` out of the *parameters* and lays it over."""
        return self.robot.with_changes(**parameters.pop("robot", {}))


Design = Callable[[dict[str, Any], Context], Component]
