"""The full-order robot computes what its description says: the same equations, written again in NumPy, agree."""

from __future__ import annotations

import numpy as np

import fmus
from benchmarks.full_order_numpy import numpy_rover, wheels_apart
from cosim.clock import NS
from plants.full_order import FullOrderRover
from plants.full_order_ground import ground_table
from plants.full_order_start import rolling
from plants.ground import Step

STEP, MICRO, COUNT, SPEED = NS // 1000, 1e-4, 60, 2.0
TORQUE = np.array([1.0, 2.0, 0.0, -1.0])
STEER = np.array([0.2, 0.1, -0.1, 0.3])  # rad, growing to that


def test_numpy_and_the_fmu_agree_over_a_step() -> None:
    """Rings roll, stick and slide against a step of 30 mm, a mode shakes the hubs, gravity rises, motors pull.

    All wheels are steered, each by its own angle, the last one faster than it can.
    """
    ground = ground_table(Step(0.72, 0.03))
    rover = FullOrderRover(
        nodes=8, points=16, seen=8, EA=600.0, wheel_shape=[[0.05], [-0.03], [0.04], [0.02]], damping=[0.02],
        micro_step=MICRO, steer_speed=4.0, gravity_time=0.05, ground_left=ground, ground_right=ground,
    )  # fmt: skip
    starts = rolling(rover, 0.0, 0.5, SPEED)
    fmu, model = fmus.instantiate(rover), numpy_rover(rover, starts)
    for name, value in {**starts, "torque": TORQUE}.items():
        fmu.set(name, value)
    fmu.enter_initialization(0)
    fmu.push()
    fmu.exit_initialization()
    peak = 0.0
    for n in range(COUNT):
        steer = STEER * (n + 1) / COUNT
        fmu.set("steer", steer)
        fmu.step(n * STEP, (n + 1) * STEP)
        model.begin(steer, 1e-3)
        for i in range(10):
            model.step((n + i / 10) * 1e-3, MICRO, TORQUE)
        peak = max(peak, float(np.max(fmu.get("normal_force_end"))))
    assert peak > 1000  # the step was met
    places, speeds, bristles = (model.state[name] for name in ("x", "v_ring", "z"))
    normal, friction, *_ = model.on_nodes(places, speeds, bristles, 0.0)  # the present
    seen = {name: np.hstack(list(v)) for name, v in (
        ("ring_nodes", places), ("ring_normal", normal), ("ring_friction", friction))}  # fmt: skip
    for name, value in (wheels_apart(model.state) | seen).items():
        theirs = fmu.get(name)
        # 600 micro steps, each with a rounding of some 10 operations on numbers as large as these; a stiff contact and
        # friction amplify it: by some hundred, as neighbouring starts do (Lyapunov exponents of some 100 1/s)
        size = max(float(np.max(np.abs(theirs))), 1e-3)
        assert np.max(np.abs(theirs - value)) < 100 * 6000 * 2.2e-16 * size, name
