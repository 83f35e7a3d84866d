"""The planar model: independent closed forms, and the numbers that the thesis and its corrected equations give."""

import numpy as np
import pytest
from scipy.optimize import brentq

from plants.planar import FRONT, REAR, Bicycle, Posture
from plants.tables import robot

ROBOT = robot("thesis_6_1")
CENTRE, GROUND = Bicycle(ROBOT, "centre"), Bicycle(ROBOT, "ground")
NEAR = 1e-12  # relative: the closed forms take some twenty operations, each right to 1.1e-16, without cancellation


@pytest.mark.parametrize("pitch", [-0.15, 0.0, 0.2])
@pytest.mark.parametrize("bicycle", [CENTRE, GROUND], ids=["centre", "ground"])
def test_P_U_and_b_are_the_corrected_equations_of_chapter_5(bicycle: Bicycle, pitch: float) -> None:
    """(5.5)-(5.8) with P_12 = cos(p + gamma)/m + Rn1 Rn2/I_y in place of the misprint; rears on the flat."""
    m, I_y, L_f, L_r, h = ROBOT.m, ROBOT.I_y, ROBOT.L_f, ROBOT.L_r, ROBOT.h
    theta, omega, g = 0.3, 0.7, 9.81
    gamma = theta - pitch
    s, c, sp, cp = np.sin(gamma), np.cos(gamma), np.sin(pitch), np.cos(pitch)
    R = ROBOT.R if bicycle is GROUND else 0.0
    Rn1, Rn2 = L_r * cp - h * sp, h * s - L_f * c
    Ra1, Ra2 = -(h * cp + L_r * sp) - R, -(h * c + L_f * s) - R
    P12 = np.cos(theta) / m + Rn1 * Rn2 / I_y
    at = Posture(theta, pitch=pitch)
    np.testing.assert_allclose(bicycle.P(at), [[1 / m + Rn1**2 / I_y, P12], [P12, 1 / m + Rn2**2 / I_y]], rtol=NEAR)
    expected = [
        [Rn1 * Ra1 / I_y, np.sin(theta) / m + Rn1 * Ra2 / I_y],
        [-np.sin(theta) / m + Rn2 * Ra1 / I_y, Rn2 * Ra2 / I_y],
    ]
    np.testing.assert_allclose(bicycle.U(at), expected, rtol=NEAR, atol=NEAR / m)
    b = [-g + omega**2 * (L_r * sp + h * cp), -g * np.cos(theta) + omega**2 * (L_f * s + h * c)]
    np.testing.assert_allclose(bicycle.b(at, np.array([2.0, 0.1, omega])), b, rtol=NEAR)


@pytest.mark.parametrize(("rear", "front"), [(0.0, 0.0), (250.0, 0.0), (0.0, 180.0), (90.0, -40.0)])
def test_accelerations_are_appendix_A_with_its_errors_removed(rear: float, front: float) -> None:
    """Level body on both axles, any v_z and omega_y: alpha_y, v_x' and v_z' over the common denominator Psi."""
    m, I_y, L_f, L_r, h, L, g = ROBOT.m, ROBOT.I_y, ROBOT.L_f, ROBOT.L_r, ROBOT.h, ROBOT.L, 9.81
    gamma, v_x, v_z, w = 0.35, 1.7, 0.2, -0.6
    s, c = np.sin(gamma), np.cos(gamma)
    at, twist, traction = Posture(gamma), np.array([v_x, v_z, w]), np.array([rear, front])
    a_x, a_z, alpha = CENTRE.accelerations(at, CENTRE.contact_forces(at, twist, traction), traction)

    psi = m * ((L * c - h * s) ** 2 + L_r**2 * s**2) + I_y * s**2
    by_traction = -L * s * front - L * s * c * rear
    psi_alpha = by_traction + m * g * L_r * s**2 + m * w**2 * L * s * (L_f * c - h * s)
    psi_v_x = (
        front * (L**2 * c - h * L * s) + rear * (L**2 * c**2 - h * L * s * c)
        - m * g * L_r * L * s * c + m * g * h * L_r * s**2
        + m * s * c * (2 * v_z * w * h * L + h * w**2 * L_r * L)
        + m * s**2 * (L_r * w**2 * (L_r * L_f - h**2) + v_z * w * (L_f**2 + 2 * L_r * L_f - h**2))
        - I_y * s**2 * (v_z * w - L_f * w**2) - m * v_z * w * L**2
    )  # fmt: skip
    psi_v_z = (
        front * L_r * L * s + rear * L_r * L * s * c - m * g * L_r**2 * s**2
        + m * s * c * (-2 * v_x * w * h * L + w**2 * L * (2 * h**2 - L_f * L_r)) + I_y * s**2 * (v_x * w - h * w**2)
        + m * s**2 * (v_x * w * (h**2 - L_f**2 - 2 * L_r * L_f) + h * w**2 * (3 * L_f * L_r + L_r**2 + L_f**2 - h**2))
        + m * L**2 * (v_x * w - h * w**2)
    )  # fmt: skip
    assert CENTRE.psi(at) == pytest.approx(psi, rel=NEAR)
    # 100 NEAR: the solution for the contact forces has the condition number of P, 30
    found = [alpha, a_x - v_z * w, a_z + v_x * w]
    np.testing.assert_allclose(found, np.array([psi_alpha, psi_v_x, psi_v_z]) / psi, rtol=100 * NEAR)
    assert a_z + L_r * alpha + h * w**2 == pytest.approx(0, abs=100 * NEAR * abs(a_z))


def test_the_twist_of_a_climbing_robot() -> None:
    """Level body: omega_y = -v_x s/(L c - h s), v_z = -omega_y L_r; nose-up, which is negative."""
    s, c = np.sin(0.2), np.cos(0.2)
    v_x, v_z, omega = CENTRE.climbing_twist(Posture(0.2), 2.0)
    assert omega == pytest.approx(-2 * s / (ROBOT.L * c - ROBOT.h * s), rel=NEAR)
    assert (v_x, v_z) == (2.0, pytest.approx(-omega * ROBOT.L_r, rel=NEAR))


def test_the_static_climb_force() -> None:
    """At the centre arm m g L_r/L times tan or sin of the slope; nothing accelerates under it at either arm."""
    weight_share = ROBOT.m * 9.81 * ROBOT.L_r / ROBOT.L
    assert CENTRE.climb_force(0.2) == pytest.approx(weight_share * np.tan(0.2), rel=NEAR)
    assert CENTRE.climb_force(0.2, "front") == pytest.approx(weight_share * np.sin(0.2), rel=NEAR)
    assert CENTRE.climb_force(0.2) == pytest.approx(146.705, abs=5e-4)
    assert GROUND.climb_force(0.2) == pytest.approx(143.952, abs=5e-4)
    for bicycle in (CENTRE, GROUND):
        for drive, name in ((REAR, "rear"), (FRONT, "front")):
            traction = bicycle.climb_force(0.2, name) * drive
            normal = bicycle.contact_forces(Posture(0.2), np.zeros(3), traction)
            # 1e-11 m/s2: rounding of g = 9.81 m/s2 times the condition number of P
            np.testing.assert_allclose(bicycle.accelerations(Posture(0.2), normal, traction), 0, atol=1e-11)


def test_the_stationary_force_of_the_papers() -> None:
    """F*: 277.5 N without and 290.6 N with the turning of a robot that climbs at 2 m/s; small slopes: twice static."""
    at = Posture(0.2)
    assert CENTRE.stationary_force(at, 0.0) == pytest.approx(277.5, abs=0.05)
    assert CENTRE.stationary_force(at, CENTRE.climbing_twist(at, 2.0)[2]) == pytest.approx(290.6, abs=0.05)
    ratio = CENTRE.stationary_force(Posture(1e-4), 0.0) / CENTRE.climb_force(1e-4)
    assert ratio == pytest.approx(2, abs=1e-3)  # the next term is of the order of the slope
    asme = Bicycle(robot("asme_paper"), "centre")
    assert asme.stationary_force(at, 0.0) == pytest.approx(157.1, abs=0.05)
    assert asme.stationary_force(at, 0.0, FRONT) == pytest.approx(148.3, abs=0.05)


def test_the_stationary_force_makes_the_difference_quotient_vanish() -> None:
    traction, omega = CENTRE.stationary_force(Posture(0.2), 0.4) * REAR, np.array([0.0, 0.0, 0.4])

    def a_z(slope: float) -> float:
        at = Posture(slope)
        return float(CENTRE.accelerations(at, CENTRE.contact_forces(at, omega, traction), traction)[1])

    step = 1e-5  # the quotient errs by step^2 a_z'''/6 and 1e-15/step, both near 1e-10; the slope is -10 without force
    assert (a_z(0.2 + step) - a_z(0.2 - step)) / (2 * step) == pytest.approx(0, abs=1e-8)


def test_contact_is_lost_at_the_slopes_of_figure_4_4() -> None:
    """0.98 rad as printed needs omega_y = 2 rad/s throughout; one that climbs at 2 m/s loses it at 0.757 rad."""

    def climbing(slope: float) -> float:
        return float(CENTRE.climbing_twist(Posture(slope), 2.0)[2])

    assert CENTRE.contact_loss_slope(climbing) == pytest.approx(0.757, abs=5e-4)
    assert CENTRE.contact_loss_slope(lambda slope: 2.0) == pytest.approx(0.9805, abs=5e-5)
    assert CENTRE.contact_loss_slope(lambda slope: 0.0) == pytest.approx(1.210, abs=5e-4)
    weightless = Bicycle(ROBOT, "centre", g=-9.81)
    assert weightless.contact_loss_slope(lambda slope: 0.0) is None  # never on the ground, so nothing to lose


def test_open_loop_frequencies_of_table_6_1() -> None:
    np.testing.assert_allclose(CENTRE.frequencies(Posture(0.3), 5.6e6), [226.6, 253.8], atol=0.05)


def test_the_three_jerks_vanish_at_three_forces() -> None:
    """Straight ramp of 0.2 rad at 2 m/s: 160.5, 216.3 and 152.4 N; and what is left at the thesis' 367 N."""
    for name, force, left in (("body", 160.5, -0.68), ("inertial", 216.3, -0.11), ("thesis", 152.4, -1.81)):

        def vertical(F: float, name: str = name) -> float:
            return float(np.atleast_1d(getattr(CENTRE.jerk(Posture(0.2), 2.0, F * REAR), name))[-1])

        assert brentq(vertical, 0, 500) == pytest.approx(force, abs=0.05)
        assert vertical(367.0) == pytest.approx(left, abs=0.005)


def test_jerk_is_the_rate_of_the_acceleration_along_the_motion() -> None:
    """Both axles on curved ground; along p' = -omega, theta' = kappa v_t, v_x' = a_x - omega v_z."""
    at, traction, v_x = Posture(0.25, 0.1, 0.05, (0.4, -0.3)), np.array([120.0, 60.0]), 1.5

    def acceleration(at: Posture, v_x: float) -> np.ndarray:
        return GROUND.accelerations(at, GROUND.contact_forces(at, GROUND.climbing_twist(at, v_x), traction), traction)

    a_x, _, _ = acceleration(at, v_x)
    _, v_z, omega = GROUND.climbing_twist(at, v_x)
    rates = []
    for x, slope, kappa in ((-ROBOT.L_r, at.rear, 0.4), (ROBOT.L_f, at.front, -0.3)):
        gamma = slope - at.pitch
        along = (v_x - omega * ROBOT.h) * np.cos(gamma) + (v_z - omega * x) * np.sin(gamma)
        rates.append(kappa * along)

    def moved(time: float) -> np.ndarray:
        there = Posture(at.front + rates[1] * time, at.rear + rates[0] * time, at.pitch - omega * time, at.curvature)
        return acceleration(there, v_x + (a_x - omega * v_z) * time)[:2]

    step = 1e-5  # s; the quotient errs by about step^2 and 1e-14/step
    quotient = (moved(step) - moved(-step)) / (2 * step)
    np.testing.assert_allclose(GROUND.jerk(at, v_x, traction).body, quotient, rtol=1e-7)
