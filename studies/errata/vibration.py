"""One mode under a force, solved anew: the ansatz is put into x'' + 2 zeta omega x' + omega^2 x = f, from rest."""

from __future__ import annotations

from functools import cache

import numpy as np
import sympy as sp
from scipy.integrate import quad

from .algebra import symbols

omega, zeta, p, time = symbols("omega zeta p t")
DAMPED = omega * sp.sqrt(1 - zeta**2)
PSI = (omega**2 - p**2) ** 2 + (2 * zeta * omega * p) ** 2


def left_side(x: sp.Expr) -> sp.Expr:
    """Return x'' + 2 zeta omega x' + omega^2 x."""
    return sp.diff(x, time, 2) + 2 * zeta * omega * sp.diff(x, time) + omega**2 * x


@cache
def amplitudes(force: str) -> tuple[sp.Expr, ...]:
    """Return the transient and steady amplitudes (sine, cosine each) for the force sin(p t) or cos(p t), from rest."""
    a_t, b_t, a_s, b_s = sp.symbols("a_t b_t a_s b_s")
    steady = a_s * sp.sin(p * time) + b_s * sp.cos(p * time)
    wanted = sp.sin(p * time) if force == "sin" else sp.cos(p * time)
    off = sp.expand(left_side(steady) - wanted)
    found = sp.solve([off.coeff(sp.sin(p * time)), off.coeff(sp.cos(p * time))], [a_s, b_s])
    free = sp.exp(-zeta * omega * time) * (a_t * sp.sin(DAMPED * time) + b_t * sp.cos(DAMPED * time))
    x = free + steady.subs(found)
    start = sp.solve([x.subs(time, 0), sp.diff(x, time).subs(time, 0)], [a_t, b_t])
    return start[a_t], start[b_t], found[a_s], found[b_s]


def response(force: str) -> sp.Expr:
    """Return x(t) for the force sin(p t) or cos(p t), from rest."""
    a_t, b_t, a_s, b_s = amplitudes(force)
    free = sp.exp(-zeta * omega * time) * (a_t * sp.sin(DAMPED * time) + b_t * sp.cos(DAMPED * time))
    return free + a_s * sp.sin(p * time) + b_s * sp.cos(p * time)


def partial_sum(width: float, period: float, harmonics: int, at: float) -> float:
    """Return the Fourier series of a repeated unit pulse on [0, width], cut off, by Dirichlet's kernel."""
    base = 2 * np.pi / period

    def kernel(u: float) -> float:
        return float(1 + 2 * sum(np.cos(k * base * u) for k in range(1, harmonics + 1)))

    return quad(lambda s: kernel(at - s), 0, width, epsabs=1e-13)[0] / period
