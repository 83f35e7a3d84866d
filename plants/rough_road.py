"""Rough roads by ISO 8608:2016: the class fixes the power spectral density of the height over spatial frequency.

    G_d(n) = G_d(n_0) (n/n_0)^-2,    n_0 = 0.1 cycles/m,    G_d(n_0) = 16e-6 4^i m3 for class A (i = 0) to H (i = 7)

are the geometric means of the classes (annex C); a class reaches from half to twice its mean.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import ceil, inf

import numpy as np

from cosim.errors import ScenarioError

from .profile import Piece, Profile, check_numbers, line

CLASSES = "ABCDEFGH"
N_0 = 0.1  # cycles/m
_SAMPLES_PER_WAVE = 10  # of the shortest wave; what a quintic spline needs to keep its height to 1e-5


def displacement_psd(road_class: str, n: np.ndarray | float) -> np.ndarray:
    """Return the mean one-sided spectral density of the height of a class at n cycles/m, in m3."""
    return 16e-6 * 4.0 ** CLASSES.index(road_class) * (np.asarray(n, dtype=float) / N_0) ** -2


@dataclass(frozen=True)
class RoughRoad(Profile):
    """A stretch of random road of an ISO 8608 class, level before and behind.

    Waves between ``shortest`` and ``longest`` with the amplitudes of the class mean and random phases, the same for the
    same ``seed``; a quintic spline through them (continuous to the fourth derivative).  The height grows from zero over
    the first ``fade`` metres and sinks back over the last.
    """

    road_class: str = "C"  # A (very good) to H
    start: float = 1.0  # m
    length: float = 20.0  # m
    seed: int = 0
    shortest: float = 0.2  # m, wavelength
    longest: float = 20.0  # m, wavelength
    fade: float = 1.0  # m

    def __post_init__(self) -> None:
        check_numbers(self, positive=("length", "shortest", "longest", "fade"), others=("start",))
        if self.road_class not in tuple(CLASSES):
            raise ScenarioError(f"RoughRoad.road_class cannot be {self.road_class!r}; ISO 8608 has A (very good) to H")
        if isinstance(self.seed, bool) or not isinstance(self.seed, int) or self.seed < 0:
            raise ScenarioError(f"RoughRoad.seed must be a whole number from 0, not {self.seed!r}")
        if not self.shortest < min(self.longest, self.length):
            raise ScenarioError(
                f"RoughRoad has no wave between shortest = {self.shortest:g} m and longest = {self.longest:g} m on "
                f"{self.length:g} m of road; the shortest must be below both"
            )
        if 2 * self.fade > self.length:
            raise ScenarioError(
                f"RoughRoad fades in and out over {self.fade:g} m each, but is {self.length:g} m long; "
                "fade over at most half the length"
            )

    @cached_property
    def pieces(self) -> tuple[Piece, ...]:
        """Level, road, level."""
        x, height = self._samples()
        from scipy.interpolate import make_interp_spline

        level = [(1, 0.0), (2, 0.0)]
        spline = make_interp_spline(x, height, k=5, bc_type=(level, level))
        slope, second = spline.derivative(1), spline.derivative(2)

        def jet(x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
            return spline(x), slope(x), second(x)

        end = float(x[-1])
        road = Piece(self.start, end, jet, self.shortest / 25)
        return line(-inf, self.start, 0.0, 0.0), road, line(end, inf, 0.0, 0.0)

    def _samples(self) -> tuple[np.ndarray, np.ndarray]:
        """Return x and height on a regular grid; the waves are the harmonics of the length (phases uniform)."""
        count = ceil(self.length / self.shortest * _SAMPLES_PER_WAVE)
        n = np.arange(1, count // 2 + 1) / self.length
        used = (n >= (1 - 1e-9) / self.longest) & (n <= (1 + 1e-9) / self.shortest)
        phase = np.random.default_rng(self.seed).uniform(0, 2 * np.pi, n.size)
        amplitude = np.where(used, np.sqrt(2 * displacement_psd(self.road_class, n) / self.length), 0.0)
        spectrum = np.concatenate([[0.0], amplitude * np.exp(1j * phase)]) * count / 2
        height = np.fft.irfft(spectrum, count)
        x = np.linspace(0.0, self.length, count + 1)
        return self.start + x, np.append(height, height[0]) * self._fading(x)

    def _fading(self, x: np.ndarray) -> np.ndarray:
        """Return 0 at both ends and 1 between, with three vanishing derivatives at either end of a fade."""
        u = np.clip(np.minimum(x, self.length - x) / self.fade, 0, 1)
        return u**4 * (35 - 84 * u + 70 * u**2 - 20 * u**3)
