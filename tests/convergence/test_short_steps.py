"""FMUs between close communication points: fewer stages, the same accuracy, events and bits."""

from __future__ import annotations

from math import cos, sqrt
from typing import Any

import pytest
from toys import Ball

import fmus
from cosim import Component, Instance, event, output, parameter, state

S = 1_000_000_000  # ns


class Pendulum(Component):
    """x'' = -w^2 x, and the square of the time that its equations saw: what is quadratic, three stages have exactly."""

    w = parameter(3.0, "rad/s", "natural frequency")
    x = state(1.0, "m", "position")
    v = state(0.0, "m/s", "velocity")
    t3 = state(0.0, "s3", "cube of the time")
    y = output("m", "position")
    cube = output("s3", "cube of the time")

    def derivatives(s: Any) -> dict[str, Any]:
        return dict(x=s.v, v=-(s.w**2) * s.x, t3=3 * s.time**2)

    def outputs(s: Any) -> dict[str, Any]:
        return dict(y=s.x, cube=s.t3)


def ready(component: Component, tolerance: float = 1e-8) -> Instance:
    instance = fmus.instantiate(component)
    instance.enter_initialization(0, 2 * S, tolerance)
    instance.exit_initialization()
    return instance


def walk(instance: Instance, begin: int, end: int, step: int) -> None:
    for start in range(begin, end, step):
        instance.step(start, start + step)
    instance.pull()


@pytest.mark.parametrize("step", [10_000, 100_000, 1_000_000, 20_000_000])
@pytest.mark.parametrize("tolerance", [1e-6, 1e-8, 1e-10])
def test_the_error_follows_the_tolerance_whatever_the_step(step: int, tolerance: float) -> None:
    """A short step leaves a hundredth of the tolerance to its second order, and less than w h of that to its third.

    In a second of such steps that adds up to w / 100 of the tolerance; of others there are some ten, as in Python.
    """
    instance = ready(Pendulum(), tolerance)
    walk(instance, 0, S, step)
    assert abs(instance.get("y") - cos(3.0)) < 100 * tolerance
    assert instance.get("cube") == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("step", [10_000, 100_000, 7_000_000])
def test_a_ball_touches_the_floor_when_it_does(step: int) -> None:
    """Its parabola has no third derivative, so every step away from the floor is a short one."""
    g, z0, e = 9.81, 1.0, 0.8
    touch, speed = sqrt(2 * z0 / g), sqrt(2 * g * z0)
    instance = ready(Ball(g=g, e=e))
    end = -(-S // step) * step
    walk(instance, 0, end, step)
    since = end / S - touch
    assert instance.get("height") == pytest.approx(e * speed * since - g * since**2 / 2, abs=1e-9)
    assert instance.get("speed") == pytest.approx(e * speed - g * since, abs=1e-9)


def test_who_goes_back_takes_the_same_steps_again() -> None:
    instance = ready(Pendulum())
    walk(instance, 0, 20 * 50_000, 50_000)
    kept = instance.snapshot()
    found = []
    for _ in range(2):
        walk(instance, S // 1000, S // 1000 + 20 * 50_000, 50_000)
        found.append(instance.get("y"))
        instance.restore(kept)
    walk(instance, S // 1000, S // 2, 499_000_000)  # one that is not short, before it goes back
    instance.restore(kept)
    walk(instance, S // 1000, S // 1000 + 20 * 50_000, 50_000)
    assert found[0] == found[1] == instance.get("y")


class Twice(Component):
    """x' = 1 m/s: half a micrometre behind a mark at 0.11 m something begins that ends 4 um behind it."""

    x = state(0.0, "m", "way")
    met = state(0.0, "1", "how often it began or ended")
    mark = event("the mark is passed")
    inside = event("it begins or ends")
    y = output("1", "how often it began or ended")

    def derivatives(s: Any) -> dict[str, Any]:
        return dict(x=1, met=0)

    def crossings(s: Any) -> dict[str, Any]:
        way = s.x - 0.11
        return dict(mark=way, inside=(way - 0.5e-6) * (way - 4e-6))

    def jump(s: Any) -> dict[str, Any]:
        return dict(met=s.met + (s.crossed.inside != 0))

    def outputs(s: Any) -> dict[str, Any]:
        return dict(y=s.met)


@pytest.mark.parametrize("make", [fmus.instantiate, lambda component: component.instance()])
def test_what_a_short_step_saw_is_not_stepped_over(make: Any) -> None:
    """The step after the mark is 1 um long and ends inside; one ten times as long would end behind it all."""
    instance = make(Twice())
    instance.enter_initialization(0, S, 1e-8)
    instance.exit_initialization()
    walk(instance, 0, S // 5, S // 50)
    assert instance.get("y") == 2
