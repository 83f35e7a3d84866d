"""Two bouncing masses and a sampled controller that kicks one of them, and the closed form of when they touch."""

from __future__ import annotations

from collections.abc import Iterator
from math import floor, sqrt

import casadi as ca

from cosim import Component, event, input, output, parameter, state

G, E, KICK, PERIOD = 9.81, 0.8, 4.0, 0.1


class Ball(Component):
    """A ball over a floor, pushed by an acceleration from outside; announces nothing."""

    z0 = parameter(1.0, "m", "height at first")
    kick = input("m/s2", "acceleration from outside, upwards")
    z = state(0.0, "m", "height above that at first")
    v = state(0.0, "m/s", "velocity, upwards")
    n = state(0.0, "1", "touches so far", whole=True)
    touch = event("the ball touches the floor")
    height = output("m", "height")
    speed = output("m/s", "velocity, upwards")
    touches = output("1", "touches so far")

    def derivatives(s):  # type: ignore[no-untyped-def]
        return dict(z=s.v, v=s.kick - G, n=0)

    def crossings(s):  # type: ignore[no-untyped-def]
        return dict(touch=s.z + s.z0)

    def jump(s):  # type: ignore[no-untyped-def]
        down = s.crossed.touch < 0
        return dict(z=ca.if_else(down, -s.z0, s.z), v=ca.if_else(down, -E * s.v, s.v), n=s.n + ca.if_else(down, 1, 0))

    def outputs(s):  # type: ignore[no-untyped-def]
        return dict(height=s.z + s.z0, speed=s.v, touches=s.n)


class Announcing(Ball):
    """The same, and it announces its touches."""

    touch = event("the ball touches the floor", announce=True)


class Switch(Component):
    """Sampled: a kick in every second period, none in the first."""

    period = parameter(PERIOD, "s", "sample period")
    strength = parameter(KICK, "m/s2", "size of the kick")
    seen = input("m", "what is watched")
    k = state(-1.0, "1", "ticks so far, less one")
    saw = state(0.0, "m", "what was seen at the last tick")
    kick = output("m/s2", "acceleration")
    last = output("m", "what was seen at the last tick")

    def sync(s):  # type: ignore[no-untyped-def]
        return dict(k=s.k + 1, saw=s.seen)

    def outputs(s):  # type: ignore[no-untyped-def]
        return dict(kick=ca.if_else(ca.fmod(s.k, 2) == 1, s.strength, 0), last=s.saw)


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
