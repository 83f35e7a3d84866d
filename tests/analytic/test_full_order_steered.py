"""The full-order robot on a circle: what steering angles and centripetal force say of any robot whose wheels grip."""

from __future__ import annotations

import numpy as np
import pytest

from cosim.scenario import Scenario
from studies.runner import execute

CURVATURE, SPEED, RINGS = 0.4, 1.0, 4 * 0.83  # 1/m, m/s, kg


def test_it_turns_as_its_wheels_are_steered() -> None:
    """Yaw rate v kappa within the slip angles of 0.02 rad, and all lateral force on the mass with its rings.

    Front and rear wheels slip aside by angles that differ by 0.005 rad over a wheelbase of 1.06 m, which is 1 % of the
    curvature; the rings swing by 1 N about 69 N.
    """
    table = {
        "name": "circle", "title": "a circle", "claim": "", "assembly": "rover", "robot": {"table": "thesis_6_1"},
        "ground": {"kind": "flat"}, "start": {"speed": SPEED}, "run": {"step": 1e-4, "duration": 1.0},
        "components": {
            "controller": {"type": "Steered", "curvature": CURVATURE, "ramp": 0.3, "speed": SPEED},
            "wheels": {"type": "WheelDeformation", "k_w": 1e5, "c_w": 200.0},
            "body": {"type": "FullOrderRover"},
        },
    }  # fmt: skip
    result = execute(Scenario.model_validate(table))
    assert result.error is None
    record, held = result.record, result.record.time > 0.7
    speed = np.linalg.norm(record["body.velocity_body"][held, :2], axis=1)
    turn, angle = record["body.rate"][held, 2], record["body.steer_angle"][held]
    assert np.mean(turn / speed) == pytest.approx(CURVATURE, rel=0.01)
    along, across = record["body.traction"][held], record["body.lateral"][held]
    centripetal = np.sum(across * np.cos(angle) + along * np.sin(angle), axis=1)
    assert np.mean(centripetal / (speed * turn)) == pytest.approx(170 + RINGS, rel=0.015)
    np.testing.assert_allclose(angle[-1], record["body.steer"][-1], atol=1e-12)
