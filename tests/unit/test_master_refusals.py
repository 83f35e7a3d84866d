"""The master: which runs it refuses, and the sentence that says so."""

from typing import Any

import pytest
from toys import Sampled, Scripted, silent

from cosim import Advance, CosimError, GaussSeidel, Jacobi, System, run

MS = 1_000_000  # ns


def refused(system: System, algorithm: Any = None, **how: Any) -> str:
    with pytest.raises(CosimError) as caught:
        run(system, algorithm or Jacobi(), **{"step": MS, "stop": 10 * MS, **how})
    return str(caught.value)


@pytest.mark.parametrize(
    ("how", "sentence"),
    [
        (
            {"step": 1e-3, "stop": 2},
            "the run from 0 s to 2e-09 s is shorter than its step of 0.001 s "
            "(an int is in nanoseconds, a float in seconds)",
        ),
        ({"step": 1e-10}, "the step is 1e-10 s, which is not a positive whole number of nanoseconds"),
        ({"step": -5}, "the step is -5 ns; it must be positive"),
    ],
)
def test_spans_that_are_no_runs(how: dict[str, Any], sentence: str) -> None:
    assert refused(System({"a": silent()}, {}), **how) == sentence


def test_an_order_names_every_component_once() -> None:
    system = System({"a": silent(), "b": silent()}, {})
    assert refused(system, GaussSeidel(("a", "c"))) == "the order of GaussSeidel names no component 'c'; known: a, b"
    assert refused(system, GaussSeidel(("a",))) == (
        "the order of GaussSeidel names b 0 times; name every component once"
    )


def test_a_period_must_fit_the_step() -> None:
    sentence = (
        "c has a period of 0.0025 s, which is neither a multiple nor a whole fraction of its step of 0.001 s; "
        "choose a step that divides the period"
    )
    assert refused(System({"c": Sampled(period=2.5e-3).instance()}, {})) == sentence


@pytest.mark.parametrize(("period", "every", "ticks"), [(2e-3, 1, 5), (0.5e-3, 1, 20), (5e-3, 5, 2), (10e-3, 5, 1)])
def test_a_period_that_fits_ticks_as_often_as_it_should(period: float, every: int, ticks: int) -> None:
    system = System({"c": Sampled(period=period).instance()}, {}, every={"c": every})
    run(system, Jacobi(), step=MS, stop=10 * MS)
    assert system["c.count"] == ticks


def test_a_period_of_nothing_is_refused() -> None:
    assert refused(System({"c": Sampled(period=0.0).instance()}, {})) == (
        "the period of c is 0.0 s, which is not a positive whole number of nanoseconds"
    )


def test_a_component_with_fixed_steps_needs_whole_ones() -> None:
    assert refused(System({"a": silent(variable_step=False)}, {}), stop=10 * MS + 1) == (
        "a needs steps of equal length, but the run is no whole number of them; choose a stop time in steps of 0.001 s"
    )


def test_a_step_that_stops_early_unasked_is_an_error() -> None:
    lazy = Scripted([], {1: lambda start, end: Advance(end - 1, early=True)})
    assert refused(System({"a": lazy}, {})) == (
        "a was asked to step from 0.000000000 s to 0.001000000 s and stopped at 0.000999999 s "
        "without having been allowed to"
    )
