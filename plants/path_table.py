"""The table of a wheel-centre path: rows that hold, beside the path itself, the other face of the nearest kink.

Columns: x_start | xa, a0..a5 | xb, b0..b5 | parity.  Face A is the one left of the nearest concave kink, face B the one
right of it, Z_A(x) = sum a_i (x - xa)^i.  The wheel touches the face with the smaller signed distance d; the sign of
parity (d_A - d_B) says which one that is, and changes only when a wheel goes from one face to the other.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .patches import Patches

COLUMNS = 16
_SAME_X = 1e-9  # m, below which two starts of rows are one
_SAMPLES = 64  # of the slope beside a kink
_OPENING = 0.5  # of the kink's jump in slope: two faces compete while they open at least so fast


@dataclass(frozen=True)
class Kink:
    """A concave corner of the path, where a wheel touches the ground at two points."""

    x: float  # m
    height: float  # m, of the wheel centre
    before: tuple[float, float]  # slope dZ/dx and d2Z/dx2 (1/m) of the face left of it
    after: tuple[float, float]  # and of the face right of it

    def face(self, side: int) -> np.ndarray:
        """Return the face left (-1) or right (+1) of the kink, carried on beyond it: anchor and coefficients, (7,).

        It goes on with the curvature it had where it bends down, so that a wheel pressed into both faces feels no step
        when its centre passes the kink; a face that bends up goes on straight, or it might meet the path again.
        """
        slope, second = self.before if side < 0 else self.after
        return np.array([self.x, self.height, slope, min(0.0, second) / 2, 0, 0, 0])


def table(patches: Patches, kinks: tuple[Kink, ...], R: float) -> np.ndarray:
    """Return the rows of a path with its kinks for a wheel of radius *R* (m), shape (n, 16).

    Within R of a kink, as long as the two faces keep opening and at most half-way to the next kink, the other face is
    the one beyond the kink, carried on.  Elsewhere there is none: a straight line R below the path stands for it, out
    of reach.  The letters change half-way between two kinks, and the parity with them.
    """
    if not kinks:
        own = np.column_stack([patches.anchor, patches.c])
        return np.column_stack([patches.start, own, own, np.zeros(len(own))])
    x = np.array([kink.x for kink in kinks])
    middles = (x[:-1] + x[1:]) / 2
    left, right = _reach(patches, kinks, middles, R)
    start = _merged(patches.start, np.concatenate([left, right, middles]))
    late = start + _SAME_X
    own = np.column_stack(patches.at(start))
    nearest = np.searchsorted(middles, late)
    after = late > x[nearest]
    other = (own - np.array([0, R, 0, 0, 0, 0, 0])) * np.array([1, 1, 1, 0, 0, 0, 0])
    for i in np.flatnonzero((late > left[nearest]) & (late < right[nearest])):
        other[i] = kinks[nearest[i]].face(-1 if after[i] else +1)
    a, b = np.where(after[:, None], other, own), np.where(after[:, None], own, other)
    return np.column_stack([start, a, b, np.where(nearest % 2, -1.0, 1.0)])


def _merged(starts: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Return all starts and those of the others that are not the same but for rounding, ascending."""
    others = np.unique(others)
    others = others[np.append(True, np.diff(others) > _SAME_X)]
    apart = np.min(np.abs(others[:, None] - starts[_around(starts, others)]), axis=1) > _SAME_X
    return np.sort(np.concatenate([starts, others[apart]]))


def _around(starts: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Return the indices of the starts before and behind each x, shape (n, 2)."""
    behind = np.searchsorted(starts, x)
    return np.clip(np.stack([behind - 1, behind], axis=1), 0, starts.size - 1)


def _reach(patches: Patches, kinks: tuple[Kink, ...], middles: np.ndarray, R: float) -> tuple[np.ndarray, np.ndarray]:
    """Return from where to where (m) the faces of each kink compete."""
    x = np.array([kink.x for kink in kinks])
    slopes = np.array([(kink.before[0], kink.after[0]) for kink in kinks])
    steps = np.linspace(0, 1, _SAMPLES + 1)[1:]
    ends = []
    for side, limits in ((-1, np.concatenate([[x[0] - R], middles])), (1, np.concatenate([middles, [x[-1] + R]]))):
        span = np.minimum(R, np.abs(limits - x))
        at = x[:, None] + side * span[:, None] * steps
        other = np.array([k.face(-side) for k in kinks])
        _, slope, _ = patches.jet(at)
        carried = other[:, 2, None] + 2 * other[:, 3, None] * (at - x[:, None])
        opening = side * (slope - carried) >= _OPENING * (slopes[:, 1:] - slopes[:, :1])
        kept = np.maximum(np.argmin(np.column_stack([opening, np.zeros(len(x), bool)]), axis=1), 1)
        ends.append(at[np.arange(len(x)), kept - 1])
    return ends[0], ends[1]
