"""The components whose Python instance and FMUs are compared: a line here, and all tests of this folder hold for it."""

from __future__ import annotations

import numpy as np
import pytest
from specimens import Ball, Delayed, Flow, Mass, Mathematics, Matrices, Road, Sampled, Specimen

from controllers.pd_impact import PdImpact
from controllers.uncontrolled import Uncontrolled
from plants.chassis_modal import ChassisModal
from plants.ground import Ground, Ramp
from plants.rigid_body import RigidBody
from plants.rigid_contact import RigidContact
from plants.wheel_deformation import WheelDeformation

# The robot of the thesis on its wheels, in round numbers: what the plants and controllers see of each other.
INTERFACE = {
    "gap": [-2e-3, -2e-3, -1e-3, 1e-3],
    "gap_rate": [-0.2, -0.1, 0.1, -0.3],
    "contact_velocity": [[2.0, 0.1]] * 4,
    "P": 0.01 + 0.02 * np.eye(4),
    "U": 0.002 * (1 + np.eye(4)),
    "b_free": [-9.81] * 4,
    "traction_demand": [100.0, -100.0, 300.0, 0.0],
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
MODES = 5

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
    Specimen(Uncontrolled(), step=1e-3, around=INTERFACE, spread=0.02),
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
