"""Richardson's estimate against the true error, and steps under PI within their tolerance."""

from math import cos, exp, sin, sqrt
from typing import Any

import numpy as np
import pytest
from test_algorithms import D, W, damped, damped_exactly, split
from toys import Alarm, Journal, Mass, Scripted, Spring, port

from cosim import PI, CouplingError, GaussSeidel, Iterated, Jacobi, Record, Richardson, System, run
from cosim.attempt import Attempt

S = 1_000_000_000  # ns


def estimated(system: System, inner: Any, port: str) -> tuple[float, float]:
    """Return the estimated error of a port after one step of 1 ms, and its value."""
    algorithm = Richardson(inner)
    sequence = algorithm.sequence(system)
    system.initialize()
    attempt = Attempt(system, 0, S // 1000, sequence, False)
    algorithm.advance(attempt)
    assert attempt.estimate is not None
    errors = dict(zip(attempt.estimate.labels, attempt.estimate.error, strict=True))
    return errors[port], system[port]


# Estimate and error agree up to a relative O(h): h = 1e-3 and W = 2 leave some thousandths.


@pytest.mark.parametrize("inner", [GaussSeidel(), GaussSeidel(("spring", "mass")), Iterated()], ids=repr)
def test_the_estimate_tracks_the_true_error_of_a_step(inner: Any) -> None:
    a, t = D / 2, 1e-3
    w = sqrt(W**2 - a**2)
    exact = -exp(-a * t) * W**2 / w * sin(w * t)  # x'(t) from x = 1, at rest
    estimate, found = estimated(damped(), inner, "mass.vel")
    assert estimate == pytest.approx(exact - found, rel=0.02)


def test_the_estimate_of_jacobi_tracks_the_true_error_where_nothing_feeds_through() -> None:
    estimate, found = estimated(split(), Jacobi(), "velocity.vel")
    assert estimate == pytest.approx(cos(W * 1e-3) - found, rel=0.02)


@pytest.mark.parametrize("inner", [Jacobi(), GaussSeidel(), Iterated()], ids=lambda a: type(a).__name__)
def test_pi_keeps_each_step_within_its_tolerance_and_the_run_near_it(inner: Any) -> None:
    """A damped oscillator does not amplify: the error of the run is at most the sum of those of its n steps."""
    errors = []
    for tolerance in (1e-3, 1e-4):
        record, control = Record(["mass.pos"]), PI(tolerance, tolerance)
        run(damped(), Richardson(inner, outputs=("mass.*",)), step=S // 100, stop=S, observers=[record],
            control=control)  # fmt: skip
        errors.append(abs(record["mass.pos"][-1] - damped_exactly(1.0)))
        steps = len(record) - 1
        assert errors[-1] <= steps * 2 * tolerance  # size of mass.pos at most 1: absolute and relative part
    assert errors[1] < errors[0]


def test_too_long_a_first_step_is_taken_back_and_told() -> None:
    journal = Journal()
    run(damped(), Richardson(), step=S // 2, stop=S, observers=[journal], control=PI(1e-3, 1e-3))
    rejected = [entry for entry in journal.entries if entry[0] == "rejected"]
    assert rejected[0][1:4] == (0, S // 2, 0)
    ends = [entry[3] for entry in journal.entries if entry[0] == "accepted"]
    assert ends[-1] == S
    assert np.all(np.diff(ends) > 0)


def test_events_lie_where_they_should_inside_steps_of_varying_length() -> None:
    parts = {"mass": Mass().instance(), "spring": Spring(k=W**2, d=D).instance(), "alarm": Alarm().instance()}
    system = System(parts, {"mass.F": "spring.F", "spring.x": "mass.pos", "spring.v": "mass.vel"})
    journal = Journal()
    run(system, Richardson(), step=S // 100, stop=S, observers=[journal], control=PI(1e-3, 1e-3))
    times = [entry[1] for entry in journal.entries if entry[0] == "event"]
    np.testing.assert_allclose(times, [3e8, 6e8, 9e8], atol=20)  # ns: the tolerance of the integrator, 1e-8 of 1 s


def test_what_cannot_be_is_refused_with_a_sentence() -> None:
    stubborn = {"stubborn": Scripted([port("u", "input"), port("y", "output")], rollback=False)}
    with pytest.raises(CouplingError, match=r"stubborn cannot be taken back .* at a fixed step"):
        run(System(stubborn, {}), Richardson(), step=S // 10, stop=S)
    with pytest.raises(CouplingError, match=r"stubborn cannot be taken back .* control the step by Fixed"):
        run(System(stubborn, {}), Jacobi(), step=S // 10, stop=S, control=PI())
    with pytest.raises(CouplingError, match=r"estimates no error.*wrap it in Richardson"):
        run(damped(), Jacobi(), step=S // 10, stop=S, control=PI())
    with pytest.raises(CouplingError, match=r"compiled loop makes steps of equal length; leave out compiled=True"):
        run(damped(), Richardson(), step=S // 10, stop=S, control=PI(), compiled=True)
    slow = System({"mass": Mass().instance()}, {}, every={"mass": 4})
    with pytest.raises(CouplingError, match=r"mass steps every 4 macro steps, which has no meaning"):
        run(slow, Jacobi(), step=S // 10, stop=S, control=PI())
