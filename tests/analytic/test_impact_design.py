"""Gains, settling times, the planned path and the allocation of the PD impact law (thesis 6.2 to 6.5)."""

from __future__ import annotations

import casadi as ca
import control
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.optimize import lsq_linear

from controllers.allocation import bounded_least_squares
from controllers.pd_impact import error_dynamics, error_response, gains_by_stiffness, settling_time
from controllers.reference import planned


def test_settling_times_of_the_thesis() -> None:
    """h0 = 1500, h1 = 70, 2 %: front 0.087 s from rest position at -0.6 m/s to -20 mm, rear 0.122 s to -10 mm (6.3)."""
    assert settling_time(1500.0, 70.0, 0.02, -0.6, 0.02 * 0.02) == pytest.approx(0.087, abs=5e-4)
    assert settling_time(1500.0, 70.0, 0.01, 0.0, 0.02 * 0.01) == pytest.approx(0.122, abs=5e-4)


def test_gains_as_printed_settle_in_more_than_80_s() -> None:
    """The text of 6.3 says h0 = 70, h1 = 1500: a pole at -0.047 1/s."""
    assert np.max(error_dynamics(70.0, 1500.0).poles().real) == pytest.approx(-0.047, abs=5e-4)
    assert settling_time(70.0, 1500.0, 0.01, 0.0, 0.02 * 0.01, horizon=200.0) > 80.0


@pytest.mark.parametrize(("h0", "h1"), [(1500.0, 70.0), (1225.0, 70.0), (1500.0, 90.0)])
def test_settling_time_against_an_integrated_error(h0: float, h1: float) -> None:
    """Under-, critically and overdamped: the error by SciPy stays in the band from then on, and not before."""
    e0, v0, band = 0.02, -0.6, 4e-4
    t = settling_time(h0, h1, e0, v0, band)
    grid = np.linspace(0.0, 1.0, 20_001)
    run = solve_ivp(lambda _, x: [x[1], -h0 * x[0] - h1 * x[1]], (0, 1), [e0, v0], t_eval=grid, rtol=1e-10, atol=1e-13)
    outside = grid[np.abs(run.y[0]) > band]
    assert outside[-1] == pytest.approx(t, abs=2 * grid[1])  # both to their grids


@pytest.mark.parametrize(("h0", "h1"), [(1500.0, 70.0), (1225.0, 70.0), (1500.0, 90.0)])
def test_error_response_against_the_matrix_exponential(h0: float, h1: float) -> None:
    """Error and rate, also at a double pole, where rounding splits it: 1e-9 of 0.02 m and 0.6 m/s."""
    t = np.array([0.0, 0.01, 0.05, 0.2])
    found = np.array(error_response(h0, h1, 0.02, -0.6, t))
    exact = np.column_stack([expm(np.array([[0, 1], [-h0, -h1]]) * s) @ [0.02, -0.6] for s in t])
    np.testing.assert_allclose(found[0], exact[0], atol=2e-11)
    np.testing.assert_allclose(found[1], exact[1], atol=6e-10)


def test_critical_damping() -> None:
    """h1 = 2 sqrt(h0): 77.46 for h0 = 1500, and h0 = 1225 for h1 = 70."""
    for h0, h1 in ((1500.0, 77.46), (1225.0, 70.0)):
        _, damping, _ = control.damp(error_dynamics(h0, h1), doprint=False)
        np.testing.assert_allclose(damping, 1.0, atol=1e-4)


def test_gains_by_rule_let_the_spring_supply_h0() -> None:
    """Nothing is cancelled then: h0 - k P22 = 0."""
    h0, h1 = gains_by_stiffness(2e5, 0.01029)
    assert h0 == pytest.approx(2e5 * 0.01029)
    assert h1 == pytest.approx(2 * np.sqrt(h0))
    assert gains_by_stiffness(2e5, 0.01029, 0.3)[1] == pytest.approx(0.3 * h1)


@pytest.mark.parametrize("T", [0.1, 0.15, 0.2])
def test_planned_path_joins_its_ends(T: float) -> None:
    """Position, velocity, acceleration and jerk at both ends, in real time (6.17-6.19 with the right C7)."""
    d0, v0, d = -1e-4, -0.6, -0.02
    eps = 1e-5 * T
    for t, inward, ends in ((0.0, eps, (d0, v0)), (T, -eps, (d, 0.0))):
        path = planned(t, T, d0, v0, d)
        np.testing.assert_allclose([path.z, path.rate], ends, atol=1e-12)  # sums of terms up to 1 m and 100 m/s
        assert abs(path.acceleration) < 1e-9
        jerk = (planned(t + inward, T, d0, v0, d).acceleration - path.acceleration) / inward
        # the jerk is 0 at the end and grows with the snap, of order 800 |v0| / T^3, over eps
        assert abs(jerk) < 800 * abs(v0) / T**3 * eps


def test_planned_path_is_one_path() -> None:
    """Its rate and acceleration are the derivatives of its position, by central differences of O(h^2)."""
    T, ends, h = 0.15, (0.0, -0.6, -0.02), 1e-5
    for t in np.linspace(0.01, 0.14, 7):
        before, at, after = (planned(t + s, T, *ends) for s in (-h, 0.0, h))
        # h^2 / 6 times the jerk and the snap, of order 1e3 m/s3 and 1e5 m/s4
        assert (after.z - before.z) / (2 * h) == pytest.approx(at.rate, abs=1e-7)
        assert (after.rate - before.rate) / (2 * h) == pytest.approx(at.acceleration, abs=1e-5)


def test_planned_path_overshoots_where_it_must() -> None:
    """-20.66, -25.72 and -31.95 mm for T = 0.1, 0.15 and 0.2 s at -0.6 m/s to -20 mm: the slower, the deeper."""
    for T, least in ((0.1, -20.66), (0.15, -25.72), (0.2, -31.95)):
        # the polynomial of the eight conditions, solved for by NumPy
        derivatives = [np.polynomial.polynomial.polyder(np.eye(8), n, axis=0) for n in range(4)]
        conditions = [x ** np.arange(len(D)) @ D for x in (0.0, T) for D in derivatives]
        C = np.linalg.solve(conditions, [0, -0.6, 0, 0, -0.02, 0, 0, 0])
        grid = np.linspace(0, T, 2001)
        z = planned(grid, T, 0.0, -0.6, -0.02).z
        np.testing.assert_allclose(z, np.polynomial.polynomial.polyval(grid, C), atol=1e-12)
        assert 1e3 * np.min(z) == pytest.approx(least, abs=5e-3)


@pytest.mark.parametrize(("rows", "columns"), [(2, 2), (4, 4)])
def test_allocation_is_the_bounded_least_squares(rows: int, columns: int) -> None:
    """Against scipy.optimize.lsq_linear by cost: where limits act, and where they do not."""
    A, b, limit = ca.SX.sym("A", rows, columns), ca.SX.sym("b", rows), ca.SX.sym("l", columns)
    solve = ca.Function("solve", [A, b, limit], [bounded_least_squares(A, b, limit)])
    rng = np.random.default_rng(5)
    saturated = 0
    for _ in range(100):
        values = rng.normal(size=(rows, columns)), 5 * rng.normal(size=rows), rng.uniform(0.1, 5, columns)
        x = solve(*values).full().ravel()
        best = lsq_linear(values[0], values[1], (-values[2], values[2]), method="bvls", tol=1e-12, max_iter=1000)
        assert np.all(np.abs(x) <= values[2] * (1 + 1e-12))
        # the weight of 1e-12 that makes the solution unique, on both costs of order 10
        assert np.sum((values[0] @ x - values[1]) ** 2) / 2 == pytest.approx(best.cost, abs=1e-9)
        saturated += int(np.any(np.abs(x) > values[2] * (1 - 1e-9)))
    assert 20 < saturated < 100
