"""What depends on parameters and the step length alone: computed when these change, in Python and in an FMU."""

from __future__ import annotations

from math import exp
from typing import Any

import casadi as ca
import numpy as np
import pytest

import fmus
from cosim import Component, DeclarationError, Instance, output, parameter, state

S = 1_000_000_000  # ns


class Fading(Component):
    """x' = -w x, exact, shown by a matrix of parameters."""

    w = parameter(2.0, "1/s", "rate")
    A = parameter([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]], "1", "what is shown of it", shape=(2, 3))
    x = state(1.0, "m", "position")
    shown = output("m", "the sums of the rows, times the position", shape=2)
    swapped = output("m", "the transposed matrix, times the position", shape=(3, 2))

    def constants(s: Any) -> dict[str, Any]:
        return {"decay": ca.exp(-s.w * s.dt), "sums": s.A @ ca.DM.ones(3), "turned": s.A.T}

    def flow(s: Any) -> dict[str, Any]:
        return dict(x=s.decay * s.x)

    def outputs(s: Any) -> dict[str, Any]:
        return dict(shown=s.sums * s.x, swapped=s.turned * s.x)


def instances(component: Component) -> list[Instance]:
    return [component.instance(), *(fmus.instantiate(component, fmi=version) for version in (2, 3))]


def begin(instance: Instance) -> None:
    instance.enter_initialization(0, S)
    instance.exit_initialization()


@pytest.mark.parametrize("which", range(3))
def test_they_follow_parameters_and_step_length(which: int) -> None:
    instance = instances(Fading())[which]
    for w, A in ((2.0, np.arange(1.0, 7.0).reshape(2, 3)), (5.0, np.ones((2, 3)))):
        instance.set("w", w)
        instance.set("A", A)
        begin(instance)
        now = 0
        for step in (100_000_000, 100_000_000, 50_000_000, 100_000_000):
            instance.step(now, now + step)
            now += step
            instance.pull()
            x = exp(-w * now / S)
            np.testing.assert_allclose(instance.get("shown"), A.sum(axis=1) * x, rtol=1e-14)
            np.testing.assert_allclose(instance.get("swapped"), A.T * x, rtol=1e-14)
        instance = instances(Fading())[which]


def test_a_state_saved_with_other_parameters_brings_its_own() -> None:
    one, other = (fmus.instantiate(Fading(w=w)) for w in (2.0, 5.0))
    for instance in (one, other):
        begin(instance)
        instance.step(0, S // 10)
    other.restore(other.deserialize(one.serialize(one.snapshot())))
    other.step(S // 10, S // 5)
    other.pull()
    assert other.get("shown")[0] == pytest.approx(6 * exp(-0.4), rel=1e-14)


@pytest.mark.parametrize(
    ("returned", "sentence"),
    [
        (lambda s: {"decay": s.x}, "Odd.constants: the equations read s.x, which is not declared"),
        (lambda s: {"w": 1 / s.w}, "Odd.constants returned 'w', which is declared"),
        (lambda s: s.w, "Odd.constants returned SX; return a dict"),
    ],
)
def test_what_cannot_be_constant_is_refused(returned: Any, sentence: str) -> None:
    Odd = type("Odd", (Fading,), {"constants": staticmethod(returned)})
    with pytest.raises(DeclarationError, match=sentence.replace("(", r"\(")):
        _ = Odd().equations
