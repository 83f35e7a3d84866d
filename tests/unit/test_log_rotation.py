"""The rotations of drawings against scipy's."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from logs.rotation import matrices, quaternions

# random attitudes, and the half turns at which three of four of a quaternion's entries vanish
ATTITUDES = np.concatenate([np.eye(4), -np.eye(4), np.random.default_rng(0).standard_normal((500, 4))])
ROUNDING = 32 * np.finfo(float).eps  # a dozen operations on numbers up to 2


def test_matrices_are_those_of_scipy() -> None:
    expected = Rotation.from_quat(ATTITUDES[:, [1, 2, 3, 0]]).as_matrix()
    np.testing.assert_allclose(matrices(ATTITUDES), expected, rtol=0, atol=ROUNDING)


def test_quaternions_are_those_of_scipy() -> None:
    """Up to the sign, which means nothing."""
    rotation = Rotation.from_quat(ATTITUDES[:, [1, 2, 3, 0]])
    found, expected = quaternions(rotation.as_matrix()), rotation.as_quat()[:, [3, 0, 1, 2]]
    sign = np.sign(np.sum(found * expected, axis=1, keepdims=True))
    np.testing.assert_allclose(sign * found, expected, rtol=0, atol=ROUNDING)
