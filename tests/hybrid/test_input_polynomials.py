"""Inputs that are polynomials within a step: FMI 2.0's derivatives, FMI 3.0's intermediate update, and Python's."""

from __future__ import annotations

import numpy as np
import pytest

import fmus
from cosim import Component, Instance, WiringError, input, output, state

MS = 1_000_000  # ns


class Integral(Component):
    """Integrates its inputs, and lets them through."""

    u = input("m/s", "rate", shape=2)
    w = input("1/s", "another rate", start=3.0)
    x = state([0.0, 0.0], "m", "integral of u", nominal=1e-3)
    z = state(0.0, "1", "integral of w", nominal=1e-3)
    pos = output("m", "integral of u", shape=2)
    turns = output("1", "integral of w")
    seen = output("m/s", "the rate, at once", shape=2)

    def derivatives(s):
        return dict(x=s.u, z=s.w)

    def outputs(s):
        return dict(pos=s.x, turns=s.z, seen=s.u)


KINDS = ["python", "fmi2", "fmi3", "isolated"]


def made(kind: str) -> Instance:
    if kind == "python":
        instance: Instance = Integral().instance()
    else:
        isolated = kind == "isolated"
        instance = fmus.instantiate(Integral(), fmi=2 if kind == "fmi2" else 3, smooth=True, isolated=isolated)
    instance.enter_initialization()
    instance.exit_initialization()
    return instance


def get(instance: Instance, name: str) -> np.ndarray:
    instance.pull()
    return instance.y[instance.y_at[name]].copy()


def start(instance: Instance, u: list[float], *derivatives: list[float]) -> None:
    instance.u[:] = [*u, 3.0]
    instance.push()
    if derivatives:
        instance.set_input_derivatives([np.array([*d, 0.0]) for d in derivatives])


@pytest.mark.parametrize("kind", KINDS)
def test_a_polynomial_is_integrated_over_the_step(kind: str) -> None:
    """Both pairs of Runge and Kutta integrate a parabola exactly; what is left is rounding."""
    instance, h = made(kind), 0.1
    assert instance.can.input_derivatives == 2
    start(instance, [1.0, -2.0], [10.0, 0.5], [-30.0, 4.0])
    instance.step(0, 100 * MS)
    u, d1, d2 = np.array([[1.0, -2.0], [10.0, 0.5], [-30.0, 4.0]])
    np.testing.assert_allclose(get(instance, "pos"), h * u + h**2 / 2 * d1 + h**3 / 6 * d2, rtol=1e-13)
    np.testing.assert_allclose(get(instance, "seen"), u + h * d1 + h**2 / 2 * d2, rtol=1e-13)
    np.testing.assert_allclose(get(instance, "turns"), 0.3, rtol=1e-13)
    instance.close()


@pytest.mark.parametrize("kind", KINDS)
def test_the_polynomial_begins_where_the_step_does_and_holds_for_it_only(kind: str) -> None:
    instance, h = made(kind), 0.1
    start(instance, [1.0, 1.0], [10.0, 0.0])
    instance.step(0, 100 * MS)
    start(instance, [2.0, 2.0], [20.0, 0.0])
    instance.step(100 * MS, 200 * MS)
    start(instance, [3.0, 3.0])
    instance.step(200 * MS, 300 * MS)
    np.testing.assert_allclose(get(instance, "pos")[0], 0.1 + 0.05 + 0.2 + 20 * h**2 / 2 + 0.3, rtol=1e-13)
    np.testing.assert_allclose(get(instance, "seen"), [3.0, 3.0])
    instance.close()


@pytest.mark.parametrize("kind", KINDS)
def test_a_step_taken_back_is_repeated_to_the_bit(kind: str) -> None:
    instance = made(kind)
    start(instance, [1.0, -2.0], [10.0, 0.5], [-30.0, 4.0])
    saved = instance.snapshot()
    instance.step(0, 70 * MS)
    once = get(instance, "pos")
    for derivatives in ([], [[5.0, 5.0]]):
        instance.restore(saved)
        start(instance, [0.3, 0.4], *derivatives)
        instance.step(0, 30 * MS)
        instance.restore(saved)
        start(instance, [1.0, -2.0], [10.0, 0.5], [-30.0, 4.0])
        instance.step(0, 70 * MS)
        np.testing.assert_array_equal(get(instance, "pos"), once)
    instance.forget(saved)
    instance.close()


def test_without_being_asked_fmi3_takes_none() -> None:
    instance = fmus.instantiate(Integral(), "integral", fmi=3)
    assert instance.can.input_derivatives == 0
    with pytest.raises(WiringError, match="integral takes no derivatives of its inputs, not 1"):
        instance.set_input_derivatives([np.zeros(3)])
    instance.close()


@pytest.mark.parametrize("kind", KINDS)
def test_more_than_two_are_refused(kind: str) -> None:
    instance = made(kind)
    with pytest.raises(WiringError, match="takes 2 derivatives of its inputs, not 3"):
        instance.set_input_derivatives([np.zeros(3)] * 3)
    instance.close()
