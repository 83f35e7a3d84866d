"""Balances of the full-order robot that meets a ramp: undamped; with motors, a mode and forces, on one side only."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

import fmus
from cosim.clock import NS
from plants.full_order import FullOrderRover
from plants.full_order_ground import ground_table
from plants.full_order_start import rolling
from plants.ground import Flat, Ramp

STEP, MICRO, STEPS = NS // 10_000, 5e-5, 1000
# what the impact has to do with: the normal speed of 0.59 m/s of half the robot holds some 15 J
ENERGY, PEAK = 15.0, 1500.0  # J; N, four times the static load: the collision took place


@dataclass(frozen=True)
class Case:
    """What differs from an uncontrolled, damped robot on a rigid chassis that meets the ramp with both front wheels."""

    parameters: dict[str, Any] = field(default_factory=dict)
    inputs: dict[str, Any] = field(default_factory=dict)
    one_sided: bool = False  # only the left wheels meet the ramp: the robot rolls and yaws


CASES = {
    "undamped": Case({"c_radial": 0.0, "c_tangential": 0.0}),
    # motors, half of them asked for more than friction holds; a mode that bends and twists; all that acts from outside
    "driven": Case(
        {"wheel_shape": [[0.06], [-0.05], [0.04], [0.05]], "damping": [0.02]},
        {"torque": [5.0, -4.0, 30.0, 6.0], "traction_demand": [100.0, 900.0, -100.0, 50.0],
         "force": [30.0, 40.0, -50.0], "moment": [9.0, -5.0, 7.0],
         "hub_force": [[20.0, 5.0, -30.0], [0, 0, 0], [-10.0, 30.0, 8.0], [1.0, 2.0, 3.0]]},
        one_sided=True,
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_balances_of_a_collision(case: str) -> None:
    """Gravity rises in 50 ms, the front wheels meet a slope of 0.3 rad at 2 m/s after 60 ms and leave the ground."""
    given = CASES[case]
    ramp, flat = ground_table(Ramp(0.72, 0.3)), ground_table(Flat())
    rover = FullOrderRover(
        nodes=16, points=64, gravity_time=0.05, micro_step=MICRO, ground_left=ramp,
        ground_right=flat if given.one_sided else ramp, **given.parameters,
    )  # fmt: skip
    fmu = fmus.instantiate(rover)
    for name, value in {**rolling(rover, 0.0, 0.5, 2.0), **given.inputs}.items():
        fmu.set(name, np.asarray(value, float))
    fmu.enter_initialization(0)
    fmu.push()
    fmu.exit_initialization()

    def account() -> tuple[float, np.ndarray, np.ndarray]:
        energy = sum(fmu.get(n) for n in ("kinetic_energy", "elastic_energy", "contact_energy", "damped", "slid"))
        return (energy - fmu.get("fallen") - fmu.get("worked"), fmu.get("momentum") - fmu.get("impulse"),
                fmu.get("angular_momentum") - fmu.get("twist"))  # fmt: skip

    before, peak, off = account(), 0.0, 0.0
    for n in range(STEPS):
        fmu.step(n * STEP, (n + 1) * STEP)
        peak = max(peak, float(fmu.get("normal_force_end")[0]))
        off = max(off, abs(account()[0] - before[0]))
    after = account()
    assert peak > PEAK
    assert off < 1e-3 * ENERGY  # at every communication point
    # each micro step rounds numbers as large as 340 N.s and 170 N.m.s
    count = STEPS * STEP / NS / MICRO
    assert np.max(np.abs(after[1] - before[1])) < count * 2.2e-16 * 340
    assert np.max(np.abs(after[2] - before[2])) < count * 2.2e-16 * 340
