"""Shock pulses: rectangular, triangular, half-sine and versed-sine, in time, in frequency, and as parts that start.

A pulse of a duration T and a peak F is zero outside [0, T).  Between times at which something starts or stops it is a
sum of steps, ramps, sines and cosines; these *onsets* have closed responses, so a pulse has one too.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from cosim.errors import ScenarioError, nearest

SHAPES = ("rectangular", "triangular", "half-sine", "versed-sine")


@dataclass(frozen=True)
class Onset:
    """A part of a force that is zero before *start*: coefficient times 1, t, sin(p t) or cos(p t) from then on."""

    kind: str  # "step", "ramp", "sin" or "cos"
    start: float  # s
    coefficient: float  # N, or N/s for a ramp
    p: float = 0.0  # rad/s


@dataclass(frozen=True)
class Series:
    """A Fourier series  mean + sum(a cos(p t) + b sin(p t)),  Eq 7.20 with its mean."""

    p: np.ndarray  # (harmonics,) rad/s
    a: np.ndarray  # (harmonics,) N
    b: np.ndarray  # (harmonics,) N
    mean: float  # N

    def force(self, t: np.ndarray) -> np.ndarray:
        """Return the force (n,) in N at times *t* (n,) in s."""
        phase = np.outer(np.asarray(t, float), self.p)
        return self.mean + np.cos(phase) @ self.a + np.sin(phase) @ self.b


@dataclass(frozen=True)
class Pulse:
    """A force pulse: its shape, duration in s and peak in N.  Raises ScenarioError for what is none."""

    shape: str
    duration: float
    peak: float = 1.0

    def __post_init__(self) -> None:
        if self.shape not in SHAPES:
            raise ScenarioError(f"there is no pulse {self.shape!r}; {nearest(self.shape, SHAPES)}")
        if not (np.isfinite(self.duration) and self.duration > 0):
            raise ScenarioError(f"a pulse of {self.duration!r} s is none; its duration must be positive")

    def force(self, t: np.ndarray) -> np.ndarray:
        """Return the force (n,) in N at times *t* (n,) in s; at a jump the value right after it."""
        t = np.asarray(t, float)
        share = t / self.duration
        inside = (t >= 0) & (t < self.duration)
        with np.errstate(invalid="ignore"):
            values = {
                "rectangular": np.ones_like(share),
                "triangular": 1 - np.abs(2 * share - 1),
                "half-sine": np.sin(pi * share),
                "versed-sine": (1 - np.cos(2 * pi * share)) / 2,
            }[self.shape]
        return self.peak * np.where(inside, values, 0.0)

    def onsets(self) -> tuple[Onset, ...]:
        """Return the parts that the pulse is the sum of."""
        T, F = self.duration, self.peak
        if self.shape == "rectangular":
            return Onset("step", 0.0, F), Onset("step", T, -F)
        if self.shape == "triangular":
            slope = 2 * F / T
            return Onset("ramp", 0.0, slope), Onset("ramp", T / 2, -2 * slope), Onset("ramp", T, slope)
        if self.shape == "half-sine":
            return Onset("sin", 0.0, F, pi / T), Onset("sin", T, F, pi / T)
        p = 2 * pi / T
        return (
            Onset("step", 0.0, F / 2), Onset("cos", 0.0, -F / 2, p),
            Onset("step", T, -F / 2), Onset("cos", T, F / 2, p),
        )  # fmt: skip

    def transform(self, omega: np.ndarray | float) -> np.ndarray:
        """Return the Fourier integral (n,), complex, N.s, at *omega* (n,) in rad/s: int f e^{-j omega t} dt.

        The rectangular one is T sinc(omega T/2) e^{-j omega T/2}, which 7.17 misprints.
        """
        T, w = self.duration, np.asarray(omega, float)

        def sinc(x: np.ndarray) -> np.ndarray:
            return np.sinc(x / pi)

        def shifted(p: float) -> np.ndarray:
            """Return the integral of cos(p u) e^{-j w u} over a window of length T around zero."""
            return T / 2 * (sinc((w - p) * T / 2) + sinc((w + p) * T / 2))

        centred = {
            "rectangular": lambda: T * sinc(w * T / 2),
            "triangular": lambda: T / 2 * sinc(w * T / 4) ** 2,
            "half-sine": lambda: shifted(pi / T),
            "versed-sine": lambda: (T * sinc(w * T / 2) + shifted(2 * pi / T)) / 2,
        }[self.shape]()
        return self.peak * centred * np.exp(-0.5j * w * T)

    def series(self, period: float, top: float) -> Series:
        """Return the Fourier series of the pulse repeated every *period* s, with harmonics up to *top* Hz.

        Raises ScenarioError if the pulse is longer than the period.
        """
        if self.duration > period:
            raise ScenarioError(f"a pulse of {self.duration:g} s cannot be repeated every {period:g} s")
        w0 = 2 * pi / period
        p = w0 * np.arange(1, int(np.floor(top * period * (1 + 1e-12))) + 1)
        lines = self.transform(p)
        return Series(p, 2 / period * lines.real, -2 / period * lines.imag, float(self.transform(0.0).real) / period)
