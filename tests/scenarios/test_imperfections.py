"""Sensors, actuators and mistaken designs in the rover's loop; and the claim of ramp-impact-late."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

from cosim import Component, ScenarioError, WiringError
from plants.planar import Bicycle, Posture
from plants.tables import robot
from studies.assembly import assemble
from studies.catalog import find_scenario
from studies.runner import Result, algorithm_of, connect, execute, instantiate

SENSED = ("gap", "gap_rate", "normal_force", "P", "U", "b_free")
STEP = 1e-4
SHORT: dict[str, Any] = {"run": {"duration": 0.06, "step": STEP}}  # s: the impact, at 7.4 ms, and what follows


def run(through: dict[str, Any], **more: Any) -> Result:
    result = execute(find_scenario("ramp-impact-late").load("pd", [SHORT, {"through": through, **more}]))
    assert result.error is None
    return result


@cache
def ideal() -> Result:
    return run({})


def test_perfect_sensors_and_actuators_change_nothing() -> None:
    """To the bit, on every connection of the controller, events that take everybody back included."""
    found = run({
        **{f"controller.{port}": {"type": "Sensor"} for port in SENSED},
        "wheels.traction_demand": [{"type": "Actuator"}, {"type": "Actuator"}],
    })  # fmt: skip
    assert found.summary is not None
    assert found.summary.rejected > 0
    for name in ("body.position", "body.orientation", "wheels.normal_force", "controller.traction_demand"):
        np.testing.assert_array_equal(found.record[name], ideal().record[name], err_msg=name)


def test_a_sensor_and_an_actuator_add_no_step_of_delay() -> None:
    """Body to controller is one step old with and without a sensor, controller to wheels none with an actuator."""
    through = {f"controller.{port}": {"type": "Sensor"} for port in SENSED}
    through["wheels.traction_demand"] = {"type": "Actuator", "lag": 5e-3}
    assembly = assemble(find_scenario("ramp-impact-late").load("pd", [{"through": through}]))
    with connect(assembly, instantiate(assembly)) as system:
        delays = system.delays(algorithm_of(assembly))
    for port in SENSED:
        assert (delays[f"{port}_to_controller.u"], delays[f"controller.{port}"]) == (1, 0)
    assert (delays["traction_demand_to_wheels.u"], delays["wheels.traction_demand"]) == (0, 0)


def test_the_controller_sees_what_the_sensor_says() -> None:
    found = run({"controller.gap": {"type": "Sensor", "quantum": 1e-4, "delay": 2}})
    seen, shown = found.record["controller.gap"], found.record["gap_to_controller.y"]
    np.testing.assert_array_equal(seen, shown)
    # A row is a macro step: what was sampled at the begin of the 10 of a tick is held over them, 2 ticks later.
    at_ticks = found.record["body.gap"][[np.searchsorted(found.record.time, t) for t in (0.0, 1e-3, 2e-3, 3e-3)]]
    rows = [np.searchsorted(found.record.time, t) for t in (2.05e-3, 3.05e-3, 4.05e-3, 5.05e-3)]
    np.testing.assert_allclose(seen[rows], 1e-4 * np.floor(at_ticks / 1e-4 + 0.5), atol=1e-18)


def test_noise_in_a_run_has_the_size_that_was_asked_for() -> None:
    """Relative to the gap at the ticks; the standard deviation of N numbers is off by 1/sqrt(2 N)."""
    found = run({"controller.gap": {"type": "Sensor", "noise": 1e-5, "seed": 7, "period": STEP}})
    steps = np.diff(found.record.time) > 0.99 * STEP  # whole ones, each with a sample at its begin
    noise = (found.record["gap_to_controller.y"][1:] - found.record["body.gap"][:-1])[steps]
    assert noise.size > 2000
    assert abs(np.std(noise) / 1e-5 - 1) < 5 / np.sqrt(2 * noise.size)
    again = run({"controller.gap": {"type": "Sensor", "noise": 1e-5, "seed": 7, "period": STEP}})
    np.testing.assert_array_equal(found.record["body.position"], again.record["body.position"])


def test_the_wheels_get_what_the_motor_gives() -> None:
    """First order on the saturated demand, exact over every step whatever its length."""
    lag, limit = 5e-3, 150.0
    found = run({"wheels.traction_demand": {"type": "Actuator", "lag": lag, "limit": limit}})
    asked = np.clip(found.record["controller.traction_demand"], -limit, limit)
    given = found.record["wheels.traction_demand"]
    keep = np.exp(-np.diff(found.record.time) / lag)[:, None]
    np.testing.assert_allclose(given[1:], asked[1:] + (given[:-1] - asked[1:]) * keep, atol=1e-9 * limit)
    assert np.any(np.abs(found.record["controller.traction_demand"]) > limit)


def test_a_variant_can_change_and_remove_one_number_of_an_element() -> None:
    file = find_scenario("ramp-impact-noise")
    noise = lambda changes: assemble(file.load("pd", changes)).components["gap_to_controller"]  # noqa: E731
    assert isinstance(noise([]), Component)
    assert np.all(noise([]).values["noise"] > 0)
    assert np.all(noise(file.overrides(["through.controller.gap.noise=0"])).values["noise"] == 0)
    assert "gap_to_controller" not in assemble(file.load("pd", [{"through": {"controller.gap": []}}])).components


def test_units_are_checked_at_both_ends_of_an_element() -> None:
    assembly = assemble(find_scenario("ramp-impact-late").load(
        "pd", [{"through": {"controller.gap": {"type": "Sensor", "unit": "mm"}}}]
    ))  # fmt: skip
    slots = {n: c.variables for n, c in assembly.components.items() if isinstance(c, Component)}
    assert assembly.wiring(slots)["gap_to_controller.u"]
    instances = {n: c.instance(n) for n, c in assembly.components.items() if isinstance(c, Component)}
    with pytest.raises(WiringError, match=r"body.gap \[m\] to gap_to_controller.u \[mm\].* multiplied by 1000"):
        connect(assembly, instances)


# mistaken designs


def controller(scenario: str, slot: dict[str, Any]) -> Component:
    file = find_scenario(scenario)
    made = assemble(file.load(file.load().variant, [{"components": {"controller": slot}}])).components["controller"]
    assert isinstance(made, Component)
    return made


@pytest.mark.parametrize("kind", ["PolePlacement", "PdImpact"])
def test_a_design_believes_in_the_robot_that_its_slot_names(kind: str) -> None:
    posture, heavy = Posture(0.3), {"m": 187.0}
    made = controller("ramp-impact-realistic", {"type": kind, "robot": heavy})
    for believed, changes in ((made, heavy), (controller("ramp-impact-realistic", {"type": "PolePlacement"}), {})):
        P = Bicycle(robot("thesis_6_1").with_changes(**changes)).P(posture)
        axles = believed.values["P_model"].reshape(2, 2, 2, 2).sum(axis=3).mean(axis=1)[::-1, ::-1]  # rear, front
        np.testing.assert_allclose(axles / axles[0, 0], P / P[0, 0], rtol=1e-12)


def test_a_design_believes_in_the_stiffness_that_its_slot_names() -> None:
    assert controller("ramp-impact-realistic", {"type": "PdImpact", "k_w": 1.2e5}).values["k_w"] == 1.2e5
    assert controller("ramp-impact-realistic", {"type": "PdImpact"}).values["k_w"] == 1e5  # the wheels'
    soft, stiff = (controller("ramp-impact-realistic", {"type": "PdImpact", "k_w": k}).values["h0"] for k in (1e5, 2e5))
    assert stiff == pytest.approx(2 * soft)  # h0 = k P22


@pytest.mark.parametrize(
    ("belief", "sentence"),
    [
        ({"mass": 187.0}, "components.controller: a robot has no 'mass'; known: m, I_y, L_f, L_r, h, R"),
        ({"m": -1.0}, "components.controller: robot.m is -1.0; it must be positive"),
        ({"m": "heavy"}, "components.controller: robot.m must be a number, not 'heavy'"),
    ],
)
def test_a_belief_is_checked(belief: dict[str, Any], sentence: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        controller("ramp-impact-realistic", {"type": "PolePlacement", "robot": belief})
    assert str(caught.value).startswith(sentence)


# ramp-impact-late


@cache
def peak(variant: str) -> float:
    result = execute(find_scenario("ramp-impact-late").load(variant))
    assert result.error is None
    return float(next(m.value for m in result.metrics if m.key == "front_normal_peak" and m.value is not None))


def lost(variant: str) -> float:
    """Return the share of what ideal control takes off the front peak that the imperfection costs."""
    return (peak(variant) - peak("pd")) / (peak("uncontrolled") - peak("pd"))


def test_control_takes_a_seventh_off_the_peak() -> None:
    assert peak("pd") / peak("uncontrolled") == pytest.approx(0.85, abs=0.02)


@pytest.mark.parametrize(
    ("variant", "least", "most"),
    [
        ("coarse", -0.02, 0.02),
        ("lag-5-ms", 0.28, 0.39),  # a third
        ("lag-20-ms", 0.61, 0.72),  # two thirds
        ("delay-10-ms", 0.8, 1.0),
        ("weak", 0.8, 1.0),
    ],
)
def test_what_an_imperfection_costs(variant: str, least: float, most: float) -> None:
    assert least < lost(variant) < most
