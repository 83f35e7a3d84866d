"""A ground made for a planned pitch (thesis chapter 5): what the front wheels must roll over, the rears on the level.

Profile angle, pitch and speed are not independent: with both axles on the ground, rears at height 0, the front wheel
centre is at Z = R + L sin p, so its slope theta(t) and the planned p(t) fix its speed, v_t sin theta = L cos p p', and
with it the ground.  The plan of the thesis, theta = xi sin(pi t/T) with p ~ t^4 at both ends, starts and ends at rest
(v_t ~ t^2) and asks for a path whose curvature theta'/v_t ~ 1/t is infinite there.  A wheel rolls through no hollow and
over no crest tighter than its radius: the last 24 % of that manoeuvre (beta = 0.0433 rad, xi = 0.5, R = 0.1 m) lie on a
crest that it cannot follow, and coasting to rest on any other takes for ever.

Here the centre of mass moves evenly instead, X = X_0 + D t/T, while the pitch follows the same degree-7 plan:

    X_f = X_0 + D t/T + L_f cos p + h sin p,    Z_f = R + L sin p,    p = beta (35 t^4 - 84 t^5 + 70 t^6 - 20 t^7)

(t in units of T), which is at the speed D/T at both ends and of bounded curvature.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import cos, inf, sin
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from cosim.errors import ScenarioError

from .profile import Piece, Profile, check_numbers, line

_STARTS = 2001  # points from which Newton's method starts: the inverse is then within 1e-6 of its value


class WheelCentre(NamedTuple):
    """The front wheel centre at normalised times: arrays."""

    x: np.ndarray  # m, world
    z: np.ndarray  # m, above the level ground
    slope: np.ndarray  # rad, climbing positive
    slope_rate: np.ndarray  # rad, d(slope)/dt_n
    speed: np.ndarray  # m, length of the path per unit of t_n


@dataclass(frozen=True)
class PitchManoeuvre(Profile):
    """A smooth step that pitches a robot of the given dimensions by *pitch* while its body moves on by *length*.

    ``start`` is where the ground leaves the level and the front wheel centres must be when the manoeuvre begins.  A
    robot whose centre of mass keeps its speed v takes length / v for it.  The step is L sin(pitch) high.
    """

    start: float = 1.0  # m
    pitch: float = 0.1  # rad, nose-up, at the end
    length: float = 0.35  # m, the way of the centre of mass
    L_f: float = 0.6  # m, centre of mass to front axle
    L_r: float = 0.46  # m, centre of mass to rear axle
    h: float = 0.4  # m, centre of mass above the wheel centres
    R: float = 0.1  # m, wheel radius

    def __post_init__(self) -> None:
        check_numbers(self, positive=("pitch", "length", "L_f", "L_r", "h", "R"), others=("start",))
        if not self.pitch < 0.6:
            raise ScenarioError(f"PitchManoeuvre.pitch is {self.pitch:g} rad; it must be below 0.6 rad")
        t = np.linspace(0, 1, _STARTS)
        if np.any(np.diff(self.centre(t).x) <= 0):
            raise ScenarioError(
                f"PitchManoeuvre.length of {self.length:g} m is too short for a pitch of {self.pitch:g} rad: the front "
                "wheels would have to go back; take a longer one"
            )
        tightest = float(np.min(self._curvature(t)))
        if not tightest * self.R > -1:
            raise ScenarioError(
                f"PitchManoeuvre.length of {self.length:g} m is too short for a pitch of {self.pitch:g} rad: the path "
                f"of the wheel centres would bend by {-tightest:.3g} 1/m on the crest, but a wheel of radius R = "
                f"{self.R:g} m follows no more than {1 / self.R:g} 1/m; take a longer one"
            )

    @property
    def height(self) -> float:
        """Height of the step, m."""
        return (self.L_f + self.L_r) * sin(self.pitch)

    @property
    def end(self) -> float:
        """Where the ground is level again, m."""
        return self.start + self.length + self.L_f * (cos(self.pitch) - 1) + self.h * sin(self.pitch)

    def centre(self, t: ArrayLike) -> WheelCentre:
        """Return where the front wheel centre is and how its path runs at normalised times *t* in [0, 1]."""
        t = np.asarray(t, dtype=float)
        p = self.pitch * t**4 * (35 - 84 * t + 70 * t**2 - 20 * t**3)
        p1, p2 = self.pitch * 140 * t**3 * (1 - t) ** 3, self.pitch * 420 * t**2 * (1 - t) ** 2 * (1 - 2 * t)
        s, c, L = np.sin(p), np.cos(p), self.L_f + self.L_r
        ahead = self.h * c - self.L_f * s  # d(X_f)/dp for a standing centre of mass
        x1, x2 = self.length + ahead * p1, ahead * p2 - (self.h * s + self.L_f * c) * p1**2
        z1, z2 = L * c * p1, L * c * p2 - L * s * p1**2
        return WheelCentre(
            x=self.start + self.length * t + self.L_f * (c - 1) + self.h * s,
            z=self.R + L * s,
            slope=np.arctan2(z1, x1),
            slope_rate=(z2 * x1 - z1 * x2) / (x1**2 + z1**2),
            speed=np.hypot(x1, z1),
        )

    def _curvature(self, t: np.ndarray) -> np.ndarray:
        at = self.centre(t)
        return at.slope_rate / at.speed

    @cached_property
    def pieces(self) -> tuple[Piece, ...]:
        """Level, the step, level."""
        step = Piece(self.start, self.end, self._jet, self.length / 100)
        return line(-inf, self.start, self.start, 0.0), step, line(self.end, inf, self.end, self.height)

    def _jet(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The ground lies R below the path, along its normal: x = X_f + R sin theta, height = Z_f - R cos theta."""
        known = np.linspace(0, 1, _STARTS)
        at = self.centre(known)
        t = np.interp(x, at.x + self.R * np.sin(at.slope), known)
        for _ in range(3):
            at = self.centre(t)
            along = at.speed + self.R * at.slope_rate  # of the contact point: along / speed = 1 + R kappa > 0
            t = np.clip(t - (at.x + self.R * np.sin(at.slope) - x) / (along * np.cos(at.slope)), 0, 1)
        at = self.centre(t)
        bend = at.slope_rate / (at.speed + self.R * at.slope_rate)  # kappa / (1 + R kappa)
        tangent = np.tan(at.slope)
        return at.z - self.R * np.cos(at.slope), tangent, bend * (1 + tangent**2) ** 1.5
