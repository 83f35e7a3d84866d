"""The full-order robot's wheel rolls as tyres do, and tends to the analytical wheel where its assumptions hold."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from plants.full_order import FullOrderRover
from plants.ring_press import calibrated, press
from plants.tables import G
from studies.full_order_limits import (
    K_W,
    RAMP,
    ROBOT,
    SPEED,
    STEP,
    Ring,
    difference,
    predicted,
    ring_on_ramp,
    spring_on_ramp,
    towards_rigid,
)
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


def test_a_light_round_ring_becomes_the_massless_spring() -> None:
    """A planar robot on round wheels predicts it: what the contact leaves falls with k_c^(-2/3), 4 times per step of 8.

    It is to fall 2.5 times at least.  From the prediction the force may be off by what stops the rings of an axle
    within the 1 ms of the smoothing: their momentum 2 m v sin(0.3).
    """
    time, mass = 0.04, 0.1
    rings = [Ring(mass, 1e3, contact, nodes=32, points=128) for contact in (1.0, 8.0, 64.0)]
    spring = spring_on_ramp(time)
    runs = [ring_on_ramp(ring, time) for ring in rings]
    left = [difference(run, spring) for run in runs]
    for before, after in pairwise(left):
        assert after.force < before.force / 2.5
        assert after.speed < before.speed / 2.5
    stopped = 2 * mass * float(FullOrderRover.ring_mass.start) * SPEED * np.sin(RAMP.angle) / 1e-3
    for ring, run in zip(rings, runs, strict=True):
        said = predicted(ring.contact, time)
        assert difference(run, (said.force, said.speed)).force < stopped / np.max(spring[0])


def test_a_sharp_corner_hardly_tells_the_spring_from_a_round_wheel_on_both_faces() -> None:
    """A wheel d deep is on both for d tan(0.3) / v; meanwhile one face is nearer than the corner by 1 - cos(0.15).

    The load of the front axle on two wheels gives d; half of the 1 ms of the smoothing is spent there.
    """
    time = 0.01
    hard = predicted(1e8, time)
    depth = ROBOT.m * G * ROBOT.L_r / ROBOT.L / (2 * K_W)
    assert hard.both == pytest.approx(depth * np.tan(RAMP.angle) / SPEED, abs=STEP)
    left = difference((hard.force, hard.speed), spring_on_ramp(time))
    assert left.force < (1 - np.cos(RAMP.angle / 2)) / 2


def test_hard_rings_become_rigid_wheels() -> None:
    """On a smooth hump, at first order: 1 / k_w is what wheels give, and what that moves the body by.

    From 3e4 to 1e5 N/m, 3.3 times; force and speed are to fall twice at least.  At 1e5 N/m 128 points change the load
    by 1 %, which is not to count yet.
    """
    ring = Ring(0.3, 1e3, nodes=32, points=128)
    soft, hard = (towards_rigid(k_w, ring, duration=0.12) for k_w in (3e4, 1e5))
    assert hard.force < soft.force / 2
    assert hard.speed < soft.speed / 2
