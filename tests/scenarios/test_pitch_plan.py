"""The pitch-plan scenario keeps its claim: what the plan reaches with and without feedback, its mass known or not."""

from functools import cache
from typing import Any

import numpy as np
import pytest

from cosim.errors import ScenarioError
from studies.assembly import assemble
from studies.catalog import find_scenario
from studies.metrics import as_mapping
from studies.runner import Result, execute

BETA, START, T = 0.1, 0.2, 1.38  # rad, s, s
FILE = find_scenario("pitch-plan")


@cache
def run(variant: str) -> Result:
    """Return a finished run of a variant."""
    result = execute(FILE.load(variant))
    assert result.error is None
    return result


def at_the_end(result: Result) -> tuple[float, float, float]:
    """Return the errors of pitch (rad), pitch rate (rad/s) and way of the body (m) at the planned end."""
    i = int(np.argmin(np.abs(result.record.time - START - T)))
    rate, x = -result.record["body.rate"][i, 1], result.record["body.position"][i, 0]
    return float(result.record["body.pitch"][i] - BETA), float(rate), float(x - 0.25 * (START + T))


def worst_error(result: Result) -> float:
    """Return the largest pitch error during the manoeuvre, rad."""
    on = result.record["controller.active"] > 0.5
    return float(np.max(np.abs(result.record["controller.pitch_error"][on])))


@pytest.mark.parametrize("variant", ["open-loop", "feedback"])
def test_with_the_mass_known_the_plan_is_followed(variant: str) -> None:
    """A force held for h = 1 ms errs by (h/T)^2 of itself, 5e-7; on the crest, unstable, that grows some 100-fold."""
    pitch, rate, way = at_the_end(run(variant))
    assert abs(pitch) < 1e-5 * BETA
    assert abs(rate) < 1e-4 * BETA / T
    assert abs(way) < 1e-4
    assert worst_error(run(variant)) < 1e-4 * BETA


def test_without_feedback_a_robot_heavier_than_planned_rolls_back() -> None:
    pitch, rate, _ = at_the_end(run("open-loop-mass-error"))
    assert pitch < -0.9 * BETA
    assert rate < 0
    speed = run("open-loop-mass-error").record["body.velocity_body"][:, 0]
    assert speed[-1] < -0.5
    assert np.max(run("open-loop-mass-error").record["body.pitch"]) < 0.9 * BETA


def test_with_feedback_it_arrives() -> None:
    """Critically damped feedback keeps the error below what the missing tenth of the force does to a standing one.

    e <= max of (F - F_planned) (Phi^2 + Phi_0^2) / (Phi h0), with the forces and gains of the plan.
    """
    result = run("feedback-mass-error")
    controller: Any = result.assembly.components["controller"]
    planned = controller.plan[1:-1]
    missing = planned[:, 1] * (270 / 243 - 1)
    Phi = planned[:, 3]
    bound = float(np.max(missing * (Phi**2 + controller.Phi_0**2) / (Phi * controller.h0)))
    assert bound < 0.01 * BETA
    assert 0.3 * bound < worst_error(result) < bound
    pitch, rate, way = at_the_end(result)
    assert abs(pitch) < 1e-5 * BETA  # on the level top, a little behind: the pitch no longer depends on the place
    assert abs(rate) < 1e-3 * BETA / T
    assert -5e-3 < way < 0


@pytest.mark.parametrize("name", ["m", "I_y", "L_f", "L_r", "h", "R"])
@pytest.mark.parametrize("factor", [0.9, 1.1])
def test_with_feedback_any_tenth_of_error_arrives(name: str, factor: float) -> None:
    """Ten per cent of the force at most: the bound for the mass, twice over since the ground's own dimensions enter."""
    true = {"m": 270, "I_y": 47, "L_f": 0.6, "L_r": 0.46, "h": 0.4, "R": 0.1}[name]
    result = execute(FILE.load("feedback", [{"components": {"controller": {"robot": {name: factor * true}}}}]))
    pitch, rate, way = at_the_end(result)
    assert worst_error(result) < 0.01 * BETA
    assert abs(pitch) < 1e-5 * BETA
    assert abs(rate) < 1e-3 * BETA / T
    assert abs(way) < 5e-3


def test_a_robot_lighter_than_planned_is_too_fast_unless_there_is_feedback() -> None:
    lighter = {"components": {"controller": {"robot": {"m": 297}}}}
    speeds = {}
    for variant in ("open-loop", "feedback"):
        result = execute(FILE.load(variant, [lighter]))
        top = np.argmax(result.record["body.pitch"] > BETA * (1 - 1e-6))
        speeds[variant] = float(result.record["body.velocity_body"][top, 0])
        assert abs(at_the_end(result)[0]) < 1e-5 * BETA
    # 10 % more work than against gravity: v^2 = v_0^2 + 0.2 g (rise of the body), here 0.06 + 0.09
    assert speeds["open-loop"] > 2 * 0.25
    assert abs(speeds["feedback"] - 0.25) < 0.05 * 0.25


def test_the_verdict_has_the_errors_at_arrival() -> None:
    """From the ports of the controller; here once more from the motion itself, to rounding."""
    for variant in ("open-loop-mass-error", "feedback-mass-error"):
        figures = as_mapping(run(variant).metrics)
        pitch, rate, _ = at_the_end(run(variant))
        assert figures["pitch_error"] == pytest.approx(1e3 * worst_error(run(variant)), rel=1e-12)
        # pitch counts from the level at the start, where rigid wheels are off it by their compliance of 1e-13 m/N
        assert figures["pitch_arrival_error"] == pytest.approx(1e3 * abs(pitch), abs=1e-6)
        assert figures["pitch_arrival_rate"] == pytest.approx(1e3 * abs(rate), rel=1e-12)


def test_both_axles_stay_on_the_ground_and_never_brake_or_slip() -> None:
    record = run("feedback").record
    assert np.min(record["wheels.normal_force"][1:]) > 0
    assert np.min(record["controller.traction_demand"]) > -1e-3
    assert np.all(record["wheels.traction"] <= record["wheels.friction_limit"] + 1e-9)


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"start": {"speed": 2.0}}, r"takes at least 0.2539 s without braking; start with at most 1.359 m/s"),
        ({"components": {"wheels": {"mu": 0.36}}, "start": {"speed": 1.0}}, r"on a ground with mu = 0.36; start with"),
        ({"components": {"wheels": {"mu": 0.3}}}, r"needs a friction coefficient of 0.34\d* however slow it is"),
        ({"start": {"x": 0.5}}, r"begins where the front wheel centres are at x = 0.65 m, but they start at 1.1 m"),
        ({"start": {"speed": 0.0}}, r"start.speed is 0 m/s, but the pitch manoeuvre needs a robot that moves forward"),
        ({"ground": {"kind": "ramp", "angle": 0.3}}, r'is made for a pitch-manoeuvre .* not for a Ramp and a Ramp'),
        ({"robot": {"h": 0.35}}, r"ground.h of the pitch-manoeuvre is 0.4 m, but the robot has 0.35 m"),
    ],
)  # fmt: skip
def test_what_cannot_be_planned_is_said(changes: dict[str, Any], sentence: str) -> None:
    with pytest.raises(ScenarioError, match=sentence):
        assemble(FILE.load("open-loop", [changes]))
