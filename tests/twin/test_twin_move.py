"""States of a running FMU that are set through the bytes of a snapshot: what a linearised step is made with."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from foreign import FMI2, FMI3, foreign
from specimens import Mass, Specimen
from test_twin_agreement import STEPS, agree, prepared, states

import fmus
from cosim import GaussSeidel, System, WiringError
from cosim.clock import NS
from cosim.step_map import step_map


def test_a_state_moves_alone_and_the_next_step_starts_there(
    specimen: Specimen, fmi: int, rng: np.random.Generator
) -> None:
    values, h = specimen.values(rng), round(specimen.step * NS)
    fmu = prepared(fmus.instantiate(specimen.component, fmi=fmi), values)
    twin = prepared(specimen.component.instance(), values)
    fmu.step(0, h)
    for name, value in states(fmu).items():  # from one point, since two integrators arrive at slightly different ones
        if not name.startswith("der("):
            twin.set(name, value)
    twin.t = h / NS
    for name in [n for n in states(fmu) if not n.startswith("der(")]:
        before = states(fmu)
        moved = np.asarray(before[name]) + 0.01 * rng.standard_normal(np.shape(before[name]))
        for instance in (fmu, twin):
            instance.move(name, moved)
        assert np.array_equal(fmu.get(name), moved)
        rest = {n: v for n, v in states(fmu).items() if n != name and not n.startswith("der(")}
        assert all(np.array_equal(v, before[n]) for n, v in rest.items())
    for instance in (fmu, twin):
        instance.step(h, h + 1)  # sync, and 1 ns of dynamics
        instance.pull()
    agree(fmu, twin, STEPS)
    fmu.close()


def test_what_is_no_state_cannot_be_moved(fmi: int) -> None:
    with_states = prepared(fmus.instantiate(Mass(), fmi=fmi), {})
    for name in ("k", "F", "power", "der(x)"):
        with pytest.raises(WiringError, match=r"is no state, and only states can be moved"):
            with_states.move(name, 1.0)
    with_states.close()


def test_an_fmu_of_another_tool_keeps_its_states(fmi: int, tmp_path: Path) -> None:
    fmu = fmus.load(foreign(tmp_path, fmi, FMI2 if fmi == 2 else FMI3))
    with pytest.raises(WiringError, match=r"the states of .* cannot be set once it runs: it is a foreign FMU"):
        fmu.move(next(iter(fmu.variables)), 1.0)
    fmu.close()


def test_the_linearised_step_is_that_of_the_twin(fmi: int) -> None:
    """Both differentiate the same equations with a tolerance of 1e-12, over 1e-6 of a difference."""
    maps = []
    for instance in (fmus.instantiate(Mass(), fmi=fmi), Mass().instance()):
        with System({"mass": instance}, {}) as system:
            system.initialize(tolerance=1e-12)
            maps.append(step_map(system, GaussSeidel(), step=0.01))
    for matrix in "ABCD":
        np.testing.assert_allclose(getattr(maps[0], matrix), getattr(maps[1], matrix), atol=1e-6)
    assert maps[0].state_labels == maps[1].state_labels == ["mass_x", "mass_v"]
