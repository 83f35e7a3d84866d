"""Profiles: their derivatives, where they bend and break, what they refuse."""

from math import cos, inf, nan, pi, tan
from typing import Any

import numpy as np
import pytest

from cosim.errors import ScenarioError
from plants.ground import Flat, Ground, HalfSine, Hump, Profile, Ramp, RoughRoad, Step, Sum

CURVED = [
    Ramp(0.5, 0.3, fillet=0.8),
    Ramp(0.5, -0.3, length=0.7, fillet=0.8),
    Hump(0.5, 0.8, 0.06),
    Hump(0.5, 0.8, -0.06, shape="sin4"),
    HalfSine(0.5, 0.8, 0.06),
    RoughRoad("D", start=0.5, length=3.0, shortest=0.3, fade=0.5),
    Sum((Hump(0.5, 0.8, 0.06), Step(0.9, -0.02), Ramp(1.1, 0.2))),
]


@pytest.mark.parametrize("profile", CURVED, ids=repr)
def test_slope_and_second_derivative_are_those_of_the_height(profile: Profile) -> None:
    """Central differences inside each piece: error d^2/6 h''' plus rounding eps h/d and eps h'/d.

    With d = 1e-5 m, |h| < 1 and waves no shorter than 0.3 m (third derivative below 1e3, fourth below 1e5) the first is
    below 2e-8 for the slope and 2e-6 for the second derivative; the second is below 1e-10.
    """
    d = 1e-5
    for piece in profile.pieces:
        x = np.linspace(max(piece.start, 0.0) + d, min(piece.end, 4.0) - d, 301)
        h, h1, h2 = piece.jet(x)
        above, below = piece.jet(x + d), piece.jet(x - d)
        np.testing.assert_allclose((above[0] - below[0]) / (2 * d), h1, rtol=0, atol=2e-8)
        np.testing.assert_allclose((above[1] - below[1]) / (2 * d), h2, rtol=0, atol=2e-6)
        np.testing.assert_array_equal(h, profile.elevation(x))


def test_a_profile_is_evaluated_for_any_shape_and_takes_the_next_piece_at_a_breakpoint() -> None:
    step = Step(1.0, 0.05)
    np.testing.assert_array_equal(
        step.elevation(np.array([[0.0, 1.0], [2.0, np.nextafter(1.0, 0)]])), [[0, 0.05], [0.05, 0]]
    )
    assert step.elevation(1.5).shape == ()
    assert float(HalfSine(1.0, 1.0, 0.1).slope(1.0)) == pytest.approx(0.1 * pi, rel=1e-15)


@pytest.mark.parametrize(
    ("profile", "corners", "knots"),
    [
        (Flat(0.3), [], []),
        (Ramp(1.0, 0.3), [1.0], []),
        (Ramp(1.0, 0.3, length=2.0), [1.0, 3.0], []),
        (Ramp(1.0, 0.3, length=2.0, fillet=0.5), [3.0], [1 - 0.5 * tan(0.15), 1 + 0.5 * tan(0.15) * cos(0.3)]),
        (Step(1.0, 0.05), [1.0], []),
        (Hump(1.0, 2.0, 0.1), [], [1.0, 3.0]),
        (Hump(1.0, 2.0, 0.1, shape="sin4"), [], []),
        (HalfSine(1.0, 2.0, 0.1), [1.0, 3.0], []),
        (RoughRoad(start=1.0, length=4.0), [], []),
        (Sum((Step(2.0, 0.05), Hump(1.0, 2.0, 0.1))), [2.0], [1.0, 3.0]),
        (Sum((Ramp(1.0, 0.3), Ramp(2.0, -0.1))), [1.0, 2.0], []),
    ],
    ids=repr,
)
def test_a_profile_knows_its_corners_and_knots(profile: Profile, corners: list[float], knots: list[float]) -> None:
    assert profile.corners == pytest.approx(corners, abs=1e-15)
    assert profile.knots == pytest.approx(knots, abs=1e-15)


@pytest.mark.parametrize("angle", [0.3, -0.3, 1.2])
def test_a_fillet_is_an_arc_of_its_radius_tangent_to_level_and_slope(angle: float) -> None:
    """The rounded foot leaves the level at 1 - r tan(a/2) and meets the line tan(a) (x - 1) with its slope."""
    radius = 0.4
    ramp = Ramp(1.0, angle, fillet=radius)
    start, end = ramp.breakpoints
    assert start == pytest.approx(1 - radius * tan(abs(angle) / 2), abs=1e-15)
    assert float(ramp.elevation(end)) == pytest.approx(tan(angle) * (end - 1), abs=1e-15)
    x = np.linspace(start, end, 50)
    h, h1, h2 = ramp.pieces[1].jet(x)
    np.testing.assert_allclose(np.hypot(x - start, h - np.copysign(radius, angle)), radius, rtol=1e-14)
    np.testing.assert_allclose(h2 / (1 + h1**2) ** 1.5, np.copysign(1 / radius, angle), rtol=1e-13)
    assert h1[-1] == pytest.approx(tan(angle), rel=1e-13)


def test_a_ramp_of_finite_length_has_a_level_top_and_a_sum_makes_a_kerb() -> None:
    np.testing.assert_allclose(Ramp(1.0, 0.3, length=2.0).elevation([2.0, 3.0, 9.0]), np.array([1, 2, 2]) * tan(0.3))
    kerb = Sum((Step(1.0, 0.05), Step(1.5, -0.05)))
    np.testing.assert_array_equal(kerb.elevation([0.5, 1.2, 2.0]), [0, 0.05, 0])


def test_humps_have_their_height_in_the_middle_and_the_smooth_one_no_third_derivative_at_its_feet() -> None:
    for shape in ("cosine", "sin4"):
        assert float(Hump(1.0, 0.8, 0.07, shape=shape).elevation(1.4)) == pytest.approx(0.07, rel=1e-15)
    # h2 of the sin4 hump starts as 12 h k^4 u^2: a third derivative would leave a term in u
    h, k, u = 0.07, pi / 0.8, 1e-4
    assert float(Hump(1.0, 0.8, h, shape="sin4").jet(1.0 + u)[2]) == pytest.approx(12 * h * k**4 * u**2, rel=1e-5)


def test_profiles_are_values() -> None:
    assert Ramp(1.0, 0.3) == Ramp(1.0, 0.3)
    assert len({Ramp(1.0, 0.3), Ramp(1.0, 0.3), Ramp(1.0, 0.31)}) == 2


def test_left_and_right_tracks_differ_when_their_profiles_do() -> None:
    same, split = Ground.same(Ramp(1.0, 0.3)).tables(0.1), Ground(Ramp(1.0, 0.3), Flat()).tables(0.1)
    np.testing.assert_array_equal(same["left"], same["right"])
    np.testing.assert_array_equal(split["left"], same["left"])
    assert split["right"].shape == (1, 16)
    assert Ground(Flat(), Ramp(1.0, 0.3)).departure(0.1) == pytest.approx(1 - 0.1 * tan(0.15), abs=1e-12)
    assert Ground(Step(1.0, 0.01), Ramp(0.5, 0.3)).departure(0.1) == Ground.same(Ramp(0.5, 0.3)).departure(0.1)
    assert Ground.same(Flat()).departure(0.1) is None


WRONG: list[tuple[type, dict[str, Any], str]] = [
    (Flat, {"height": inf}, "Flat.height must be a finite number, not inf"),
    (Flat, {"height": "0.1"}, "Flat.height must be a finite number, not '0.1'"),
    (Ramp, {"start": nan}, "Ramp.start must be a finite number, not nan"),
    (Ramp, {"angle": 1.6}, "Ramp.angle is 1.6 rad, but must lie between -pi/2 and pi/2"),
    (Ramp, {"length": 0.0}, "Ramp.length is 0, but must be positive"),
    (Ramp, {"fillet": -0.1}, "Ramp.fillet is -0.1 m, but must be zero (a sharp foot) or positive"),
    (
        Ramp,
        {"angle": 0.3, "length": 0.1, "fillet": 1.0},
        "Ramp.fillet of 1 m takes 0.144385 m of the slope, but the ramp is 0.1 m long; "
        "take a smaller radius or a longer ramp",
    ),
    (Step, {"height": True}, "Step.height must be a finite number, not True"),
    (Hump, {"length": -1}, "Hump.length is -1, but must be positive"),
    (Hump, {"shape": "round"}, "Hump.shape cannot be 'round'; it is 'cosine' or 'sin4'"),
    (HalfSine, {"length": 0}, "HalfSine.length is 0, but must be positive"),
    (RoughRoad, {"road_class": "J"}, "RoughRoad.road_class cannot be 'J'; ISO 8608 has A (very good) to H"),
    (RoughRoad, {"seed": -1}, "RoughRoad.seed must be a whole number from 0, not -1"),
    (RoughRoad, {"seed": 1.5}, "RoughRoad.seed must be a whole number from 0, not 1.5"),
    (
        RoughRoad,
        {"shortest": 30.0},
        "RoughRoad has no wave between shortest = 30 m and longest = 20 m on 20 m of road; "
        "the shortest must be below both",
    ),
    (
        RoughRoad,
        {"length": 3.0, "fade": 2.0},
        "RoughRoad fades in and out over 2 m each, but is 3 m long; fade over at most half the length",
    ),
    (Sum, {"profiles": ()}, "Sum.profiles is empty; give at least one profile"),
]


@pytest.mark.parametrize(("kind", "values", "sentence"), WRONG, ids=lambda v: v if isinstance(v, str) else "")
def test_a_wrong_value_is_refused_in_one_sentence(kind: type, values: dict[str, Any], sentence: str) -> None:
    with pytest.raises(ScenarioError) as error:
        kind(**values)
    assert str(error.value) == sentence


REFUSED = [
    (
        Step(1.0, 0.12),
        "a wheel of radius R = 0.1 m cannot roll over x = 1 m, where the ground rises vertically by 0.12 m; "
        "a step must be lower than R",
    ),
    (
        Step(1.0, 0.1),
        "a wheel of radius R = 0.1 m cannot roll over x = 1 m, where the ground rises vertically by 0.1 m; "
        "a step must be lower than R",
    ),
    (
        Step(1.0, -0.25),
        "a wheel of radius R = 0.1 m cannot roll over x = 1 m, where the ground drops vertically by 0.25 m; "
        "a step must be lower than R",
    ),
    (
        Sum((Step(1.0, 0.06), Step(1.005, 0.06))),
        "a wheel of radius R = 0.1 m cannot roll over x = 1.005 m, where the ground rises vertically by 0.12 m; "
        "a step must be lower than R",
    ),
]


@pytest.mark.parametrize(("profile", "sentence"), REFUSED, ids=repr)
def test_a_face_as_high_as_the_wheel_has_no_rolling_path(profile: Profile, sentence: str) -> None:
    with pytest.raises(ScenarioError) as error:
        Ground.same(profile).tables(0.1)
    assert str(error.value) == sentence


def test_a_wheel_needs_a_radius() -> None:
    for R in (0.0, -0.1, inf):
        with pytest.raises(ScenarioError, match=f"a wheel rolls with a positive radius, not R = {R:g} m"):
            Ground.same(Flat()).tables(R)
