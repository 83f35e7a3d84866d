"""The Python instance: values by name, sampling, derivatives."""

import numpy as np
import pytest
from toys import Gain, Mass, Sampled, Spring

from cosim import StepError, WiringError

MS = 1_000_000


def test_values_are_set_and_got_by_name() -> None:
    instance = Spring(k=3.0).instance("spring")
    assert instance.get("k") == 3.0
    instance.set("k", 5.0)
    instance.set("x", 2.0)
    assert instance.u[instance.u_at["x"]] == 2.0
    assert instance.get("F") == -10.0


def test_what_cannot_be_set_is_named() -> None:
    instance = Spring().instance("spring")
    with pytest.raises(WiringError) as caught:
        instance.set("F", 1.0)
    assert str(caught.value) == "spring.F cannot be set: it is computed"
    with pytest.raises(WiringError) as caught:
        instance.set("kk", 1.0)
    assert str(caught.value) == "spring has no variable 'kk'; did you mean 'k'?"
    with pytest.raises(WiringError) as caught:
        instance.set("k", [1.0, 2.0])
    assert str(caught.value) == "spring.k has shape [], but was given [2]"


def test_an_input_that_is_no_number_is_named_with_its_time() -> None:
    instance = Gain().instance("gain")
    instance.enter_initialization(0)
    instance.exit_initialization()
    instance.u[0] = np.nan
    instance.push()
    with pytest.raises(StepError) as caught:
        instance.step(2 * MS, 3 * MS)
    assert str(caught.value) == "gain failed at t = 0.002 s: input u is nan"


@pytest.mark.parametrize(("start", "end", "ticks"), [(0, 10, 2), (5, 10, 1), (1, 5, 0), (1, 6, 1), (4, 26, 5)])
def test_every_tick_inside_a_long_step_is_executed(start: int, end: int, ticks: int) -> None:
    """Ticks are the multiples of 5 ms in [start, end): the one at the end belongs to the next step."""
    instance = Sampled(period=5e-3).instance()
    instance.enter_initialization(start * MS)
    instance.exit_initialization()
    instance.step(start * MS, end * MS)
    assert instance.get("count") == ticks


def test_directional_derivatives_are_those_of_the_equations() -> None:
    spring = Spring(k=3.0, d=0.5).instance()
    np.testing.assert_allclose(spring.directional_derivative(["F"], ["x", "v"], np.array([1.0, 2.0])), [-4.0])
    mass = Mass().instance()
    np.testing.assert_allclose(
        mass.directional_derivative(["vel", "pos"], ["x", "v"], np.array([1.0, 2.0])), [2.0, 1.0]
    )
