"""The full-order-ramp scenario keeps its claim: what feedback can do without limit, and what friction leaves."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from cosim.errors import ScenarioError
from studies.assembly import assemble
from studies.catalog import find_scenario
from studies.metrics import as_mapping
from studies.picture import drawable
from studies.runner import Result, execute
from studies.sketch import instants, sketch

FILE = find_scenario("full-order-ramp")
SHORT = FILE.overrides(["run.duration=0.45"])  # s; the impact is at 0.3 s, 0.6 m at 2 m/s


@cache
def run(variant: str) -> Result:
    result = execute(FILE.load(variant, SHORT))
    assert result.error is None
    return result


def verdict(variant: str) -> dict[str, float]:
    return {key: value for key, value in as_mapping(run(variant).metrics).items() if value is not None}


def test_before_the_impact_the_robot_has_settled() -> None:
    """Gravity rose in 0.2 s: every axle carries its share, and what is left of its swinging is below 5 % of it."""
    result = run("uncontrolled")
    t, F = result.record.time, result.signal("wheels.normal_force")
    assert F is not None
    settled = F[(t > 0.2) & (t < 0.295)]
    front = 9.81 * (170 * 0.46 / 1.06 / 2 + 0.83)
    rear = 9.81 * (170 * 0.6 / 1.06 / 2 + 0.83)
    np.testing.assert_allclose(settled.mean(axis=0), [front, front, rear, rear], rtol=0.05)


def test_uncontrolled_the_wheels_rebound() -> None:
    found = verdict("uncontrolled")
    assert found["front_off"] > 100  # of 150 ms


@pytest.mark.parametrize("variant", ["pd", "observer"])
def test_feedback_without_limit_keeps_every_wheel_down(variant: str) -> None:
    """At many times the friction there is: the largest traction over normal force is above 10."""
    found = verdict(variant)
    assert found["front_off"] == found["rear_off"] == 0
    assert found["friction_needed"] > 10


@pytest.mark.parametrize("variant", ["pd-friction", "playback"])
def test_within_friction_and_open_loop_they_rebound(variant: str) -> None:
    assert verdict(variant)["front_off"] > 100


def test_unlimited_forces_played_back_throw_the_robot_off() -> None:
    """One axle in the air leaves the other's 245 kN alone, 1400 m/s2: more than 10 m/s in less than 20 ms."""
    assert max(-verdict("playback")["speed_min"], verdict("playback")["speed_max"]) > 10


def test_it_is_drawn_like_any_rover() -> None:
    """Pictures and sketches ask for the ports of wheels."""
    assert drawable([run("pd")])
    assert "largest front force" in instants(run("pd"))
    assert sketch([run("pd")]) is not None


def test_wheels_and_drives_of_others_are_refused() -> None:
    with pytest.raises(ScenarioError, match="has its own wheels"):
        assemble(FILE.load("pd", FILE.overrides(['wheels.fmu="mine.fmu"'])))


def test_a_start_on_the_slope_is_refused() -> None:
    with pytest.raises(ScenarioError, match=r"meet something else; change start\.x"):
        assemble(FILE.load("pd", FILE.overrides(["start.x=0.6"])))
