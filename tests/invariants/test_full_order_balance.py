"""The full-order robot keeps momentum to rounding and energy to 1e-3, stays where it stands, and tells what it is."""

from __future__ import annotations

import numpy as np
import pytest

import fmus
from controllers.slip_control import SlipControl
from cosim import Instance
from cosim.clock import NS
from plants.full_order import FullOrderRover
from plants.full_order_ground import ground_table
from plants.full_order_ports import SENSED
from plants.full_order_start import rolling, settled
from plants.ground import Ground, Ramp
from plants.rigid_body import RigidBody

STEP = NS // 10_000


NODES = {"nodes": 16, "points": 64, "micro_step": 5e-5}


def started(rover: FullOrderRover, values: dict[str, np.ndarray]) -> Instance:
    fmu = fmus.instantiate(rover)
    for name, value in values.items():
        fmu.set(name, value)
    fmu.enter_initialization(0)
    fmu.push()
    fmu.exit_initialization()
    return fmu


def account(fmu: Instance) -> tuple[float, np.ndarray, np.ndarray]:
    """Return energy, momentum and angular momentum less what came from outside."""
    energy = sum(fmu.get(n) for n in ("kinetic_energy", "elastic_energy", "contact_energy", "damped", "slid"))
    return (energy - fmu.get("fallen") - fmu.get("worked"), fmu.get("momentum") - fmu.get("impulse"),
            fmu.get("angular_momentum") - fmu.get("twist"))  # fmt: skip


def test_balances_of_a_collision() -> None:
    """Gravity rises in 50 ms, the front wheels meet a slope of 0.3 rad at 2 m/s after 60 ms and leave the ground."""
    ground = ground_table(Ramp(0.72, 0.3))
    rover = FullOrderRover(**NODES, gravity_time=0.05, ground_left=ground, ground_right=ground)
    fmu = started(rover, rolling(rover, 0.0, 0.5, 2.0))
    before, peak = account(fmu), 0.0
    for n in range(1000):
        fmu.step(n * STEP, (n + 1) * STEP)
        peak = max(peak, float(fmu.get("normal_force_end")[0]))
    after = account(fmu)
    assert peak > 1500  # the collision took place: four times the static load
    # what the normal speed of 0.59 m/s holds is some 15 J: 1e-3 of that
    assert after[0] == pytest.approx(before[0], abs=0.015)
    # 2000 micro steps, each with a rounding of 2.2e-16 of 340 N.s and of 170 N.m.s
    assert np.max(np.abs(after[1] - before[1])) < 2000 * 2.2e-16 * 340
    assert np.max(np.abs(after[2] - before[2])) < 2000 * 2.2e-16 * 340


def test_balances_of_everything_that_can_be_laid_on() -> None:
    """Torques, traction half by torque and half laid on, forces on hubs and body: accounted to the same digits."""
    rover = FullOrderRover(**NODES, laid_on=0.5)
    fmu = started(rover, settled(rover, 0.0, 0.0, 1.0))
    fmu.set("torque", np.array([2.0, -1.0, 3.0, 1.0]))
    fmu.set("traction_demand", np.array([60.0, 40.0, -50.0, 80.0]))
    fmu.set("hub_force", np.array([[10.0, 5.0, 200.0], [0.0, -8.0, -50.0], [0.0] * 3, [-20.0, 0.0, 30.0]]))
    fmu.set("force", np.array([5.0, -4.0, 20.0]))
    fmu.set("moment", np.array([1.0, 4.0, -2.0]))
    before = account(fmu)
    for n in range(300):
        fmu.step(n * STEP, (n + 1) * STEP)
    after = account(fmu)
    assert abs(fmu.get("worked")) > 1.0  # J: there was something to account for
    assert after[0] == pytest.approx(before[0], abs=1e-3 * abs(float(fmu.get("worked"))))
    assert np.max(np.abs(after[1] - before[1])) < 600 * 2.2e-16 * 340
    assert np.max(np.abs(after[2] - before[2])) < 600 * 2.2e-16 * 340


def test_balances_of_a_steered_robot_with_slip_control() -> None:
    """Slip control asks a slippery floor for too much while four wheels swing by angles of their own and a mode shakes.

    Motors of drive and steering work; the wheels are turned to 0.3 rad and back at up to 9 rad/s.
    """
    rover = FullOrderRover(**NODES, mu_s=0.3, mu_d=0.2, wheel_shape=[[0.05], [-0.03], [0.04], [0.02]])
    fmu = started(rover, settled(rover, 0.0, 0.0, 2.0))
    law = SlipControl(demand=150.0, mu_peak=0.3).instance()
    law.enter_initialization(0)
    before, most = account(fmu), np.zeros(2)
    for n in range(1500):
        for name in ("slip", "slip_speed", "traction"):
            law.set(name, fmu.get(name))
        law.set("normal_force", fmu.get("normal_force_end"))
        law.step(n * STEP, (n + 1) * STEP)
        fmu.set("torque", law.get("torque"))
        fmu.set("steer", np.array([0.3, 0.25, -0.2, 0.1]) * np.sin(30 * n * 1e-4))
        fmu.step(n * STEP, (n + 1) * STEP)
        most = np.maximum(most, [np.max(fmu.get("slip")), np.max(np.abs(fmu.get("lateral")))])
    after = account(fmu)
    assert most[0] > 0.05
    assert most[1] > 50  # N: it slipped forwards and aside
    assert fmu.get("worked") > 50
    assert after[0] == pytest.approx(before[0], abs=1e-3 * abs(float(fmu.get("worked"))))
    assert np.max(np.abs(after[1] - before[1])) < 3000 * 2.2e-16 * 340
    assert np.max(np.abs(after[2] - before[2])) < 3000 * 2.2e-16 * 340


def test_a_settled_robot_stays_at_rest() -> None:
    """On its pressed rings, front and rear under their own loads.

    The shape at the start knows nothing of the weight of the ring itself, so forces swing by less than that about the
    loads, and the robot moves by less than that weight moves its quarter of the mass in a tenth of a period.
    """
    rover = FullOrderRover(**NODES)
    fmu = started(rover, settled(rover, 0.0, 0.0, 0.0))
    weight = rover.ring_mass * 9.81
    loads = rover.m * 9.81 / 2 * np.array([0.46, 0.46, 0.6, 0.6]) / 1.06 + weight
    forces, speeds = [], []
    for n in range(200):
        fmu.step(n * STEP, (n + 1) * STEP)
        forces.append(fmu.get("normal_force_end"))
        speeds.append(fmu.get("velocity"))
    assert np.max(np.abs(forces - loads)) < weight
    np.testing.assert_allclose(np.mean(forces, axis=0), loads, rtol=5e-3)
    assert np.max(np.abs(speeds)) < weight / (rover.m / 4) * 0.1 * 2 * np.pi / 45


def test_ports_are_those_of_the_rigid_body_in_the_same_pose() -> None:
    """What an analytical controller reads, rounding apart: on two different slopes, rolled, pitched and turning."""
    sides = Ground(Ramp(0.5, 0.3), Ramp(0.4, 0.1))
    pose = {"r": np.array([0.3, 0.02, 0.52]), "q": np.array([0.998, 0.01, -0.05, 0.02]), "v": np.array([1.5, 0.1, 0.2])}
    pose["q"] = pose["q"] / np.linalg.norm(pose["q"])
    omega = np.array([0.2, -0.4, 0.1])
    body, rover = RigidBody(**sides.tables(0.1)), FullOrderRover(**NODES, **sides.tables(0.1))
    rigid, full = body.instance(), rover.instance()
    for instance in (rigid, full):
        for name, value in pose.items():
            instance.set(name, value)
        instance.enter_initialization(0)
    rigid.set("omega", omega)
    w, v = pose["q"][0], pose["q"][1:]
    turned = 20 * np.eye(3)[0] * omega[0] + 47 * np.eye(3)[1] * omega[1] + 55 * np.eye(3)[2] * omega[2]
    full.set("H", turned + 2 * np.cross(v, np.cross(v, turned) + w * turned))
    for name in SENSED:
        np.testing.assert_allclose(
            full.get(name), rigid.get(name), atol=1e-12 * max(1, np.max(np.abs(rigid.get(name))))
        )
