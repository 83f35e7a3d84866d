"""Steering angles against rigid-body kinematics, and the law that holds the speed."""

from typing import Any

import numpy as np
import pytest

from controllers.steered import Steered
from cosim.twin import PythonInstance
from plants.ground import Flat, Ground
from plants.tables import ROBOTS
from studies.designs import DESIGNS, Context

X = np.array([0.6, 0.6, -0.46, -0.46])
Y = 0.29 * np.array([1, -1, 1, -1])
MS = 1_000_000


def at(time: float, speed: float = 1.0, **parameters: Any) -> PythonInstance:
    """Return the controller after the tick at *time*."""
    made = Steered(**parameters).instance("steered")
    made.enter_initialization(round(time * 1e9), None, 1e-8)
    made.set("velocity_body", np.array([speed, 0.0, 0.0]))
    made.exit_initialization()
    made.step(round(time * 1e9), round(time * 1e9) + MS)
    return made


@pytest.mark.parametrize("curvature", [0.5, -0.5, 0.05])
@pytest.mark.parametrize("centre", [0.0, -0.46, 0.2])
def test_all_wheels_roll_about_one_centre(curvature: float, centre: float) -> None:
    """Turning about (x_c, 1 / kappa), a wheel at (x, y) moves along (1 / kappa - y, x - x_c): nothing is across it."""
    delta = at(1.0, curvature=curvature, centre=centre, ramp=0.5).get("steer")
    along, aside = 1 / curvature - Y, X - centre
    across = aside * np.cos(delta) - along * np.sin(delta)
    np.testing.assert_allclose(across, 0, atol=1e-12)
    assert np.all(np.abs(delta) < np.pi / 2)
    turning_left = delta[:2] > 0
    assert np.all(turning_left == (curvature > 0))


def test_without_curvature_the_wheels_keep_their_toe_and_it_grows_with_the_ramp() -> None:
    toe = [0.02, -0.02, 0.01, -0.03]
    np.testing.assert_allclose(at(1.0, toe=toe, ramp=2.0).get("steer"), np.array(toe) / 2, atol=1e-15)
    np.testing.assert_allclose(at(5.0, toe=toe, ramp=2.0).get("steer"), toe, atol=1e-15)


def test_the_curvature_swings() -> None:
    """At f = 0.5 Hz it has changed its sign after one second; then left and right change places."""
    now, later = (at(t, curvature=0.4, frequency=0.5, ramp=0.5).get("steer") for t in (2.0, 3.0))
    np.testing.assert_allclose(later, -now[[1, 0, 3, 2]], atol=1e-12)


@pytest.mark.parametrize(("speed", "each"), [(0.8, 25.0), (1.2, -25.0), (1.0, 0.0), (-9.0, 200.0)])
def test_traction_brings_the_speed_back_within_its_limit(speed: float, each: float) -> None:
    made = at(1.0, speed=speed)
    np.testing.assert_allclose(made.get("traction_demand"), each, atol=1e-12)
    np.testing.assert_allclose(made.get("torque"), 0.1 * each, atol=1e-12)


def test_its_design_takes_the_robots_dimensions() -> None:
    robot = ROBOTS["dymac_paper"]
    made = DESIGNS["Steered"]({"curvature": 0.1}, Context(robot, Ground.same(Flat()), 0.0, 1.0, 1.0, {}))
    assert [float(made.values[n]) for n in ("L_f", "L_r", "half_track", "R")] == [0.8, 1.0, robot.half_track, robot.R]
