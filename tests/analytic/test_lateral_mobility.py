"""How lateral forces move the wheels: V and the sideslip mobility of the body against its own accelerations."""

import numpy as np

from cosim.twin import PythonInstance
from plants.ground import Ground, Ramp
from plants.rigid_body import RigidBody
from plants.tables import robot

ROBOT = robot("thesis_6_1")
ARMS = np.array([[x, y, -ROBOT.h] for x in (ROBOT.L_f, -ROBOT.L_r) for y in (ROBOT.half_track, -ROBOT.half_track)])
STEER = np.array([0.1, 0.2, -0.1, 0.0])
TOLERANCE = 1e-10  # accelerations of 10 m/s2 right to 1e-15, differences of 1e-3 m/s2 per N


def climbing() -> PythonInstance:
    """The front wheels on a slope, rolled and pitched and steered, at rest."""
    body = RigidBody(**ROBOT.body_parameters(), **Ground.same(Ramp(start=0.3, angle=0.3)).tables(ROBOT.R))
    instance = body.instance("body")
    instance.enter_initialization(0)
    instance.set("r", [0.0, 0.0, 0.6])
    instance.set("q", np.array([1.0, 0.03, -0.08, 0.02]) / np.linalg.norm([1.0, 0.03, -0.08, 0.02]))
    instance.set("steer", STEER)
    return instance


def test_V_is_the_change_of_the_gap_acceleration_per_lateral_force() -> None:
    body = climbing()
    idle, V = body.get("b_free"), body.get("V")
    assert np.ptp(body.get("slope")) > 0.2
    for j, unit in enumerate(np.eye(4)):
        body.set("lateral", 100.0 * unit)
        np.testing.assert_allclose((body.get("b_free") - idle) / 100, V[:, j], rtol=0, atol=TOLERANCE)


def test_the_sideslip_mobility_is_the_greatest_acceleration_to_the_side() -> None:
    body = climbing()
    normal, along = body.get("contact_normal"), body.get("traction_direction")
    left = np.cross(normal, along)

    def aside() -> np.ndarray:
        w, x, y, z = body.get("q")
        turn = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                         [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                         [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])  # fmt: skip
        contacts = ARMS - body.component.R * normal @ turn  # where the lateral forces act, body axes
        accelerations = body.get("der(v)") + np.cross(body.get("der(omega)"), contacts) @ turn.T
        return np.sum(left * accelerations, axis=1)

    idle, total = aside(), np.zeros(4)
    for unit in np.eye(4):
        body.set("lateral", 100.0 * unit)
        total += np.abs(aside() - idle) / 100
    np.testing.assert_allclose(body.get("sideslip_mobility"), total, rtol=0, atol=TOLERANCE)
