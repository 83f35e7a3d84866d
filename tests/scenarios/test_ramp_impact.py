"""The ramp-impact scenarios keep their claims: what impact control does with unlimited traction, friction and noise."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from studies.catalog import find_scenario
from studies.metrics import as_mapping
from studies.runner import Result, execute

LAWS = ("pd", "pd-planned", "pd-static", "pole-placement", "pole-placement-observer", "lqr", "playback")
BY_NOISE = ("pd", "pole-placement", "pole-placement-observer", "pd-observer")


@cache
def run(scenario: str, variant: str, seed: int = 0) -> Result:
    """Return a finished run; *seed* moves the seeds of all sensors."""
    file = find_scenario(scenario)
    sensors = file.table.get("through", {})
    moved = {port: {"seed": slot["seed"] + seed} for port, slot in sensors.items()}
    result = execute(file.load(variant, [{"through": moved}] if moved else []))
    assert result.error is None
    return result


def verdict(scenario: str, variant: str, seed: int = 0) -> dict[str, float]:
    return {key: value for key, value in as_mapping(run(scenario, variant, seed).metrics).items() if value is not None}


def friction_needed(result: Result) -> float:
    """Return the largest share of its normal force that a wheel's traction is."""
    F, traction = result.record["wheels.normal_force"], np.abs(result.record["wheels.traction"])
    return float(np.max(traction[F > 1.0] / F[F > 1.0]))


def test_without_control_the_fronts_rebound() -> None:
    """Two rebounds, most of 0.3 s in the air; a peak of v sqrt(k / P22) = 13.8 kN, and the load they carried before."""
    found = verdict("ramp-impact", "uncontrolled")
    assert found["front_rebounds"] >= 2
    assert found["front_off"] > 200
    assert 13.8e3 < found["front_normal_peak"] < 13.8e3 + 2 * 170 * 9.81 * 0.46 / 1.06  # a load applied at once: twice


@pytest.mark.parametrize("law", LAWS)
def test_unlimited_traction_keeps_all_wheels_on_the_ground(law: str) -> None:
    found = verdict("ramp-impact", law)
    assert found["front_off"] == found["rear_off"] == 0
    assert found["front_rebounds"] == found["rear_rebounds"] == 0
    # the price: what no ground transmits
    assert friction_needed(run("ramp-impact", law)) > 2


@pytest.mark.parametrize("law", LAWS)
def test_within_friction_no_law_does(law: str) -> None:
    found = verdict("ramp-impact", f"{law}-friction")
    assert found["front_off"] > 200
    assert found["front_rebounds"] >= 1
    assert found["friction_used"] <= 1 + 1e-9


def test_the_planned_path_is_tracked_ten_times_better_than_a_step() -> None:
    """Fig 6.11: the plan starts where the wheels are, a step does not."""
    step, plan = (verdict("ramp-impact", name)["tracking_error"] for name in ("pd", "pd-planned"))
    assert plan < 0.1 * step


def test_the_estimate_is_close_to_the_deformation_it_cannot_see() -> None:
    """From 10 ms after the impact on, within 5 % of the deepest deformation."""
    record = run("ramp-impact", "pole-placement-observer").record
    late = record.time > 0.0174
    gap, estimate = record["body.gap"][:-1], record["controller.estimate"][1:]  # of the tick at the step's start
    assert np.max(np.abs(estimate - gap)[late[:-1]]) < 0.05 * np.max(np.abs(gap))


@pytest.mark.parametrize("law", ["pole-placement-observer", "pd-observer"])
def test_with_noise_observed_deformations_keep_contact(law: str) -> None:
    for seed in (0, 10):
        found = verdict("ramp-impact-noise", law, seed)
        assert found["front_off"] == found["rear_off"] == 0


@pytest.mark.parametrize("law", ["pd", "pole-placement"])
def test_with_noise_measured_deformations_lose_it(law: str) -> None:
    for seed in (0, 10):
        assert verdict("ramp-impact-noise", law, seed)["front_off"] > 10
