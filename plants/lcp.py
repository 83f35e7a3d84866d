"""The linear complementarity problem of a few contacts, solved exactly without a branch or an iteration.

    0 <= x  _|_  w = M x + q >= 0

Every contact either pushes (w = 0) or does not (x = 0): 16 cases for four contacts, each a linear system.  All are
solved by principal pivots that share their work along a binary tree, and the case of least violation is taken.  No
symmetry is asked of M; the solution is unique if M is a P-matrix (all principal minors positive), as it is for normal
forces with friction coefficients that do not jam.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca

_SINGULAR = 1e-13  # of a diagonal element: smaller pivots are rounding, their case is left out
_EXCLUDED = 1e300


@dataclass(frozen=True)
class _Case:
    """A branch of the tree: contacts 0 .. k-1 are decided, row i is their x_i or w_i over the open contacts and 1."""

    rows: list[list[Any]]
    pushing: tuple[bool, ...]
    penalty: Any  # 0, or `_EXCLUDED` after a singular pivot


def solve_lcp(M: ca.SX, q: ca.SX) -> ca.SX:
    """Return x (n) for a positive diagonal of M (n, n); a case whose block is singular is passed over.

    Violations of x are compared with those of w by the diagonal of M: x_i counts as M_ii x_i.
    """
    n = q.numel()
    root = _Case([[*(M[i, j] for j in range(n)), q[i]] for i in range(n)], (), ca.SX(0))
    cases = [root]
    for k in range(n):
        cases = [branch for case in cases for branch in (_open(case), _close(case, k, M[k, k]))]
    least, best = ca.SX(2 * _EXCLUDED), ca.SX.zeros(n)
    for case in cases:
        values = [row[0] for row in case.rows]
        excess = case.penalty
        for i, (value, pushes) in enumerate(zip(values, case.pushing, strict=True)):
            excess = ca.fmax(excess, -value * M[i, i] if pushes else -value)
        better = excess < least
        solution = ca.vertcat(*(v if pushes else 0 for v, pushes in zip(values, case.pushing, strict=True)))
        least, best = ca.if_else(better, excess, least), ca.if_else(better, solution, best)
    return best


def _open(case: _Case) -> _Case:
    """Let the next contact not push: its x is 0, so its column goes."""
    return _Case([row[1:] for row in case.rows], (*case.pushing, False), case.penalty)


def _close(case: _Case, k: int, scale: Any) -> _Case:
    """Let contact *k*, the next one, push: its w is 0, so its row gives x_k, which is put into all other rows."""
    pivot = case.rows[k][0]
    singular = ca.fabs(pivot) <= _SINGULAR * scale
    inverse = 1 / ca.if_else(singular, 1, pivot)
    x = [-entry * inverse for entry in case.rows[k][1:]]
    rows = [
        x if i == k else [entry + row[0] * x_j for entry, x_j in zip(row[1:], x, strict=True)]
        for i, row in enumerate(case.rows)
    ]
    penalty = ca.if_else(singular, _EXCLUDED, case.penalty)
    return _Case(rows, (*case.pushing, True), penalty)
