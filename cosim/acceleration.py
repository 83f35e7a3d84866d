"""How the next guess of an iteration x = G(x) is made from those before: residuals r = G(x) - x, all scaled."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import numpy as np

Method = Literal["fixed_point", "aitken", "quasi_newton", "newton"]
Map = Callable[[np.ndarray], np.ndarray]
MOVED = 1e-6  # of a scaled value: how far Newton's differences move it
FILTER = 1e-10  # singular values of the differences below this share of the largest are noise


class Acceleration:
    """The iterates of one macro step so far, and the next one."""

    def __init__(self, method: Method) -> None:
        self.method, self.omega = method, 1.0
        self.x: list[np.ndarray] = []
        self.g: list[np.ndarray] = []

    def next(self, x: np.ndarray, g: np.ndarray, again: Map) -> np.ndarray:
        """Return the guess after *x*, of which the map gave *g*; *again* evaluates the map anywhere."""
        self.x.append(x)
        self.g.append(g)
        if self.method == "newton":
            return self._newton(x, g, again)
        if self.method == "quasi_newton" and len(self.x) > 1:
            return self._least_squares()
        if self.method == "aitken" and len(self.x) > 1:
            return self._aitken()
        return g

    def _aitken(self) -> np.ndarray:
        """Relax by the factor that would have made the last two residuals cancel along their difference."""
        old, new = self.g[-2] - self.x[-2], self.g[-1] - self.x[-1]
        change = new - old
        if size := float(change @ change):
            self.omega *= -float(old @ change) / size
        return self.x[-1] + self.omega * new

    def _least_squares(self) -> np.ndarray:
        """IQN-ILS (Degroote et al. 2009): the combination of all iterates whose residual is least, mapped."""
        g, r = np.array(self.g), np.array(self.g) - np.array(self.x)
        weights = np.linalg.lstsq((r[:-1] - r[-1]).T, -r[-1], rcond=FILTER)[0]
        found: np.ndarray = g[-1] + (g[:-1] - g[-1]).T @ weights
        return found

    def _newton(self, x: np.ndarray, g: np.ndarray, again: Map) -> np.ndarray:
        """Solve (1 - dG/dx) d = r, the derivative of a whole step by differences."""
        columns = []
        for i in range(len(x)):
            moved = x.copy()
            moved[i] += MOVED * max(1.0, abs(x[i]))
            columns.append((again(moved) - g) / (moved[i] - x[i]))
        matrix = np.eye(len(x)) - np.array(columns).T
        found: np.ndarray = x + np.linalg.lstsq(matrix, g - x, rcond=None)[0]
        return found
