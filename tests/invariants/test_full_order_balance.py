"""The full-order robot keeps momentum to rounding and energy to 1e-3 while it meets a ramp."""

from __future__ import annotations

import numpy as np
import pytest

import fmus
from cosim.clock import NS
from plants.full_order import FullOrderRover
from plants.full_order_ground import ground_table
from plants.full_order_start import rolling
from plants.ground import Ramp

STEP = NS // 10_000


def test_balances_of_a_collision() -> None:
    """Gravity rises in 50 ms, the front wheels meet a slope of 0.3 rad at 2 m/s after 60 ms and leave the ground."""
    ground = ground_table(Ramp(0.72, 0.3))
    rover = FullOrderRover(
        nodes=16, points=64, gravity_time=0.05, micro_step=5e-5, ground_left=ground, ground_right=ground
    )
    fmu = fmus.instantiate(rover)
    for name, value in rolling(rover, 0.0, 0.5, 2.0).items():
        fmu.set(name, value)
    fmu.enter_initialization(0)
    fmu.push()
    fmu.exit_initialization()

    def account() -> tuple[float, np.ndarray, np.ndarray]:
        energy = sum(fmu.get(n) for n in ("kinetic_energy", "elastic_energy", "contact_energy", "damped", "slid"))
        return (energy - fmu.get("fallen") - fmu.get("worked"), fmu.get("momentum") - fmu.get("impulse"),
                fmu.get("angular_momentum") - fmu.get("twist"))  # fmt: skip

    before, peak = account(), 0.0
    for n in range(1000):
        fmu.step(n * STEP, (n + 1) * STEP)
        peak = max(peak, float(fmu.get("normal_force_end")[0]))
    after = account()
    assert peak > 1500  # the collision took place: four times the static load
    # what the normal speed of 0.59 m/s holds is some 15 J: 1e-3 of that
    assert after[0] == pytest.approx(before[0], abs=0.015)
    # 2000 micro steps, each with a rounding of 2.2e-16 of 340 N.s and of 170 N.m.s
    assert np.max(np.abs(after[1] - before[1])) < 2000 * 2.2e-16 * 340
    assert np.max(np.abs(after[2] - before[2])) < 2000 * 2.2e-16 * 340
