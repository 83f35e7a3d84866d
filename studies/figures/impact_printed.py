"""The planned path of chapter 6 as it is printed."""

from __future__ import annotations

import numpy as np


def printed_path(t: np.ndarray, T: float, v0: float, d: float) -> np.ndarray:
    """Return the path of 6.19 at *t* (n,), s, with C7 = -10 (v0 T + 2 d) / T^7: from 0 with v0 (m/s), but not to d."""
    V = v0 * T
    C = np.array([0, v0, 0, 0, 5 * (7 * d - 4 * V) / T**4, -3 * (28 * d - 15 * V) / T**5,
                  2 * (35 * d - 18 * V) / T**6, -10 * (V + 2 * d) / T**7])  # fmt: skip
    return np.asarray(np.polynomial.polynomial.polyval(t, C))
