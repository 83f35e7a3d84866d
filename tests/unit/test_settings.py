"""The section [run]: which strategy and which step control it stands for, and that a run goes by them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cosim import (
    PI,
    Bond,
    Conserving,
    Consistent,
    CouplingError,
    EnergyError,
    Extrapolated,
    Fixed,
    GaussSeidel,
    Iterated,
    Jacobi,
    Richardson,
)
from cosim.scenario import ScenarioFile
from cosim.settings import RunSettings
from studies.runner import execute

STUDY = Path(__file__).parents[2] / "studies" / "ramp-impact.toml"
ORDER = ("b", "a")
CASES: list[tuple[dict[str, Any], Any, Any]] = [
    ({}, GaussSeidel(ORDER), Fixed()),
    ({"algorithm": "jacobi"}, Jacobi(), Fixed()),
    ({"algorithm": "jacobi", "solve_loops": True, "trusted": ("a",)}, Consistent(Jacobi(), ("a",)), Fixed()),
    ({"iterated": {"inner": "jacobi"}}, GaussSeidel(ORDER), Fixed()),
    (
        {"algorithm": "iterated", "iterated": {"inner": "jacobi", "method": "newton", "tolerance": 1e-6}},
        Iterated(Jacobi(), "newton", 1e-6),
        Fixed(),
    ),
    (
        {"algorithm": "iterated", "iterated": {"max_iterations": 9, "unconverged": "warn"}, "control": {}},
        Richardson(Iterated(GaussSeidel(ORDER), max_iterations=9, unconverged="warn")),
        PI(),
    ),
    (
        {"control": {"tolerance_rel": 1e-3, "tolerance_abs": 1e-2, "min_step": 1e-6, "outputs": ["a.*"]}},
        Richardson(GaussSeidel(ORDER), outputs=("a.*",)),
        PI(1e-3, 1e-2, 1e-6),
    ),
    (
        {"algorithm": "iterated", "extrapolate": 1, "control": {}},
        Richardson(Extrapolated(Iterated(GaussSeidel(ORDER)), 1), order=2),
        PI(order=2),
    ),
    (
        {"bonds": [{"effort": "a.F", "flow": "b.v"}], "conserving": True, "control": {"estimate": "energy"}},
        EnergyError(Conserving(GaussSeidel(ORDER), (Bond("a.F", "b.v"),)), (Bond("a.F", "b.v"),)),
        PI(order=2),
    ),
    ({"control": {"max_step": 1e-3}}, Richardson(GaussSeidel(ORDER)), PI(max_step=1e-3)),
]


@pytest.mark.parametrize(("run", "algorithm", "control"), CASES)
def test_a_section_stands_for_strategies(run: dict[str, Any], algorithm: Any, control: Any) -> None:
    settings = RunSettings(duration=1.0, **run)
    assert settings.strategy(ORDER) == algorithm
    assert settings.pace() == control
    assert RunSettings.model_validate_json(settings.model_dump_json()) == settings  # as it is kept in a log


def run_with(*overrides: str) -> Any:
    file = ScenarioFile(STUDY)
    return execute(file.load(None, file.overrides(["run.duration=0.015", *overrides])))


def test_a_run_goes_by_overrides_as_the_command_line_takes_them() -> None:
    """Through the impact at 7.4 ms; all couplings are near each other at their steps, none is the same to the bit."""
    outputs = 'run.control.outputs=["body.velocity", "body.position"]'
    fixed = run_with()
    paced = run_with("run.control.tolerance_rel=1e-4", "run.control.tolerance_abs=1e-4", outputs)
    computed = run_with("run.order=computed")
    speeds = [float(r.signal("body.velocity")[-1, 2]) for r in (fixed, paced, computed)]
    assert fixed.error is paced.error is computed.error is None
    # the largest speed is 0.6 m/s; each step may be wrong by 1e-4 m/s and 1e-4 of it, and there are fewer than 100
    assert len(paced.record) - 1 < 100 < len(fixed.record)
    np.testing.assert_allclose(speeds, speeds[0], atol=100 * 2e-4)
    assert len(set(speeds)) == 3


def test_a_pattern_that_matches_no_output_is_refused() -> None:
    with pytest.raises(CouplingError, match=r"no output that carries numbers matches 'body\.velocty'; did you mean 'b"):
        run_with('run.control.outputs=["body.velocty"]')
