"""Rough roads against ISO 8608: the spectral density of the height lies in the middle of the class."""

import numpy as np
import pytest
from scipy.signal import welch
from scipy.stats import chi2

from plants.ground import RoughRoad
from plants.rough_road import CLASSES, displacement_psd

LENGTH, STEP, SEGMENT = 400.0, 0.02, 50.0  # m


def test_the_class_means_are_those_of_the_standard() -> None:
    """ISO 8608, table C.1: 16, 64, 256, ... 1e-6 m3 at 0.1 cycles/m, falling with the square of the frequency."""
    assert [float(displacement_psd(c, 0.1)) * 1e6 for c in CLASSES] == pytest.approx([16 * 4**i for i in range(8)])
    assert float(displacement_psd("C", 1.0)) == pytest.approx(256e-8)


@pytest.mark.parametrize(("road_class", "seed"), [("A", 0), ("C", 1), ("F", 2)])
def test_the_density_of_each_octave_is_that_of_the_class(road_class: str, seed: int) -> None:
    """Welch with Hann windows, 8 segments without overlap, averaged over octaves.

    A periodogram ordinate varies as chi-square with 2 degrees of freedom; the Hann window correlates neighbours (1.5
    bins count as one), so k bins of m segments have at least 2 k m/1.5 > k m degrees.  Leakage tilts a density n^-2 by
    less than 1 % from the 10th bin on.  Bounds: chi-square at 1e-6 on either side, and that 1 %.  They exclude the
    neighbouring classes (a factor of 4) from the first octave on, and an error of a fifth in the last.
    """
    road = RoughRoad(road_class, start=0.0, length=LENGTH + 2, seed=seed, shortest=0.1, longest=50.0, fade=1.0)
    x = np.arange(1.0, 1.0 + LENGTH, STEP)
    n, density = welch(road.elevation(x), 1 / STEP, "hann", round(SEGMENT / STEP), noverlap=0, detrend="constant")
    ratio = density[1:] / displacement_psd(road_class, n[1:])
    for octave in range(5):
        bins = (n[1:] >= 0.2 * 2**octave) & (n[1:] < 0.4 * 2**octave)
        degrees = np.count_nonzero(bins) * round(LENGTH / SEGMENT)
        low, high = chi2.ppf([1e-6, 1 - 1e-6], degrees) / degrees
        assert 0.99 * low < np.mean(ratio[bins]) < 1.01 * high
        assert 0.5 < np.mean(ratio[bins]) < 2  # the limits of the class


def test_waves_outside_the_band_are_missing() -> None:
    """Above 1/shortest only what the spline between samples leaves is seen: below 1e-4 of the class."""
    road = RoughRoad("C", start=0.0, length=102.0, shortest=0.5, longest=5.0)
    x = np.arange(1.0, 101.0, STEP)
    n, density = welch(road.elevation(x), 1 / STEP, "blackmanharris", round(50 / STEP), noverlap=0)
    ratio = density[1:] / displacement_psd("C", n[1:])
    inside, above, below = (n[1:] > 0.4) & (n[1:] < 1.8), (n[1:] > 2.2) & (n[1:] < 6), (n[1:] > 0.04) & (n[1:] < 0.1)
    assert np.mean(ratio[inside]) > 0.5
    assert np.max(ratio[above]) < 1e-4
    assert np.max(ratio[below]) < 1e-2


def test_the_same_seed_gives_the_same_bits_and_another_seed_another_road() -> None:
    x = np.linspace(0, 22, 3001)
    first, again, other = (RoughRoad("C", seed=seed).elevation(x) for seed in (7, 7, 8))
    assert first.tobytes() == again.tobytes()
    assert np.corrcoef(first, other)[0, 1] < 0.5
    # a finer road of the same seed has the same long waves: what differs is of the waves between 0.1 and 0.2 m
    finer = RoughRoad("C", seed=7, shortest=0.1).elevation(x)
    added = np.trapezoid(displacement_psd("C", np.linspace(5, 10, 501)), np.linspace(5, 10, 501)) ** 0.5
    assert np.std(finer - first) == pytest.approx(added, rel=0.2)


def test_the_road_grows_from_level_ground_and_ends_on_it() -> None:
    """The fade-in u^4 leaves height, slope and second derivative zero at both ends; halfway it has half the height."""
    road = RoughRoad("D", start=1.0, length=20.0, fade=2.0)
    for value in road.jet(np.array([0.5, 1.0, 21.0, 25.0])):
        np.testing.assert_allclose(value, 0, rtol=0, atol=1e-9)
    full = RoughRoad("D", start=1.0, length=20.0, fade=0.01)
    x = np.array([2.0, 3.0, 10.0, 20.0])
    np.testing.assert_allclose(road.elevation(x), full.elevation(x) * [0.5, 1, 1, 0.5], rtol=0, atol=1e-6)
