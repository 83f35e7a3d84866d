"""The full-order robot's wheel rolls as tyres do, and tends to the analytical wheel where its assumptions hold."""

from __future__ import annotations

from plants.full_order import FullOrderRover
from plants.ring_press import calibrated, press
from studies.full_order_limits import towards_deformation
from studies.full_order_wheel import free_rolling, slip_stiffness, tangential_stiffness


def test_rolling_resistance_comes_from_damping_and_is_larger_for_soft_wheels() -> None:
    """None without dampers, since nothing else loses energy: less than 2 % of that with them.

    The effective radius lies between that of the loaded wheel, R - W / k_w, and that of the free one.
    """
    undamped, damped = free_rolling(1e5, 0.0), free_rolling(1e5, 1322.8)
    assert abs(undamped.resistance) < 0.02 * damped.resistance
    assert 0.1 - 417 / 1e5 < undamped.radius < 0.1
    assert free_rolling(2.8e6, 1167.0).resistance < 0.1 * damped.resistance
    assert free_rolling(1e5, 1322.8, speed=1.0).resistance < damped.resistance


def test_relaxation_length_is_about_half_of_the_contact() -> None:
    """Brush and carcass models give sigma = a for bristles alone, more with a soft carcass: from a / 2 to 2 a."""
    ring = FullOrderRover(micro_step=1e-7).values
    ring = {**ring, **calibrated(ring, 32, 128, 1e5, 417.0)}
    patch = press(ring, 32, 128, 417.0 / 1e5).patch
    length = slip_stiffness(1e5, 1322.8) / tangential_stiffness(ring, patch)
    assert 0.25 * patch < length < patch


def test_a_ring_that_stays_round_tends_to_the_massless_spring() -> None:
    """Force and speed on the ramp come nearer with every step towards a light ring that hardly bends."""
    left = towards_deformation([(0.3, 1.0), (0.3, 10.0)], duration=0.04)
    assert left[1].force < 0.6 * left[0].force
    assert left[1].speed < left[0].speed
