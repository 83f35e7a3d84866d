"""One line swaps the plant: what a scenario says of wheels, chassis and connections becomes the full-order robot's."""

from __future__ import annotations

import numpy as np
import pytest

from cosim.errors import ScenarioError
from logs.parts import by_parts, like, read_as
from plants.full_order import FullOrderRover
from plants.ring_press import pressed
from studies.assembly import Assembly, assemble
from studies.catalog import find_scenario, scenario_files
from studies.full_order import is_whole

LINE = 'body.type="FullOrderRover"'


def swapped(scenario: str, variant: str, *more: str) -> Assembly:
    file = find_scenario(scenario)
    return assemble(file.load(variant, file.overrides([LINE, *more])))


def body(assembly: Assembly) -> FullOrderRover:
    part = assembly.components["body"]
    assert isinstance(part, FullOrderRover)
    return part


def test_wheels_and_chassis_fall_away_and_describe_the_rings() -> None:
    made = swapped("ramp-impact", "uncontrolled")
    assert list(made.components) == ["controller", "body"]
    rover = body(made)
    assert pressed(rover)["k_w"] == pytest.approx(2.8e6, rel=1e-2)
    assert pressed(rover)["c_w"] == pytest.approx(0)
    assert (rover.mu_s, rover.mu_d, rover.laid_on) == (0.8, 0.3, 0.0)
    assert rover.modes == 25
    assert np.any(rover.values["wheel_shape"] != 0)


def test_friction_without_limit_is_laid_on() -> None:
    assert body(swapped("ramp-impact", "pd")).laid_on == 1.0


def test_a_rigid_chassis_can_be_asked_for() -> None:
    assert np.all(body(swapped("ramp-impact", "uncontrolled", "body.chassis=false")).values["wheel_shape"] == 0)


def test_the_same_controller_is_designed_from_a_press_test() -> None:
    """Its stiffness is that of the rings to the 1e-6 at which the search for their depth ends."""
    ours = swapped("ramp-impact-realistic", "pd").components["controller"]
    file = find_scenario("ramp-impact-realistic")
    theirs = assemble(file.load("pd")).components["controller"]
    assert ours.values["k_w"] == pytest.approx(theirs.values["k_w"], rel=1e-5)  # type: ignore[union-attr]
    assert ours.values["h0"] == pytest.approx(theirs.values["h0"], rel=1e-5)  # type: ignore[union-attr]


def test_what_stands_in_the_connections_of_wheels_stands_in_those_of_the_body() -> None:
    made = swapped("ramp-impact-late", "lag-5-ms")
    assert "traction_demand_to_body" in made.components
    wires = wired(made)
    assert wires["body.traction_demand"] == "traction_demand_to_body.y"
    assert wires["traction_demand_to_body.u"] == "controller.traction_demand"
    assert wires["controller.normal_force"] == "body.normal_force_end"
    assert wires["controller.gap"] == "body.gap"


def wired(made: Assembly) -> dict[str, str]:
    """Return the source of each input."""
    found = made.wiring({n: p.variables for n, p in made.components.items() if not isinstance(p, str)})
    return {target: source if isinstance(source, str) else source.source for target, source in found.items()}


def test_with_a_drive_the_rims_are_given_torques_and_slip_is_measured() -> None:
    made = swapped("slip-start", "slip-control", "drive.J_w=0.02", "drive.v_min=0.05")
    assert list(made.components) == ["controller", "body"]
    assert (body(made).J_w, body(made).v_min) == (0.02, 0.05)
    wires = wired(made)
    assert wires["body.torque"] == "controller.torque"
    assert "body.traction_demand" not in wires
    for name in ("slip", "slip_speed", "traction"):
        assert wires[f"controller.{name}"] == f"body.{name}"
    theirs = assemble(find_scenario("slip-start").load("slip-control")).components["controller"]
    ours = made.components["controller"]
    for name in ("curve", "mu_peak", "slip_peak", "C_x"):  # the friction curve that the scenario's drive has
        np.testing.assert_array_equal(ours.values[name], theirs.values[name])  # type: ignore[union-attr]


def test_without_a_drive_it_gives_the_traction_that_is_asked_for() -> None:
    wires = wired(swapped("steered-rough", "direct"))
    assert wires["body.traction_demand"] == "controller.traction_demand"
    assert "body.torque" not in wires
    assert wires["body.steer"] == "controller.steer"


def controllers() -> dict[str, tuple[str, str]]:
    """Return scenario and variant for each type of controller that the scenarios have."""
    found: dict[str, tuple[str, str]] = {}
    for name in scenario_files():
        file = find_scenario(name)
        for variant in file.variants or ("",):
            scenario = file.load(variant)
            if scenario.assembly == "rover" and not is_whole(scenario):
                found.setdefault(str(scenario.components["controller"].type), (name, variant))
    return found


@pytest.mark.parametrize(("scenario", "variant"), list(controllers().values()), ids=list(controllers()))
def test_no_controller_loses_a_connection(scenario: str, variant: str) -> None:
    """What it reads comes from somewhere, and what it gives goes somewhere, as on the analytical robot."""
    analytical, whole = wired(assemble(find_scenario(scenario).load(variant))), wired(swapped(scenario, variant))
    for wires in (analytical, whole):
        assert any(source.startswith("controller.") for source in wires.values())
    assert {t for t in analytical if t.startswith("controller.")} <= set(whole)
    given, taken = ({s for s in w.values() if s.startswith("controller.")} for w in (analytical, whole))
    assert given <= taken


def test_it_starts_settled_or_without_load() -> None:
    starts = swapped("ramp-impact", "uncontrolled").starts
    assert np.sum(starts["body.pressing"]) == pytest.approx((170 + 4 * 0.83) * 9.81)
    rising = swapped("ramp-impact", "uncontrolled", "body.gravity_time=0.1").starts
    assert "body.pressing" not in rising
    assert rising["body.r"][2] == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("wheels.k_w=-1.0", "takes one positive number for all wheels"),
        ("wheels.k_w=[1e5, 1e5, 2e5, 2e5]", "takes one positive number for all wheels"),
        ("body.chassis=3", "must be a table of the parameters of ChassisModal, or false"),
        ("body.micro_step=1e-3", "are stable up to"),
    ],
)
def test_what_cannot_be_is_said_in_a_sentence(change: str, words: str) -> None:
    with pytest.raises(ScenarioError, match=words):
        swapped("ramp-impact", "uncontrolled", change)


def test_readers_of_wheels_read_the_body_where_there_are_none() -> None:
    ports = {name: np.zeros(3) for name in ("body.normal_force", "body.pitch", "body.acceleration")}
    read = by_parts(ports.get)
    assert read("wheels.normal_force") is ports["body.normal_force"]
    assert read("chassis.acceleration") is None  # that of the body is another one
    assert by_parts({**ports, "body.station_acceleration": ports["body.pitch"]}.get)("chassis.acceleration") is not None
    assert read("body.pitch") is ports["body.pitch"]
    assert read("wheels.nothing") is None


def test_signals_of_wheels_are_those_of_the_body_where_there_are_none() -> None:
    whole, parts = ["body.gap", "body.gap_rate", "controller.gap"], ["body.gap", "wheels.gap"]
    assert like(whole, ["wheels.gap"]) == ["body.gap"]
    assert like(whole, ["wheels.*", "controller.*"]) == whole
    assert like(parts, ["wheels.*"]) == ["wheels.gap"]
    assert like(parts, []) == parts
    assert read_as(["wheels.*", "chassis.acceleration"], whole)["chassis.acceleration"] == "body.station_acceleration"
    assert like(["wheels.gap"], ["chassis.*"]) == []
