"""Wheel-centre paths against closed forms: offset lines and curves, arcs about edges, and where they meet in a kink."""

from math import atan, cos, pi, sin, sqrt, tan

import numpy as np
import pytest

from plants.ground import Flat, HalfSine, Hump, Profile, Ramp, RoughRoad, Step, Sum
from plants.patches import HEIGHT_ERROR, SLOPE_ERROR
from plants.wheel_path import WheelPath, rolling_path, wheel_path

R = 0.1


def offset(profile: Profile, R: float, s: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return x, height, slope and curvature of the centre of a disc that touches the profile at s and nowhere else."""
    theta, bend = np.arctan(profile.slope(s)), profile.curvature(s)
    return s - R * np.sin(theta), profile.elevation(s) + R * np.cos(theta), np.tan(theta), bend / (1 - R * bend)


def bend_error(path: WheelPath, R: float) -> float:
    """Return what an error of HEIGHT_ERROR in the middle of a patch of length h means for its second derivative.

    The error of Hermite interpolation is nearly e(t) = E 64 t^3 (1-t)^3 along a patch, whose second derivative is
    largest at t = 1/2: 24 E/h^2.
    """
    lengths = np.diff(path.patches.start)
    return 24 * HEIGHT_ERROR / np.min(lengths[lengths > R / 100]) ** 2


def test_on_level_ground_the_centre_stays_one_radius_above() -> None:
    table = wheel_path(Flat(0.25), R)
    assert table.tolist() == [[-1e9, 0, 0.25 + R, 0, 0, 0, 0, 0, 0, 0.25 + R, 0, 0, 0, 0, 0, 0]]
    assert rolling_path(Flat(0.25), R).departure is None


@pytest.mark.parametrize("angle", [0.05, 0.3, 1.2])
def test_the_kink_at_a_sharp_ramp_is_where_the_offset_lines_meet(angle: float) -> None:
    """The parallels at distance R meet on the bisector: x = start - R tan(angle/2)."""
    path = rolling_path(Ramp(2.0, angle), R)
    (kink,) = path.kinks
    assert kink.x == pytest.approx(2 - R * tan(angle / 2), abs=1e-12)
    assert kink.height == pytest.approx(R, abs=1e-12)
    assert (kink.before, kink.after) == ((0, 0), (pytest.approx(tan(angle), rel=1e-14), 0))
    assert path.departure == kink.x
    x = np.array([2.0, 3.0, 50.0])
    np.testing.assert_allclose(path.height(x), tan(angle) * (x - 2) + R / cos(angle), rtol=1e-14)


def test_a_fillet_wider_than_the_wheel_leaves_no_kink_and_a_narrower_one_the_kink_of_the_sharp_foot() -> None:
    """Inside an arc of radius r > R the centre goes on an arc of radius r - R; for r < R the arc is never touched."""
    wide, narrow = rolling_path(Ramp(2.0, 0.3, fillet=0.4), R), rolling_path(Ramp(2.0, 0.3, fillet=0.09), R)
    assert wide.kinks == ()
    foot, lifted = 2 - 0.4 * tan(0.15), 2 + 0.4 * tan(0.15) * cos(0.3)
    x = np.linspace(foot, lifted - R * sin(0.3), 301)[1:-1]
    np.testing.assert_allclose(np.hypot(x - foot, wide.height(x) - 0.4), 0.3, rtol=0, atol=HEIGHT_ERROR)
    np.testing.assert_allclose(wide.curvature(x), 1 / 0.3, rtol=0, atol=2 * bend_error(wide, R))
    assert [k.x for k in narrow.kinks] == pytest.approx([2 - R * tan(0.15)], abs=1e-12)


def test_a_hollow_barely_wider_than_the_wheel_counts_as_a_kink() -> None:
    """A fillet of 1.01 R would turn the path by 0.3 rad on a radius of 1 mm; in its place there is a kink.

    Were it the kink of the tangents at both ends, the path would dip by 0.01 R (1/cos(0.15) - 1) = 1.1e-5 m.  It is the
    one of the circles about the fillet's two ends, which fall off those tangents by l^2/2R on their way l to the kink.
    """
    tight = rolling_path(Ramp(2.0, 0.3, fillet=1.01 * R), R)
    way = 0.01 * R * tan(0.15)
    (kink,) = tight.kinks
    assert kink.x == pytest.approx(2 - R * tan(0.15), abs=way**2 / R)
    x = np.linspace(1.9, 2.1, 2001)
    foot = 2 - 1.01 * R * tan(0.15)
    turning = (x > foot) & (x < foot + 0.01 * R * sin(0.3))
    arc = 1.01 * R - np.sqrt(np.maximum(0, (0.01 * R) ** 2 - (x - foot) ** 2))
    dip = np.where(turning, arc, rolling_path(Ramp(2.0, 0.3), R).height(x)) - tight.height(x)
    assert np.max(dip) < 0.01 * R * (1 / cos(0.15) - 1) + way**2 / R
    assert np.min(dip) > -HEIGHT_ERROR


def test_a_convex_corner_is_an_arc_about_it() -> None:
    path = rolling_path(Ramp(2.0, 0.3, length=1.0), R)
    assert len(path.kinks) == 1
    x = np.linspace(3 - R * sin(0.3), 3, 201)
    np.testing.assert_allclose(np.hypot(x - 3, path.height(x) - tan(0.3)), R, rtol=0, atol=HEIGHT_ERROR)
    np.testing.assert_allclose(path.height([3.0, 9.0]), tan(0.3) + R, rtol=1e-15)


@pytest.mark.parametrize("height", [0.01, 0.05, 0.09, 0.0999])
def test_a_step_makes_a_kink_and_an_arc_about_its_edge(height: float) -> None:
    """The disc meets the edge where its centre, still at height R, is R away: x = start - sqrt(R^2 - (R - H)^2).

    Its slope u/sqrt(R^2 - u^2) has the derivative R^2/(R - H)^3 in u, which amplifies the rounding of x (4e-16 m).
    """
    path = rolling_path(Step(2.0, height), R)
    (kink,) = path.kinks
    before = sqrt(R**2 - (R - height) ** 2)
    assert kink.x == pytest.approx(2 - before, abs=1e-12)
    assert kink.after[0] == pytest.approx(before / (R - height), abs=1e-12 + 1e-15 * R**2 / (R - height) ** 3)
    x = np.linspace(kink.x, 2, 2001)
    np.testing.assert_allclose(np.hypot(x - 2, path.height(x) - height), R, rtol=0, atol=HEIGHT_ERROR)
    down = rolling_path(Step(2.0, -height), R)
    np.testing.assert_allclose(down.height(4 - x) + height, path.height(x), rtol=0, atol=2 * HEIGHT_ERROR)
    assert down.kinks[0].x == pytest.approx(2 + before, abs=1e-12)


def test_a_slot_narrower_than_the_wheel_is_bridged_however_deep() -> None:
    """Between two edges w apart the centre sinks to sqrt(R^2 - w^2/4) in the middle, where it touches both."""
    path = rolling_path(Sum((Step(2.0, -5.0), Step(2.1, 5.0))), R)
    (kink,) = path.kinks
    assert (kink.x, kink.height) == (pytest.approx(2.05, abs=1e-12), pytest.approx(sqrt(R**2 - 0.05**2), abs=1e-12))


@pytest.mark.parametrize("shape", ["cosine", "sin4"])
@pytest.mark.parametrize("height", [0.06, -0.06])
def test_over_a_gentle_hump_the_path_is_its_offset_curve(shape: str, height: float) -> None:
    """Least radius of the hump: 1 m long, 6 cm high: over 0.42 m, so every point is touched and nothing is cut off."""
    hump = Hump(1.0, 1.0, height, shape=shape)  # type: ignore[arg-type]
    path = rolling_path(hump, R)
    assert path.kinks == ()
    x, z, slope, bend = offset(hump, R, np.linspace(1, 2, 5003)[1:-1])
    np.testing.assert_allclose(path.height(x), z, rtol=0, atol=HEIGHT_ERROR)
    # the bound on the slope is relative to 1 + slope^2, here below 1.2
    np.testing.assert_allclose(path.slope(x), slope, rtol=0, atol=1.2 * SLOPE_ERROR)
    np.testing.assert_allclose(path.curvature(x), bend, rtol=0, atol=bend_error(path, R))


def test_a_half_sine_has_kinks_where_level_and_offset_curve_meet() -> None:
    """The touching point s solves g(s) + R cos(theta) = R; the bump falls mirror-like."""
    bump = HalfSine(1.0, 1.0, 0.05)
    path = rolling_path(bump, R)
    rise = 0.05 * pi  # slope at the foot; the contact right of the kink is s with u = s - 1
    u = 0.0
    for _ in range(50):  # Newton on f(u) = h sin(pi u) + R (cos theta - 1)
        g1, g2 = rise * cos(pi * u), -rise * pi * sin(pi * u)
        f = 0.05 * sin(pi * u) + R * (1 / sqrt(1 + g1**2) - 1)
        u -= f / (g1 - R * g1 * g2 / (1 + g1**2) ** 1.5)
    first, last = path.kinks
    assert first.x == pytest.approx(1 + u - R * sin(atan(rise * cos(pi * u))), abs=1e-12)
    assert last.x == pytest.approx(3 - first.x, abs=1e-12)
    assert (last.before[0], last.after[0]) == (pytest.approx(-first.after[0], abs=1e-12), 0)


def test_a_hollow_tighter_than_the_wheel_becomes_a_kink_in_the_middle() -> None:
    """Depth 0.1 m on 0.3 m: curvature 11/m at the bottom, above 1/R; by symmetry the disc rests on both flanks."""
    dip = HalfSine(1.0, 0.3, -0.1)
    (kink,) = rolling_path(dip, R).kinks
    assert kink.x == pytest.approx(1.15, abs=1e-12)
    # the flank touched is the contact whose centre lies above the middle: bisection of its x
    low, high = 1.02, 1.149
    for _ in range(60):
        s = (low + high) / 2
        x, z, slope, bend = offset(dip, R, np.array([s]))
        low, high = (s, high) if x[0] < 1.15 else (low, s)
    assert kink.height == pytest.approx(z[0], abs=1e-12)
    assert kink.after == (
        pytest.approx(-slope[0], rel=1e-9),
        pytest.approx(bend[0] * (1 + slope[0] ** 2) ** 1.5, rel=1e-6),
    )


@pytest.mark.parametrize(
    "profile",
    [Hump(1.0, 1.0, 0.06), RoughRoad("D", length=10.0), Ramp(1.0, 0.3, length=1.0, fillet=0.5), Step(1.0, 0.05)],
    ids=repr,
)
def test_patches_join_with_the_same_height_slope_and_where_the_ground_does_curvature(profile: Profile) -> None:
    """At a join both patches take exact values; sums in powers of x - xa round to 1e-15, relative to terms below 1.

    Their derivatives lose another factor h^-1 and h^-2, with patches of 1 cm.
    """
    path = rolling_path(profile, R)
    kinks = {kink.x for kink in path.kinks}
    jumps = 0
    p = path.patches
    for i in range(1, p.start.size):
        u = p.start[i] - p.anchor[i - 1]
        left = [np.polyval(np.polyder(p.c[i - 1, ::-1], n), u) for n in range(3)]
        right = [np.polyval(np.polyder(p.c[i, ::-1], n), p.start[i] - p.anchor[i]) for n in range(3)]
        assert left[0] == pytest.approx(right[0], abs=1e-13)
        if p.start[i] not in kinks:
            assert left[1] == pytest.approx(right[1], abs=1e-11)
            jumps += int(abs(left[2] - right[2]) > 1e-7)
    # curvature jumps: at both feet of the cosine; at the fillet's two ends and the arc's two; behind the edge
    assert jumps == {"Hump": 2, "RoughRoad": 0, "Ramp": 4, "Step": 1}[type(profile).__name__]
