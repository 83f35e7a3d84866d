"""What goes wrong is said in one sentence: with the variable, its value and the time."""

from __future__ import annotations

import locale

import numpy as np
import pytest
from specimens import Mass, Matrices, Road, Sampled
from test_twin_agreement import prepared

import fmus
from cosim import Component, StepError, event, output, parameter, state
from cosim.clock import NS


class Runaway(Component):
    """x' = x^2: x = 1/(1 - t), which no step reaches past t = 1 s."""

    x = state(1.0, "m", "position")
    y = output("m", "position")

    def derivatives(s):
        return dict(x=s.x**2)

    def outputs(s):
        return dict(y=s.x)


class Broken(Component):
    """x' = log(1 - t): not a number after 1 s."""

    x = state(1.0, "m", "position")
    y = output("m", "position")

    def derivatives(s):
        import casadi as ca

        return dict(x=ca.log(1 - s.time))

    def outputs(s):
        return dict(y=s.x)


class Chatter(Component):
    """Every event puts the state back onto the indicator's zero: the next one comes at once."""

    back = parameter(1e-13, "m", "how far the state is put back")
    x = state(-0.5, "m", "position")
    wall = event("the position is positive")
    y = output("m", "position")

    def derivatives(s):
        return dict(x=1.0)

    def crossings(s):
        return dict(wall=s.x)

    def jump(s):
        return dict(x=-s.back)

    def outputs(s):
        return dict(y=s.x)


def failure(fmi: int, component: Component) -> str:
    """Return what a component says that fails on its way to 2 s."""
    fmu = prepared(fmus.instantiate(component, "it", fmi=fmi), {})
    with pytest.raises(StepError) as found:
        fmu.step(0, 2 * NS)
    fmu.close()
    return str(found.value)


def test_nan_in_an_input(fmi: int) -> None:
    fmu = prepared(fmus.instantiate(Matrices(), "it", fmi=fmi), {})
    fmu.step(0, NS // 10)
    fmu.u[fmu.u_at["B"]] = [0, 1, 2, 3, np.nan, 5]
    fmu.push()
    with pytest.raises(StepError) as found:
        fmu.step(NS // 10, NS // 5)
    call = f"fmi{fmi}DoStep returned error"
    assert str(found.value) == f"it failed at t = 0.1 s: input B[2,2] is nan at t = 0.1 s ({call})"
    assert (found.value.component, found.value.time, found.value.call) == ("it", 0.1, call)


def test_infinity_in_an_input(fmi: int) -> None:
    fmu = prepared(fmus.instantiate(Mass(), "it", fmi=fmi), {})
    fmu.u[0] = -np.inf
    fmu.push()
    with pytest.raises(StepError, match="it failed at t = 0 s: input F is -inf at t = 0 s"):
        fmu.step(0, NS)


def test_divergence(fmi: int) -> None:
    said = failure(fmi, Runaway())
    assert said.startswith("it failed at t = 0 s: the integrator cannot go on at t = 1 s with x = ")
    # near the pole x = 1/(1 - t): the value it gives is the one where steps of some ulp of t no longer resolve it
    assert float(said.split("x = ")[1].split(":")[0]) > 1e6


def test_nan_in_a_derivative(fmi: int) -> None:
    said = failure(fmi, Broken())
    assert said.startswith("it failed at t = 0 s: the integrator cannot go on at t = 1 s with x = ")
    # x(1) = 1 + integral of log(1 - t) = 0
    assert abs(float(said.split("x = ")[1].split(":")[0])) < 1e-7


def test_events_without_end(fmi: int) -> None:
    said = failure(fmi, Chatter())
    assert said.startswith("it failed at t = 0 s: events without end at t = 0.5 s: more than 100 of wall within 1 ns")
    assert "x = -1e-13" in said


def test_a_period_of_nothing(fmi: int) -> None:
    assert failure(fmi, Sampled(period=0.0)) == (
        "it failed at t = 0 s: the sample period is 0 s at t = 0 s, but must be at least 1 ns "
        f"(fmi{fmi}DoStep returned error)"
    )


def test_a_step_from_another_time(fmi: int) -> None:
    fmu = prepared(fmus.instantiate(Mass(), "it", fmi=fmi), {})
    with pytest.raises(StepError, match=r"a step was asked for from t = 1 s, but the component is at t = 0 s"):
        fmu.step(NS, 2 * NS)


def test_a_step_of_nothing(fmi: int) -> None:
    fmu = prepared(fmus.instantiate(Mass(), "it", fmi=fmi), {})
    with pytest.raises(StepError, match=r"from t = 0 s to 0 s, but a step must be longer than nothing"):
        fmu.step(0, 0)


def test_a_parameter_after_the_initialisation(fmi: int) -> None:
    fmu = prepared(fmus.instantiate(Mass(), "it", fmi=fmi), {})
    with pytest.raises(StepError, match="k cannot be set at t = 0 s: it is fixed once the initialisation has ended"):
        fmu.set("k", 1.0)


def test_an_output_cannot_be_set(fmi: int) -> None:
    fmu = fmus.instantiate(Matrices(), "it", fmi=fmi)
    with pytest.raises(StepError, match=r"C\[1,1\] cannot be set: it is computed"):
        fmu.set("C", np.zeros((2, 3)))


def test_a_start_value_that_is_no_number(fmi: int) -> None:
    fmu = fmus.instantiate(Mass(), "it", fmi=fmi)
    fmu.set("k", np.nan)
    fmu.enter_initialization()
    with pytest.raises(StepError, match="start value k is nan at t = 0 s"):
        fmu.exit_initialization()


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("0 1 2;3 4", "table pieces: row 2 has 2 numbers, but needs 3"),
        ("0 1 2;0 4 5", "table pieces: row 2 does not ascend in its first column, by which rows are looked up"),
        ("0 1 2;1 4 five", "table pieces: row 2 holds 'five', which is not a finite number"),
        ("0 1 nan", "table pieces: row 1 holds 'nan', which is not a finite number"),
        ("0 1 1e999", "table pieces: row 1 holds '1e999', which is not a finite number"),
        ("0 0x10 1", "table pieces: row 1 holds '0x10', which is not a finite number"),
        ("0 1,5 1", "table pieces: row 1 holds '1,5', which is not a finite number"),
        (" ; ", "table pieces is empty: it needs at least one row of 3 numbers"),
    ],
)
def test_a_bad_table(text: str, said: str, fmi: int) -> None:
    fmu = fmus.instantiate(Road(), "it", fmi=fmi)
    with pytest.raises(StepError) as found:
        fmu.set("pieces", text)
    assert str(found.value) == f"it failed at t = 0 s: {said} (fmi{fmi}SetString returned error)"


def test_numbers_are_read_and_written_with_a_point_in_every_locale(fmi: int) -> None:
    old = locale.setlocale(locale.LC_NUMERIC)
    try:
        for name in ("de_DE.UTF-8", "fr_FR.UTF-8"):
            try:
                locale.setlocale(locale.LC_NUMERIC, name)
                break
            except locale.Error:
                continue
        else:
            pytest.skip("no locale with a decimal comma is installed")
        fmu = prepared(fmus.instantiate(Road(pieces=[[-1e9, 0.25, 0]]), "it", fmi=fmi), {})
        assert fmu.get("height")[0] == 0.25
        fmu.u[0] = np.nan
        fmu.push()
        fmu.time = 0.0
        with pytest.raises(StepError, match="input speed is nan"):
            fmu.step(0, NS // 2)
    finally:
        locale.setlocale(locale.LC_NUMERIC, old)
