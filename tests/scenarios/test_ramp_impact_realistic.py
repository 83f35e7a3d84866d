"""The ramp-impact-realistic scenario keeps its claim: damping in the wheel does it, control within friction helps."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from studies.catalog import find_scenario
from studies.metrics import as_mapping
from studies.runner import Result, execute

FILE = find_scenario("ramp-impact-realistic")
STATIC = ("pd", "pole-placement", "pole-placement-observer", "lqr")  # laws that hold the static deflection
MISTAKEN = ("pd-mistaken", "pole-placement-mistaken")


@cache
def run(variant: str) -> Result:
    result = execute(FILE.load(variant))
    assert result.error is None
    return result


def verdict(variant: str) -> dict[str, float]:
    return {key: value for key, value in as_mapping(run(variant).metrics).items() if value is not None}


def test_undamped_wheels_rebound() -> None:
    found = verdict("uncontrolled-undamped")
    assert found["front_off"] > 300
    assert found["front_rebounds"] >= 3


@pytest.mark.parametrize("variant", ["uncontrolled", *STATIC, "pd-planned", *MISTAKEN])
def test_damped_wheels_stay_on_the_ground(variant: str) -> None:
    """The rears too, which reach the ramp at 0.8 s; friction is never exceeded."""
    found = verdict(variant)
    assert found["front_off"] == found["rear_off"] == found["airborne"] == 0
    assert found["friction_used"] <= 1 + 1e-9


def test_without_control_the_fronts_are_unloaded_for_a_moment() -> None:
    assert 1 < verdict("uncontrolled")["front_unloaded"] < 10  # ms


@pytest.mark.parametrize("variant", [*STATIC, *MISTAKEN])
def test_control_lowers_the_peak_by_a_tenth_and_keeps_all_wheels_loaded(variant: str) -> None:
    """Also where the design believes in 10 % more mass and 20 % more stiffness than there is."""
    found = verdict(variant)
    assert found["front_normal_peak"] < 0.9 * verdict("uncontrolled")["front_normal_peak"]
    assert found["front_unloaded"] == found["rear_unloaded"] == 0
    assert found["actuator_energy"] > 300  # J, which is what it takes


def test_the_planned_path_raises_the_peak() -> None:
    """It follows the approach speed into the wheel and overshoots the static deflection."""
    assert verdict("pd-planned")["front_normal_peak"] > 1.1 * verdict("uncontrolled")["front_normal_peak"]


def test_friction_limits_every_law() -> None:
    """The fronts' demand is at its limit for part of the time: h1 * 0.6 m/s is about 50 m/s2, |U mu F_n| a few."""
    for variant in (*STATIC, "pd-planned"):
        saturated = run(variant).record["controller.saturated"][:, :2]
        assert 0.01 < np.mean(saturated) < 0.5
