"""The ground under a wheel: signed distance to a curved path, and the change of face at a kink."""

import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from tracks import R, curve, kink, placed

from plants.rigid_body import RigidBody


@pytest.mark.parametrize("gap", [-0.02, -0.003, 0.0, 0.005, 0.05, 0.3])
@pytest.mark.parametrize("x", [-0.55, 0.0, 0.37])
def test_the_gap_is_the_distance_to_the_closest_point(gap: float, x: float) -> None:
    """A path with curvatures from -0.6 to 1.1 1/m: a wheel set *gap* off it, along the normal, is *gap* away from it.

    The search starts up to 0.15 m beside the foot (gap 0.3 m) and ends at rounding, or in that case within 1e-8 m; the
    gap is wrong by the square of that only.
    """
    path = np.polynomial.Polynomial([0.1, 0.1, 0.3, -0.5, 0.1, 0.2])
    slope, bend = path.deriv()(x), path.deriv(2)(x)
    length = np.hypot(1, slope)
    centre = np.array([x, path(x)]) + gap * np.array([-slope, 1]) / length
    body = placed(RigidBody(left=curve(*path.coef), right=curve(*path.coef)), r=[centre[0] - 0.6, 0, centre[1] + 0.4])
    tolerance = 1e-8 if gap > 0.1 else 1e-14
    assert body.get("gap")[0] == pytest.approx(gap, abs=1e-14)
    assert body.get("slope")[0] == pytest.approx(np.arctan(slope), abs=tolerance)
    assert body.get("curvature")[0] == pytest.approx(bend / length**3, abs=tolerance)


@pytest.mark.parametrize("height", [0.02, 0.1, 0.3, 1.0, 30.0])
def test_a_wheel_far_above_a_hump_has_a_sound_gap(height: float) -> None:
    """Above a sharp crest (radius 0.1 m) the search stays beside the wheel: finite, positive, and near the distance."""
    crest = np.polynomial.Polynomial([0.2, 0.0, -5.0])
    for x in np.linspace(-0.3, 0.3, 13):
        body = placed(RigidBody(left=curve(*crest.coef), right=curve(*crest.coef)), r=[x - 0.6, 0, 0.2 + height + 0.4])
        found = minimize_scalar(lambda u, x=x: (u - x) ** 2 + (crest(u) - 0.2 - height) ** 2, (x - 0.1, x)).fun ** 0.5
        gap = body.get("gap")[0]
        assert np.all(np.isfinite([body.get("b_free"), body.get("gap_rate"), body.get("gap")]))
        assert gap == pytest.approx(found, rel=0.1)


def test_the_smaller_distance_decides_which_face_touches() -> None:
    """On the bisector of the two faces the indicator vanishes; it changes its sign across it and nowhere else."""
    angle, x_kink = 0.4, 1.0
    component = RigidBody(left=kink(x_kink, 0.0, angle), right=kink(x_kink, 0.0, angle))
    for depth in (-0.01, -1e-3, 2e-3, 0.05):
        on_bisector = x_kink - depth * np.tan(angle / 2)
        for offset in (-0.2, -1e-9, 1e-9, 0.2):
            body = placed(component, r=[on_bisector + offset - 0.6, 0, R + depth + 0.4])
            assert body.get("slope")[0] == pytest.approx(angle if offset > 0 else 0.0, abs=1e-15)
            beyond = depth * np.cos(angle) - (on_bisector + offset - x_kink) * np.sin(angle)
            assert body.get("gap")[0] == pytest.approx(min(depth, beyond), abs=1e-15)


@pytest.mark.parametrize("sag", [1e-3, 0.0, -2e-3])
def test_a_step_returns_early_where_the_faces_are_equally_near(sag: float) -> None:
    """Rolling at 2 m/s with wheels pressed in by *sag*: the bisector is reached tan(angle/2) sag behind the kink."""
    angle, x_kink, speed = 0.4, 1.0, 2.0
    component = RigidBody(left=kink(x_kink, 0.0, angle), right=kink(x_kink, 0.0, angle), g=0.0)
    body = placed(component, r=[x_kink - 0.6 - 0.01, 0, R - sag + 0.4], v=[speed, 0, 0])
    time = (0.01 + sag * np.tan(angle / 2)) / speed
    advance = body.step(0, 10_000_000, early_return=True)
    assert advance.early
    # the indicator's zero is located to a float of time; the tick is the first at or after it, off by rounding of x
    assert advance.reached == pytest.approx(np.ceil(time * 1e9), abs=1)
    np.testing.assert_allclose(body.get("slope"), [angle, angle, 0, 0], atol=1e-15)
    np.testing.assert_allclose(body.get("gap")[:2], -sag, atol=1e-12)  # no step in the gap


def test_no_event_without_a_kink() -> None:
    body = placed(RigidBody(left=curve(0.1, 0, 0.3), right=curve(0.1, 0.05)), v=[2.0, 0.3, 0.5], omega=[0.5, 0.2, 1.0])
    advance = body.step(0, 200_000_000, early_return=True)
    assert not advance.early
    assert advance.reached == 200_000_000
