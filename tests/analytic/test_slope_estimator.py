"""The slope estimator: exact for a wheel in equilibrium, defined where the printed formula is not, and its filter."""

import numpy as np
import pytest
from tracks import on_two_slopes

from controllers.slope_estimator import body_slope, track
from plants.planar import Posture

EXACT = 1e-12  # rad: arctangent, root and eight products, each right to 1.1e-16, of forces with F_n above 0.1 |R|


def push(gamma: float, F_n: float, F_t: float) -> tuple[float, float]:
    """Return the force of a massless wheel on its axle, forward and up."""
    return F_t * np.cos(gamma) - F_n * np.sin(gamma), F_t * np.sin(gamma) + F_n * np.cos(gamma)


def test_it_returns_the_slope_that_made_the_force() -> None:
    """All slopes a wheel can stand on, driven, braked and idle, up to ten times more traction than load."""
    for gamma in np.linspace(-1.5, 1.5, 61):
        for F_t in (-4000.0, -300.0, 0.0, 1e-6, 300.0, 4000.0):
            assert float(body_slope(*push(gamma, 420.0, F_t), F_t)) == pytest.approx(gamma, abs=EXACT)


def test_it_is_the_minus_root_of_the_printed_formula() -> None:
    """(4.56): 2 atan((R_y - sqrt(R_x^2 + R_y^2 - F_t^2)) / (R_x + F_t)); its difference cancels, hence 1e-10."""
    for gamma, F_t in ((0.3, 200.0), (-0.4, 150.0), (0.7, -90.0)):
        R_x, R_y = push(gamma, 400.0, F_t)
        printed = 2 * np.arctan((R_y - np.sqrt(R_y**2 + R_x**2 - F_t**2)) / (R_x + F_t))
        assert float(body_slope(R_x, R_y, F_t)) == pytest.approx(printed, abs=1e-10)


def test_an_idle_wheel_on_the_flat_and_a_wheel_in_the_air_are_no_division_by_zero() -> None:
    """R_x + F_t = 0 is 0/0 in (4.56); without any force there is no slope to find, and 0 is said."""
    assert float(body_slope(0.0, 400.0, 0.0)) == 0
    gamma = float(body_slope(-120.0, 390.0, 120.0))
    np.testing.assert_allclose(push(gamma, 390.0, 120.0), (-120.0, 390.0), rtol=EXACT)
    assert float(body_slope(0.0, 0.0, 0.0)) == 0


def test_more_traction_than_force_is_read_as_all_of_it() -> None:
    """Measured forces need not be consistent: the root of a negative number must not become NaN."""
    assert float(body_slope(100.0, 0.0, 100.1)) == pytest.approx(0, abs=EXACT)


@pytest.mark.parametrize("pitch", [-0.1, 0.0, 0.17])
def test_the_angle_is_relative_to_the_body(pitch: float) -> None:
    """A pitched rigid body on two slopes, steered straight: axle forces give theta - pitch at every wheel."""
    at = Posture(front=0.35, rear=-0.1, pitch=pitch)
    body = on_two_slopes(at, np.array([1.0, 0.1, -0.3]))
    traction = np.array([80.0, -60.0, 0.0, 150.0])
    body.set("normal_force", np.array([300.0, 420.0, 510.0, 260.0]))
    body.set("traction", traction)
    force = np.array(body.get("axle_force"))
    for k in range(4):
        gamma = float(body_slope(force[k, 0], force[k, 2], traction[k]))
        assert gamma + float(body.get("pitch")) == pytest.approx(float(body.get("slope")[k]), abs=EXACT)


def test_the_filter_follows_a_constant_second_rate_without_lag() -> None:
    """After 60 time constants exp(-60) of the start is left: rounding, through divisions by the period squared."""
    period, bandwidth = 1e-3, 200.0
    x = (0.0, 0.0, 0.0)
    for k in range(1, 301):
        t = k * period
        x = track(*x, 0.2 - 0.5 * t + 3.0 * t**2, period, bandwidth)
    t = 300 * period
    expected = (0.2 - 0.5 * t + 3.0 * t**2, -0.5 + 6.0 * t, 6.0)
    np.testing.assert_allclose(np.array(x, float), expected, atol=1e-8)


def test_its_three_poles_lie_at_the_bandwidth() -> None:
    """The transition matrix, found column by column, has the triple eigenvalue exp(-bandwidth period).

    A triple eigenvalue is computed to the cube root of rounding only, hence the characteristic polynomial is compared.
    """
    period, bandwidth = 2e-3, 80.0
    transition = np.array([[float(v) for v in track(*unit, 0.0, period, bandwidth)] for unit in np.eye(3)]).T
    forget = np.exp(-bandwidth * period)
    np.testing.assert_allclose(np.poly(transition), np.poly([forget] * 3), rtol=1e-10)
