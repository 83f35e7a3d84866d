"""The closed form that runs of two bouncing masses and a clocked controller are compared with."""

from __future__ import annotations

from collections.abc import Iterator
from math import floor, sqrt

G, E = 9.81, 0.8


def touches(
    h: float, stop: float, *, kick: float = 0.0, period: float = 0.0, e: float = E, g: float = G
) -> Iterator[float]:
    """Yield when a ball dropped from *h* touches the floor.

    Its acceleration is -g + kick in every second interval of length *period* (the first one without kick), so that it
    flies along pieces of parabolas; each touch is the root of one.
    """
    t, v = 0.0, 0.0
    while t < stop:
        n = floor(t / period * (1 + 1e-15) + 1e-12) if period else 0
        end = (n + 1) * period if period else stop
        a = -g + (kick if n % 2 else 0.0)
        hit = (v + sqrt(v * v - 2 * a * h)) / -a
        if t + hit <= end:
            t, h, v = t + hit, 0.0, -e * (v + a * hit)
            if t < stop:
                yield t
        else:
            dt = end - t
            t, h, v = end, h + dt * (v + dt / 2 * a), v + dt * a
