"""The ground as the nodes of a ring meet it: a table of parabolas over world x, with the faces at every corner.

A row holds three faces A, B and C, each an origin and three coefficients; the signed distance of a point near it is
min(A, max(B, C)), see `ring_contact`.  Beside the face under the point these are what lies across the nearest corner,
and across the next one if that is close by, as at the two ends of a step.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import ceil, isinf
from typing import Any

import numpy as np

from .patches import evaluate
from .profile import SAME_ANGLE, SAME_HEIGHT, Piece, Profile
from .ring_contact import COLUMNS

LEAN = 0.05  # a vertical step of height h is a face that leans over 0.05 h, on its lower side: 3 degrees
REACH = 0.01  # m, from a corner within which both of its faces are looked at
HEIGHT_ERROR = 1e-7  # m, of a parabola against the profile
_FAR = 1e3  # m, below the ground: a face that is not there


@dataclass(frozen=True)
class Face:
    """One parabola from ``start`` (m) on: z = sum c_i (x - origin)^i."""

    start: float
    origin: float
    c: tuple[float, float, float]

    @property
    def numbers(self) -> tuple[float, ...]:
        """Origin and coefficients (4,)."""
        return (self.origin, *self.c)

    def jet(self, x: float) -> tuple[float, float]:
        """Return height and slope at *x*."""
        u = x - self.origin
        return self.c[0] + (self.c[1] + self.c[2] * u) * u, self.c[1] + 2 * self.c[2] * u


def ground_table(profile: Profile) -> np.ndarray:
    """Return the rows (n, 13) of the ground as `FullOrderRover` takes it, ascending in x."""
    faces = _faces(profile)
    corners = [i for i in range(1, len(faces)) if _corner(faces[i - 1], faces[i])]
    at = np.array([faces[i].start for i in corners])
    starts = {face.start for face in faces}
    if len(corners):
        starts |= {*(at - REACH).tolist(), *(at + REACH).tolist(), *((at[1:] + at[:-1]) / 2).tolist()}
    rows, i, ordered = [], 0, sorted(starts)
    for start, end in pairwise([*ordered, ordered[-1] + 2 * REACH]):
        while i + 1 < len(faces) and faces[i + 1].start <= start:
            i += 1
        rows.append([start, *_row(faces, corners, at, i, (max(start, end - 2 * REACH) + end) / 2)])
    return np.array(rows).reshape(-1, COLUMNS)


def _row(faces: list[Face], corners: list[int], at: np.ndarray, own: int, middle: float) -> list[float]:
    """Return the three faces (12,) where *own* is under the point."""
    alone = faces[own].numbers
    if not len(at):
        return [*alone, *alone, *alone]
    j = int(np.argmin(np.abs(at - middle)))
    if abs(at[j] - middle) > REACH:
        return [*alone, *alone, *alone]
    chain = [j]
    close = [k for k in (j - 1, j + 1) if 0 <= k < len(at) and abs(at[k] - at[j]) < REACH]
    if close and _corner(*_sides(faces, corners[close[0]])) != _corner(*_sides(faces, corners[j])):
        chain = sorted([j, close[0]])
    around = [corners[chain[0]] - 1, *(corners[k] for k in chain)]
    around = [own if np.searchsorted(corners, i, side="right") == np.searchsorted(corners, own, side="right") else i
              for i in around]  # fmt: skip
    kinds = [_corner(*_sides(faces, corners[k])) for k in chain]
    far = Face(0.0, at[j], (faces[own].jet(at[j])[0] - _FAR, 0.0, 0.0))
    order: Any = {
        (1,): lambda a, b: (a, b, b), (-1,): lambda a, b: (far, a, b),
        (1, -1): lambda a, b, c: (a, b, c), (-1, 1): lambda a, b, c: (c, a, b),
    }[tuple(kinds)]  # fmt: skip
    return [v for face in order(*(faces[i] for i in around)) for v in face.numbers]


def _sides(faces: list[Face], i: int) -> tuple[Face, Face]:
    return faces[i - 1], faces[i]


def _corner(before: Face, after: Face) -> int:
    """Return 1 for a concave corner between two faces, -1 for a convex one, 0 for none."""
    (_, a), (_, b) = before.jet(after.start), after.jet(after.start)
    return 0 if abs(np.arctan(b) - np.arctan(a)) <= 10 * SAME_ANGLE else 1 if b > a else -1


def _faces(profile: Profile) -> list[Face]:
    """Return all faces of a profile from left to right, steps as leaning ones."""
    found: list[Face] = []
    for before, after in pairwise([None, *profile.pieces]):
        assert after is not None
        faces = _parabolas(after)
        if before is not None:
            low, high = before.at(before.end)[0], after.at(after.start)[0]
            rise = high - low
            if abs(rise) > SAME_HEIGHT:
                x, width = after.start, LEAN * abs(rise)
                start = x - width if rise > 0 else x
                found.append(Face(start, start, (low, rise / width, 0.0)))
                if rise < 0:
                    faces[0] = Face(x + width, faces[0].origin, faces[0].c)
        found += faces
    return found


def _parabolas(piece: Piece) -> list[Face]:
    """Return the faces of one piece: two parabolas per interval, with height and slope right at both of its ends."""
    if piece.straight:
        anchor = piece.start if not isinf(piece.start) else piece.end if not isinf(piece.end) else 0.0
        height, slope, _ = piece.at(anchor)
        return [Face(max(piece.start, -1e9), anchor, (height, slope, 0.0))]
    n = max(1, ceil((piece.end - piece.start) / piece.resolution))
    while True:
        x = np.linspace(piece.start, piece.end, n + 1)
        origin, c = _hermite(x, *piece.jet(x)[:2])
        inside = np.sort(np.concatenate([x[:-1] + f * np.diff(x) for f in (0.2, 0.5, 0.8)]))
        which = np.searchsorted(origin[:, 0], inside, side="right") - 1
        made = evaluate(origin[which, 1], np.column_stack([c[which], np.zeros((len(which), 3))]), inside)[0]
        if np.max(np.abs(made - piece.jet(inside)[0])) < HEIGHT_ERROR or n > 100_000:
            return [
                Face(float(o[0]), float(o[1]), (float(k[0]), float(k[1]), float(k[2])))
                for o, k in zip(origin, c, strict=True)
            ]
        n *= 2


def _hermite(x: np.ndarray, z: np.ndarray, slope: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return start and origin (2n, 2) and coefficients (2n, 3) of two parabolas between each pair of n + 1 points."""
    h = np.diff(x)
    total = np.diff(slope) / h
    apart = 4 / h**2 * (np.diff(z) - (slope[:-1] + slope[1:]) * h / 2)
    first = np.column_stack([z[:-1], slope[:-1], (total + apart) / 2])
    second = np.column_stack([z[1:], slope[1:], (total - apart) / 2])
    origin = np.stack([np.column_stack([x[:-1], x[:-1]]), np.column_stack([(x[:-1] + x[1:]) / 2, x[1:]])], axis=1)
    return origin.reshape(-1, 2), np.stack([first, second], axis=1).reshape(-1, 3)
