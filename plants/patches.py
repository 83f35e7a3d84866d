"""Quintic patches through exact points of a curve: height, slope and second derivative are met at both ends of each."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

import numpy as np
from numpy.typing import ArrayLike

from .rolling import EDGE, Arc, Roll

HEIGHT_ERROR = 1e-9  # m, of a patch against the exact path; up to 1e-6 m where `_SHORTEST` stops the halving
SLOPE_ERROR = 5e-7  # of dZ/dx
_LONGEST = 0.25  # radii: a curved patch is no longer, to keep its power form well conditioned
# Radii: a patch of rolling is not halved below this.  A sunk or lifted wheel touches beside its centre, so a reader
# carries the patch at the centre on beyond its ends, and a quintic much shorter than that way is of no use there.
_SHORTEST = 1 / 400
_CHECKED = np.array([[0.2], [0.35], [0.5], [0.65], [0.8], [1.0]])  # where in a patch the errors are looked at
_HALVINGS = 30


@dataclass(frozen=True)
class Patches:
    """Quintics sum c_i (x - anchor)^i, each from its ``start`` (m, ascending) to the next one's."""

    start: np.ndarray  # (n,)
    anchor: np.ndarray  # (n,)
    c: np.ndarray  # (n, 6)

    def jet(self, x: ArrayLike) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return value, first and second derivative at x."""
        points = np.asarray(x, dtype=float)
        return evaluate(*self.at(points), points)

    def at(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return anchor and coefficients of the patches that hold the points x."""
        which = np.maximum(np.searchsorted(self.start, x, side="right") - 1, 0)
        return self.anchor[which], self.c[which]


def evaluate(anchor: np.ndarray, c: np.ndarray, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return value and two derivatives at x of quintics with anchors and coefficients (..., 6), by Horner's rule."""
    u = x - anchor
    v = np.zeros_like(u)
    v1, v2 = np.zeros_like(u), np.zeros_like(u)
    for i in range(5, -1, -1):
        v2 = v2 * u + 2 * v1
        v1 = v1 * u + v
        v = v * u + c[..., i]
    return v, v1, v2


def fit(part: Roll | Arc) -> Patches:
    """Return patches along one part of a rolling path, halved until they keep the error bounds above."""
    if isinstance(part, Roll) and part.piece.straight:
        anchor = part.start if part.start > -EDGE else part.end if part.end < EDGE else 0.0
        x, z, slope, _ = part.frame(np.array([anchor]))[:, 0]
        first = part.frame(np.array([part.start]))[0]
        return Patches(first, np.array([x]), np.array([[z, slope, 0, 0, 0, 0]]))
    p = _parameters(part)
    sliver = _osculating(part.frame(p))
    if np.ptp(part.frame(p)[0]) < _SHORTEST * part.R and not _wrong(part, p, sliver).any():
        return sliver
    for _ in range(_HALVINGS):
        frame = part.frame(p)
        patches = Patches(frame[0, :-1], frame[0, :-1], hermite(frame))
        wrong = _wrong(part, p, patches)
        if isinstance(part, Roll):
            wrong &= np.diff(frame[0]) > 2 * _SHORTEST * part.R
        if not wrong.any():
            break
        p = np.sort(np.concatenate([p, ((p[:-1] + p[1:]) / 2)[wrong]]))
    return patches


def _osculating(frame: np.ndarray) -> Patches:
    """Return the parabola at the first of some points: all that a part shows that is too short for a quintic."""
    x, z, slope, second = frame[:, 0]
    return Patches(np.array([x]), np.array([x]), np.array([[z, slope, second / 2, 0, 0, 0]]))


def _parameters(part: Roll | Arc) -> np.ndarray:
    """Return the parameters of the first patches' ends."""
    if isinstance(part, Arc):
        start, end = (float(np.arcsin(np.clip((x - part.x) / part.R, -1, 1))) for x in (part.start, part.end))
    else:
        start, end = part.start, part.end
    first, last = part.frame(np.array([start, end]))[0]
    return np.linspace(start, end, 1 + max(1, ceil((last - first) / (_LONGEST * part.R))))


def _wrong(part: Roll | Arc, p: np.ndarray, patches: Patches) -> np.ndarray:
    """Return which patches miss the exact path inside by more than the bounds."""
    x, z, slope, _ = part.frame((p[:-1] + _CHECKED * np.diff(p)).ravel()).reshape(4, _CHECKED.size, -1)
    value, first, _ = evaluate(patches.anchor, patches.c, x)
    missed = (np.abs(value - z) > HEIGHT_ERROR) | (np.abs(first - slope) > SLOPE_ERROR * (1 + slope**2))
    return missed.any(axis=0)


def hermite(frame: np.ndarray) -> np.ndarray:
    """Return the coefficients (n-1, 6) of the quintics between n points with x, value and two derivatives (4, n)."""
    x, z, z1, z2 = frame
    h = np.diff(x)
    a1, a2 = z1[:-1] * h, z2[:-1] * h**2 / 2
    # what value, first and second derivative still lack at the far end, in units of h
    d = np.diff(z) - a1 - a2
    d1 = z1[1:] * h - a1 - 2 * a2
    d2 = z2[1:] * h**2 - 2 * a2
    scaled = [z[:-1], a1, a2, 10 * d - 4 * d1 + d2 / 2, -15 * d + 7 * d1 - d2, 6 * d - 3 * d1 + d2 / 2]
    return np.stack([a / h**i for i, a in enumerate(scaled)], axis=1)
