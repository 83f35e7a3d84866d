"""Linear systems from components: exact matrices, named signals."""

from math import cos
from typing import Any

import casadi as ca
import numpy as np
import pytest
from toys import Mass

from cosim import Component, DeclarationError, input, output, parameter, state
from cosim.linearize import linearize


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
    assert str(caught.value) == "Mass cannot be linearised: it does not declare the derivatives of its states"
