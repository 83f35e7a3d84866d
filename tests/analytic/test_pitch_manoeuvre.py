"""The ground of a pitch manoeuvre: a wheel that rolls over it goes where the plan wants it, and no tighter."""

import numpy as np
import pytest

from controllers.pitch_plan import PitchPlan, planned_pitch, sine_slope
from cosim.errors import ScenarioError
from plants.manoeuvre import PitchManoeuvre
from plants.patches import HEIGHT_ERROR, SLOPE_ERROR
from plants.tables import robot
from plants.wheel_path import rolling_path

GROUND = PitchManoeuvre(start=0.65, pitch=0.1, length=0.345)
T = np.linspace(0, 1, 1001)


def test_a_wheel_that_rolls_over_it_follows_the_plan() -> None:
    """The path is the envelope of a disc on the ground, tabulated to the stated errors of its patches."""
    path, at = rolling_path(GROUND, GROUND.R), GROUND.centre(T)
    assert not path.kinks
    np.testing.assert_allclose(path.height(at.x), at.z, rtol=0, atol=1.5 * HEIGHT_ERROR)
    np.testing.assert_allclose(path.slope(at.x), np.tan(at.slope), rtol=0, atol=SLOPE_ERROR)
    assert path.departure == pytest.approx(GROUND.start, abs=1e-12)
    # second derivatives of quintics: their error in slope over the shortest patch, a 30th of the step
    bend = SLOPE_ERROR / (0.345 / 30)
    np.testing.assert_allclose(path.curvature(at.x), at.slope_rate / at.speed, rtol=0, atol=bend)


def test_the_body_moves_evenly_and_pitches_as_planned() -> None:
    """Rear wheel centre at height R, front one on the path: the wheelbase between them, the body above."""
    robot_L, at, p = GROUND.L_f + GROUND.L_r, GROUND.centre(T), planned_pitch(T, 0.1).p
    np.testing.assert_allclose(at.z - GROUND.R, robot_L * np.sin(p), atol=1e-15)
    body = at.x - GROUND.L_f * np.cos(p) - GROUND.h * np.sin(p)
    np.testing.assert_allclose(body, GROUND.start - GROUND.L_f + 0.345 * T, atol=1e-15)
    # slope, its rate and speed of the path are derivatives of it: central differences over 2e-4 err by some 1e-7
    before, after = GROUND.centre(T[1:-1] - 1e-4), GROUND.centre(T[1:-1] + 1e-4)
    dx, dz = (after.x - before.x) / 2e-4, (after.z - before.z) / 2e-4
    np.testing.assert_allclose(np.arctan2(dz, dx), at.slope[1:-1], atol=1e-5)
    np.testing.assert_allclose(np.hypot(dx, dz), at.speed[1:-1], atol=1e-5)
    np.testing.assert_allclose((after.slope - before.slope) / 2e-4, at.slope_rate[1:-1], atol=1e-3)


def test_height_slope_and_second_derivative_belong_together() -> None:
    x = np.linspace(GROUND.start + 1e-3, GROUND.end - 1e-3, 801)
    d = 1e-5
    _, slope, second = GROUND.jet(x)
    np.testing.assert_allclose((GROUND.elevation(x + d) - GROUND.elevation(x - d)) / (2 * d), slope, atol=1e-7)
    np.testing.assert_allclose((GROUND.slope(x + d) - GROUND.slope(x - d)) / (2 * d), second, atol=1e-5)
    np.testing.assert_allclose(GROUND.elevation([0, GROUND.end, 9]), [0, GROUND.height, GROUND.height], atol=1e-15)
    assert GROUND.corners == GROUND.knots == ()


def test_the_end_of_the_printed_manoeuvre_is_a_crest_that_no_wheel_of_the_robot_follows() -> None:
    """Slope 0.5 sin(pi t), beta = 0.0433: from 76 % of the time, 94 % of the pitch on, it bends by more than 1/R."""
    plan = PitchPlan(robot("thesis_5_1"), 0.0433, sine_slope(0.5))
    t = np.linspace(1e-3, 1 - 1e-3, 9981)
    curvature = sine_slope(0.5)(t)[1] / plan.speed(t)
    tight = curvature < -1 / 0.1
    first = int(np.argmax(tight))
    assert np.all(tight[first:])
    assert t[first] == pytest.approx(0.762, abs=1e-3)
    assert planned_pitch(t[first], 1.0).p == pytest.approx(0.94, abs=1e-3)
    assert curvature[-1] == pytest.approx(curvature[-2] * (1 - t[-2]) / (1 - t[-1]), rel=0.1)  # as 1/(1 - t): unbounded


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        (
            {"length": 0.15, "pitch": 0.0433},
            "bend by 10.7 1/m on the crest, but a wheel of radius R = 0.1 m follows no",
        ),
        ({"length": 0.1, "h": 0.05, "pitch": 0.5}, "the front wheels would have to go back"),
        ({"pitch": 0.7}, "must be below 0.6 rad"),
        ({"length": -1.0}, "PitchManoeuvre.length is -1, but must be positive"),
    ],
)
def test_what_cannot_be_rolled_over_is_refused(values: dict[str, float], sentence: str) -> None:
    with pytest.raises(ScenarioError, match=sentence):
        PitchManoeuvre(**values)
