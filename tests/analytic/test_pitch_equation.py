"""The pitch plan of chapter 5: its equation against the planar model, its limits, what it needs in time and grip."""

import numpy as np
import pytest

from controllers.pitch_plan import (
    PitchPlan,
    Slope,
    coefficients,
    pitch_for_time,
    planned_pitch,
    shortest_time_on_a_sine,
    sine_slope,
)
from controllers.reference import planned
from cosim.errors import DeclarationError
from plants.manoeuvre import PitchManoeuvre
from plants.planar import Bicycle, Posture
from plants.tables import robot

ROBOT = robot("thesis_5_1")
WEIGHT = ROBOT.m * 9.81
INSIDE = np.linspace(0.02, 0.98, 49)


def even(length: float = 0.345, pitch: float = 0.1) -> tuple[PitchManoeuvre, Slope]:
    """Return the ground on which the body moves evenly, and its slope over the normalised time."""
    ground = PitchManoeuvre(pitch=pitch, length=length)

    def slope(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return ground.centre(t).slope, ground.centre(t).slope_rate

    return ground, slope


def planar(plan: PitchPlan, t: float, T: float) -> tuple[Bicycle, Posture, np.ndarray]:
    """Return the planar model in the state that the plan has at a normalised time."""
    p, rate, _, _ = planned_pitch(t, plan.beta, T)
    theta, turning = (float(v) for v in plan.slope(np.array(t)))
    curvature = turning / float(plan.speed(t)) if plan.curvature else 0.0
    at = Posture(theta, pitch=p, curvature=(0.0, curvature))
    side = Bicycle(ROBOT, plan.traction_arm)
    unit = side.climbing_twist(at, 1.0)
    return side, at, unit * (-rate / unit[2])


@pytest.mark.parametrize("arm", ["ground", "centre"])
def test_the_pitch_equation_is_that_of_the_planar_model(arm: str) -> None:
    """Appendix B, corrected, for any pitch, slope, speed, curvature and traction; some fifty roundings of 1e-16."""
    rng = np.random.default_rng(5)
    side = Bicycle(ROBOT, arm)
    for _ in range(50):
        p, theta, F, v, kappa = rng.uniform([0, 0.05, -300, 0, -5], [0.3, 0.6, 600, 2, 5])
        at = Posture(theta, pitch=p, curvature=(0.0, kappa))
        twist, traction = side.climbing_twist(at, v), np.array([F, 0.0])
        alpha = side.accelerations(at, side.contact_forces(at, twist, traction), traction)[2]
        v_t = (twist[0] - twist[2] * ROBOT.h) * np.cos(theta - p) + (twist[1] - twist[2] * ROBOT.L_f) * np.sin(
            theta - p
        )
        of = coefficients(ROBOT, p, theta, ROBOT.R if arm == "ground" else 0.0)
        terms = np.array([of.Phi * F, of.Gamma * twist[2] ** 2, of.Lambda, of.K * kappa * v_t**2])
        assert -alpha == pytest.approx(np.sum(terms), abs=1e-13 * np.sum(np.abs(terms)))


def test_the_plan_is_the_degree_7_path_at_rest_at_both_ends() -> None:
    t, T = np.linspace(0, 1, 21), 1.38
    plan = planned_pitch(t, 0.1, T)
    path = planned(t * T, T, 0.0, 0.0, 0.1)
    np.testing.assert_allclose(plan.p, path.z, atol=1e-14)
    np.testing.assert_allclose(plan.rate, path.rate, atol=1e-13)
    np.testing.assert_allclose(plan.acceleration, path.acceleration, atol=1e-12)
    of_p = np.polynomial.Polynomial([0, 0, 0, 0, 3.5, -8.4, 7.0, -2.0])
    np.testing.assert_allclose(plan.jerk, of_p.deriv(3)(t) / T**3, atol=1e-12)
    for quantity in plan[1:]:
        assert quantity[0] == quantity[-1] == 0


def test_a_pitch_of_0_0433_rad_takes_1_38_s_without_braking() -> None:
    """In closed form, and by the search: its cubic from 3e-3 inside is off by less than 1e-6 of the ratio."""
    closed = pitch_for_time(1.38, lambda beta: shortest_time_on_a_sine(ROBOT, beta, 0.5))
    assert round(closed, 4) == 0.0433
    for arm in ("ground", "centre"):
        searched = pitch_for_time(
            1.38, lambda beta, arm=arm: PitchPlan(ROBOT, beta, sine_slope(0.5), False, arm).shortest_time()
        )
        assert searched == pytest.approx(closed, rel=1e-6)


@pytest.mark.parametrize(("xi", "beta"), [(0.5, 0.0638), (-0.2, 0.0107)])
def test_the_curvature_that_the_thesis_leaves_out_takes_a_third_off_the_time_squared(xi: float, beta: float) -> None:
    found = pitch_for_time(1.38, lambda b: PitchPlan(ROBOT, b, sine_slope(xi)).shortest_time())
    assert round(found, 4) == beta
    closed = pitch_for_time(1.38, lambda b: shortest_time_on_a_sine(ROBOT, b, xi))
    assert found / closed == pytest.approx(1.5, abs=0.03)  # of small pitches: F ~ 420 - 140 in place of 420


def test_a_faster_manoeuvre_brakes_and_a_slower_one_needs_less() -> None:
    """Fig 5.4 and 5.5: the sign changes below 1.38 s, the peak of 600 N falls with the time."""
    plan = PitchPlan(ROBOT, 0.0433, sine_slope(0.5), curvature=False)
    t = np.linspace(0, 1, 2001)
    F = {T: plan.force(t, T) for T in (1.0, 1.2, 1.381, 1.6, 2.0)}
    assert [round(float(F[T].min())) for T in (1.0, 1.2)] == [-41.0, -7.0]
    assert all(F[T].min() > -1e-6 for T in (1.381, 1.6, 2.0))
    assert round(float(F[1.381].max()), -1) == 600
    peaks = [float(force.max()) for force in F.values()]
    assert peaks == sorted(peaks, reverse=True)


def test_the_force_goes_to_zero_at_both_ends() -> None:
    """The quotient is 0/0 there: F / t has a limit, and the values at the ends themselves are finite and 0."""
    plan = PitchPlan(ROBOT, 0.06, sine_slope(0.5))
    t = np.array([1e-3, 1e-5, 1e-7, 1e-9])
    for side in (plan.force(t, 3.0), plan.force(1 - t, 3.0)):
        # F / t differs over 1e-3 of the manoeuvre by some pi 1e-3 of itself; 1 - 1e-9 keeps 7 digits
        np.testing.assert_allclose(side / t, side[1] / t[1], rtol=0.02)
    np.testing.assert_allclose(plan.force([0.0, 1.0], 1.38), 0, atol=1e-9)
    assert plan.speed([0.0, 1.0]) == pytest.approx([0, 0], abs=1e-9)


def test_normal_forces_are_those_of_the_planar_model() -> None:
    for plan in (PitchPlan(ROBOT, 0.06, sine_slope(0.5)), PitchPlan(ROBOT, 0.1, even()[1], traction_arm="centre")):
        rear, front = plan.normal_forces(INSIDE, 1.0)
        F = plan.force(INSIDE, 1.0)
        for i, t in enumerate(INSIDE):
            side, at, twist = planar(plan, t, 1.0)
            expected = side.contact_forces(at, twist, np.array([F[i], 0.0]))
            np.testing.assert_allclose([rear[i], front[i]], expected, atol=1e-9 * WEIGHT)


def test_the_time_is_chosen_by_the_friction_there_is() -> None:
    plan = PitchPlan(ROBOT, 0.1, even()[1])
    shortest = plan.shortest_time()
    assert plan.time_for_friction(0.8, shortest) == pytest.approx(shortest, rel=1e-6)
    slower = plan.time_for_friction(0.38, shortest)
    assert slower > 1.2 * shortest
    assert plan.friction_needed(slower) == pytest.approx(0.38, rel=1e-9)
    assert plan.friction_needed(0.99 * slower) > 0.38
    # however slow, the static share of the steepest place is needed
    theta, at = plan.slope(INSIDE)[0], int(np.argmax(plan.slope(INSIDE)[0]))
    side, posture, _ = planar(plan, INSIDE[at], 1e6)
    forces = side.contact_forces(posture, np.zeros(3), np.array([plan.force(INSIDE, 1e6)[at], 0.0]))
    static = float(forces[1] * np.sin(theta[at]) / forces[0])
    with pytest.raises(DeclarationError, match=f"needs a friction coefficient of {static:.2f}.* however slow"):
        plan.time_for_friction(0.3)


def test_an_even_motion_never_brakes_before_the_front_wheels_lift() -> None:
    """Without horizontal acceleration F = F_n2 sin theta, an independent balance, and F changes sign with F_n2."""
    ground, slope = even()
    plan = PitchPlan(ROBOT, ground.pitch, slope)
    t = np.linspace(0, 1, 401)
    for T in (0.3, 1.38):
        _, front = plan.normal_forces(t, T)
        # A / Phi is a difference of terms 1 / t as large near the ends: their rounding, at most 1e-4 inside
        np.testing.assert_allclose(plan.force(t, T), front * np.sin(ground.centre(t).slope), atol=1e-9 * WEIGHT)
    shortest = plan.shortest_time()
    assert 0 <= np.min(plan.normal_forces(t, 1.001 * shortest)[1]) < 0.01 * WEIGHT
    assert np.min(plan.normal_forces(t, 0.999 * shortest)[1]) < 0


def test_a_slope_on_which_every_manoeuvre_brakes_is_refused() -> None:
    def flat_ended(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:  # vanishes faster than the pitch acceleration
        return 0.5 * np.sin(np.pi * t) ** 2, np.pi * 0.5 * np.sin(2 * np.pi * t)

    with pytest.raises(DeclarationError, match=r"no manoeuvre of beta = 0.05 rad over this slope is without braking"):
        PitchPlan(ROBOT, 0.05, flat_ended).shortest_time()
    with pytest.raises(DeclarationError, match=r"no pitch up to 0.5 rad has a shortest manoeuvre time of 100 s"):
        pitch_for_time(100.0, lambda beta: shortest_time_on_a_sine(ROBOT, beta, 0.5))
