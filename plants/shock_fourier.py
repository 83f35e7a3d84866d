"""The thesis' way to a shock response (7.20 to 7.35): a periodic pulse, harmonics, a transient and a steady response.

    f = sum a cos(p t) + b sin(p t)            every harmonic from rest:
    q = e^{-zeta w t} (A_t sin w_d t + B_t cos w_d t) + A_s sin p t + B_s cos p t      for sin p t  (7.23, 7.24)
    q = e^{-zeta w t} (C_t sin w_d t + D_t cos w_d t) + C_s sin p t + D_s cos p t      for cos p t  (7.27, 7.28)

The response starts from rest, so within one period the repetition does no harm; what is lost is what lies above the
highest harmonic.  As printed, the mean of the pulse is missing (7.20) and 1/w stands for 1/w_d (7.21, 7.26).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from .pulses import Pulse, Series
from .shock import Response

PERIOD, TOP = 3.0, 200.0  # s, Hz: section 8.3
_TABLE = 1_200_000  # sines at a time: 10 MB


@dataclass(frozen=True)
class Coefficients:
    """The eight amplitudes of 7.25 and 7.29, each (modes, harmonics), s^2."""

    A_t: np.ndarray
    B_t: np.ndarray
    A_s: np.ndarray
    B_s: np.ndarray
    C_t: np.ndarray
    D_t: np.ndarray
    C_s: np.ndarray
    D_s: np.ndarray


def coefficients(w: np.ndarray, zeta: np.ndarray, p: np.ndarray) -> Coefficients:
    """Return the amplitudes for modes of w (modes,) in rad/s and ratios zeta, and frequencies p (harmonics,)."""
    w, zeta = np.reshape(w, (-1, 1)), np.reshape(zeta, (-1, 1))
    wd = w * np.sqrt(1 - zeta**2)
    psi = (w**2 - p**2) ** 2 + (2 * zeta * w * p) ** 2
    in_phase, lag = (w**2 - p**2) / psi, 2 * zeta * w * p / psi
    A_t = p * (2 * zeta**2 * w**2 - w**2 + p**2) / (wd * psi)
    C_t = -zeta * w * (w**2 + p**2) / (wd * psi)
    return Coefficients(A_t, lag, in_phase, -lag, C_t, -in_phase, lag, in_phase)


def printed_coefficients(w: np.ndarray, zeta: np.ndarray, p: np.ndarray) -> Coefficients:
    """Return the amplitudes as 7.25 and 7.29 print them: all too small by sqrt(1 - zeta^2)."""
    w, zeta = np.reshape(w, (-1, 1)), np.reshape(zeta, (-1, 1))
    root = np.sqrt(1 - zeta**2)
    wd = w * root
    psi = p**4 - 2 * p**2 * w**2 + 4 * zeta**2 * p**2 * w**2 + w**4
    steady = (zeta**2 * w**2 - p**2 + wd**2) * root / psi
    lag = 2 * p * zeta * wd / psi
    A_t = -(p / w) * (-(zeta**2) * w**2 - p**2 + wd**2) / psi
    C_t = -zeta * (p**2 + w**2) / psi
    D_t = (p**2 * root - w**2 * zeta**2 * root - w**2 * (1 - zeta**2) ** 1.5) / psi
    return Coefficients(A_t, lag, steady, -lag, C_t, D_t, lag, steady)


def fourier_response(
    frequency: np.ndarray,
    damping: np.ndarray | float,
    pulse: Pulse,
    t: np.ndarray,
    *,
    period: float = PERIOD,
    top: float = TOP,
    printed: bool = False,
) -> Response:
    """Return the response of modes (modes,) in Hz at rest to a *pulse* by the thesis' method, at *t* (n,) in s.

    Harmonics up to *top* Hz; *printed* uses the printed amplitudes and leaves the mean out, as 7.20 does.
    """
    w = 2 * pi * np.asarray(frequency, float)
    zeta = np.broadcast_to(np.asarray(damping, float), w.shape)
    series = pulse.series(period, top)
    amplitudes = (printed_coefficients if printed else coefficients)(w, zeta, series.p)
    transient, steady = _summed(amplitudes, series)
    if not printed:
        transient, constant = _mean(transient, w, zeta, series.mean)
    else:
        constant = np.zeros_like(w)
    return _evaluated(w, zeta, series.p, np.asarray(t, float), transient, steady, constant)


Pair = tuple[np.ndarray, np.ndarray]  # amplitudes of a sine and of a cosine


def _summed(c: Coefficients, series: Series) -> tuple[Pair, Pair]:
    """Return the amplitudes of the transient, (modes,) each, and of the steady response, (modes, harmonics) each."""
    a, b = series.a, series.b
    transient = (c.A_t @ b + c.C_t @ a, c.B_t @ b + c.D_t @ a)
    return transient, (c.A_s * b + c.C_s * a, c.B_s * b + c.D_s * a)


def _mean(transient: Pair, w: np.ndarray, zeta: np.ndarray, mean: float) -> tuple[Pair, np.ndarray]:
    """Add the response to the mean of the series: the cosine response at p = 0."""
    static = mean / w**2
    sine, cosine = transient
    return (sine - static * zeta / np.sqrt(1 - zeta**2), cosine - static), static


def _evaluated(
    w: np.ndarray, zeta: np.ndarray, p: np.ndarray, t: np.ndarray, transient: Pair, steady: Pair, constant: np.ndarray
) -> Response:
    """Sum up q, q' and q'' (modes, n); the tables of sines and cosines are shared by all modes, in blocks of times."""
    wd = w * np.sqrt(1 - zeta**2)
    decay = np.exp(np.outer(-zeta * w, t))
    sine, cosine = decay * np.sin(np.outer(wd, t)), decay * np.cos(np.outer(wd, t))
    found = [np.empty((len(w), len(t))) for _ in range(3)]
    orders = list(_derivatives(w * zeta, wd, transient, p, steady))
    for block in np.array_split(np.arange(len(t)), 1 + len(t) * len(p) // _TABLE):
        phase = np.outer(p, t[block])
        tables = np.sin(phase), np.cos(phase)
        for out, (free, forced) in zip(found, orders, strict=True):
            out[:, block] = free[0][:, None] * sine[:, block] + free[1][:, None] * cosine[:, block]
            out[:, block] += forced[0] @ tables[0] + forced[1] @ tables[1]
    found[0] += constant[:, None]
    return Response(*found)


def _derivatives(
    decay: np.ndarray, wd: np.ndarray, transient: Pair, p: np.ndarray, steady: Pair
) -> list[tuple[Pair, Pair]]:
    """Return the amplitudes of the response and of its first and second derivative."""
    found = [(transient, steady)]
    for _ in range(2):
        (S, C), (A, B) = found[-1]
        found.append(((-decay * S - wd * C, -decay * C + wd * S), (-p * B, p * A)))
    return found
