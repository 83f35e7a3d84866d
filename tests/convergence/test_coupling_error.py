"""The co-simulated rover against the same rover in one ODE, on the thesis' ramp impact."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cosim import PI, Algorithm, Extrapolated, Fixed, GaussSeidel, Record, Richardson, run
from cosim.scenario import ScenarioFile
from plants.ground import Ground, Ramp
from plants.monolithic import MonolithicRover
from plants.tables import ROBOTS
from studies.assembly import assemble
from studies.coupling import Case, Coupling, coupled, exactly, kink, reference, worst_error

STUDY = Path(__file__).parents[2] / "studies" / "ramp-impact.toml"
# the start is shifted by 0.07 mm, so that the edge falls inside a macro step
IMPACT = Case(ROBOTS["thesis_6_1"], Ground.same(Ramp(start=0.63, angle=0.3)), k_w=2.8e6, x=7e-5)


@pytest.mark.parametrize(("step", "bound"), [(1e-4, 1e-3), (1e-3, 5e-2)])
def test_error_with_the_edge_located(step: float, bound: float) -> None:
    assert worst_error(IMPACT, step) <= bound


def test_what_locating_the_edge_and_the_reduced_model_are_worth() -> None:
    located = worst_error(IMPACT, 1e-4)
    assert worst_error(IMPACT, 1e-4, locate=False) > 5 * located
    assert worst_error(IMPACT, 1e-4, "classical") > 100 * located
    assert worst_error(IMPACT, 1e-4, "reduced-jacobi") > 100 * located


def test_error_falls_with_the_square_of_the_step() -> None:
    """Over the first contact, before rebounds amplify differences: P, U, b are held, an error O(h^2) a step in z."""
    case = replace(IMPACT, duration=0.02)
    steps = (4e-4, 2e-4, 1e-4, 5e-5)
    errors = [worst_error(case, h) for h in steps]
    order = np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert 1.5 < order < 2.6, errors


@pytest.mark.parametrize("coupling", ["reduced", "classical"])
@pytest.mark.parametrize("step", [1e-3, 3e-4, None], ids=["1 ms", "0.3 ms", "PI"])
def test_the_edge_is_met_within_a_nanosecond(coupling: Coupling, step: float | None) -> None:
    """Whatever the steps: until then the coupling does nothing, and the instant is known in closed form."""
    algorithm: Algorithm = GaussSeidel(("wheels", "body"))
    control: Fixed | PI = Fixed()
    if step is None:
        algorithm, control = Richardson(algorithm, outputs=("body.position",)), PI(0.0, 1e-4)
    record = Record(["body.velocity"])
    with coupled(IMPACT, coupling) as system:
        run(system, algorithm, step=step or 1e-5, stop=0.009, observers=[record], control=control)
    assert abs(record.events[0][0] - kink(IMPACT, 0.3)) <= 1


def test_steps_as_long_as_the_tolerance_allows() -> None:
    """An error of position becomes one of velocity at 254 rad/s; no step is wrong by more than the tolerance."""
    algorithm = Richardson(GaussSeidel(("wheels", "body")), 2, outputs=("body.position",))
    for tolerance, few in ((1e-6, 30), (1e-7, 60)):
        record = Record(["body.velocity"])
        with coupled(IMPACT) as system:
            run(system, algorithm, step=1e-5, stop=0.02, observers=[record], control=PI(0.0, tolerance, order=2))
        exact = exactly(IMPACT, record.time_ns).vertical_speed
        assert np.max(np.abs(record["body.velocity"][:, 2] - exact)) < 254 * len(record) * tolerance
        assert len(record) < few  # a fixed step as good takes 50 and 100


def test_reference_is_the_same_with_another_integrator() -> None:
    """The compiled Dormand-Prince reference against SciPy's DOP853, both at a relative tolerance of 1e-12."""
    case = replace(IMPACT, duration=0.012)
    whole = MonolithicRover(**case.body_values(), k_w=np.full(4, case.k_w), c_w=np.zeros(4))
    twin = whole.instance("twin")
    for name, value in case.starts().items():
        slot, _, variable = name.partition(".")
        if slot == "body":
            twin.set(variable, value)
    twin.enter_initialization(0, None, 1e-12)
    twin.exit_initialization()
    exact = reference(case, 1e-3)
    for ns in exact.ns[1:]:
        twin.step(int(ns) - 1_000_000, int(ns))
        # both keep 1e-12 relative per step; some hundred steps, and the impact's gain of k z_max / (m v) below 100
        assert abs(twin.get("velocity")[2] - exact.vertical_speed[ns // 1_000_000]) < 1e-8


def test_means_over_a_step_are_not_to_be_extrapolated() -> None:
    """The wheels give mean forces: read as values at the end of a step they are half a step late, which is order 1.

    A delay of h / 2 = 5e-5 s in a force turns at 254 rad/s into 1.3 % of the 0.6 m/s, so into some mm/s.
    """
    worst = {}
    in_turn = GaussSeidel(("wheels", "body"))
    ways: dict[str, Algorithm] = {"held": in_turn, "lines": Extrapolated(in_turn)}
    for way, algorithm in ways.items():
        record = Record(["body.velocity"])
        with coupled(IMPACT, smooth=True) as system:
            run(system, algorithm, step=1e-4, stop=0.02, observers=[record])
        exact = exactly(IMPACT, record.time_ns).vertical_speed
        worst[way] = np.max(np.abs(record["body.velocity"][:, 2] - exact))
    assert worst["held"] < 1e-4
    assert 1e-3 < worst["lines"] < 1.3e-2 * 0.6 * 2
    table = ScenarioFile(STUDY)
    (note,) = assemble(table.load(None, table.overrides(["run.extrapolate=1"]))).notes
    assert "run.extrapolate spoils the reduced interface model" in note
