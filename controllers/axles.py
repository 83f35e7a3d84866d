"""What is designed for two axles, written for four wheels: motions, forces and the matrices between them."""

from __future__ import annotations

import numpy as np

# Axles in the order of the thesis to wheels in the order of the plants: every wheel moves as the mean of its axle, and
# carries half of its force.
_SPREAD = np.array([[0.0, 1.0], [0.0, 1.0], [1.0, 0.0], [1.0, 0.0]])


def wheels_from_axles(per_axle: np.ndarray) -> np.ndarray:
    """Return a matrix that acts per force of an axle (motion, motion; P, U, observer gains) for single wheels."""
    return _blocks(per_axle, _SPREAD, _SPREAD.T)


def wheel_forces_from_axles(per_axle: np.ndarray) -> np.ndarray:
    """Return a matrix from motions of axles to their forces (gains, feed-forward) for single wheels: half each."""
    return _blocks(per_axle, _SPREAD / 2, _SPREAD.T / 2)


def wheel_motions_from_axles(per_axle: np.ndarray) -> np.ndarray:
    """Return a matrix from motions of axles to motions of axles (m per m/s2, ...) for single wheels."""
    return _blocks(per_axle, _SPREAD, _SPREAD.T / 2)


def _blocks(matrix: np.ndarray, left: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Return left @ block @ right for every 2 x 2 block of the matrix."""
    rows = [np.hstack([left @ block @ right for block in np.hsplit(row, row.shape[1] // 2)])
            for row in np.vsplit(np.asarray(matrix), len(matrix) // 2)]  # fmt: skip
    return np.vstack(rows)
