"""The robots of the product against the same robot in MuJoCo: gross motion, contact times, forces of an impact."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

pytest.importorskip("mujoco")

import mujoco_rovers as mj
from rigid_checks import drive

import fmus
from cosim.clock import NS
from plants.full_order import FullOrderRover
from plants.full_order_ground import ground_table
from plants.full_order_start import rolling, settled
from plants.ground import Flat, Ground, Ramp, Step
from plants.profile import Profile
from plants.rigid_contact import RigidContact
from plants.ring_press import STIFFNESSES, mean_load

SPEED, ANGLE, TICK, NODES, POINTS = 2.0, 0.3, NS // 10_000, 32, 128
ROBOT = mj.ROBOT
RISE = np.sqrt(ROBOT.R**2 - (ROBOT.R - 0.03) ** 2)  # m, ahead of a step of 30 mm where a wheel meets its edge
CASES: dict[str, tuple[Profile, str, float]] = {  # ground here and there, speed of approach
    "ramp": (Ramp(0.63, ANGLE), mj.ramp(0.63, ANGLE), SPEED * np.sin(ANGLE)),
    "step": (Step(0.72, 0.03), mj.step(0.72, 0.03), SPEED * RISE / ROBOT.R),
}


@pytest.mark.parametrize("case", CASES)
def test_rigid_wheels_move_as_in_mujoco_up_to_the_time_its_contacts_take(case: str) -> None:
    """Rigid, frictionless wheels, plastic impacts, 0.3 s: impact at the front, the rear axle flies and lands."""
    profile, ground, approach = CASES[case]
    h, duration = 5e-5, 0.3
    record = drive(Ground.same(profile), RigidContact(e=0.0), SPEED, duration, h)
    here = np.column_stack([record["body.position"][:, [0, 2]], ROBOT.L_f * record["body.pitch"]])
    off = []
    for T in (2e-4, 1e-4):
        model = mj.rigid(ground, T)
        model.data.qvel[0] = SPEED
        there = model.run(duration)
        columns = (there[:, 1], there[:, 2], ROBOT.L_f * there[:, 3])
        off.append(max(float(np.max(np.abs(np.interp(record.time, there[:, 0], c) - here[:, i])))
                       for i, c in enumerate(columns)))  # fmt: skip
    # a contact sinks in by v T/2 there and by v h/2 here; at an edge the normal turns meanwhile, some 2 T long, and
    # what is left of the approach goes astray for the rest of the run
    sunk = approach * (T + h) / 2
    astray = approach * SPEED * 2 * T / ROBOT.R * duration if case == "step" else 0.0
    assert off[1] < sunk + astray
    assert off[1] < 0.65 * off[0]  # and it is the softness of MuJoCo's contacts: of first order in T


def rover(profile: Profile, scale: float) -> FullOrderRover:
    """Return the full-order robot on undamped rings *scale* times as stiff as the default."""
    ground, default = ground_table(profile), FullOrderRover().values
    stiff: dict[str, Any] = {name: scale * float(default[name]) for name in STIFFNESSES}
    return FullOrderRover(nodes=NODES, points=POINTS, micro_step=2.5e-5, mu_d=0.8, c_radial=0.0, c_tangential=0.0,
                          ground_left=ground, ground_right=ground, **stiff)  # fmt: skip


def motion(component: FullOrderRover, starts: dict[str, Any], duration: float, torque: float = 0.0) -> np.ndarray:
    """Return rows of time, x, z, pitch and normal force of the front axle."""
    fmu, rows = fmus.instantiate(component), []
    for name, value in {**starts, "torque": np.full(4, torque)}.items():
        fmu.set(name, value)
    fmu.enter_initialization(0)
    fmu.push()
    fmu.exit_initialization()
    for n in range(round(duration * NS) // TICK):
        fmu.step(n * TICK, (n + 1) * TICK)
        x, _, z = fmu.get("position")
        rows.append([(n + 1) * TICK / NS, x, z, fmu.get("pitch"), float(np.sum(fmu.get("normal_force")[:2]))])
    return np.array(rows)


def test_a_dropped_robot_meets_the_ground_when_it_does_in_mujoco() -> None:
    """From 20 mm, after sqrt(2 h / g) = 63.9 ms."""
    component = rover(Flat(), 10.0)
    here = motion(component, rolling(component, 0.0, ROBOT.h + ROBOT.R + 0.02, 0.0), 0.07)
    model = mj.rolling(mj.PLANE, 2e-4, sprung=False)
    model.data.qpos[2] += 0.02
    there = model.run(0.07)
    met = [float(rows[np.argmax(rows[:, 4] > 0), 0]) for rows in (here, there)]
    # the lowest of the points lies less than R (pi / 128)^2 / 2 above the round rim; outputs come every 0.1 ms there
    late = ROBOT.R * (np.pi / POINTS) ** 2 / 2 / 0.626
    assert met[0] == pytest.approx(np.sqrt(2 * 0.02 / 9.81), abs=late + TICK / NS)
    assert met[1] == pytest.approx(met[0], abs=late + TICK / NS + 5e-5)


def test_driven_wheels_accelerate_as_in_mujoco() -> None:
    """5 N.m on every rim from 2 m/s, 0.3 s, without slip: 50 mm further than without."""
    component = rover(Flat(), 10.0)
    starts = settled(component, 0.0, 0.0, SPEED)
    here = motion(component, starts, 0.3, torque=5.0)
    model = mj.rolling(mj.PLANE, 2e-4, sprung=False)
    model.data.qvel[0], model.data.qvel[6:] = SPEED, SPEED / ROBOT.R
    model.data.qfrc_applied[6:] = 5.0
    there = model.run(0.3)
    gained = [rows[-1, 1] - SPEED * rows[-1, 0] for rows in (here, there)]
    depth = ROBOT.h + ROBOT.R - float(starts["r"][2])
    # a pressed wheel rolls on a radius between R - depth and R: by that share the force of a torque differs, and the
    # spin of a wheel that rolls, which a run starts without
    wheels = 4 * (mj.J_RIM / ROBOT.R**2 + mj.RING) / (ROBOT.m + 4 * (mj.J_RIM / ROBOT.R**2 + 2 * mj.RING))
    assert gained[0] == pytest.approx(gained[1], abs=depth / ROBOT.R * (gained[1] + wheels * SPEED * 0.3))


def test_a_ramp_is_met_as_by_wheels_on_springs_in_mujoco() -> None:
    """Elastic wheels: MuJoCo's are rigid discs whose hubs rest on the force-depth law of the ring's press test.

    What that leaves out is the ring's own motion: its mass is 1.7 % of the 48 kg that a front wheel meets the ramp
    with.
    """
    component = rover(Ramp(0.63, ANGLE), 10.0)
    starts, duration = settled(component, 0.0, 0.0, SPEED), 0.1
    here = motion(component, starts, duration)
    depths = np.linspace(0, 0.012, 13)
    loads = np.array([0.0, *(mean_load(component.values, NODES, POINTS, float(d)) for d in depths[1:])])
    model = mj.rolling(mj.ramp(0.63, ANGLE), 2e-4, sprung=True)
    at, rate = 7 + 3 * np.arange(4), 6 + 3 * np.arange(4)
    static = ROBOT.m * 9.81 / 2 * np.array([ROBOT.L_r, ROBOT.L_f]) / ROBOT.L
    model.data.qpos[:3], model.data.qpos[3:7] = starts["r"], starts["q"]
    model.data.qpos[at + 1] = np.repeat(np.interp(static, loads, depths), 2)
    model.data.qvel[0], model.data.qvel[rate + 2] = SPEED, SPEED / ROBOT.R

    def law(data: Any) -> None:
        away = np.hypot(data.qpos[at], data.qpos[at + 1])
        pull = np.interp(away, depths, loads) / np.maximum(away, 1e-12)
        for i in range(2):  # the little damping lets discs come to rest on the ground
            data.qfrc_applied[rate + i] = -pull * data.qpos[at + i] - 20.0 * data.qvel[rate + i]

    there = model.run(duration, law)
    share = mj.RING * 0.01029 * 2
    moved = np.array([SPEED * duration, here[-1, 2] - here[0, 2], np.ptp(here[:, 3])])
    impulse = [float(np.sum(rows[:, 4]) * (rows[1, 0] - rows[0, 0])) for rows in (here, there)]
    assert impulse[0] == pytest.approx(impulse[1], rel=share)
    np.testing.assert_array_less(np.abs(here[-1, 1:4] - there[-1, 1:4]), share * moved)
