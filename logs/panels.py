"""What runs are compared by over time: one curve per variant and panel, in the log and in the static picture alike."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

FRONT, REAR = (0, 1), (2, 3)  # fl, fr, rl, rr


@dataclass(frozen=True)
class Panel:
    """One quantity: the sum of some values of a port, in a unit for reading."""

    key: str
    title: str
    unit: str
    port: str
    at: tuple[int, ...] = (0,)
    scale: float = 1.0

    def read(self, signal: Callable[[str], np.ndarray | None]) -> np.ndarray | None:
        """Return the curve (n,) of a run whose ports *signal* gives as (n, ...), or None if it has no such port."""
        values = signal(self.port)
        if values is None or values[0].size <= max(self.at):
            return None
        return self.scale * values.reshape(len(values), -1)[:, list(self.at)].sum(axis=1)


DECISIVE = (
    Panel("front_normal_force", "normal force, front axle", "N", "wheels.normal_force", FRONT),
    Panel("rear_normal_force", "normal force, rear axle", "N", "wheels.normal_force", REAR),
    Panel("front_deformation", "deformation, front left (above 0: in the air)", "mm", "wheels.deformation", (0,), 1e3),
    Panel("rear_deformation", "deformation, rear left (above 0: in the air)", "mm", "wheels.deformation", (2,), 1e3),
)  # fmt: skip
MOTION = (
    Panel("front_traction", "traction, front axle", "N", "wheels.traction", FRONT),
    Panel("rear_traction", "traction, rear axle", "N", "wheels.traction", REAR),
    Panel("forward_speed", "forward speed", "m/s", "body.velocity_body", (0,)),
    Panel("vertical_speed", "vertical speed of the centre of mass", "m/s", "body.velocity", (2,)),
    Panel("pitch", "pitch (nose up)", "deg", "body.pitch", (0,), 180 / np.pi),
    Panel("station", "elastic acceleration at station 1", "m/s2", "chassis.acceleration", (0,)),
)
PANELS = DECISIVE + MOTION
