"""Observed order of the coupling algorithms against closed forms.

The components advance exactly for inputs held over the step (a ``flow``), so the whole error is the coupling's.
"""

from collections.abc import Callable
from math import cos, exp, log2, sin, sqrt
from typing import Any

import pytest
from toys import Mass, Position, Spring, Velocity

from cosim import GaussSeidel, Jacobi, Record, System, run

STOP = 1_000_000_000  # ns
W, D = 2.0, 0.6  # rad/s and N.s/m of the oscillators below (k = W^2 and m = 1)


def error(make: Callable[[], System], algorithm: Any, steps: int, port: str, exact: float) -> float:
    record = Record([port])
    run(make(), algorithm, step=STOP // steps, stop=STOP, observers=[record], locate_events=False)
    return abs(record[port][-1] - exact)


def order(make: Callable[[], System], algorithm: Any, port: str, exact: float, steps: int = 160) -> float:
    """Return log2 of the error ratio of one halving: the order p up to O(h)."""
    errors = [error(make, algorithm, n, port, exact) for n in (steps, 2 * steps)]
    return log2(errors[0] / errors[1])


def damped() -> System:
    parts = {"mass": Mass().instance(), "spring": Spring(k=W**2, d=D).instance()}
    return System(parts, {"mass.F": "spring.F", "spring.x": "mass.pos", "spring.v": "mass.vel"})


def damped_exactly(t: float) -> float:
    """Return the solution of x'' + D x' + W^2 x = 0 from x = 1, at rest."""
    a = D / 2
    w = sqrt(W**2 - a**2)
    return exp(-a * t) * (cos(w * t) + a / w * sin(w * t))


def split() -> System:
    """The undamped oscillator cut between x' = v and v' = -W^2 x, from x = 0, v = 1."""
    parts = {"position": Position().instance(), "velocity": Velocity(w=W).instance()}
    return System(parts, {"position.v": "velocity.vel", "velocity.x": "position.pos"})


# With errors c h + d h^2 one halving shows the order 1 + O(h d / c); h = 1/160 and W = 2 leave some hundredths.
NEAR = 0.05


@pytest.mark.parametrize("algorithm", [Jacobi(), GaussSeidel(), GaussSeidel(("spring", "mass"))], ids=repr)
def test_order_one_on_a_damped_oscillator(algorithm: Any) -> None:
    assert order(damped, algorithm, "mass.pos", damped_exactly(1.0)) == pytest.approx(1, abs=NEAR)


def test_jacobi_has_order_one_on_the_split_oscillator() -> None:
    assert order(split, Jacobi(), "position.pos", sin(W) / W) == pytest.approx(1, abs=NEAR)


def test_gauss_seidel_is_the_leapfrog_on_the_split_oscillator() -> None:
    """Second order there, and only there: x_n+1 = x_n + h v_n, v_n+1 = v_n - h W^2 x_n+1 is Stoermer-Verlet.

    v_n is then the velocity half a step later, v(t_n + h/2) + O(h^2): from x = 0 the start fits that to second order
    (v(h/2) = 1 - O(h^2)), and x is of order 2, while v read at t_n is off by half a step, which is order 1.
    """
    assert order(split, GaussSeidel(), "position.pos", sin(W) / W) == pytest.approx(2, abs=NEAR)
    assert order(split, GaussSeidel(), "velocity.vel", cos(W)) == pytest.approx(1, abs=NEAR)


def test_gauss_seidel_beats_jacobi_by_its_smaller_delay() -> None:
    """Force from the start of the step: the delay of Jacobi is 3/2 h in the loop, that of Gauss-Seidel 1/2 h.

    A delay T in the spring changes the damping by -k T, so at first order the errors are in the ratio of the delays.
    """
    exact = damped_exactly(1.0)
    jacobi, gauss_seidel = (error(damped, a, 640, "mass.pos", exact) for a in (Jacobi(), GaussSeidel()))
    assert jacobi / gauss_seidel == pytest.approx(3, rel=0.02)


def test_a_slow_spring_has_the_error_of_its_own_step() -> None:
    """Every 4: the force is held over four macro steps, as long as one of a run with four times the step.

    The mass still moves in the same way under a held force, since its flow is exact: the two runs are the same.
    """

    def slow() -> System:
        parts = {"spring": Spring(k=W**2, d=D).instance(), "mass": Mass().instance()}
        wires = {"mass.F": "spring.F", "spring.x": "mass.pos", "spring.v": "mass.vel"}
        return System(parts, wires, every={"spring": 4})

    exact = damped_exactly(1.0)
    assert order(slow, GaussSeidel(), "mass.pos", exact) == pytest.approx(1, abs=4 * NEAR)
