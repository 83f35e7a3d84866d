"""The response of elastic modes to shocks, exact: closed forms for pulses, a recursion for forces held over steps.

A mode under a force f from rest obeys  q'' + 2 zeta w q' + w^2 q = f  (7.10).  With s = -zeta w + j w_d its whole
state is one complex number,

    z' = s z + f,    q = Im(z)/w_d,    q' = Im(s z)/w_d,    q'' = Im(s^2 z)/w_d + f,

so the response to a step is (e^{st} - 1)/s, and to e^{jpt} it is (e^{jpt} - e^{st})/(jp - s): finite also where p
meets w_d.  Every pulse of `plants.pulses` is a sum of such onsets.  Nothing is truncated and nothing is discretised.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import pi

import numpy as np
from scipy.signal import lfilter

from .chassis_modes import ModalData
from .pulses import Onset, Pulse

GRAVITY = 9.81  # m/s2, what the thesis divides accelerations by


@dataclass(frozen=True)
class Response:
    """Modal coordinates and their rates, each (modes, n), to forces per unit of modal mass."""

    q: np.ndarray
    rate: np.ndarray
    acceleration: np.ndarray

    def at_stations(self, data: ModalData, gamma: np.ndarray | float = 1.0) -> np.ndarray:
        """Return accelerations (n, stations) in m/s2 of these modes, each times its participation *gamma* (modes,)."""
        n = len(self.acceleration)
        return (self.acceleration * np.reshape(gamma, (-1, 1))).T @ data.station_shape[:, :n].T


def poles(frequency: np.ndarray, damping: np.ndarray | float) -> tuple[np.ndarray, np.ndarray]:
    """Return s (modes,), complex, 1/s, and w_d (modes,), rad/s, of natural frequencies in Hz and ratios below 1."""
    w = 2 * pi * np.asarray(frequency, float)
    wd = w * np.sqrt(1 - np.asarray(damping, float) ** 2)
    return -np.asarray(damping) * w + 1j * wd, wd


def pulse_response(frequency: np.ndarray, damping: np.ndarray | float, pulse: Pulse, t: np.ndarray) -> Response:
    """Return the exact response of modes (modes,) at rest to a *pulse* as modal force, at times *t* (n,) in s.

    The acceleration at a jump of the force is the one right after it.
    """
    s, wd = poles(frequency, damping)
    t = np.asarray(t, float)
    z = sum(part.coefficient * _started(s, part, t) for part in pulse.onsets())
    return _response(np.asarray(z), s, wd, pulse.force(t))


def _started(s: np.ndarray, part: Onset, t: np.ndarray) -> np.ndarray:
    """Return the complex state (modes, n) at *t* (n,) that a unit onset has caused."""
    since = np.maximum(t - part.start, 0.0)
    column = s[:, None]
    if part.kind == "step":
        return np.asarray(np.expm1(column * since) / column)
    if part.kind == "ramp":
        return np.asarray((np.expm1(column * since) - column * since) / column**2)
    turning = np.exp(column * since) * since
    forth, back = (turning * _grown((sign * 1j * part.p - column) * since) for sign in (1, -1))
    return (forth - back) / 2j if part.kind == "sin" else (forth + back) / 2


def _grown(x: np.ndarray) -> np.ndarray:
    """Return (e^x - 1)/x, 1 at zero."""
    return np.divide(np.expm1(x), x, out=np.ones_like(x), where=x != 0)


def held_response(
    frequency: np.ndarray,
    damping: np.ndarray | float,
    t: np.ndarray,
    force: np.ndarray,
    start: np.ndarray | float = 0.0,
    *,
    left: bool = False,
) -> Response:
    """Return the exact response to modal forces (modes, n) or (n,), entry k held over [t_k, t_k+1); any steps.

    *start* (modes,) are modal coordinates at rest at the first time.  The acceleration is the one right after each
    change of the force, or with *left* right before it, which is what a co-simulation records at the end of a step.
    """
    s, wd = poles(frequency, damping)
    f = np.broadcast_to(np.asarray(force, float), (len(s), len(t)))
    dt = np.diff(t)
    first = wd * start * (1j - s.real / wd)  # Im(z)/w_d = start and Im(s z) = 0
    # equal up to the rounding of the times themselves
    even = len(dt) > 0 and np.ptp(dt) <= 8 * np.spacing(np.max(np.abs(t)))
    z = (_even if even else _uneven)(s, dt, f, np.broadcast_to(first, s.shape))
    felt = np.concatenate([f[:, :1], f[:, :-1]], axis=1) if left else f
    return _response(z, s, wd, felt)


def _even(s: np.ndarray, dt: np.ndarray, f: np.ndarray, first: np.ndarray) -> np.ndarray:
    """Run z(k+1) = e^{s dt} z(k) + (e^{s dt} - 1)/s f(k): one complex filter per mode, nothing squared."""
    step = float(np.mean(dt))
    turn, push = np.exp(s * step), np.expm1(s * step) / s
    z = np.empty(f.shape, complex)
    z[:, 0] = first
    for i in range(len(s)):
        z[i, 1:], _ = lfilter([push[i]], [1.0, -turn[i]], f[i, :-1], zi=[turn[i] * first[i]])
    return z


def _uneven(s: np.ndarray, dt: np.ndarray, f: np.ndarray, first: np.ndarray) -> np.ndarray:
    """Run the same recursion where the steps differ."""
    grown = np.expm1(np.outer(dt, s))
    pushes = grown / s * f[:, :-1].T
    turns = grown + 1
    z = np.empty((f.shape[1], len(s)), complex)
    z[0] = now = first
    for k in range(len(dt)):
        now = turns[k] * now + pushes[k]
        z[k + 1] = now
    return z.T


def _response(z: np.ndarray, s: np.ndarray, wd: np.ndarray, force: np.ndarray) -> Response:
    per = wd[:, None]
    column = s[:, None]
    return Response(z.imag / per, (column * z).imag / per, (column**2 * z).imag / per + force)


def peaks(acceleration: np.ndarray) -> np.ndarray:
    """Return the largest magnitude (stations,) of accelerations (n, stations) in m/s2, in g."""
    return np.asarray(np.max(np.abs(acceleration), axis=0) / GRAVITY)


Method = Callable[[np.ndarray, np.ndarray, Pulse, np.ndarray], Response]


def station_response(
    data: ModalData, load: np.ndarray, pulse: Pulse, t: np.ndarray, method: Method = pulse_response
) -> np.ndarray:
    """Return accelerations (n, stations) in m/s2 at *t* (n,) under a *load* (4,) on the wheels times a *pulse*.

    *method* computes the response of the modes: the exact one, or `plants.shock_fourier.fourier_response`.
    """
    return method(data.frequency, data.damping, pulse, t).at_stations(data, load @ data.wheel_shape)
