"""Inputs as polynomials within a step: orders against a closed form, exact to go back to, fresh after events."""

from __future__ import annotations

import warnings
from math import log2
from typing import Any

import casadi as ca
import numpy as np
import pytest
from toys import Mass, Scripted, Spring, port

import fmus
from cosim import (
    Component,
    CouplingError,
    Extrapolated,
    GaussSeidel,
    Iterated,
    Jacobi,
    Record,
    Richardson,
    System,
    event,
    input,
    output,
    run,
    state,
)
from cosim.attempt import Attempt
from studies.oscillator import START, STILL, LeftMass, RightMass, coupled, solution

S = 1_000_000_000  # ns


def made(part: Component, kind: str) -> Any:
    return part.instance() if kind == "python" else fmus.instantiate(part, fmi=int(kind[-1]), smooth=True)


def oscillator(kind: str = "python", start: tuple[float, ...] = START, **every: int) -> System:
    return coupled(made(LeftMass(d_wall=0.2), kind), made(RightMass(), kind), start, every=every)


def errors(
    algorithm: Any, steps: tuple[int, ...], kind: str = "python", start: Any = START, **every: int
) -> list[float]:
    """Return the largest error of both positions after 1 s, for numbers of steps."""
    exact, found = solution(LeftMass(d_wall=0.2), RightMass(), 1.0, start), []
    for n in steps:
        record = Record(["left.position", "right.position"])
        with oscillator(kind, start, **every) as system:
            run(system, algorithm, step=S // n, stop=S, observers=[record], tolerance=1e-11)
        found.append(max(abs(record["left.position"][-1] - exact[0]), abs(record["right.position"][-1] - exact[3])))
    return found


# With errors c h^p + d h^(p+1) one halving shows the order p + O(h d / c): up to 0.2 at h = 1/40 and w = 4 rad/s.
NEAR = 0.2


@pytest.mark.parametrize("kind", ["python", "fmi2", "fmi3"])
@pytest.mark.parametrize("degree", [0, 1, 2])
def test_jacobi_has_the_order_of_the_degree_and_one(degree: int, kind: str) -> None:
    found = errors(Extrapolated(Jacobi(), degree), (40, 80), kind, STILL)
    assert log2(found[0] / found[1]) == pytest.approx(degree + 1, abs=NEAR)


def test_held_inputs_in_the_first_step_limit_the_order_to_two() -> None:
    found = errors(Extrapolated(Jacobi(), 2), (40, 80), "fmi2")
    assert log2(found[0] / found[1]) == pytest.approx(2, abs=NEAR)


@pytest.mark.parametrize(("inner", "degree", "order"), [(GaussSeidel(), 1, 2), (Iterated(), 1, 2), (Iterated(), 2, 3)])
def test_interpolation_where_the_end_is_known(inner: Any, degree: int, order: int) -> None:
    """Iterated knows, in the first step, what is at its end: a parabola lacks one point there, at O(h^3)."""
    found = errors(Extrapolated(inner, degree), (40, 80), "fmi2")
    assert log2(found[0] / found[1]) == pytest.approx(order, abs=NEAR)


def test_a_slow_target_and_a_slow_source_keep_the_order() -> None:
    for slow in ("left", "right"):
        found = errors(Extrapolated(Jacobi(), 1), (160, 320), "fmi2", **{slow: 4})
        assert log2(found[0] / found[1]) == pytest.approx(2, abs=NEAR)


def test_halves_of_steps_are_extrapolated_from_where_they_begin() -> None:
    found = errors(Richardson(Extrapolated(Jacobi(), 1), order=2), (20, 40), "fmi2")
    assert log2(found[0] / found[1]) == pytest.approx(2, abs=NEAR)


@pytest.mark.parametrize("inner", [Jacobi(), GaussSeidel(), Iterated()], ids=lambda a: type(a).__name__)
def test_what_was_taken_back_leaves_no_trace(inner: Any) -> None:
    """Three steps, with and without another third one taken back, and a fourth: the same to the bit."""
    algorithm, found = Extrapolated(inner, 2), []
    for taken_back in (False, True):
        system = oscillator()
        sequence = algorithm.sequence(system)
        system.initialize(tolerance=1e-9)
        for k in range(4):
            if taken_back and k == 2:
                saved = system.save(sequence)
                algorithm.advance(Attempt(system, 2 * S // 10, 2 * S // 10 + S // 37, sequence, False))
                system.restore(saved, sequence)
                system.forget(saved)
            algorithm.advance(Attempt(system, k * S // 10, (k + 1) * S // 10, sequence, False))
        found.append(system.row.copy())
    np.testing.assert_array_equal(*found)


class Triangle(Component):
    """Goes up and down with slopes of 1 between 0 and 1, and announces where it turns."""

    y = state(0.0, "1", "value", nominal=1e-3)
    way = state(1.0, "1", "direction, 1 or -1")
    turn = event("it turns", announce=True)
    value = output("1", "value")

    def derivatives(s: Any) -> dict[str, Any]:
        return {"y": s.way / s_per_unit(), "way": 0}

    def crossings(s: Any) -> dict[str, Any]:
        return {"turn": ca.if_else(s.way > 0, 1 - s.y, s.y)}

    def jump(s: Any) -> dict[str, Any]:
        return {"way": ca.if_else(s.crossed.turn < 0, -s.way, s.way)}

    def outputs(s: Any) -> dict[str, Any]:
        return {"value": s.y}


def s_per_unit() -> float:
    """Return how long it takes from 0 to 1, in s: no whole number of steps of 0.1 s."""
    return 0.73


class Area(Component):
    """x' = u."""

    u = input("1", "rate")
    x = state(0.0, "s", "integral")
    total = output("s", "integral")

    def derivatives(s: Any) -> dict[str, Any]:
        return {"x": s.u}

    def outputs(s: Any) -> dict[str, Any]:
        return {"total": s.x}


def test_what_was_before_an_event_is_not_extrapolated_over_it() -> None:
    """A line is extrapolated exactly, but the step after the start and after each turn is on a held value.

    The step of length l after a turn at T ends at the next multiple of h, and lacks slope l^2 / 2.
    """
    h, record = 0.1, Record(["area.total"])
    parts = {"triangle": Triangle().instance(), "area": Area().instance()}
    run(System(parts, {"area.u": "triangle.value"}), Extrapolated(Jacobi(), 1), step=h, stop=1.4, observers=[record])
    after = 0.8 - s_per_unit()  # of the turn at 0.73 s
    slope, fallen = 1 / s_per_unit(), 1.4 - s_per_unit()
    exact = s_per_unit() / 2 + fallen - slope * fallen**2 / 2
    missed = slope * h**2 / 2 - slope * after**2 / 2
    assert record["area.total"][-1] == pytest.approx(exact - missed, abs=1e-6)  # 100 times the integrators' tolerance


def test_who_holds_is_named_and_what_cannot_be_is_refused() -> None:
    parts = {"mass": Mass().instance(), "spring": Spring().instance(), "other": Scripted([port("u", "input")])}
    wires = {"mass.F": "spring.F", "spring.x": "mass.pos", "spring.v": "mass.vel"}
    system = System(parts, wires)
    with pytest.warns(UserWarning, match=r"mass takes no derivatives of its inputs: over its steps they are held") as w:
        Extrapolated(Jacobi(), 2).sequence(system)
    assert len(w) == 1  # nothing is extrapolated for who is not connected, and the spring can
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        Extrapolated(Jacobi(), 0).sequence(system)
    with pytest.raises(CouplingError, match=r"a degree of 0, 1 or 2, not 3"):
        Extrapolated(Jacobi(), 3).sequence(system)
    with pytest.raises(CouplingError, match=r"write Extrapolated\(Iterated\(\.\.\.\)\)"):
        run(oscillator(), Iterated(Extrapolated()), step=S // 10, stop=S)


def test_degree_zero_is_the_inner_algorithm_to_the_bit() -> None:
    records = [Record(), Record()]
    for algorithm, record in zip((Jacobi(), Extrapolated(Jacobi(), 0)), records, strict=True):
        run(oscillator(), algorithm, step=S // 10, stop=S, observers=[record])
    np.testing.assert_array_equal(*(record["left.position"] for record in records))
