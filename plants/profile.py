"""What a ground profile is: the height of the ground over world x, in pieces between which slope or height may jump.

A profile is a frozen dataclass that lists its pieces from x = -inf to +inf.  Each piece knows height, slope and second
derivative in closed form up to and including both of its ends, so corners are exact and nothing is ever differenced.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from math import inf, isfinite

import numpy as np
from numpy.typing import ArrayLike

from cosim.errors import ScenarioError

Jet = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]]

# Below these a difference between two neighbouring pieces is rounding, not a corner or a jump in curvature.
SAME_HEIGHT = 1e-12  # m
SAME_ANGLE = 1e-9  # rad
SAME_CURVATURE = 1e-6  # 1/m


@dataclass(frozen=True)
class Piece:
    """Smooth ground for start <= x <= end (m).

    ``jet(x)`` returns height (m), dh/dx (1) and d2h/dx2 (1/m) for an array x, one-sided at the two ends.
    ``resolution`` (m) is a spacing at which samples still show every bend; infinite for a straight piece.
    """

    start: float
    end: float
    jet: Jet
    resolution: float = inf

    @property
    def straight(self) -> bool:
        """Whether the piece has no curvature."""
        return self.resolution == inf

    def at(self, x: float) -> tuple[float, float, float]:
        """Return height, slope and second derivative at one point of the piece."""
        h, h1, h2 = self.jet(np.array([x]))
        return float(h[0]), float(h1[0]), float(h2[0])


def line(start: float, end: float, at: float, height: float, slope: float = 0.0) -> Piece:
    """Return the straight piece through (at, height), in m, with a slope dh/dx."""

    def jet(x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return height + slope * (x - at), np.full_like(x, slope), np.zeros_like(x)

    return Piece(start, end, jet)


class Profile(ABC):
    """Base of all profiles: a frozen dataclass that says of which pieces it is made."""

    @property
    @abstractmethod
    def pieces(self) -> tuple[Piece, ...]:
        """The pieces from x = -inf to +inf, ascending and without holes, the outermost ones straight."""

    @cached_property
    def breakpoints(self) -> np.ndarray:
        """Where one piece ends and the next starts, m."""
        return np.array([piece.start for piece in self.pieces[1:]])

    def jet(self, x: ArrayLike) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return height (m), slope (1) and second derivative (1/m) at x; at a breakpoint those of the next piece."""
        points = np.asarray(x, dtype=float)
        flat, result = points.ravel(), np.empty((3, points.size))
        which = np.searchsorted(self.breakpoints, flat, side="right")
        for i in np.unique(which):
            result[:, which == i] = self.pieces[i].jet(flat[which == i])
        h, h1, h2 = result.reshape(3, *points.shape)
        return h, h1, h2

    def elevation(self, x: ArrayLike) -> np.ndarray:
        """Return the height of the ground above world z = 0, m."""
        return self.jet(x)[0]

    def slope(self, x: ArrayLike) -> np.ndarray:
        """Return dh/dx, the tangent of the slope angle; positive climbs along +x."""
        return self.jet(x)[1]

    def curvature(self, x: ArrayLike) -> np.ndarray:
        """Return the curvature of the ground, 1/m; positive in a hollow."""
        _, h1, h2 = self.jet(x)
        return h2 / (1 + h1**2) ** 1.5

    @cached_property
    def corners(self) -> tuple[float, ...]:
        """Where height or slope jumps, m."""
        return tuple(b.start for a, b in self._pairs() if not joined_smoothly(a, b))

    @cached_property
    def knots(self) -> tuple[float, ...]:
        """Where the slope is continuous but the curvature jumps, m."""
        return tuple(
            b.start
            for a, b in self._pairs()
            if joined_smoothly(a, b) and abs(b.at(b.start)[2] - a.at(a.end)[2]) > SAME_CURVATURE
        )

    def _pairs(self) -> Iterable[tuple[Piece, Piece]]:
        return pairwise(self.pieces)


def joined_smoothly(a: Piece, b: Piece) -> bool:
    """Whether piece b continues a with the same height and slope."""
    (h_a, slope_a, _), (h_b, slope_b, _) = a.at(a.end), b.at(b.start)
    return abs(h_b - h_a) <= SAME_HEIGHT and abs(np.arctan(slope_b) - np.arctan(slope_a)) <= SAME_ANGLE


@dataclass(frozen=True)
class Sum(Profile):
    """Profiles added up, such as obstacles one behind the other or a rough road over a hump."""

    profiles: tuple[Profile, ...]

    def __post_init__(self) -> None:
        if not self.profiles:
            raise ScenarioError("Sum.profiles is empty; give at least one profile")

    @cached_property
    def pieces(self) -> tuple[Piece, ...]:
        """The pieces between all breakpoints of all summands."""
        ends = [-inf, *sorted({x for p in self.profiles for x in p.breakpoints.tolist()}), inf]
        found = []
        for start, end in pairwise(ends):
            parts = [p.pieces[np.searchsorted(p.breakpoints, start, side="right")] for p in self.profiles]
            found.append(Piece(start, end, _added(parts), min(part.resolution for part in parts)))
        return tuple(found)


def _added(parts: list[Piece]) -> Jet:
    def jet(x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        h, h1, h2 = np.sum([part.jet(x) for part in parts], axis=0)
        return h, h1, h2

    return jet


def check_numbers(profile: Profile, *, positive: tuple[str, ...] = (), others: tuple[str, ...] = ()) -> None:
    """Raise ScenarioError unless the named fields are finite numbers, and those of *positive* above zero."""
    kind = type(profile).__name__
    for name in (*positive, *others):
        value = getattr(profile, name)
        if isinstance(value, bool) or not isinstance(value, (int, float, np.number)) or not isfinite(value):
            raise ScenarioError(f"{kind}.{name} must be a finite number, not {value!r}")
        if name in positive and not value > 0:
            raise ScenarioError(f"{kind}.{name} is {value:g}, but must be positive")
