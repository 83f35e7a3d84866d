"""Wheel-centre paths against an independent reference: grey dilation of the sampled ground by a disc (scipy)."""

import numpy as np
import pytest
from scipy.ndimage import grey_dilation

from plants.ground import HalfSine, Hump, Profile, Ramp, RoughRoad, Step, Sum
from plants.patches import HEIGHT_ERROR
from plants.wheel_path import rolling_path

D = 2e-4  # m, grid spacing; all obstacles start and end on grid points


def dilated(profile: Profile, R: float, start: float, end: float) -> tuple[np.ndarray, np.ndarray]:
    """Return a grid and the highest centre of a disc at each of its points that touches a *sampled* ground point.

    At a vertical face the sample is the upper side: what a disc can touch there is the edge.
    """
    n = round(R / D)
    x = D * np.arange(round(start / D) - n, round(end / D) + n + 1)
    ground = np.maximum(profile.elevation(x + 1e-12), profile.elevation(x - 1e-12))
    cap = np.sqrt(np.maximum(0, R**2 - (D * np.arange(-n, n + 1)) ** 2))
    centre = grey_dilation(ground, size=cap.size, structure=cap)
    return x[n:-n], centre[n:-n]


CASES = [
    (Ramp(1.0, 0.6, length=0.4), 0.1),
    (Ramp(1.0, -0.6, length=0.4, fillet=0.05), 0.1),
    (Step(1.0, 0.07), 0.1),
    (Sum((Step(1.0, 0.07), Step(1.03, -0.11), Step(1.1, 0.04), Ramp(1.3, 0.2))), 0.1),
    (Hump(1.0, 0.4, 0.1, shape="sin4"), 0.1),
    (HalfSine(1.0, 0.3, -0.1), 0.1),
    (Sum((Hump(1.0, 0.2, -0.05), Hump(1.1, 0.2, 0.05), HalfSine(1.2, 0.1, 0.02))), 0.15),
    (RoughRoad("E", start=1.0, length=3.0, shortest=0.1, fade=0.5), 0.2),
    (RoughRoad("H", start=1.0, length=3.0, shortest=0.1, fade=0.5), 0.2),
]


@pytest.mark.parametrize(("profile", "R"), CASES, ids=repr)
def test_the_path_is_the_dilation_of_the_ground(profile: Profile, R: float) -> None:
    """The dilation of samples is a lower bound of the path, short by what the touched point lies off the grid.

    The centre's height over the place u of the touched point, g(x + u) + sqrt(R^2 - u^2), is greatest at that point.
    Half a grid step beside it, it is lower by (D/2)^2/2 |g'' - 1/(R cos^3 theta)|; at an edge, which is a grid point,
    not at all.  For |theta| < 1.3 rad and R = 0.1 m that is 2.5e-6 m at most, besides the curvature of the ground.
    In a hollow within 2 % of the wheel's own radius the path may dip by 1e-6 m under the dilation.
    """
    x, lower = dilated(profile, R, 0.7, 4.5)
    path = rolling_path(profile, R)
    height = path.height(x)
    theta = np.arctan(np.abs(path.slope(x)))
    assert np.max(theta) < 1.3
    assert np.min(height - lower) > -1e-6
    bent = max(0.0, -np.min(profile.jet(x)[2]))
    short = (D / 2) ** 2 / 2 * (bent + 1 / (R * np.cos(theta) ** 3))
    assert np.all(height - lower < short + HEIGHT_ERROR)


@pytest.mark.parametrize(("road_class", "R"), [("C", 0.1), ("C", 0.2), ("D", 0.1)])
def test_on_a_rough_road_the_disc_never_cuts_into_the_ground(road_class: str, R: float) -> None:
    """No ground point is nearer to any centre than R, but for the patches' error, and some point is just R away."""
    road = RoughRoad(road_class, start=1.0, length=20.0, shortest=0.2, seed=3)
    path = rolling_path(road, R)
    x = np.linspace(0.5, 21.5, 4001)
    u = np.linspace(-R, R, 801)
    ground = road.elevation(x[:, None] + u)
    nearest = np.min(np.hypot(u, path.height(x)[:, None] - ground), axis=1)
    assert np.min(nearest) > R - 1e-8
    # as above, with g'' > -5/m, theta < 0.5 and a grid of R/400
    assert np.max(nearest) < R + (R / 800) ** 2 / 2 * (5 + 1.5 / R) + HEIGHT_ERROR
