"""The path table as a reader uses it: signed distances to both faces, which one is touched, and the sign that tells."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from plants.ground import Flat, HalfSine, Hump, Profile, Ramp, RoughRoad, Step, Sum
from plants.wheel_path import WheelPath, rolling_path, wheel_path

R = 0.1


def distance(origin: np.ndarray, a: np.ndarray, X: np.ndarray, Z: np.ndarray) -> np.ndarray:
    """Return the signed distance of (X, Z) from the graphs of sum a_i (x - origin)^i; Newton on the foot from x = X."""
    c = a[..., ::-1]
    x = X
    for _ in range(6):
        u = (x - origin)[:, None]
        z, z1, z2 = (np.sum(f * u ** np.arange(5, -1, -1), axis=1) for f in _derivatives(c))
        x = x - (x - X + (z - Z) * z1) / np.maximum(0.3, 1 + z1**2 + (z - Z) * z2)
    return (Z - z - (X - x) * z1) / np.sqrt(1 + z1**2)


def _derivatives(c: np.ndarray) -> list[np.ndarray]:
    """Return coefficients of the value and two derivatives, highest power (5) first."""
    powers = np.arange(5, -1, -1)
    first = np.concatenate([np.zeros_like(c[:, :1]), (c * powers)[:, :-1]], axis=1)
    second = np.concatenate([np.zeros_like(c[:, :1]), (first * powers)[:, :-1]], axis=1)
    return [c, first, second]


def faces(table: np.ndarray, X: np.ndarray, Z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the distances of centres from faces A and B, and the indicator parity (d_A - d_B)."""
    rows = table[np.searchsorted(table[:, 0], X, side="right") - 1]
    a, b = distance(rows[:, 1], rows[:, 2:8], X, Z), distance(rows[:, 8], rows[:, 9:15], X, Z)
    return a, b, rows[:, 15] * (a - b)


def lifted(path: WheelPath, x: np.ndarray, d: float) -> tuple[np.ndarray, np.ndarray]:
    """Return centres at the distance d from the path along its normal at x."""
    theta = np.arctan(path.slope(x))
    return x - d * np.sin(theta), path.height(x) + d * np.cos(theta)


KINKED = [
    Ramp(1.0, 0.3),
    Ramp(1.0, -0.5, length=0.3),
    Step(1.0, 0.05),
    Step(1.0, -0.05),
    Sum((Step(1.0, 0.04), Step(1.3, -0.06))),
    HalfSine(1.0, 0.6, 0.05),
    HalfSine(1.0, 0.3, -0.1),
    Hump(1.0, 0.4, 0.1, shape="sin4"),
    Sum((Ramp(1.0, 0.1, length=0.03), Ramp(1.03, -0.5, length=3.0))),  # the level, carried on, would cut the far slope
    Sum((Step(1.0, -5.0), Step(1.1, 5.0))),
    RoughRoad("F", start=1.0, length=3.0, shortest=0.1, fade=0.5),
]


@pytest.mark.parametrize("profile", KINKED, ids=repr)
def test_rows_hold_the_path_itself_and_one_other_face(profile: Profile) -> None:
    path, table = rolling_path(profile, R), wheel_path(profile, R)
    assert table.shape[1] == 16
    assert table[0, 0] == -1e9
    assert np.all(np.diff(table[:, 0]) > 0)
    assert {kink.x for kink in path.kinks} <= set(table[:, 0])
    assert set(table[:, 15]) <= {1.0, -1.0}
    x = (table[1:-1, 0] + table[2:, 0]) / 2
    rows = table[1:-1]
    own = path.height(x)
    a, b = (np.sum(rows[:, n : n + 6] * (x - rows[:, n - 1])[:, None] ** np.arange(6), axis=1) for n in (2, 9))
    np.testing.assert_allclose(np.maximum(a, b), own, rtol=0, atol=1e-14)


@pytest.mark.parametrize("profile", KINKED, ids=repr)
def test_a_wheel_that_follows_the_path_changes_faces_at_kinks_and_nowhere_else(profile: Profile) -> None:
    """The indicator has one sign up to a kink and the other one up to the next: +, -, + ... is minus, plus, minus here.

    On the path one distance is zero and the other positive, so left of the first kink d_A < d_B.
    """
    path, table = rolling_path(profile, R), wheel_path(profile, R)
    kinks = np.array([kink.x for kink in path.kinks])
    assert kinks.size
    x = np.linspace(0.5, 5.0, 20011)
    x = x[np.min(np.abs(x[:, None] - kinks), axis=1) > 1e-6]
    a, b, indicator = faces(table, x, path.height(x))
    np.testing.assert_allclose(np.minimum(a, b), 0, rtol=0, atol=1e-15)
    np.testing.assert_array_equal(np.sign(indicator), np.where(np.searchsorted(kinks, x) % 2, 1, -1))


@pytest.mark.parametrize("profile", [p for p in KINKED if not isinstance(p, RoughRoad)], ids=repr)
@pytest.mark.parametrize("depth", [1e-4, 2e-3])
def test_a_sunk_wheel_changes_faces_once_per_kink_and_where_both_are_equally_far(
    profile: Profile, depth: float
) -> None:
    """A centre that passes under a kink, `depth` below both faces, changes from one to the other on the bisector.

    Each distance changes by at most one `step` from one sample to the next, so where the indicator changes they agree
    within two, but for a face that bends up: beyond the kink it goes on straight, Z'' depth^2/2 lower at most.
    """
    path, table = rolling_path(profile, R), wheel_path(profile, R)
    for kink in path.kinks:
        theta = np.arctan([kink.before[0], kink.after[0]])
        along = np.linspace(-3 * depth, 3 * depth, 8001)
        middle = depth / np.cos((theta[1] - theta[0]) / 2)
        tilt = np.mean(theta)
        # sideways through the point `depth` under both tangents, at right angles to the bisector of the kink
        X = kink.x + middle * np.sin(tilt) + along * np.cos(tilt)
        Z = kink.height - middle * np.cos(tilt) + along * np.sin(tilt)
        a, b, indicator = faces(table, X, Z)
        (change,) = np.flatnonzero(np.diff(np.sign(indicator)))
        step = np.hypot(X[1] - X[0], Z[1] - Z[0])
        bend = max(0.0, kink.before[1], kink.after[1])
        assert abs(a[change] - b[change]) < 2 * step + bend * depth**2 / 2
        assert abs(along[change]) < depth


@pytest.mark.parametrize("profile", [*KINKED, Hump(1.0, 1.0, 0.06), Ramp(1.0, 0.3, fillet=0.4, length=1.0)], ids=repr)
@pytest.mark.parametrize("d", [-1e-3, 1e-3])
def test_the_nearer_face_gives_the_distance_from_the_path(profile: Profile, d: float) -> None:
    """Against the nearest of points 4e-6 m apart, which is at most (2e-6)^2/2d = 2e-9 m too far.

    The foot lies d sin(theta) beside the centre, and where the curvature of the path jumps in between, the patch of the
    centre misses it by at most max|Z''| (d sin theta)^2: 5e-6 m at worst here.  Below the path the nearest point of a
    kink is a corner that no wheel touches, so only centres whose foot lies aside of it are compared.
    """
    path, table = rolling_path(profile, R), wheel_path(profile, R)
    curve = np.arange(0.6, 2.2, 4e-6)
    tree = cKDTree(np.column_stack([curve, path.height(curve)]))
    x = np.linspace(0.7, 2.1, 3001)
    kinks = np.array([kink.x for kink in path.kinks])
    if kinks.size:
        x = x[np.min(np.abs(x[:, None] - kinks), axis=1) > 3e-3]
    X, Z = lifted(path, x, d)
    expected = np.copysign(tree.query(np.column_stack([X, Z]))[0], d)
    a, b, _ = faces(table, X, Z)
    _, slope, second = path.patches.jet(curve)
    aside = abs(d) * np.max(np.abs(np.sin(np.arctan(slope))))
    np.testing.assert_allclose(np.minimum(a, b), expected, rtol=0, atol=3e-9 + np.max(np.abs(second)) * aside**2)


def test_a_track_without_kinks_has_one_face_and_a_constant_indicator() -> None:
    for profile in (Flat(0.1), Hump(1.0, 1.0, 0.05), Ramp(1.0, 0.3, fillet=0.5)):
        table = wheel_path(profile, R)
        np.testing.assert_array_equal(table[:, 1:8], table[:, 8:15])
        np.testing.assert_array_equal(table[:, 15], 0)


@pytest.mark.parametrize("profile", KINKED, ids=repr)
def test_away_from_kinks_the_second_face_is_out_of_reach(profile: Profile) -> None:
    """More than R from every kink, what stands for the other face lies R below the tangent: at least R/2 away."""
    path, table = rolling_path(profile, R), wheel_path(profile, R)
    x = np.linspace(0.3, 5.0, 3001)
    for d in (0.0, -0.01, 0.01):
        X, Z = lifted(path, x, d)
        away = np.min(np.abs(X[:, None] - [kink.x for kink in path.kinks]), axis=1) > R
        a, b, _ = faces(table, X[away], Z[away])
        assert np.all(np.abs(a - b) > R / 2)


def test_a_table_of_a_long_road_is_small_and_quickly_made() -> None:
    """120 m of class C between 0.2 and 20 m: a few thousand rows."""
    table = wheel_path(RoughRoad("C", length=120.0), R)
    assert 2000 < len(table) < 8000
