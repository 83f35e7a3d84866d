"""When axles leave the ground: the numbers of chapter 4, the crest of a hump, and impacts by an independent search."""

import numpy as np
import pytest
from planar_impacts import complementary

from plants.contact_loss import impact, speed_at_loss, traction_at_loss
from plants.ground import Hump
from plants.planar import FOUR, FRONT, REAR, Bicycle, Posture
from plants.tables import robot

ROBOT = robot("thesis_6_1")
CENTRE, GROUND = Bicycle(ROBOT, "centre"), Bicycle(ROBOT, "ground")
CLOSING = 0.6  # m/s, the approach speed of the thesis' impacts, sections 6.3 and 8


@pytest.mark.parametrize(
    ("bicycle", "omega", "forces"),
    [(CENTRE, None, (3126, 1913, 1379)), (CENTRE, 2.0, (2414, 1477, 1064)), (GROUND, None, (2203, 1523, 1164))],
    ids=["climbing", "2 rad/s", "climbing, traction at the ground"],
)
def test_figure_4_5_rear_drive_unloads_the_front_last(
    bicycle: Bicycle, omega: float | None, forces: tuple[float, ...]
) -> None:
    """Slope 0.3, 2 m/s, 170 kg: rear > four-wheel > front, whatever pitch rate the figure was drawn with."""
    at = Posture(0.3)
    twist = bicycle.climbing_twist(at, 2.0) if omega is None else np.array([2.0, 0.0, omega])
    found = [traction_at_loss(bicycle, at, twist, drive) for drive in (REAR, FOUR, FRONT)]
    np.testing.assert_allclose(found, forces, atol=0.5)  # as rounded in the list of corrected figures
    assert found[0] > found[1] > found[2]
    # none of them is attainable: friction passes on 0.8 of what the rear axle bears at rest on that slope
    assert min(found) > 0.8 * bicycle.contact_forces(at, np.zeros(3), np.zeros(2))[0]


def test_an_axle_that_traction_loads_is_never_lost_by_it() -> None:
    at, twist = Posture(0.3), CENTRE.climbing_twist(Posture(0.3), 2.0)
    assert traction_at_loss(CENTRE, at, twist, REAR, axle=0) is None
    braking = traction_at_loss(CENTRE, at, twist, -REAR, axle=0)
    assert braking is not None
    assert CENTRE.contact_forces(at, twist, -braking * REAR)[0] == pytest.approx(0, abs=1e-9)


def test_rear_traction_presses_the_front_axle_on_a_steep_slope() -> None:
    """Beyond some slope pushing from behind holds the front axle on the ground, as its load at three forces shows."""
    for slope in np.linspace(0.05, 0.95, 10):
        at, twist = Posture(slope), CENTRE.climbing_twist(Posture(slope), 2.0)
        loads = [CENTRE.contact_forces(at, twist, force * REAR)[1] for force in (0.0, 1e3, 2e3)]
        found = traction_at_loss(CENTRE, at, twist, REAR)
        if loads[2] > loads[1] > loads[0]:
            assert found is None
            assert slope > 0.5
        else:
            assert found is not None
            assert CENTRE.contact_forces(at, twist, found * REAR)[1] == pytest.approx(0, abs=1e-8)


def test_the_crest_of_a_hump_is_left_above_a_speed() -> None:
    """On a crest both n are vertical, so that F_2 = 0 where kappa v^2 = g but for the other axle's inertia.

    The path of the wheel centre bends by kappa / (1 - R kappa) with kappa = -2 pi^2 h / l^2 at the crest.  Level body,
    omega = 0: b = (-g, -g - kappa v^2), and the front force vanishes where b_2 = P_12 / P_11 b_1.
    """
    hump = Hump(length=1.0, height=0.05)
    kappa = -2 * np.pi**2 * hump.height / hump.length**2
    kappa /= 1 - ROBOT.R * kappa
    at = Posture(0.0, curvature=(0.0, kappa))
    P = CENTRE.P(at)
    expected = np.sqrt(9.81 * (1 - P[0, 1] / P[0, 0]) / -kappa)
    rear, front = speed_at_loss(CENTRE, at)
    assert front == pytest.approx(expected, rel=1e-12)
    assert rear > front  # the falling front loads the rear axle or hardly changes it
    forces = CENTRE.contact_forces(at, CENTRE.climbing_twist(at, front), np.zeros(2))
    assert forces[1] == pytest.approx(0, abs=1e-9)
    assert np.all(np.isinf(speed_at_loss(CENTRE, Posture(0.0))))


@pytest.mark.parametrize(("m", "rear", "front"), [(170.0, -6.6, None), (270.0, 8.4, 74.9)])
def test_a_front_impact_on_the_ramp_lifts_or_loads_the_rear_axle(m: float, rear: float, front: float | None) -> None:
    """0.6 m/s at 0.3 rad: with 170 kg the ground would have to hold the rear axle down, with 270 kg it is pressed."""
    bicycle, at = Bicycle(ROBOT.with_changes(m=m), "centre"), Posture(0.3)
    rate = np.array([0.0, -CLOSING])
    held = impact(bicycle, at, rate, bilateral=True)
    assert held[0] == pytest.approx(rear, abs=0.05)
    if front is not None:
        assert held[1] == pytest.approx(front, abs=0.05)
    P = bicycle.P(at)
    assert held[0] == pytest.approx(-P[0, 1] / P[0, 0] * held[1])
    free = impact(bicycle, at, rate)
    np.testing.assert_allclose(free, held if rear > 0 else [0, CLOSING / P[1, 1]])


def test_the_centre_of_percussion_on_the_flat() -> None:
    """Lam_r = (m L_f L_r - I_y) / (I_y + m L_r^2) Lam_f: -0.001 with 170 kg, +0.264 with 270 kg."""
    for m, ratio in ((170.0, -0.001), (270.0, 0.264)):
        bicycle = Bicycle(ROBOT.with_changes(m=m))
        rear, front = impact(bicycle, Posture(0.0), np.array([0.0, -CLOSING]), bilateral=True)
        assert rear / front == pytest.approx((m * ROBOT.L_f * ROBOT.L_r - ROBOT.I_y) / (ROBOT.I_y + m * ROBOT.L_r**2))
        assert rear / front == pytest.approx(ratio, abs=5e-4)


def test_impacts_are_the_complementary_ones_and_never_gain_energy() -> None:
    """Against a search of all cases; (1 - e^2) of the energy of the normal motion goes where both axles push."""
    rng = np.random.default_rng(5)
    for _ in range(300):
        at = Posture(rng.uniform(-0.4, 0.6), rng.uniform(-0.3, 0.3), rng.uniform(-0.2, 0.2))
        rate, e = rng.normal(size=2), rng.uniform(0, 1)
        P, found = GROUND.P(at), impact(GROUND, at, rate, e)
        np.testing.assert_allclose(found, complementary(P, (1 + e) * rate), rtol=1e-9, atol=1e-9)
        after = rate + P @ found
        change = found @ (rate + after) / 2  # the work of the impulses
        assert change <= 1e-12
        if np.all(found > 0):
            np.testing.assert_allclose(after, -e * rate, atol=1e-12)
            assert change == pytest.approx(-(1 - e**2) / 2 * rate @ np.linalg.solve(P, rate), rel=1e-9, abs=1e-12)
