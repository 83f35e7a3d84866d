"""What a script or a notebook calls: a scenario, a run with a component of one's own, a comparison."""

from __future__ import annotations

from pathlib import Path

import casadi as ca
import numpy as np
import pytest

import studies
from cosim import Component, input, output, parameter
from cosim.errors import ScenarioError
from plants.rigid_body import RigidBody
from studies.assembly import assemble
from studies.catalog import find_scenario
from studies.runner import execute

SHORT = {"duration": 2e-3}


class Push(Component):
    """Traction of a share of what each wheel carries."""

    share = parameter(0.1, "1", "traction per normal force")
    normal_force = input("N", "normal force of each wheel", shape=4)
    traction_demand = output("N", "traction asked of each wheel", shape=4)

    def outputs(s):  # type: ignore[no-untyped-def]
        return {"traction_demand": s.share * ca.fmax(0, s.normal_force)}


def test_a_rover_has_a_body_also_where_only_its_parameters_are_given() -> None:
    file = find_scenario("ramp-impact")
    made = assemble(file.load("pd", file.overrides(["body.traction_arm=centre"])))
    body = made.components["body"]
    assert isinstance(body, RigidBody)
    assert body.structure["traction_arm"] == "centre"
    assert body.m == 170.0  # of the robot


def test_changes_are_those_of_the_command_line() -> None:
    file = find_scenario("ramp-impact")
    texts = file.overrides(["wheels.c_w=0", "run.duration=0.002", "components.wheels.k_w=2e5"])
    given = studies.scenario(
        "ramp-impact", "uncontrolled", wheels={"c_w": 0}, run=SHORT, components={"wheels": {"k_w": 2e5}}
    )
    assert given == file.load("uncontrolled", texts)
    assert studies.scenario("ramp-impact") == file.load()
    with pytest.raises(ScenarioError, match=r"there is no scenario 'ramp-impac'; did you mean 'ramp-impact'\?"):
        studies.scenario("ramp-impac")


@pytest.mark.parametrize("variant", ["uncontrolled", "pd"])
def test_an_object_stands_in_a_slot(variant: str) -> None:
    """Whether the slot is empty in the scenario or not; the demand is the share of the forces it is shown."""
    result = studies.run("ramp-impact", variant, parts={"controller": Push(share=0.2)}, run=SHORT)
    assert result.error is None
    demand, force = result.record["controller.traction_demand"], result.record["controller.normal_force"]
    np.testing.assert_array_equal(demand[1:], 0.2 * force[1:])
    assert np.all(demand[1:] > 10)
    assert result.assembly.notes[-1] == (
        "an object of the class Push stands in the slot controller, which a log cannot run again"
    )


def test_what_does_not_fit_a_slot_is_refused() -> None:
    plan = studies.scenario("ramp-impact", "pd", run=SHORT)
    with pytest.raises(ScenarioError, match=r"ramp-impact: there is no slot 'controler'; did you mean 'controller'\?"):
        execute(plan, parts={"controler": Push()})
    with pytest.raises(ScenarioError, match="a slot takes an object of a component"):
        execute(plan, parts={"controller": Push})  # type: ignore[dict-item]


def test_they_say_in_a_line_what_they_are(tmp_path: Path) -> None:
    result = studies.run("ramp-impact", "uncontrolled", run=SHORT)
    n = len(result.metrics)
    assert repr(result) == f"<Result of ramp-impact uncontrolled: 20 steps to 0.002 s, {n} figures>"
    compared = studies.compare("ramp-impact", "uncontrolled", "pd", out=tmp_path, run=SHORT)
    assert repr(compared) == f"<Comparison of uncontrolled, pd, logs {tmp_path / 'ramp-impact-all.rrd'}>"
    done = compared.runs[0]
    assert repr(done) == f"{result!r}"[:-1] + f", log {tmp_path / 'ramp-impact-uncontrolled.rrd'}>"
