"""The complementarity solver against independent solutions: SciPy's non-negative least squares, NumPy's enumeration."""

from functools import cache
from itertools import product

import casadi as ca
import numpy as np
import pytest
from scipy.optimize import nnls

from plants.lcp import solve_lcp

CASES = 2000
# Mounting points of a rover's wheels (x forward, y left, m), its mass and inertia: magnitudes like those in use.
X, Y = np.array([0.6, 0.6, -0.46, -0.46]), np.array([0.29, -0.29, 0.29, -0.29])
M, IX, IY, ARM = 170.0, 20.0, 47.0, 0.5
FLAT = 1 / M + np.outer(Y, Y) / IX + np.outer(X, X) / IY  # rank 3: no force twists a rigid body


@cache
def solver(n: int) -> ca.Function:
    matrix, vector = ca.SX.sym("M", n, n), ca.SX.sym("q", n)
    return ca.Function("lcp", [matrix, vector], [solve_lcp(matrix, vector)])


def solve(matrix: np.ndarray, vector: np.ndarray) -> np.ndarray:
    return np.asarray(solver(len(vector))(matrix, vector)).ravel()


def violation(matrix: np.ndarray, vector: np.ndarray, x: np.ndarray) -> float:
    """Return by how much x misses 0 <= x _|_ M x + q >= 0, relative to the size of q."""
    w = matrix @ x + vector
    scale = np.diag(matrix) * x
    return float(max(np.max(-scale), np.max(-w), np.max(np.minimum(np.abs(scale), np.abs(w))))) / np.max(np.abs(vector))


def enumerated(matrix: np.ndarray, vector: np.ndarray) -> list[np.ndarray]:
    """Return every solution, one linear solve per set of pushing contacts."""
    found = []
    for pushing in product((False, True), repeat=len(vector)):
        a = np.array(pushing)
        x = np.zeros(len(vector))
        x[a] = np.linalg.solve(matrix[np.ix_(a, a)], -vector[a])
        if violation(matrix, vector, x) < 1e-9:
            found.append(x)
    return found


def test_symmetric_problems_equal_non_negative_least_squares() -> None:
    """For M = L L' the solution minimises |L' x + L^-1 q| over x >= 0."""
    rng = np.random.default_rng(1)
    for _ in range(CASES):
        factor = rng.normal(size=(4, 4))
        matrix, vector = factor @ factor.T + 0.1 * np.eye(4), rng.normal(size=4)
        L = np.linalg.cholesky(matrix)
        reference, _ = nnls(L.T, -np.linalg.solve(L, vector))
        # Condition numbers up to 1e3 times rounding, with two digits to spare.
        np.testing.assert_allclose(solve(matrix, vector), reference, rtol=0, atol=1e-11 * max(1, np.max(reference)))


def test_non_symmetric_problems_have_the_one_solution_that_enumeration_finds() -> None:
    """Friction that slides by mu up to 0.8 at each wheel makes M non-symmetric: M = P + U diag(mu), |mu_k| <= 0.8."""
    rng = np.random.default_rng(2)
    tilted = np.outer(X, np.ones(4)) * ARM / IY
    for _ in range(CASES):
        matrix = FLAT + tilted * rng.uniform(-0.8, 0.8, 4) + np.diag(rng.uniform(1e-4, 1e-2, 4))
        vector = rng.normal(size=4)
        x = solve(matrix, vector)
        references = enumerated(matrix, vector)
        assert len(references) == 1
        # Condition numbers reach |P| / 1e-4 = 250; rounding times that, with two digits to spare.
        np.testing.assert_allclose(x, references[0], rtol=0, atol=1e-11 * np.max(np.abs(references[0])))


def test_four_wheels_on_a_plane_share_as_evenly_as_springs() -> None:
    """P of rank 3 plus a small compliance: the least-squares solution of the regularised problem, by SciPy."""
    rng = np.random.default_rng(3)
    eps = 1e-5 * np.max(FLAT)
    matrix = FLAT + eps * np.eye(4)
    L = np.linalg.cholesky(matrix)
    for _ in range(CASES):
        vector = FLAT @ rng.normal(size=4)
        x = solve(matrix, vector)
        assert violation(matrix, vector, x) < 1e-9  # condition number 1e6 times rounding
        reference, _ = nnls(L.T, -np.linalg.solve(L, vector))
        np.testing.assert_allclose(x, reference, rtol=0, atol=1e-8 * np.max(np.abs(reference)))


def test_singular_cases_are_passed_over() -> None:
    """Without compliance the block of all four wheels is singular: a basic solution with three at most is found."""
    rng = np.random.default_rng(4)
    for _ in range(CASES):
        vector = FLAT @ rng.normal(size=4)
        x = solve(FLAT, vector)
        assert np.all(np.isfinite(x))
        assert violation(FLAT, vector, x) < 1e-10


def test_degenerate_problems_are_solved() -> None:
    np.testing.assert_array_equal(solve(np.eye(4), np.zeros(4)), np.zeros(4))
    np.testing.assert_array_equal(solve(np.eye(4), np.array([0.0, -1.0, 2.0, 0.0])), [0, 1, 0, 0])
    np.testing.assert_array_equal(solve(np.zeros((4, 4)), np.ones(4)), np.zeros(4))  # wheels that cannot be pushed


@pytest.mark.parametrize("n", [1, 2, 3])
def test_any_number_of_contacts(n: int) -> None:
    rng = np.random.default_rng(5)
    for _ in range(200):
        factor = rng.normal(size=(n, n))
        matrix, vector = factor @ factor.T + 0.1 * np.eye(n), rng.normal(size=n)
        assert violation(matrix, vector, solve(matrix, vector)) < 1e-11
