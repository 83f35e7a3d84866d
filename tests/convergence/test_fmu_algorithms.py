"""FMUs of both versions under the algorithms that go back: the same runs as those of their Python twins."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from math import log2
from typing import Any

import numpy as np
import pytest

import fmus
from cosim import (
    PI,
    Bond,
    Component,
    Conserving,
    EnergyError,
    Extrapolated,
    Fixed,
    GaussSeidel,
    Instance,
    Iterated,
    Jacobi,
    Record,
    Richardson,
    System,
    run,
)
from cosim.attempt import Attempt
from studies.oscillator import START, LeftMass, RightMass, coupled, solution

S = 1_000_000_000  # ns
BOND = Bond("right.force", "left.velocity", 0.065)
MAKE: dict[str, Callable[[Component], Instance]] = {
    "python": lambda part: part.instance(),
    "fmi2": lambda part: fmus.instantiate(part, fmi=2),
    "fmi3": lambda part: fmus.instantiate(part, fmi=3, smooth=True),
    "isolated": lambda part: fmus.instantiate(part, fmi=3, isolated=True),
}


def system(kind: str) -> System:
    return coupled(MAKE[kind](LeftMass(d=0.5)), MAKE[kind](RightMass()))


@lru_cache
def ran(kind: str, way: str) -> tuple[list[int], np.ndarray]:
    """Return the communication points of 0.4 s and the positions at them."""
    algorithm, control = WAYS[way]
    record = Record(["left.position", "right.position"])
    with system(kind) as whole:
        run(whole, algorithm, step=S // 25, stop=2 * S // 5, observers=[record], control=control, tolerance=1e-10)
    return record.time_ns.tolist(), np.array([record["left.position"], record["right.position"]])


WAYS: dict[str, tuple[Any, Any]] = {
    "iterated": (Iterated(), Fixed()),
    "newton": (Iterated(Jacobi(), "newton"), Fixed()),
    "richardson": (Richardson(), Fixed()),
    "pi": (Richardson(Iterated(Jacobi())), PI(1e-3, 1e-3)),
    "energy": (EnergyError(Conserving(GaussSeidel(), (BOND,)), (BOND,)), PI(1e-3, 1e-3, order=2)),
}


@pytest.mark.parametrize(
    ("kind", "way"), [*((kind, way) for kind in ("fmi2", "fmi3") for way in WAYS), ("isolated", "energy")]
)
def test_an_fmu_runs_as_its_python_twin(kind: str, way: str) -> None:
    """Integrators of 1e-10 and an iteration of 1e-8: where the estimates decide, they decide alike but for rounding.

    The last 1e-8 of an estimate moves a step by as much, so points agree within 1e-6 of 0.4 s, and values within what
    moves meanwhile (less than 1 m/s).
    """
    (times, values), (twin_times, twin_values) = (ran(k, way) for k in (kind, "python"))
    assert len(times) == len(twin_times)
    np.testing.assert_allclose(times, twin_times, atol=400)
    np.testing.assert_allclose(values, twin_values, atol=4e-7)


def local_error(algorithm: Any, h: int) -> float:
    """Return the error of the velocity of the second mass after one step of *h* ns, from where all is known."""
    with system("fmi3") as whole:
        sequence = algorithm.sequence(whole)
        whole.initialize(tolerance=1e-12)
        algorithm.advance(Attempt(whole, 0, h, sequence, False))
        return abs(whole["right.velocity"] - solution(LeftMass(d=0.5), RightMass(), h / S)[4])


@pytest.mark.parametrize("inner", [GaussSeidel(), Iterated(), GaussSeidel(("right", "left"))], ids=repr)
def test_what_is_extrapolated_is_an_order_better_in_a_step(inner: Any) -> None:
    """One halving of h = 0.01 s at w = 4 rad/s: the next term of the error moves the order by a few hundredths."""
    plain, better = ([local_error(Richardson(inner, extrapolate=e), S // n) for n in (100, 200)] for e in (False, True))
    assert log2(plain[0] / plain[1]) == pytest.approx(2, abs=0.1)
    assert log2(better[0] / better[1]) == pytest.approx(3, abs=0.1)


@pytest.mark.parametrize("kind", ["fmi2", "fmi3"])
@pytest.mark.parametrize(("inner", "order"), [(Jacobi(), 1), (Extrapolated(Iterated(), 1), 2)], ids=["held", "lines"])
def test_pi_over_fmus_keeps_its_tolerance(kind: str, inner: Any, order: int) -> None:
    """Damped, so errors do not grow: a run of n steps is within n times what one may be wrong by."""
    tolerance, record = 1e-5, Record(["left.position", "right.position"])
    with system(kind) as whole:
        run(whole, Richardson(inner, order, outputs=("*.position", "*.velocity")), step=S // 1000, stop=S,
            observers=[record], control=PI(0.0, tolerance, order=order), tolerance=1e-10)  # fmt: skip
    steps = len(record) - 1
    exact = solution(LeftMass(d=0.5), RightMass(), 1.0)
    wrong = max(abs(record["left.position"][-1] - exact[0]), abs(record["right.position"][-1] - exact[3]))
    assert START[0] * 1e-6 < wrong < steps * tolerance
    assert steps < (600 if order == 1 else 60)
