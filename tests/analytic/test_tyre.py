"""Friction curves against the published formulas, and the slip definitions of Eq 3.1 and 3.2.

The formulas are written again here in their textbook form (Dugoff, Fancher and Segel 1970; Pacejka), from slip ratio
and slip angle.  Both sides are a few dozen operations on numbers of size 1: they agree to 1e-12.
"""

from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np
import pytest

from plants.tyre import LAWS, Tyre, curves, friction_coefficients, slope, wheel_slip

EXACT = dict(rtol=1e-12, atol=1e-12)
SLIPS = np.concatenate([np.linspace(-1.0, 1.0, 81), [-0.999, 0.999, 0.01, -0.01]])
ANGLES = [0.0, 0.02, 0.1, 0.3, 0.8]


def tyre(law: str, **changes: float) -> Tyre:
    return Tyre(law, **{**dict(mu=0.8, C_x=9.0, C_y=12.0, C=1.6, E=-0.4), **changes})


def dugoff(t: Tyre, slip: float, alpha: float) -> tuple[float, float]:
    """F_x = C_x s / (1 - s) f, F_y = C_y tan(alpha) / (1 - s) f; s: braking, or driving measured against V."""
    s = -slip if slip < 0 else -slip / (1 - slip)
    size = np.hypot(t.C_x * s, t.C_y * np.tan(alpha))
    tau = t.mu * (1 - s) / (2 * size) if size else np.inf
    f = (2 - tau) * tau if tau < 1 else 1.0
    return -t.C_x * s / (1 - s) * f, t.C_y * np.tan(alpha) / (1 - s) * f


def magic(t: Tyre, x: np.ndarray, stiffness: float) -> np.ndarray:
    """Y = D sin(C atan(B x - E (B x - atan(B x)))) with D = mu and B C D = stiffness."""
    B = stiffness / (t.C * t.mu)
    return t.mu * np.sin(t.C * np.arctan(B * x - t.E * (B * x - np.arctan(B * x))))


@pytest.mark.parametrize("alpha", [*ANGLES, -0.1])
def test_dugoff_is_the_published_formula(alpha: float) -> None:
    t = tyre("dugoff")
    moving = SLIPS[
        np.abs(SLIPS) < 1
    ]  # the printed form divides by 0 with a locked wheel and with one that spins in place
    wanted = np.array([dugoff(t, slip, alpha) for slip in moving]).T
    np.testing.assert_allclose(curves(t, moving, alpha), wanted, **EXACT)


def test_the_magic_formula_is_the_published_one_in_pure_slip() -> None:
    t = tyre("magic")
    mu_a, mu_l = curves(t, SLIPS)
    np.testing.assert_allclose(mu_a, magic(t, SLIPS, t.C_x), **EXACT)
    np.testing.assert_array_equal(mu_l, 0)
    for alpha in ANGLES:
        np.testing.assert_allclose(curves(t, np.zeros(1), alpha)[1], magic(t, np.tan(alpha), t.C_y), **EXACT)


@pytest.mark.parametrize("law", LAWS)
def test_it_starts_with_the_given_stiffness(law: str) -> None:
    """At a slip of 1e-8 both curves are within 1e-7 of their tangent, and so is a difference quotient over 1e-8."""
    t, small = tyre(law), 1e-8
    for slip in (-small, small):
        assert curves(t, np.array([slip]))[0][0] == pytest.approx(t.C_x * slip, rel=1e-6)
    assert curves(t, np.zeros(1), small)[1][0] == pytest.approx(t.C_y * small, rel=1e-6)
    assert slope(t, 0.0) == pytest.approx(t.C_x, rel=1e-12)
    h = 1e-6  # the central difference is off by h^2 times a third derivative of 1e3, and by 1e-16 / h
    above, below = curves(t, np.array([0.03 + h, 0.03 - h]))[0]
    assert slope(t, 0.03) == pytest.approx((above - below) / (2 * h), rel=1e-7)


def test_the_magic_formula_peaks_at_mu_where_it_should() -> None:
    """Without curvature the peak lies at tan(pi / 2 C) / B; for large slip the curve falls to mu sin(C pi / 2)."""
    t = tyre("magic", E=0.0)
    B = t.C_x / (t.C * t.mu)
    peak = np.tan(np.pi / (2 * t.C)) / B
    assert curves(t, np.array([peak]))[0][0] == pytest.approx(t.mu, rel=1e-12)
    assert slope(t, float(peak)) == pytest.approx(0.0, abs=1e-12)
    assert slope(t, float(1.01 * peak)) < 0 < slope(t, float(0.99 * peak))
    far = curves(tyre("magic", E=0.0, C_x=1e9), np.ones(1))[0][0]
    assert far == pytest.approx(t.mu * np.sin(t.C * np.pi / 2), rel=1e-6)


def test_dugoff_sticks_then_slides_and_only_rises() -> None:
    """Straight up to mu / 2, where the slope is continuous; then towards mu, which only a locked wheel reaches."""
    t = tyre("dugoff")
    edge = t.mu / (2 * t.C_x)
    assert curves(t, np.array([edge]))[0][0] == pytest.approx(t.mu / 2, rel=1e-12)
    assert slope(t, edge * (1 + 1e-6)) == pytest.approx(slope(t, edge * (1 - 1e-6)), rel=1e-5)
    assert np.all(np.diff(curves(t, np.linspace(-1, 1, 1001))[0]) > 0)
    assert curves(t, np.array([-1.0]))[0][0] == pytest.approx(-t.mu, rel=1e-12)
    assert curves(t, np.array([1.0]))[0][0] == pytest.approx(t.mu * (1 - t.mu / (4 * t.C_x)), rel=1e-12)


@pytest.mark.parametrize("law", LAWS)
def test_the_resultant_stays_within_friction(law: str) -> None:
    """For every direction of slip, and the limit is one that is met: to 1% where it is nearest."""
    largest = [np.max(np.hypot(*curves(tyre(law), SLIPS, alpha))) for alpha in (*ANGLES, 1.4)]
    assert 0.8 * 0.99 < np.max(largest) <= 0.8 * (1 + 1e-12)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("side", [-1, 1])
def test_steering_takes_from_traction_and_slip_from_cornering(law: str, side: int) -> None:
    """Fig 3.2: with the slip angle the lateral coefficient grows and that of traction falls, driving and braking.

    Up to 0.1 rad, below the peak of the lateral curve, and from the slip of 0.05 on, where Dugoff's wheel slides: one
    that sticks gives its traction whatever the angle, and braking a lateral force that grows with 1 / (1 - s).
    """
    slips = side * np.linspace(0.05, 0.95, 46)
    mu_a, mu_l = np.array([curves(tyre(law), slips, alpha) for alpha in np.linspace(0, 0.1, 21)]).swapaxes(0, 1)
    assert np.all(np.diff(np.abs(mu_a), axis=0) < 0)
    assert np.all(np.diff(mu_l, axis=0) > 0)
    assert np.all(np.diff(mu_l[1:], axis=1) < 0)


@pytest.mark.parametrize("law", LAWS)
def test_left_and_right_are_mirror_images(law: str) -> None:
    left, right = curves(tyre(law), SLIPS, 0.2), curves(tyre(law), SLIPS, -0.2)
    np.testing.assert_array_equal(left[0], right[0])
    np.testing.assert_array_equal(left[1], -right[1])


def evaluated(v_min: float = 0.1) -> Callable[..., np.ndarray]:
    """Return slip ratio, side slip and their derivatives by (rim, along, across), by numbers."""
    x = ca.SX.sym("x", 3)
    s = wheel_slip(x[0], x[1], x[2], v_min)
    both = ca.vertcat(s.ratio, s.side)
    f = ca.Function("f", [x], [ca.horzcat(both, ca.jacobian(both, x))])
    return lambda *at: np.array(f(at))


def test_slip_is_as_defined_in_driving_and_in_braking() -> None:
    f: Any = evaluated()
    assert f(2.5, 2.0, 0.0)[0, 0] == (2.5 - 2.0) / 2.5  # 3.1
    assert f(1.5, 2.0, 0.0)[0, 0] == (1.5 - 2.0) / 2.0  # 3.2
    assert f(0.0, 2.0, 0.0)[0, 0] == -1.0  # locked
    assert f(2.0, 0.0, 0.0)[0, 0] == 1.0  # spins in place
    assert f(-2.5, -2.0, 0.0)[0, 0] == -f(2.5, 2.0, 0.0)[0, 0]  # drives backwards
    assert f(2.0, 2.0, 0.1)[1, 0] == 0.1 / 2.0  # tan of the slip angle


def test_slip_is_finite_and_smooth_at_rest() -> None:
    """Nothing divides by zero, and value and slopes continue through v_min: a step of 1e-9 changes them by 1e-6."""
    f: Any = evaluated()
    rest = f(0.0, 0.0, 0.0)
    np.testing.assert_array_equal(rest[:, 0], 0)
    np.testing.assert_allclose(rest[0, 1:3], [20.0, -20.0])  # 2 / v_min
    np.testing.assert_allclose(f(0.1 - 1e-9, 0.04, 0.02), f(0.1 + 1e-9, 0.04, 0.02), atol=1e-6)
    np.testing.assert_allclose(f(0.04, 0.1 - 1e-9, 0.02), f(0.04, 0.1 + 1e-9, 0.02), atol=1e-6)


@pytest.mark.parametrize("law", LAWS)
def test_a_wheel_at_rest_or_locked_has_a_finite_force_and_slope(law: str) -> None:
    x = ca.SX.sym("x", 3)
    t = tyre(law)
    both = ca.vertcat(*friction_coefficients(t, wheel_slip(x[0], x[1], x[2], 0.1)))
    f = ca.Function("f", [x], [both, ca.jacobian(both, x)])
    for at in ((0, 0, 0), (0, 2, 0), (2, 0, 0), (0, 0, 1), (0, 2, 1), (-1, 1, 0), (1e-12, 0, 0)):
        value, derivative = (np.array(m) for m in f(at))
        assert np.all(np.isfinite(value))
        assert np.all(np.isfinite(derivative))
        assert np.hypot(*value.ravel()) <= t.mu * (1 + 1e-12)
