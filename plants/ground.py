"""Ground profiles as data, and the two tracks the wheels of the left and of the right side roll on.

World axes: x along the track, z up; a profile is extruded along y.  Lengths are in m, angles in rad.  Before its
``start`` every obstacle has level ground at height 0.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import cos, inf, pi, tan
from typing import Literal

import numpy as np

from cosim.errors import ScenarioError

from .csv_profile import CsvProfile
from .profile import Jet, Piece, Profile, Sum, check_numbers, line
from .rough_road import RoughRoad
from .wheel_path import rolling_path, wheel_path


@dataclass(frozen=True)
class Flat(Profile):
    """Level ground."""

    height: float = 0.0  # m

    def __post_init__(self) -> None:
        check_numbers(self, others=("height",))

    @cached_property
    def pieces(self) -> tuple[Piece, ...]:
        """One straight piece."""
        return (line(-inf, inf, 0.0, self.height),)


@dataclass(frozen=True)
class Ramp(Profile):
    """A slope with a sharp or rounded foot, endless or with a level top.

    ``angle`` > 0 climbs.  ``length`` is horizontal, from the sharp foot at ``start`` to the corner at the top; without
    one the ramp is endless.  ``fillet`` is the radius of an arc tangent to the level and to the slope; 0: a sharp foot.
    """

    start: float = 1.0  # m
    angle: float = 0.3  # rad
    length: float | None = None  # m
    fillet: float = 0.0  # m

    def __post_init__(self) -> None:
        check_numbers(self, others=("start", "angle", "fillet"), positive=() if self.length is None else ("length",))
        if not abs(self.angle) < pi / 2:
            raise ScenarioError(f"Ramp.angle is {self.angle:g} rad, but must lie between -pi/2 and pi/2")
        if self.fillet < 0:
            raise ScenarioError(f"Ramp.fillet is {self.fillet:g} m, but must be zero (a sharp foot) or positive")
        needed = self._tangent * cos(self.angle)
        if self.length is not None and needed > self.length:
            raise ScenarioError(
                f"Ramp.fillet of {self.fillet:g} m takes {needed:g} m of the slope, but the ramp is {self.length:g} m "
                "long; take a smaller radius or a longer ramp"
            )

    @property
    def _tangent(self) -> float:
        """Distance from the sharp foot to where the fillet's arc touches either side, m."""
        return self.fillet * tan(abs(self.angle) / 2)

    @cached_property
    def pieces(self) -> tuple[Piece, ...]:
        """Level, the arc if there is one, the slope, and the level top if there is one."""
        slope, top = tan(self.angle), inf if self.length is None else self.start + self.length
        foot, lifted = self.start - self._tangent, self.start + self._tangent * cos(self.angle)
        found = [line(-inf, foot, foot, 0.0)]
        if lifted > foot:
            found.append(Piece(foot, lifted, self._arc(foot), (lifted - foot) / 16))
        if top > lifted:
            found.append(line(lifted, top, self.start, 0.0, slope))
        if self.length is not None:
            found.append(line(top, inf, top, slope * self.length))
        return tuple(found)

    def _arc(self, foot: float) -> Jet:
        sign, radius = np.sign(self.angle), self.fillet

        def jet(x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
            u = x - foot
            rise = np.sqrt(radius**2 - u**2)
            # u^2/(r + rise) in place of r - rise: no cancellation near the foot
            return sign * u**2 / (radius + rise), sign * u / rise, sign * radius**2 / rise**3

        return jet


@dataclass(frozen=True)
class Step(Profile):
    """A vertical step, up for a positive and down for a negative height; level before and behind."""

    start: float = 1.0  # m
    height: float = 0.05  # m

    def __post_init__(self) -> None:
        check_numbers(self, others=("start", "height"))

    @cached_property
    def pieces(self) -> tuple[Piece, ...]:
        """The ground before and behind the step."""
        return line(-inf, self.start, self.start, 0.0), line(self.start, inf, self.start, self.height)


@dataclass(frozen=True)
class Hump(Profile):
    """A smooth hump (a dip for a negative height) between two level stretches.

    ``cosine``: h/2 (1 - cos 2 pi u/l), whose curvature jumps at both ends; ``sin4``: h sin^4(pi u/l), which joins the
    level with continuous second and third derivatives, so that jerk has no step there.
    """

    start: float = 1.0  # m
    length: float = 1.0  # m
    height: float = 0.05  # m
    shape: Literal["cosine", "sin4"] = "cosine"

    def __post_init__(self) -> None:
        check_numbers(self, positive=("length",), others=("start", "height"))
        if self.shape not in ("cosine", "sin4"):
            raise ScenarioError(f"Hump.shape cannot be {self.shape!r}; it is 'cosine' or 'sin4'")

    @cached_property
    def pieces(self) -> tuple[Piece, ...]:
        """Level, hump, level."""
        return _between_levels(self.start, self.length, self._cosine if self.shape == "cosine" else self._sin4)

    def _cosine(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        k = pi / self.length
        s, c = np.sin(k * (x - self.start)), np.cos(k * (x - self.start))
        return self.height * s**2, 2 * self.height * k * s * c, 2 * self.height * k**2 * (c**2 - s**2)

    def _sin4(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        k = pi / self.length
        s, c = np.sin(k * (x - self.start)), np.cos(k * (x - self.start))
        return self.height * s**4, 4 * self.height * k * s**3 * c, 4 * self.height * k**2 * s**2 * (3 * c**2 - s**2)


@dataclass(frozen=True)
class HalfSine(Profile):
    """A bump h sin(pi u/l) with corners at both feet (a hollow for a negative height) between two level stretches."""

    start: float = 1.0  # m
    length: float = 1.0  # m
    height: float = 0.05  # m

    def __post_init__(self) -> None:
        check_numbers(self, positive=("length",), others=("start", "height"))

    @cached_property
    def pieces(self) -> tuple[Piece, ...]:
        """Level, bump, level."""
        return _between_levels(self.start, self.length, self._sine)

    def _sine(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        k = pi / self.length
        s, c = np.sin(k * (x - self.start)), np.cos(k * (x - self.start))
        return self.height * s, self.height * k * c, -self.height * k**2 * s


def _between_levels(start: float, length: float, jet: Callable[[np.ndarray], tuple]) -> tuple[Piece, ...]:
    end = start + length
    return line(-inf, start, start, 0.0), Piece(start, end, jet, length / 100), line(end, inf, end, 0.0)


@dataclass(frozen=True)
class Ground:
    """What the two sides of a robot roll on: ``left`` under wheels with y > 0, ``right`` under the others."""

    left: Profile
    right: Profile

    @classmethod
    def same(cls, profile: Profile) -> Ground:
        """Return a ground with the same profile under both sides."""
        return cls(profile, profile)

    def tables(self, R: float) -> dict[str, np.ndarray]:
        """Return the wheel-centre paths of wheels of radius *R* (m) as `RigidBody` takes them: ``left`` and ``right``.

        Raises ScenarioError if a wheel of that radius cannot roll along.
        """
        return {"left": wheel_path(self.left, R), "right": wheel_path(self.right, R)}

    def departure(self, R: float) -> float | None:
        """Return the least x (m) of a wheel centre from which a wheel of radius *R* is off the level it starts on."""
        found = [rolling_path(profile, R).departure for profile in (self.left, self.right)]
        return min((x for x in found if x is not None), default=None)


__all__ = ["CsvProfile", "Flat", "Ground", "HalfSine", "Hump", "Profile", "Ramp", "RoughRoad", "Step", "Sum"]
