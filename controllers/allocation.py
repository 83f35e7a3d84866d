"""Bounded least squares, min |A x - b| with |x_i| <= limit_i, exact and without iterating: for laws that run in an FMU.

The minimum lies in one of 3^n cases: every unknown free, at its lower or at its upper limit.  Each case is a small
linear system; its solution, brought into the limits, is a candidate, and the case of the minimum is its own candidate.
So the best candidate is the minimum: nothing has to be tested for feasibility.
"""

from __future__ import annotations

from itertools import product
from typing import Any

import casadi as ca

_RELATIVE = 1e-12  # of the largest diagonal of A'A: picks the smallest x where A leaves it open


def bounded_least_squares(A: Any, b: Any, limit: Any) -> Any:
    """Return x (n,) for A (m, n), b (m,) and limits (n,) >= 0, in CasADi."""
    n = A.shape[1]
    weight = _RELATIVE * ca.mmax(ca.diag(A.T @ A)) + 1e-300
    normal = A.T @ A + weight * ca.SX.eye(n)
    projected = A.T @ b
    least, best = ca.SX(ca.inf), ca.SX.zeros(n)
    for case in product((0, -1, 1), repeat=n):  # 0: free
        fixed = ca.vertcat(*(side * limit[i] for i, side in enumerate(case)))
        free = [i for i, side in enumerate(case) if side == 0]
        candidate = ca.SX(fixed)
        if free:
            found = _cholesky_solve(normal[free, free], (projected - normal @ fixed)[free])
            for i, value in zip(free, found, strict=True):
                candidate[i] = ca.fmax(-limit[i], ca.fmin(limit[i], value))
        cost = ca.dot(candidate, normal @ candidate) - 2 * ca.dot(candidate, projected)
        better = cost < least
        least, best = ca.if_else(better, cost, least), ca.if_else(better, candidate, best)
    return best


def _cholesky_solve(M: Any, r: Any) -> list[Any]:
    """Solve M x = r for a symmetric positive definite M of a few rows, symbolically."""
    n = M.shape[0]
    L: list[list[Any]] = [[0] * n for _ in range(n)]
    for i in range(n):
        for j in range(i + 1):
            rest = M[i, j] - sum(L[i][k] * L[j][k] for k in range(j))
            L[i][j] = ca.sqrt(ca.fmax(rest, 1e-300)) if i == j else rest / L[j][j]
    y: list[Any] = []
    for i in range(n):
        y.append((r[i] - sum(L[i][k] * y[k] for k in range(i))) / L[i][i])
    x: list[Any] = [0] * n
    for i in reversed(range(n)):
        x[i] = (y[i] - sum(L[k][i] * x[k] for k in range(i + 1, n))) / L[i][i]
    return x
