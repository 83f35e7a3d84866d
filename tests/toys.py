"""Small components and instances with known answers, for the tests of the master."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from cosim import (
    Advance,
    Capabilities,
    Component,
    Instance,
    Observer,
    Point,
    RunInfo,
    Summary,
    System,
    Variable,
    event,
    input,
    output,
    parameter,
    state,
)


class Mass(Component):
    """m v' = F, exact for a force held over the step."""

    m = parameter(1.0, "kg", "mass")
    F = input("N", "force")
    x = state(1.0, "m", "position")
    v = state(0.0, "m/s", "velocity")
    pos = output("m", "position")
    vel = output("m/s", "velocity")

    def flow(s):
        a = s.F / s.m
        return dict(x=s.x + s.dt * s.v + s.dt**2 / 2 * a, v=s.v + s.dt * a)

    def outputs(s):
        return dict(pos=s.x, vel=s.v)


class Spring(Component):
    """F = -k x - d v: a direct feedthrough."""

    k = parameter(4.0, "N/m", "stiffness")
    d = parameter(0.0, "N.s/m", "damping")
    x = input("m", "elongation")
    v = input("m/s", "elongation rate")
    F = output("N", "force on the body at its end")

    def outputs(s):
        return dict(F=-s.k * s.x - s.d * s.v)


class Position(Component):
    """x' = v."""

    v = input("m/s", "velocity")
    x = state(0.0, "m", "position")
    pos = output("m", "position")

    def flow(s):
        return dict(x=s.x + s.dt * s.v)

    def outputs(s):
        return dict(pos=s.x)


class Velocity(Component):
    """v' = -w^2 x."""

    w = parameter(2.0, "rad/s", "natural frequency")
    x = input("m", "position")
    v = state(1.0, "m/s", "velocity")
    vel = output("m/s", "velocity")

    def flow(s):
        return dict(v=s.v - s.dt * s.w**2 * s.x)

    def outputs(s):
        return dict(vel=s.v)


class Gain(Component):
    """y = k u, at once."""

    k = parameter(2.0, "1", "gain")
    u = input("1", "what goes in")
    y = output("1", "what comes out")

    def outputs(s):
        return dict(y=s.k * s.u)


class Watch(Component):
    """Tells its own time, and remembers the input and the time at which its last step began."""

    u = input("s", "what is seen")
    seen = state(-1.0, "s", "the input of the last step")
    began = state(-1.0, "s", "time at the begin of the last step")
    y = output("s", "own time")
    saw = output("s", "the input of the last step")
    since = output("s", "begin of the last step")

    def sync(s):
        return dict(seen=s.u, began=s.time)

    def outputs(s):
        return dict(y=s.time, saw=s.seen, since=s.began)


class Sampled(Component):
    """Counts the ticks of its period."""

    period = parameter(0.01, "s", "sample period")
    n = state(0.0, "1", "ticks so far")
    count = output("1", "ticks so far")

    def sync(s):
        return dict(n=s.n + 1)

    def outputs(s):
        return dict(count=s.n)


class Alarm(Component):
    """Integrates its input and announces each time that the integral passes another multiple of *at*."""

    at = parameter(0.3, "1", "distance between alarms")
    rate = input("1/s", "rate of the integral", start=1.0)
    x = state(0.0, "1", "integral")
    n = state(0.0, "1", "alarms so far")
    bell = event("the next multiple of at is reached", announce=True)
    total = output("1", "integral")
    count = output("1", "alarms so far")

    def derivatives(s):
        return dict(x=s.rate, n=0)

    def crossings(s):
        return dict(bell=s.x - s.at * (s.n + 1))

    def jump(s):
        return dict(n=s.n + ca.if_else(s.crossed.bell > 0, 1, 0))

    def outputs(s):
        return dict(total=s.x, count=s.n)


class Ball(Component):
    """A ball in free fall over a floor at height 0: v = -e v where it touches."""

    g = parameter(9.81, "m/s2", "gravity")
    e = parameter(0.8, "1", "restitution")
    z = state(1.0, "m", "height")
    v = state(0.0, "m/s", "velocity, upwards")
    touch = event("the ball touches the floor", announce=True)
    height = output("m", "height")
    speed = output("m/s", "velocity, upwards")

    def derivatives(s):
        return dict(z=s.v, v=-s.g)

    def crossings(s):
        return dict(touch=s.z)

    def jump(s):
        down = s.crossed.touch < 0
        return dict(z=ca.if_else(down, 0, s.z), v=ca.if_else(down, -s.e * s.v, s.v))

    def outputs(s):
        return dict(height=s.z, speed=s.v)


class Fading(Component):
    """x' = log(end - t): there is no such number after the end."""

    end = parameter(1.0, "s", "when it ends")
    x = state(1.0, "m", "position")
    y = output("m", "position")

    def derivatives(s):
        return dict(x=ca.log(s.end - s.time))

    def outputs(s):
        return dict(y=s.x)


class Scripted(Instance):
    """An instance written by hand, as a foreign FMU might be: any variables, any capabilities, any misbehaviour.

    Its outputs repeat its inputs of the same type and position; *script* maps the number of a step (from 1) to what
    happens in it: an exception to raise, or a function of (start, end) that returns the Advance.
    """

    def __init__(self, variables: list[Variable], script: dict[int, Any] | None = None, **can: bool) -> None:
        super().__init__("Scripted", {v.name: v for v in variables})
        self.can = Capabilities(**can)
        self.script = script or {}
        self.steps = 0
        self.closed = False
        self.values = {v.name: v.start for v in variables if v.type != "Float64"}

    def set(self, name: str, value: Any) -> None:
        self.values[name] = value

    def get(self, name: str) -> Any:
        return self.values[name]

    def enter_initialization(self, start: int = 0, stop: int | None = None, tolerance: float | None = None) -> None:
        self.span = (start, stop, tolerance)

    def exit_initialization(self) -> None:
        pass

    def push(self) -> None:
        self.held = self.u.copy()

    def pull(self) -> None:
        n = min(len(self.y), len(self.u))
        self.y[:n] = self.held[:n] if hasattr(self, "held") else 0
        inputs = [v for v in self.variables.values() if v.causality == "input" and v.type != "Float64"]
        outputs = [v for v in self.variables.values() if v.causality == "output" and v.type != "Float64"]
        for source, target in zip(inputs, outputs, strict=False):
            self.values[target.name] = self.values[source.name]

    def step(self, start: int, end: int, *, early_return: bool = False) -> Advance:
        self.steps += 1
        act = self.script.get(self.steps)
        if isinstance(act, BaseException):
            raise act
        return act(start, end) if act else Advance(end)

    def snapshot(self) -> Any:
        return self.u.copy()

    def restore(self, snapshot: Any) -> None:
        self.u[:] = snapshot

    def serialize(self, snapshot: Any) -> bytes:
        return bytes(snapshot)

    def deserialize(self, data: bytes) -> Any:
        return np.frombuffer(data)

    def directional_derivative(self, unknowns: list[str], knowns: list[str], seed: np.ndarray) -> np.ndarray:
        raise NotImplementedError

    def close(self) -> None:
        self.closed = True


def port(name: str, causality: str, type: str = "Float64", **about: Any) -> Variable:
    """Return a variable for ``Scripted``: dimensionless if Float64, starting at 0."""
    known = {"unit": "1" if type == "Float64" else None, "start": 0.0 if type == "Float64" else None, "depends_on": ()}
    return Variable(name, causality, type, **{**known, **about})


def silent(**can: bool) -> Scripted:
    """Return an instance without ports."""
    return Scripted([], **can)


class Journal(Observer):
    """Writes down all that a run tells, in its order."""

    def __init__(self) -> None:
        self.entries: list[tuple[Any, ...]] = []

    def started(self, system: System, info: RunInfo) -> None:
        self.entries.append(("started", info))

    def accepted(self, point: Point) -> None:
        self.entries.append(("accepted", point.number, point.start, point.end))

    def rejected(self, start: int, end: int, reached: int, component: str) -> None:
        self.entries.append(("rejected", start, end, reached, component))

    def event(self, time: int, component: str) -> None:
        self.entries.append(("event", time, component))

    def finished(self, summary: Summary) -> None:
        self.entries.append(("finished", summary.steps, summary.rejected, summary.events))

    def failed(self, error: BaseException) -> None:
        self.entries.append(("failed", str(error)))
