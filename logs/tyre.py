"""A tyre that shows its deformation: a disc with a flat where it is pressed.

In the frame of the wheel, z along the ground's outward normal and y along the axle, a disc of radius R pressed by d is
cut off at z = -(R - d).  So short a flat is hard to see; it is drawn as long as a deformation *factor* d would make it,
2 sqrt(R^2 - (R - factor d)^2), and still lies where the ground is.
"""

from __future__ import annotations

import numpy as np

FACETS = 28
DEEPEST = 0.5  # of R, the most that a flat is cut in

_ANGLE = 2 * np.pi * np.arange(FACETS) / FACETS
_CIRCLE = np.column_stack([np.sin(_ANGLE), np.cos(_ANGLE)])  # x, z
_RINGS = 4  # tread left and right, sides left and right, each with normals of its own


def shape(R: float, width: float, pressed: np.ndarray, factor: float) -> np.ndarray:
    """Return the vertices (n, vertices, 3) in m of a tyre *pressed* by (n,) in m, at least 0."""
    cut = np.clip(factor * pressed, 0.0, DEEPEST * R)[:, None]
    x, z = (R * np.broadcast_to(c, (len(pressed), FACETS)) for c in _CIRCLE.T)
    flat = z < -(R - cut)
    half = np.sqrt(R**2 - (R - cut) ** 2)
    # the vertices of the flat are spread along it, or a coarse disc would lose its corners
    spread = np.where(flat, np.clip(x / np.maximum(np.max(np.abs(np.where(flat, x, 0)), axis=1, keepdims=True), 1e-12),
                                    -1, 1) * half, x)  # fmt: skip
    height = np.where(flat, -(R - cut), z)
    height = np.where(height < 0, height * (R - np.minimum(pressed[:, None], cut)) / (R - cut), height)
    found = np.empty((len(pressed), _RINGS * FACETS + 2, 3))
    for ring in range(_RINGS):
        rows = slice(ring * FACETS, (ring + 1) * FACETS)
        found[:, rows, 0], found[:, rows, 2] = spread, height
        found[:, rows, 1] = width / 2 * (1 if ring % 2 == 0 else -1)
    found[:, -2:] = [[0, width / 2, 0], [0, -width / 2, 0]]
    return found


def triangles() -> np.ndarray:
    """Return which vertices make triangles, (triangles, 3)."""
    i = np.arange(FACETS)
    j = (i + 1) % FACETS
    tread = [np.column_stack([i, i + FACETS, j]), np.column_stack([j, i + FACETS, j + FACETS])]
    centre = np.full(FACETS, _RINGS * FACETS)
    left = np.column_stack([centre, i + 2 * FACETS, j + 2 * FACETS])
    right = np.column_stack([centre + 1, j + 3 * FACETS, i + 3 * FACETS])
    return np.concatenate([*tread, left, right])


def normals() -> np.ndarray:
    """Return the directions the vertices face, (vertices, 3), those of the undeformed tyre."""
    radial = np.column_stack([_CIRCLE[:, 0], np.zeros(FACETS), _CIRCLE[:, 1]])
    left, right = np.array([[0.0, 1.0, 0.0]]), np.array([[0.0, -1.0, 0.0]])
    return np.concatenate([radial, radial, np.repeat(left, FACETS, 0), np.repeat(right, FACETS, 0), left, right])
