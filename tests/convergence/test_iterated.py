"""Iterated coupling against closed forms: it settles where Gauss-Seidel diverges, by every method, with order 1."""

from itertools import permutations
from math import log2
from typing import Any

import numpy as np
import pytest
from toys import Gain, Journal, Mass, Scripted, Spring, port

from cosim import CouplingError, GaussSeidel, Iterated, Jacobi, Record, System, run

STOP = 1_000_000_000  # ns
METHODS = ("fixed_point", "aitken", "quasi_newton", "newton")
INNER = (Jacobi(), GaussSeidel(), GaussSeidel(("spring", "mass")))


def oscillator(k: float, d: float = 0.0) -> System:
    parts = {"mass": Mass().instance(), "spring": Spring(k=k, d=d).instance()}
    return System(parts, {"mass.F": "spring.F", "spring.x": "mass.pos", "spring.v": "mass.vel"})


def implicit(k: float, d: float, h: float, n: int) -> float:
    """Return x after n steps with the force of the end of a step held over it, in closed form.

    x1 = x + h v + h^2/2 F, v1 = v + h F, F = -k x1 - d v1: a linear map of (x, v).
    """
    left = np.array([[1 + h**2 / 2 * k, h**2 / 2 * d], [h * k, 1 + h * d]])
    step = np.linalg.solve(left, np.array([[1, h], [0, 1]]))
    return float((np.linalg.matrix_power(step, n) @ [1.0, 0.0])[0])


@pytest.mark.parametrize("inner", INNER, ids=repr)
@pytest.mark.parametrize("method", METHODS)
def test_every_method_finds_the_implicit_solution(method: Any, inner: Any) -> None:
    record = Record(["mass.pos"])
    run(oscillator(4.0, 0.6), Iterated(inner, method, 1e-12), step=STOP // 20, stop=STOP, observers=[record])
    # 20 steps, each within 1e-12 of its solution, not amplified: a damped oscillator
    assert record["mass.pos"][-1] == pytest.approx(implicit(4.0, 0.6, 1 / 20, 20), abs=1e-10)


def test_order_one() -> None:
    """The implicit map has errors c h + d h^2 to the exact solution, so one halving shows 1 + O(h d / c)."""
    from test_algorithms import damped, damped_exactly

    errors = []
    for n in (160, 320):
        record = Record(["mass.pos"])
        run(damped(), Iterated(), step=STOP // n, stop=STOP, observers=[record])
        errors.append(abs(record["mass.pos"][-1] - damped_exactly(1.0)))
    assert log2(errors[0] / errors[1]) == pytest.approx(1, abs=0.05)


@pytest.mark.parametrize("method", ["aitken", "quasi_newton", "newton"])
def test_a_stiff_coupling_settles_where_gauss_seidel_diverges(method: Any) -> None:
    """h^2 k / 2 = 50: a plain sweep multiplies an error by -50; the implicit solution decays."""
    k, n = 1e4, 10
    record = Record(["mass.pos"])
    run(oscillator(k), Iterated(GaussSeidel(), method), step=STOP // n, stop=STOP, observers=[record])
    assert np.max(np.abs(record["mass.pos"])) <= 1
    assert record["mass.pos"][-1] == pytest.approx(implicit(k, 0.0, 1 / n, n), abs=1e-6)
    run(oscillator(k), GaussSeidel(), step=STOP // n, stop=STOP, observers=[record := Record(["mass.pos"])])
    assert abs(record["mass.pos"][-1]) > 1e6


def test_what_does_not_settle_is_an_error_with_the_worst_port() -> None:
    with pytest.raises(CouplingError, match=r"after 5 iterations spring\.F still changes from .* N, a residual of"):
        run(oscillator(1e4), Iterated(GaussSeidel(), "fixed_point", max_iterations=5), step=STOP // 10, stop=STOP)
    algorithm = Iterated(GaussSeidel(), "fixed_point", max_iterations=2, unconverged="warn")
    with pytest.warns(UserWarning, match="did not settle"):
        run(oscillator(4.0), algorithm, step=STOP // 10, stop=STOP)


def test_who_cannot_go_back_steps_once_and_is_named() -> None:
    """It is called once per macro step; the others, iterated, still find the solution for what it shows."""
    stubborn = Scripted([port("u", "input"), port("y", "output")], rollback=False)
    parts = {"gain": Gain().instance(), "stubborn": stubborn}
    system = System(parts, {"gain.u": "stubborn.y", "stubborn.u": "gain.y"})
    with pytest.warns(UserWarning, match="stubborn cannot be taken back .* steps it once per macro step"):
        run(system, Iterated(), step=STOP // 10, stop=STOP)
    assert stubborn.steps == 10


def test_events_are_located_inside_iterated_steps() -> None:
    """Alarms at 0.3 k s of an integral of rate 1, met within a nanosecond after, once each."""
    from toys import Alarm

    journal = Journal()
    run(System({"alarm": Alarm().instance()}, {}), Iterated(), step=STOP // 4, stop=STOP, observers=[journal])
    times = [entry[1] for entry in journal.entries if entry[0] == "event"]
    np.testing.assert_allclose(times, [3e8, 6e8, 9e8], atol=20)  # ns: the tolerance of the integrator, 1e-8 of 1 s
    assert journal.entries[-1][3] == 3


def test_the_computed_order_has_the_fewest_delays() -> None:
    """Against every order there is; a cycle a -> b -> c -> a has one delayed connection, and one more wire c -> b."""
    names = ("a", "b", "c")
    wires = {"a.u": "c.y", "b.u": "a.y", "c.u": "b.y"}
    for turned in permutations(names):
        system = System({name: Scripted([port("u", "input"), port("y", "output")]) for name in turned}, wires)
        fewest = min(sum(system.delays(GaussSeidel(order)).values()) for order in permutations(names))
        assert sum(system.delays(GaussSeidel("computed")).values()) == fewest == 1
