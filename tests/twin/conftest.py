"""The components whose Python instance and FMUs are compared: a line here, and all tests of this folder hold for it."""

from __future__ import annotations

import numpy as np
import pytest
from specimens import Ball, Delayed, Flow, Mass, Mathematics, Matrices, Road, Sampled, Specimen

from controllers.actuator import Actuator
from controllers.force_profile import ForceProfile
from controllers.jerk_traction import JerkTraction
from controllers.open_loop_torque import OpenLoopTorque
from controllers.pd_impact import PdImpact
from controllers.pitch_trajectory import PitchTrajectory
from controllers.playback import Playback
from controllers.pole_placement import PolePlacement
from controllers.sensor import Sensor
from controllers.slip_control import SlipControl
from controllers.steered import Steered
from controllers.uncontrolled import Uncontrolled
from plants.chassis_modal import ChassisModal
from plants.full_order import FullOrderRover
from plants.full_order_start import rolling
from plants.ground import Ground, Ramp
from plants.rigid_body import RigidBody
from plants.rigid_contact import RigidContact
from plants.wheel_deformation import WheelDeformation
from plants.wheel_drive import WheelDrive

# The robot of the thesis on its wheels, in round numbers: what the plants and controllers see of each other.
INTERFACE = {
    "gap": [-2e-3, -2e-3, -1e-3, 1e-3],
    "gap_rate": [-0.2, -0.1, 0.1, -0.3],
    "contact_velocity": [[2.0, 0.1]] * 4,
    "P": 0.01 + 0.02 * np.eye(4),
    "U": 0.002 * (1 + np.eye(4)),
    "V": 0.003 * (1 - np.eye(4)),
    "sideslip_mobility": [0.09] * 4,
    "b_free": [-9.81] * 4,
    "traction_demand": [100.0, -100.0, 300.0, 0.0],
    "lateral_demand": [-50.0, 80.0, 200.0, 400.0],
    "normal_force": [450.0, 430.0, 400.0, 390.0],
}
# The front wheels meet the ramp after some 7 ms.
BODY = {
    **INTERFACE,
    "traction": [50.0, 60.0, 0.0, -20.0],
    "lateral": [5.0, -5.0, 3.0, 0.0],
    "r": [0.37, 0.0, 0.5],
    "q": [1.0, 0.01, -0.02, 0.01],
    "v": [2.0, 0.05, -0.1],
}
# On the slope with the front wheels: what the scheme of Fig 4.9 measures there.
CLIMBING = {
    "pitch": 0.03,
    "velocity_body": [1.0, 0.0, 0.05],
    "slope": [0.15, 0.15, 0.0, 0.0],
    "curvature": [0.8, 0.8, 0.0, 0.0],
    "normal_force": [420.0, 410.0, 400.0, 405.0],
    "traction": [0.0, 0.0, 70.0, 70.0],
    "axle_force": [[-50.0, 0.0, 415.0], [-49.0, 0.0, 411.0], [58.0, 0.0, 400.0], [59.0, 0.0, 402.0]],
}
MODES = 5

# Rings that stretch easily: the third derivative of their energy, 3 EA / l^2, is what difference quotients miss.
SHAPES = {"stations": 2, "station_shape": [[0.1], [0.2]], "wheel_shape": [[0.1], [0.05], [-0.1], [0.02]]}
FULL_ORDER = FullOrderRover(nodes=8, points=16, seen=8, EA=600.0, **SHAPES)

COMPONENTS = [
    Specimen(Mass(k=80.0)),
    Specimen(Ball(), step=0.05),
    Specimen(Sampled(gain=[5.0, 1.0])),
    Specimen(Flow(w=31.0)),
    Specimen(Road(pieces=[[-1e9, 0, 0], [-0.5, 0, 0.2], [0.1, 0.12, 0.0], [0.4, 0.12, -1.0]])),
    Specimen(Matrices()),
    Specimen(Mathematics()),
    Specimen(Delayed()),
    Specimen(RigidBody(**Ground.same(Ramp(angle=0.3)).tables(R=0.1)), step=1e-3, around=BODY, spread=0.02),
    Specimen(WheelDeformation(c_w=50.0), step=1e-3, around=INTERFACE, spread=0.02),
    Specimen(WheelDeformation(c_w=50.0, sideslip="demand"), step=1e-3, around=INTERFACE, spread=0.02),
    Specimen(RigidContact(e=0.3), step=1e-3, around=INTERFACE, spread=0.02),
    Specimen(
        ChassisModal(
            modes=MODES,
            stations=3,
            frequency=25.0 * np.arange(1, MODES + 1),
            wheel_shape=np.cos(np.arange(4 * MODES)).reshape(4, MODES),
            station_shape=np.sin(np.arange(3 * MODES)).reshape(3, MODES),
        ),
        step=1e-3,
    ),
    Specimen(PdImpact(), step=1e-3, around=INTERFACE, spread=0.02),
    Specimen(
        PolePlacement(
            feedback="observer",
            P_model=INTERFACE["P"],
            U_model=INTERFACE["U"],
            K_z=-2e4 * np.eye(4),
            K_rate=900.0 * np.eye(4),
            z_per_b=1e-4 * np.eye(4),
            L_z=-2e-6 * np.eye(4),
            L_rate=-1e-4 * np.eye(4),
        ),
        step=1e-3,
        around=INTERFACE,
        spread=0.02,
    ),
    Specimen(
        PitchTrajectory(beta=0.1, T=5e-2, h0=400, h1=40, plan=[[0, 0, 900, 0, 6e-3], [0.5, 450, -900, 3e-3, -6e-3]]),
        step=1e-3,
        around={"pitch": 0.05, "rate": [0.0, -3.0, 0.0]},
    ),
    Specimen(Playback(t_end=1.0, forces=[[0, *4 * [100], *4 * [2e3]], [4e-3, *4 * [90], *4 * [0]]]), step=1e-3),
    Specimen(JerkTraction(slope_source="estimated", k_v=100.0), step=1e-3, around=CLIMBING, spread=0.02),
    Specimen(ForceProfile(profile=[[-1, 50, 20], [0.2, 74, -300]]), step=1e-3, around={"position": [0.1, 0, 0.5]}),
    Specimen(
        Sensor(shape=[2, 2], unit="m", delay=2, noise=0.1, seed=7, quantum=0.01),
        around={"begun": 1.0, "s1": 1e9, "s2": 2e9},
        spread=0.2,
    ),
    Specimen(Actuator(shape=[3], unit="N", lag=0.02, limit=1.0, rate_limit=20.0)),
    Specimen(Uncontrolled(), step=1e-3, around=INTERFACE, spread=0.02),
    Specimen(
        FULL_ORDER, step=1e-4, steps=4, around=rolling(FULL_ORDER, 0.0, 0.497, 2.0) | {"elapsed": 1.0}, spread=1e-4
    ),
    Specimen(WheelDrive(), step=1e-3, around=INTERFACE | {"omega": [20.3, 19.0, 0.0, 24.0]}, spread=0.02),
    Specimen(OpenLoopTorque(demand=30.0), step=1e-3),
    Specimen(SlipControl(demand=80.0), step=1e-3, around=INTERFACE, spread=0.02),
    Specimen(Steered(curvature=0.3, frequency=1.0, ramp=0.01), step=1e-3),
]


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Run a test that takes ``specimen`` for every component, one that takes ``fmi`` for both versions."""
    if "specimen" in metafunc.fixturenames:
        names = [type(s.component).__name__ for s in COMPONENTS]
        metafunc.parametrize("specimen", COMPONENTS, ids=names)
    if "fmi" in metafunc.fixturenames:
        metafunc.parametrize("fmi", [2, 3], ids=["fmi2", "fmi3"])


@pytest.fixture
def rng() -> np.random.Generator:
    """Return a generator that gives every test the same numbers."""
    return np.random.default_rng(20240229)
