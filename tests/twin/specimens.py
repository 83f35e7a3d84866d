"""Small components that between them use everything an FMU has: the plants and controllers follow in conftest.py."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import casadi as ca
import numpy as np

from cosim import Component, event, input, output, parameter, state, table


class Mass(Component):
    """Mass on a spring with a damper: m x'' = F - k x - d x'."""

    m = parameter(2.0, "kg", "mass")
    k = parameter(50.0, "N/m", "stiffness")
    d = parameter(0.4, "N.s/m", "damping")
    F = input("N", "force", start=1.0)
    x = state(0.1, "m", "position", nominal=1e-2)
    v = state(0.0, "m/s", "velocity")
    position = output("m", "position")
    power = output("W", "power of the force: an output that its input reaches at once")

    def derivatives(s):
        return dict(x=s.v, v=(s.F - s.k * s.x - s.d * s.v) / s.m)

    def outputs(s):
        return dict(position=s.x, power=s.F * s.v)


class Ball(Component):
    """Ball on a floor: free fall, and v = -e v when it reaches the floor."""

    g = parameter(9.81, "m/s2", "gravity")
    e = parameter(0.8, "1", "restitution")
    push = input("m/s2", "acceleration from outside, upwards")
    height = state(0.2, "m", "height of the ball")
    speed = state(0.0, "m/s", "its speed upwards")
    bounces = state(0.0, "1", "how often it met the floor")
    floor = event("the ball meets the floor", announce=True)
    gap = output("m", "height of the ball")
    count = output("1", "how often it met the floor")

    def derivatives(s):
        return dict(height=s.speed, speed=s.push - s.g, bounces=0)

    def crossings(s):
        return dict(floor=s.height)

    def jump(s):
        down = s.crossed.floor < 0
        return dict(speed=ca.if_else(down, -s.e * s.speed, s.speed), bounces=s.bounces + ca.if_else(down, 1, 0))

    def outputs(s):
        return dict(gap=s.height, count=s.bounces)


class Sampled(Component):
    """Proportional-integral controller, sampled: its output is held between the ticks."""

    period = parameter(0.003, "s", "sample period")
    gain = parameter([2.0, 3.0], "N/m", "proportional gain of each channel")
    reset = parameter(0.1, "s", "integral time")
    error = input("m", "what to bring to zero", shape=2)
    sum = state([0.0, 0.0], "m.s", "integral of the sampled error")
    held = state([0.0, 0.0], "N", "force since the last tick")
    force = output("N", "force", shape=2)

    def sync(s):
        total = s.sum + s.period * s.error
        return dict(sum=total, held=s.gain * (s.error + total / s.reset))

    def outputs(s):
        return dict(force=s.held)


class Flow(Component):
    """Harmonic oscillator, advanced exactly: (x, v/w) turns by w h."""

    w = parameter(40.0, "rad/s", "angular frequency")
    a = input("m/s2", "acceleration from outside, held over a step")
    x = state(1.0, "m", "position")
    v = state(0.0, "m/s", "velocity")
    y = output("m", "position")

    def flow(s):
        rest = s.a / s.w**2
        c, d = ca.cos(s.w * s.dt), ca.sin(s.w * s.dt)
        return dict(x=rest + (s.x - rest) * c + s.v / s.w * d, v=-(s.x - rest) * s.w * d + s.v * c)

    def outputs(s):
        return dict(y=s.x)


class Road(Component):
    """Two points riding on a road given as straight pieces (x, height, slope)."""

    pieces = table(3, "start, height there and slope of each piece", start=[[-1e9, 0, 0], [1.0, 0, 0.5], [2.0, 0.5, 0]])
    speed = input("m/s", "speed of both points", start=1.0)
    offset = parameter(0.7, "m", "how far the second point is behind the first")
    x = state(0.0, "m", "position of the first point")
    height = output("m", "height of each point", shape=2)
    climbed = output("m", "height of the first point above the second")

    def lookups(s):
        return dict(pieces=[s.x, s.x - s.offset])

    def derivatives(s):
        return dict(x=s.speed)

    def outputs(s):
        x = ca.vertcat(s.x, s.x - s.offset)
        height = s.pieces[:, 1] + s.pieces[:, 2] * ca.if_else(s.pieces[:, 0] > -1e8, x - s.pieces[:, 0], 0)
        return dict(height=height, climbed=height[0] - height[1])


class Matrices(Component):
    """Matrix ports: Z' = A Z - Z + B, C = A B."""

    A = input("1/s", "square matrix", shape=(2, 2), start=[[0.0, 1.0], [-2.0, -0.5]])
    B = input("m/s", "wide matrix", shape=(2, 3))
    weight = parameter([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]], "1", "weight of each element of C")
    Z = state(np.arange(6.0).reshape(2, 3), "m", "state matrix")
    C = output("m/s2", "weighted product", shape=(2, 3))
    total = output("m", "sum of the state")

    def derivatives(s):
        return dict(Z=s.A @ s.Z + s.B)

    def outputs(s):
        return dict(C=s.weight * (s.A @ s.B), total=ca.sum1(ca.sum2(s.Z)))


class Mathematics(Component):
    """Every mathematical function that equations may use: they have to be there in any build."""

    x = input("1", "argument", start=0.3)
    y = input("1", "second argument", start=0.4)
    value = output("1", "all of them", shape=27)

    def outputs(s):
        x, y = s.x, s.y
        inside = x / (1 + x * x)  # in (-1, 1)
        one = (ca.sin, ca.cos, ca.tan, ca.atan, ca.sinh, ca.cosh, ca.tanh, ca.asinh, ca.exp, ca.expm1,
               ca.floor, ca.ceil, ca.fabs, ca.sign, ca.erf)  # fmt: skip
        limited = (ca.asin(inside), ca.acos(inside), ca.atanh(inside), ca.acosh(1 + x * x), ca.sqrt(x * x),
                   ca.log(1 + x * x), ca.log1p(x * x))  # fmt: skip
        two = (ca.atan2(x, y), ca.fmod(x, 0.7), ca.hypot(x, y), ca.fmax(x, y), (1 + x * x) ** y)
        return dict(value=ca.vertcat(*(f(x) for f in one), *limited, *two))


class Delayed(Component):
    """A state set at the begin of each step, and its integral from there: what a wheel does with the body's gap."""

    seen = input("m", "position at the begin of the step", start=0.5)
    x = state(0.0, "m", "position")
    impulse = state(0.0, "m.s", "integral of the position since the step began")
    low = event("the position changes its sign", announce=True)
    mean = output("m.s", "integral of the position over the last step")

    def sync(s):
        return dict(x=s.seen, impulse=0)

    def derivatives(s):
        return dict(x=-1.0, impulse=s.x)

    def crossings(s):
        return dict(low=s.x)

    def outputs(s):
        return dict(mean=s.impulse)


@dataclass(frozen=True)
class Specimen:
    """A component and where to look at it: inputs and states around these values, steps of this length."""

    component: Component
    step: float = 0.01  # s
    steps: int = 20
    around: dict[str, Any] = field(default_factory=dict)
    spread: float = 0.3  # standard deviation of what is added, and relative to what is there

    def values(self, rng: np.random.Generator) -> dict[str, np.ndarray]:
        """Return random inputs and states."""
        found = {}
        for name, d in self.component.declarations.items():
            if d.role in ("input", "state"):
                variable = self.component.variables[name]
                centre = np.broadcast_to(np.asarray(self.around.get(name, variable.start), float), variable.shape)
                noise = rng.standard_normal((2, *variable.shape))
                own = 0 if name in self.around else self.spread * noise[0]
                found[name] = centre * (1 + self.spread * noise[1]) + own
        return found
