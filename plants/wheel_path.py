"""The path of a wheel centre over a ground profile, and the table of it that `RigidBody` reads.

The path has no steps in slope or curvature but its own: kinks (impacts, where the wheel touches the ground at two
points) and steps in curvature where an arc about a corner begins or where the curvature of the ground jumps.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, is_dataclass
from functools import lru_cache
from hashlib import sha256
from math import isfinite

import numpy as np
from numpy.typing import ArrayLike

from cosim.errors import ScenarioError
from cosim.kept import kept, of_class

from .patches import Patches, evaluate, fit
from .path_table import Kink, table
from .profile import SAME_ANGLE, Profile
from .rolling import stretches


@dataclass(frozen=True)
class WheelPath:
    """Height of a wheel's centre over world x, m, for a wheel that touches the ground without sinking in."""

    R: float  # m, radius of the wheel
    patches: Patches
    kinks: tuple[Kink, ...]

    def height(self, x: ArrayLike) -> np.ndarray:
        """Return the height of the centre above world z = 0, m."""
        return self.patches.jet(x)[0]

    def slope(self, x: ArrayLike) -> np.ndarray:
        """Return dZ/dx, the tangent of the slope angle of path and touched ground; at a kink that of the next face."""
        return self.patches.jet(x)[1]

    def curvature(self, x: ArrayLike) -> np.ndarray:
        """Return the curvature of the path, 1/m; positive in a hollow, -1/R on a corner."""
        _, slope, second = self.patches.jet(x)
        return second / (1 + slope**2) ** 1.5

    @property
    def departure(self) -> float | None:
        """Where the path first leaves the level it starts on, m; none for level ground."""
        bent = np.any(np.abs(self.patches.c[:, 1:]) > 0, axis=1)
        return float(self.patches.start[np.argmax(bent)]) if bent.any() else None


@lru_cache(maxsize=64)
def rolling_path(profile: Profile, R: float) -> WheelPath:
    """Return the path of the centre of a wheel of radius *R* (m) that rolls over a profile.

    Raises ScenarioError where a vertical face as high as R stops the wheel.
    """
    if not (isfinite(R) and R > 0):
        raise ScenarioError(f"a wheel rolls with a positive radius, not R = {R:g} m")
    path = kept("path", _key(profile, R), lambda: _rolling_path(profile, R))
    for array in (path.patches.start, path.patches.anchor, path.patches.c):
        array.flags.writeable = False
    return path


def _key(profile: Profile, R: float) -> str | None:
    """Return a hash of all that a path depends on; None for a profile that more belongs to than numbers, as a file."""
    known = of_class(type(profile))
    if known is None or not is_dataclass(profile):
        return None
    numbers = [getattr(profile, f.name) for f in fields(profile)]
    if not all(n is None or isinstance(n, int | float) for n in numbers):
        return None
    return sha256(repr((known, numbers, R)).encode()).hexdigest()


def _rolling_path(profile: Profile, R: float) -> WheelPath:
    found: list[Patches] = []
    corners: list[int] = []  # the patch after each meeting of two runs
    for stretch in stretches(profile, float(R)):
        found += [fit(part) for part in stretch.run.between(stretch.start, stretch.end)]
        corners.append(sum(p.start.size for p in found))
    patches = Patches(*(np.concatenate([getattr(p, name) for p in found]) for name in ("start", "anchor", "c")))
    return WheelPath(float(R), patches, _kinks(patches, corners[:-1]))


def _kinks(patches: Patches, corners: list[int]) -> tuple[Kink, ...]:
    """Return the meetings of two runs where the slope jumps."""
    found = []
    for i in corners:
        x = patches.start[i]
        (height, *before), (_, *after) = (
            [float(v) for v in evaluate(patches.anchor[j], patches.c[j], x)] for j in (i - 1, i)
        )
        if np.arctan(after[0]) - np.arctan(before[0]) > SAME_ANGLE:
            found.append(Kink(float(x), height, (before[0], before[1]), (after[0], after[1])))
    return tuple(found)


def wheel_path(profile: Profile, R: float) -> np.ndarray:
    """Return the path table (rows, 16) of `RigidBody` for a wheel of radius *R* (m) on a profile; see `path_table`."""
    path = rolling_path(profile, R)
    return table(path.patches, path.kinks, path.R)
