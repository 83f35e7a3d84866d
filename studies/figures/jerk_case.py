"""What the jerk figures are made of: accelerations of a robot on both axles, and how they change with a slope.

Level body, one axle on a slope gamma, the other on the flat.  Accelerations (a_x, a_z, alpha_y) are affine in the
traction F, and so is their change d/d gamma with omega and F held, which is "jerk" in the papers:

    J = (d a / d gamma) (d gamma / dx) v_x                      (DYMAC 11, ASME 5 to 8, TIMR 5 to 7)

d gamma / dx is given nowhere, but where J vanishes is free of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from plants.planar import FRONT, REAR, Bicycle, Posture
from plants.tables import robot

_COMPLEX_STEP = 1e-30
QUANTITIES = ("longitudinal", "normal", "pitch")
DRIVES = {"rear": REAR, "front": FRONT}
STRAIGHT = "level body, rears on the flat, traction at the wheel centres, pitch rate 0"


@dataclass(frozen=True)
class Affine:
    """Something that is affine in the traction: its value without any, and what a newton adds."""

    free: np.ndarray
    gain: np.ndarray

    def at(self, force: float | np.ndarray) -> np.ndarray:
        """Return the values (..., 3) at a *force* (...), N."""
        return np.asarray(self.free + np.multiply.outer(force, self.gain))

    def zero(self, quantity: str) -> float:
        """Return the force, N, at which one of `QUANTITIES` vanishes."""
        i = QUANTITIES.index(quantity)
        return float(-self.free[i] / self.gain[i])


@dataclass(frozen=True)
class Climber:
    """A robot of the tables, level, with one axle on a slope, as the papers see it."""

    table: str
    drive: str = "rear"
    climbs: str = "front"  # the axle on the slope

    @property
    def model(self) -> Bicycle:
        """The planar model, its traction acting at the wheel centres as in the thesis' text and the papers."""
        return Bicycle(robot(self.table), "centre")

    def posture(self, slope: complex) -> Posture:
        """Return the posture with the climbing axle on a *slope*, rad."""
        return Posture(slope) if self.climbs == "front" else Posture(0.0, rear=slope)

    def accelerations(self, slope: float, omega: float = 0.0) -> Affine:
        """Return a_x, a_z, alpha_y with a pitch rate *omega*, rad/s; m/s2 and rad/s2."""
        return Affine(*np.real(self._values(slope, omega)))

    def changes(self, slope: float, omega: float = 0.0) -> Affine:
        """Return d(a_x, a_z, alpha_y)/d gamma with *omega* and the traction held; per rad."""
        return Affine(*(np.imag(self._values(slope + 1j * _COMPLEX_STEP, omega)) / _COMPLEX_STEP))

    def _values(self, slope: complex, omega: float) -> np.ndarray:
        at, twist, model = self.posture(slope), np.array([0.0, 0.0, omega]), self.model
        forces = [F * DRIVES[self.drive] for F in (0.0, 1.0)]
        free, pushed = (model.accelerations(at, model.contact_forces(at, twist, F), F) for F in forces)
        return np.array([free, pushed - free])

    def pitch_rate(self, slope: float, v_x: float) -> float:
        """Return omega, rad/s, of a robot that rolls up the slope with *v_x* (m/s)."""
        return float(np.real(self.model.climbing_twist(self.posture(slope), v_x)[2]))


def flat(slopes: np.ndarray, forces: np.ndarray, **values: np.ndarray) -> dict[str, np.ndarray]:
    """Return a grid as columns, its *values* (forces, slopes)."""
    gamma, F = np.meshgrid(slopes, forces)
    return {"gamma [rad]": gamma.ravel(), "F [N]": F.ravel()} | {k: v.ravel() for k, v in values.items()}
