"""Time is a whole number of nanoseconds."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cosim import ScenarioError
from cosim.clock import seconds, tick_at_or_after, ticks


@given(st.integers(min_value=1, max_value=10**15))
def test_a_tick_survives_the_way_through_seconds(n: int) -> None:
    # Below 1e15 ns (11 days) a float of seconds resolves 1.2e-10 s, so rounding finds the tick again.
    assert round(seconds(n) * 1e9) == n


@given(st.integers(min_value=1, max_value=10**12))
def test_a_tick_is_the_first_tick_at_or_after_itself(n: int) -> None:
    # Up to 1e12 ns (17 minutes) the spacing of floats is below 1.2e-4 ns, inside the slack of 1e-3 ns.
    assert tick_at_or_after(seconds(n)) == n


@pytest.mark.parametrize("value", [1e-4, 0.1, 0.3, 1e-9, 12.345678901])
def test_decimal_seconds_are_whole_ticks(value: float) -> None:
    assert ticks(value, "the step") == round(value * 1e9)


@pytest.mark.parametrize("value", [0.0, -1e-3, 1e-10, 1 / 3])
def test_what_is_no_whole_number_of_ticks_is_refused(value: float) -> None:
    with pytest.raises(ScenarioError) as caught:
        ticks(value, "the step")
    assert str(caught.value) == f"the step is {value!r} s, which is not a positive whole number of nanoseconds"


def test_an_event_is_met_at_the_first_tick_not_before_it() -> None:
    assert tick_at_or_after(1.0000001e-3) == 1_000_001
    assert tick_at_or_after(1e-3) == 1_000_000
