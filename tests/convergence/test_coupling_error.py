"""The co-simulated rover against the same rover in one ODE, on the thesis' ramp impact."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from plants.ground import Ground, Ramp
from plants.monolithic import MonolithicRover
from plants.tables import ROBOTS
from studies.coupling import Case, reference, worst_error

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
