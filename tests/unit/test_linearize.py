"""Linear systems from components: exact matrices, named signals."""

from math import cos
from typing import Any

import casadi as ca
import numpy as np
import pytest
from toys import Mass

from controllers.actuator import Actuator
from controllers.sensor import Sensor
from cosim import Component, DeclarationError, input, output, parameter, state
from cosim.linearize import linearize
from plants.chassis_modal import ChassisModal


class Pendulum(Component):
    """l a'' = -g sin a - d a' + u, two equal outputs of a and one of u."""

    g = parameter(9.81, "m/s2", "gravity")
    length = parameter(0.5, "m", "length")
    d = parameter(0.1, "m/s", "damping")
    u = input("m/s2", "push")
    angle = state(0.3, "rad", "angle")
    rate = state(0.0, "rad/s", "angular rate")
    y = output("rad", "the angle, twice", shape=2)
    through = output("m/s2", "three times the push")

    def derivatives(s: Any) -> dict[str, Any]:
        return dict(angle=s.rate, rate=(-s.g * ca.sin(s.angle) - s.d * s.rate + s.u) / s.length)

    def outputs(s: Any) -> dict[str, Any]:
        return dict(y=ca.vertcat(s.angle, s.angle), through=3 * s.u)


def test_the_matrices_are_the_derivatives_at_the_point() -> None:
    system = linearize(Pendulum())
    np.testing.assert_allclose(system.A, [[0, 1], [-9.81 * cos(0.3) / 0.5, -0.2]], rtol=1e-14)
    np.testing.assert_allclose(system.B, [[0], [2]], rtol=1e-14)
    np.testing.assert_array_equal(system.C, [[1, 0], [1, 0], [0, 0]])
    np.testing.assert_array_equal(system.D, [[0], [0], [3]])
    assert (system.state_labels, system.input_labels) == (["angle", "rate"], ["u"])
    assert system.output_labels == ["y[1]", "y[2]", "through"]


def test_an_instance_is_taken_where_it_is() -> None:
    instance = Pendulum().instance()
    instance.set("angle", 1.0)
    assert linearize(instance).A[1, 0] == pytest.approx(-9.81 * cos(1.0) / 0.5, rel=1e-14)


def test_without_derivatives_there_is_nothing_to_linearise() -> None:
    with pytest.raises(DeclarationError) as caught:
        linearize(Mass())
    assert str(caught.value) == (
        "Mass cannot be linearised: it does not declare the derivatives of its states; "
        "linearise a step of a system with it by cosim.step_map"
    )


class Integral(Component):
    """A sampled proportional-integral law: sum += T e, y = k (e + sum / T_i)."""

    period = parameter(0.1, "s", "sample period")
    k = parameter(3.0, "1", "gain")
    T_i = parameter(0.5, "s", "integral time")
    e = input("m", "error")
    sum = state(0.0, "m.s", "integral of the sampled error")
    held = state(0.0, "m", "output since the last tick")
    ticks = state(0.0, "1", "ticks so far", whole=True)
    y = output("m", "output")

    def sync(s: Any) -> dict[str, Any]:
        total = s.sum + s.period * s.e
        return dict(sum=total, held=s.k * (s.e + total / s.T_i), ticks=s.ticks + 1)

    def outputs(s: Any) -> dict[str, Any]:
        return dict(y=s.held)


def test_a_sampled_component_is_a_system_in_discrete_time() -> None:
    """From what it reads at a tick to what it shows after it: k (1 + T / T_i z / (z - 1))."""
    system = linearize(Integral())
    assert (system.dt, system.state_labels) == (0.1, ["sum", "held"])  # a count of ticks has no derivative
    z = np.exp(1j * np.array([0.1, 1.0, 3.0]))
    np.testing.assert_allclose(system(z), 3 * (1 + 0.1 / 0.5 * z / (z - 1)), rtol=1e-12)


def test_a_late_sensor_is_a_delay() -> None:
    system = linearize(Sensor(period=0.01, delay=3, noise=1.0))
    z = np.exp(1j * np.array([0.1, 1.0, 3.0]))
    started = Sensor(period=0.01, delay=3).instance()
    started.enter_initialization()
    started.exit_initialization()
    started.step(0, 10_000_000)
    np.testing.assert_allclose(linearize(started)(z), z**-3, rtol=1e-12)
    np.testing.assert_allclose(system(z), 1, rtol=1e-12)  # the first measurement fills the line, and is shown at once


def test_an_actuator_is_a_lag_within_its_limits_and_nothing_beyond() -> None:
    actuator = Actuator(lag=0.02, limit=2.0).instance()
    assert linearize(actuator)(1j * 50.0) == pytest.approx(1 / (1 + 1j))
    actuator.set("u", 3.0)
    assert linearize(actuator)(1j * 50.0) == 0


def test_modes_are_found_again() -> None:
    system = linearize(ChassisModal(modes=2, stations=1, frequency=[25.0, 40.0], damping=[0.1, 0.2]))
    w, zeta = 2 * np.pi * np.array([25.0, 40.0]), np.array([0.1, 0.2])
    upper = system.poles()[system.poles().imag > 0]
    np.testing.assert_allclose(np.sort_complex(upper), np.sort_complex(w * (-zeta + 1j * np.sqrt(1 - zeta**2))))
