"""The Python instance's integrator: accuracy follows the tolerance, events lie where closed forms say."""

from math import cos, sqrt
from typing import Any

import casadi as ca
import numpy as np
import pytest
from toys import Ball

from cosim import Component, StepError, event, input, output, parameter, state

S = 1_000_000_000  # ns


class Oscillator(Component):
    """x'' = -w^2 x."""

    w = parameter(3.0, "rad/s", "natural frequency")
    x = state(1.0, "m", "position")
    v = state(0.0, "m/s", "velocity")
    y = output("m", "position")

    def derivatives(s: Any) -> dict[str, Any]:
        return dict(x=s.v, v=-(s.w**2) * s.x)

    def outputs(s: Any) -> dict[str, Any]:
        return dict(y=s.x)


def value(component: Component, port: str, stop: int, tolerance: float) -> float:
    instance = component.instance()
    instance.enter_initialization(0, stop, tolerance)
    instance.exit_initialization()
    instance.step(0, stop)
    return float(instance.get(port))


@pytest.mark.parametrize("tolerance", [1e-5, 1e-8, 1e-11])
def test_the_error_follows_the_tolerance(tolerance: float) -> None:
    # A local error of tol per unit of state and some ten steps over five periods; the global one stays below 100 tol.
    error = abs(value(Oscillator(), "y", 10 * S, tolerance) - cos(30))
    assert error < 100 * tolerance


def test_a_loose_tolerance_is_a_looser_result() -> None:
    errors = [abs(value(Oscillator(), "y", 10 * S, tolerance) - cos(30)) for tolerance in (1e-4, 1e-7, 1e-10)]
    assert errors[0] > 10 * errors[1] > 100 * errors[2]


def test_a_bouncing_ball_follows_its_closed_form() -> None:
    """Parabolas between touches at t_1 = sqrt(2 z_0 / g), each flight e times the one before."""
    g, e, z0 = 9.81, 0.8, 1.0
    t1 = sqrt(2 * z0 / g)
    speed = sqrt(2 * g * z0)
    instance = Ball(g=g, e=e).instance()
    instance.enter_initialization(0, 2 * S)
    instance.exit_initialization()
    instance.step(0, 2 * S)
    touch, flight = t1, 2 * e * t1
    k = 1
    while touch + flight < 2.0:
        touch += flight
        flight *= e
        k += 1
    since = 2.0 - touch
    upwards = speed * e**k
    assert k == 3
    # Parabolas are integrated exactly; each touch is located to an ulp, about 1e-16 s.
    assert instance.get("height") == pytest.approx(upwards * since - g * since**2 / 2, abs=1e-12)
    assert instance.get("speed") == pytest.approx(upwards - g * since, abs=1e-12)


def test_one_long_step_and_many_short_ones_agree() -> None:
    one, many = (Ball().instance() for _ in range(2))
    for instance in (one, many):
        instance.enter_initialization(0)
        instance.exit_initialization()
    one.step(0, S)
    for k in range(100):
        many.step(k * S // 100, (k + 1) * S // 100)
    assert many.get("height") == pytest.approx(one.get("height"), abs=1e-12)


def test_an_announced_event_ends_the_step_at_its_tick() -> None:
    instance = Ball().instance()
    instance.enter_initialization(0)
    instance.exit_initialization()
    advance = instance.step(0, S, early_return=True)
    t1 = sqrt(2 / 9.81)
    assert advance.early
    assert 0 <= advance.reached - t1 * 1e9 < 1
    assert instance.get("speed") == pytest.approx(0.8 * sqrt(2 * 9.81), rel=1e-12)


def test_the_same_step_up_to_the_event_says_that_it_is_passed() -> None:
    instance = Ball().instance()
    instance.enter_initialization(0)
    instance.exit_initialization()
    before = instance.snapshot()
    reached = instance.step(0, S, early_return=True).reached
    instance.restore(before)
    again = instance.step(0, reached, early_return=True)
    assert (again.reached, again.early) == (reached, True)
    instance.restore(before)
    assert not instance.step(0, reached - 1, early_return=True).early


class Delayed(Component):
    """Two indicators inside one integrator step: x falls from 1 as exp(-t); rings at 1/2 and at 1/4."""

    x = state(1.0, "1", "what decays")
    rung = state(0.0, "1", "order in which the bells rang, as decimals", shape=2)
    count = state(0.0, "1", "bells so far")
    bell = event("x passes 1/2, 1/4", shape=2)
    y = output("1", "times of the bells", shape=2)

    def derivatives(s: Any) -> dict[str, Any]:
        return dict(x=-s.x, rung=ca.SX.zeros(2), count=0)

    def crossings(s: Any) -> dict[str, Any]:
        return dict(bell=ca.vertcat(s.x - 0.25, s.x - 0.5))

    def jump(s: Any) -> dict[str, Any]:
        return dict(rung=ca.if_else(s.crossed.bell != 0, s.time, s.rung), count=s.count + 1)

    def outputs(s: Any) -> dict[str, Any]:
        return dict(y=s.rung)


def test_two_indicators_are_found_in_the_order_of_time() -> None:
    instance = Delayed().instance()
    instance.enter_initialization(0, tolerance=1e-10)
    instance.exit_initialization()
    instance.step(0, 3 * S)
    # x is known to 1e-10 times a few steps, so are the times (x' = -x = -1/4 at the later one)
    np.testing.assert_allclose(instance.get("y"), [np.log(4), np.log(2)], atol=1e-8)
    assert instance.get("count") == 2


class Explosion(Component):
    """x' = x^2 from x = 1 is infinite at t = 1."""

    u = input("1/s", "factor", start=1.0)
    x = state(1.0, "1", "what explodes")
    y = output("1", "what explodes")

    def derivatives(s: Any) -> dict[str, Any]:
        return dict(x=s.u * s.x**2)

    def outputs(s: Any) -> dict[str, Any]:
        return dict(y=s.x)


def test_a_solution_that_ends_is_an_error_with_its_time() -> None:
    instance = Explosion().instance("bomb")
    instance.enter_initialization(0)
    instance.exit_initialization()
    with pytest.raises(StepError) as caught, np.errstate(all="ignore"):
        instance.step(0, 2 * S)
    assert caught.value.component == "bomb"
    assert caught.value.time == pytest.approx(1.0, abs=1e-3)
