"""Power bonds on two masses between springs: a residual is the energy that the coupling makes; it can be paid back."""

from __future__ import annotations

from math import log2
from typing import Any

import numpy as np
import pytest
from toys import Alarm, Journal, Mass, Spring

import fmus
from cosim import (
    PI,
    Bond,
    Conserving,
    CouplingError,
    EnergyError,
    Extrapolated,
    Fixed,
    GaussSeidel,
    Iterated,
    Jacobi,
    Record,
    Residuals,
    Richardson,
    System,
    run,
)
from studies.oscillator import CONNECTIONS, LeftMass, RightMass, coupled, solution

S = 1_000_000_000  # ns
E = 0.065  # J, of the start
BOND = Bond("right.force", "left.velocity", E)
ALGORITHMS = [Jacobi(), GaussSeidel(), GaussSeidel(("right", "left")), Iterated(), Conserving(GaussSeidel(), (BOND,))]


def system(fmi: int = 2, **left: float) -> System:
    return coupled(fmus.instantiate(LeftMass(**left), fmi=fmi), fmus.instantiate(RightMass(), fmi=fmi))


def drift(algorithm: Any, n: int, control: Any = Fixed(), **left: float) -> tuple[np.ndarray, Residuals, Record]:  # noqa: B008
    """Return the energy that was made up to each point of 1 s in steps of 1 / n (s), and what the residuals say."""
    record, residuals = Record(), Residuals(BOND)
    with system(**left) as whole:
        run(whole, algorithm, step=S // n, stop=S, observers=[record, residuals], tolerance=1e-11, control=control)
    energy = record["left.energy"] + record["right.energy"]
    return energy - energy[0], residuals, record


# Errors c h^p + d h^(p+1): one halving shows p + O(h d / c), two tenths at h = 1/80 and w = 4 rad/s.
NEAR = 0.2


@pytest.mark.parametrize(("left", "order"), [({}, 2), ({"d_wall": 0.2}, 2), ({"d": 0.5}, 1)])
@pytest.mark.parametrize("algorithm", ALGORITHMS, ids=repr)
def test_the_residuals_add_up_to_the_energy_made_to_their_order(
    algorithm: Any, left: dict[str, float], order: int
) -> None:
    """Each side keeps its own balance, so what is made is made at the bond: O(h^2) a step, found but for O(h^3).

    With a damper in the coupling spring the force jumps by O(h) where the velocity is set, which the rule does not see.
    """
    gaps = []
    for n in (80, 160):
        made, residuals, _ = drift(algorithm, n, **left)
        gaps.append(np.max(np.abs(np.cumsum(residuals.energy[:, 0]) - made[1:])))
        if algorithm == Jacobi():
            assert gaps[-1] < 0.02 * np.max(np.abs(made))  # h w / 2 at h = 1/80 and w = 3 rad/s
    assert log2(gaps[0] / gaps[1]) > order - NEAR


@pytest.mark.parametrize("inner", [Jacobi(), GaussSeidel(), Iterated()], ids=lambda a: type(a).__name__)
def test_paying_back_makes_energy_and_solution_second_order(inner: Any) -> None:
    held, paid, wrong = [], [], []
    exact = solution(LeftMass(), RightMass(), 1.0)
    for n in (80, 160):
        held.append(np.max(np.abs(drift(inner, n)[0])))
        made, _, record = drift(Conserving(inner, (BOND,)), n)
        paid.append(np.max(np.abs(made)))
        wrong.append(np.hypot(record["left.position"][-1] - exact[0], record["right.position"][-1] - exact[3]))
    assert log2(held[0] / held[1]) == pytest.approx(1, abs=NEAR)
    assert paid[1] < held[1] / 10
    assert log2(paid[0] / paid[1]) > 2 - NEAR
    assert log2(wrong[0] / wrong[1]) == pytest.approx(2, abs=NEAR)


def test_the_impulse_given_is_the_impulse_received() -> None:
    """Up to what is owed for the last step, h (F1 - F0) / 2: also where steps vary, the debts being paid in time."""
    for control in (Fixed(), PI(1e-3, 1e-6, order=2)):
        algorithm = EnergyError(Conserving(Jacobi(), (BOND,)), (BOND,))
        _, _, record = drift(algorithm, 50, control)
        steps, shown = np.diff(record.time_ns) / S, record["left.force"]
        given = np.sum(steps * (shown[1:] + shown[:-1]) / 2)
        received = np.sum(steps * record["right.force"][1:])
        assert abs(given - received) <= 2 * steps[-1] * np.max(np.abs(np.diff(shown)))
        assert abs(np.sum(steps * (shown[:-1] - shown[1:]) / 2)) > 5 * abs(given - received)  # what holding would miss
    assert len(set(np.diff(record.time_ns))) > 3


@pytest.mark.parametrize("inner", [Jacobi(), GaussSeidel(), Iterated()], ids=lambda a: type(a).__name__)
def test_steps_as_the_energy_asks_for(inner: Any) -> None:
    """No step makes more than its tolerance, so n of them no more than n times that; no step is taken twice."""
    runs = []
    for tolerance in (1e-3, 1e-4):
        made, residuals, record = drift(EnergyError(inner, (BOND,)), 10, PI(tolerance, tolerance))
        assert np.max(np.abs(residuals.energy)) <= 2 * tolerance * E  # the absolute and the relative part
        runs.append((len(record) - 1, np.max(np.abs(made))))
    (few, rough), (many, fine) = runs
    assert fine < rough
    assert many / few == pytest.approx(10**0.5, rel=0.3)  # residuals of order h^2


def test_an_event_ends_what_is_owed() -> None:
    """A first step after an event is that of the inner algorithm, as the first step of a run is."""
    record = Record()
    with system() as one:
        parts = {**one.instances, "alarm": Alarm(at=0.25).instance()}
        whole = System(parts, CONNECTIONS)
        algorithm, journal = Conserving(Jacobi(), (BOND,)), Journal()
        run(whole, algorithm, step=S // 10, stop=S // 2, observers=[record, journal])
    met = next(entry[1] for entry in journal.entries if entry[0] == "event")
    k = int(np.flatnonzero(record.time_ns == met)[0])
    held, shown = record["right.force"], record["left.force"]
    assert held[1] == shown[0]
    assert held[k + 1] == shown[k]
    assert all(held[i + 1] != shown[i] for i in range(1, k))


def test_what_is_no_bond_is_refused() -> None:
    whole = system()

    def refused(*bonds: Bond, inner: Any = Jacobi(), on: System = whole) -> str:  # noqa: B008
        with pytest.raises(CouplingError) as caught:
            EnergyError(inner, bonds).sequence(on)
        return str(caught.value)

    assert refused(Bond("right.forc", "left.velocity")) == (
        "no connection for a power bond drives 'right.forc'; did you mean 'right.force'?"
    )
    assert "which is not the way back" in refused(Bond("right.force", "right.force"))
    assert "there are no power bonds" in refused()
    assert "which Extrapolated moves" in refused(BOND, inner=Richardson(Extrapolated()))
    slow = System(whole.instances, CONNECTIONS, every={"left": 2})
    assert "asks left to step at every macro step" in refused(BOND, on=slow)
    parts = {"mass": Mass().instance(), "spring": Spring().instance()}
    lengths = System(parts, {"mass.F": "spring.F", "spring.x": "mass.pos", "spring.v": "mass.vel"})
    work = refused(Bond("mass.F", "spring.x"), on=lengths)
    assert work == "mass.F * spring.x is no power bond: N times m is no power"
    with pytest.raises(CouplingError, match=r"write Conserving\(Iterated\(\.\.\.\), bonds\)"):
        run(system(), Iterated(Conserving(Jacobi(), (BOND,))), step=S // 10, stop=S)
    whole.close()
