"""Rotations of many instants at once; scipy's are the same, but bring half of scipy, 0.15 s before the first step.

Quaternions are (w, x, y, z) as in the ports of the body.
"""

from __future__ import annotations

import numpy as np


def matrices(quaternion: np.ndarray) -> np.ndarray:
    """Return the rotation matrices (n, 3, 3) of quaternions (n, 4) of any length but 0."""
    w, x, y, z = (quaternion / np.linalg.norm(quaternion, axis=1, keepdims=True)).T
    rows = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]  # fmt: skip
    return np.moveaxis(np.array(rows), 2, 0)


def quaternions(matrix: np.ndarray) -> np.ndarray:
    """Return the unit quaternions (n, 4) of rotation matrices (n, 3, 3).

    4 q q^T is linear in the matrix; the column of the largest diagonal entry has no small divisor (Shepperd, J. Guid.
    Control 1(3), 1978).
    """
    xx, yy, zz = (matrix[:, i, i] for i in range(3))
    wx, wy, wz = (matrix[:, j, i] - matrix[:, i, j] for i, j in ((1, 2), (2, 0), (0, 1)))
    xy, xz, yz = (matrix[:, j, i] + matrix[:, i, j] for i, j in ((0, 1), (0, 2), (1, 2)))
    outer = [[1 + xx + yy + zz, wx, wy, wz], [wx, 1 + xx - yy - zz, xy, xz],
             [wy, xy, 1 - xx + yy - zz, yz], [wz, xz, yz, 1 - xx - yy + zz]]  # fmt: skip
    products = np.moveaxis(np.array(outer), 2, 0)
    largest = np.argmax(np.diagonal(products, axis1=1, axis2=2), axis=1)
    found: np.ndarray = products[np.arange(len(products)), largest]
    return found / np.linalg.norm(found, axis=1, keepdims=True)
