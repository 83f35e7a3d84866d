"""``explain`` says how a system is run: order, delays, loops, units, capabilities; the delays are counted in a run."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commandline import Command
from toys import Gain, Mass, Scripted, Spring, port, silent

import fmus
from cosim import Component, GaussSeidel, Jacobi, Link, Record, RunInfo, System, input, output, run, state
from cosim.consistent import Consistent
from studies import explanation
from studies.assembly import assemble
from studies.catalog import find_scenario
from studies.runner import execute

MS = 1_000_000  # ns
INFO = RunInfo(MS, 10 * MS, 0, "")
RING = """
title = "Two gains in a circle"
claim = "None."
[run]
step = 1e-3
duration = 1e-2
solve_loops = {solve}
[components.a]
fmu = "{fmu}"
[components.b]
fmu = "{fmu}"
every = 2
[connections]
"a.u" = "b.y"
"b.u" = {{ source = "a.y", factor = 0.25 }}
"""


def facts(wmr: Command, *arguments: object) -> dict[str, Any]:
    """Return the JSON document that a command prints."""
    said = wmr("explain", *arguments, "--json")
    assert (said.code, said.err) == (0, "")
    found: dict[str, Any] = json.loads(said.out)
    return found


@pytest.fixture(scope="module")
def rover() -> dict[str, Any]:
    """Return what there is to know about the rover before an impact."""
    return explanation.scenario_facts("ramp-impact", "pd")


# the delays are what a run shows


def shown_delays(connections: list[dict[str, Any]], record: Record) -> dict[str, int]:
    """Return for each connection how many points old the value is that its target holds, told from the record.

    Connections of constant values could have any delay and are left out.
    """
    found = {}
    for c in connections:
        source, target = _element(record, c["source"]), _element(record, c["target"])
        expected = c["factor"] * source + c["offset"]
        fits = [d for d in range(4) if np.array_equal(target[4:], expected[4 - d : len(expected) - d])]
        if len(fits) == 1:
            found[c["target"]] = fits[0]
    return found


def _element(record: Record, name: str) -> np.ndarray:
    port, bracket, index = name.partition("[")
    return record[port][:, int(index[:-1]) - 1] if bracket else record[port]


@pytest.mark.parametrize("algorithm", ["gauss-seidel", "jacobi"])
def test_the_delays_of_the_rover_are_those_of_a_run(algorithm: str) -> None:
    file = find_scenario("ramp-impact")
    changes = [f"run.algorithm={algorithm}", "run.duration=2e-2"]
    found = explanation.scenario_facts("ramp-impact", "pd", changes)["connections"]
    scenario = file.load("pd", file.overrides(changes))
    record = execute(scenario).record
    counted = shown_delays(found, record)
    assert len(counted) >= len(found) - 2  # P and U may stand still before the ramp
    assert counted == {c["target"]: c["delay"] for c in found if c["target"] in counted}
    assert set(counted.values()) == ({0, 1} if algorithm == "gauss-seidel" else {1})


class Pulse(Component):
    """1 for one step, 0 before and after."""

    n = state(0.0, "1", "steps so far")
    y = output("1", "the pulse: 1 at the end of the third step")

    def sync(s: Any) -> dict[str, Any]:
        return dict(n=s.n + 1)

    def outputs(s: Any) -> dict[str, Any]:
        import casadi as ca

        return dict(y=ca.if_else(ca.fabs(s.n - 3) < 0.5, 1, 0))


class Pass(Component):
    """Shows after a step what its input was during it."""

    kept = state(0.0, "1", "the input")
    u = input("1", "what goes in")
    y = output("1", "what went in")

    def sync(s: Any) -> dict[str, Any]:
        return dict(kept=s.u)

    def outputs(s: Any) -> dict[str, Any]:
        return dict(y=s.kept)


@pytest.mark.parametrize(
    "algorithm", [Jacobi(), GaussSeidel(), GaussSeidel(("c", "b", "a", "pulse")), GaussSeidel(("b", "pulse", "c", "a"))]
)
def test_a_pulse_needs_the_sum_of_the_delays(algorithm: Jacobi | GaussSeidel) -> None:
    parts = {"pulse": Pulse().instance(), **{name: Pass().instance() for name in "abc"}}
    system = System(parts, {"a.u": "pulse.y", "b.u": "a.y", "c.u": "b.y"})
    found = explanation.connection_facts(system, algorithm, INFO)
    assert {c["target"]: c["delay"] for c in found} == system.delays(algorithm)
    assert [c["delay_s"] for c in found] == [c["delay"] * 1e-3 for c in found]
    record = Record()
    run(system, algorithm, step=MS, stop=10 * MS, observers=[record])
    assert int(np.argmax(record["pulse.y"])) == 3
    assert int(np.argmax(record["c.y"])) == 3 + sum(c["delay"] for c in found)


# what is said of the rover


def test_order_and_rates_of_the_rover(rover: dict[str, Any]) -> None:
    assembly = assemble(find_scenario("ramp-impact").load("pd"))
    assert tuple(c["component"] for c in rover["order"]) == assembly.order
    assert [(c["component"], c["steps_on_new"], c["steps_on_old"]) for c in rover["order"]] == [
        ("controller", [], ["wheels", "body"]),
        ("wheels", ["controller"], ["body"]),
        ("body", ["wheels"], []),
        ("chassis", ["body"], []),
    ]
    assert [c["period"] for c in rover["order"]] == [1e-4, None, None, None]
    assert all(not c["late"] for c in rover["order"])


def test_the_rover_has_no_loop_and_says_what_nobody_drives(rover: dict[str, Any]) -> None:
    assert rover["loops"] == []
    assert {i["port"] for i in rover["unconnected"]} == {
        "wheels.lateral_demand", "body.steer", "body.force", "body.moment",
    }  # fmt: skip


def test_units_of_the_rover(rover: dict[str, Any]) -> None:
    units = {c["target"]: (c["unit"], c["values"]) for c in rover["connections"]}
    assert units["wheels.P"] == ("1/kg", 16)
    assert units["body.normal_force"] == ("N", 4)


def test_what_the_rover_allows(rover: dict[str, Any]) -> None:
    possible = {a["what"]: (a["possible"], a["why"]) for a in rover["allows"]}
    events = "events located, everybody brought to the instant"
    assert possible[events] == (True, "body may return early; controller, wheels, body go back then")
    assert possible["compiled loop, no Python per step"][0]


# what is said of others


def ring(tmp_path: Path, solve: str = "false") -> Path:
    """Write a scenario of two FMUs that form a loop."""
    path = tmp_path / "ring.toml"
    path.write_text(RING.format(fmu=fmus.build(Gain()), solve=solve))
    return path


def test_a_loop_is_shown_with_its_path_and_how_it_is_handled(wmr: Command, tmp_path: Path) -> None:
    (loop,) = facts(wmr, ring(tmp_path))["loops"]
    assert loop["path"] == ["a.u", "a.y", "b.u", "b.y", "a.u"]
    assert loop["equations"] == 2
    assert loop["at_start"] == "solved by Newton's method with the components' own derivatives"
    assert loop["at_points"].startswith("not solved: each connection is as old as its delay says")
    (solved,) = facts(wmr, ring(tmp_path, "true"))["loops"]
    assert solved["at_points"] == "solved in the same way"
    assert facts(wmr, ring(tmp_path, "true"))["algorithm"].startswith("Consistent(algorithm=GaussSeidel(")


def test_tables_fit_a_page_and_are_plain_where_there_is_no_terminal(wmr: Command, tmp_path: Path) -> None:
    for what in ([ring(tmp_path)], ["ramp-impact", "--variant", "pd"], [fmus.build(Mass()), fmus.build(Gain(), fmi=2)]):
        said = wmr("explain", *what)
        assert (said.code, said.err) == (0, "")
        assert max(map(len, said.out.splitlines())) <= 100
        assert "\x1b" not in said.out
        assert "…" not in said.out  # nothing is cut off


def test_conversions_and_long_steps_are_shown(wmr: Command, tmp_path: Path) -> None:
    text = wmr("explain", ring(tmp_path)).out
    assert "a.u -> a.y -> b.u -> b.y -> a.u" in text
    (line,) = [line for line in text.splitlines() if line.startswith("a.y")]
    assert line.split() == ["a.y", "b.u", "1", "1", "none", "x", "0.25"]
    (line,) = [line for line in text.splitlines() if line.startswith("b.y")]
    assert line.split() == ["b.y", "a.u", "1", "1", "1", "step", "(1", "ms)", "2", "steps"]


def test_fmus_alone(wmr: Command) -> None:
    found = facts(wmr, fmus.build(Spring()), fmus.build(Spring(), fmi=2))["components"]
    assert [c["kind"] for c in found.values()] == ["FMI 3.0 FMU", "FMI 2.0 FMU"]
    assert [c["get_after_set"] for c in found.values()] == [True, False]
    assert all(c["feeds_through"] == {"F": ["x", "v"]} for c in found.values())
    assert all(c["rollback"] and c["directional_derivatives"] for c in found.values())


def allows(system: System, algorithm: Any) -> dict[str, tuple[bool, str]]:
    """Return what a system allows, by what it is."""
    return {a["what"]: (a["possible"], a["why"]) for a in explanation.allowed(system, algorithm, INFO)}


def test_who_prevents_what_is_named() -> None:
    parts = {"good": silent(rollback=True, directional_derivatives=True), "poor": silent(variable_step=False)}
    found = allows(System(parts, {}), Jacobi())
    assert found["step control with error estimate, iterated coupling"] == (
        False,
        "poor cannot be taken back to the start of a step; steps stay fixed; the other algorithms remain",
    )
    assert found["macro steps of any length"][1].startswith("poor needs steps of equal length")
    assert found["exact Jacobians (interface Newton, linearisation)"][1].startswith("poor gives no")
    assert found["events located, everybody brought to the instant"] == (
        False, "no component announces events, so there are none to locate",
    )  # fmt: skip
    assert found["compiled loop, no Python per step"] == (
        False,
        "good is no FMU that is stepped by its C functions alone; the readable loop makes the same steps",
    )


def test_the_loop_that_was_asked_for_is_told(tmp_path: Path) -> None:
    for wanted, why in (("false", "switched off: run.compiled = false"), ("true", "every component is an FMU; ")):
        facts = explanation.scenario_facts(str(ring(tmp_path)), changes=[f"run.compiled={wanted}"])
        (found,) = (a for a in facts["allows"] if a["what"] == "compiled loop, no Python per step")
        assert found["possible"] == (wanted == "true")
        assert found["why"].startswith(why)


def test_events_that_cannot_be_located_say_why() -> None:
    parts = {"a": silent(), "b": silent(early_return=True, rollback=True)}
    possible, why = allows(System(parts, {}), GaussSeidel())["events located, everybody brought to the instant"]
    assert not possible
    assert "a cannot be taken back to an earlier state" in why


def test_what_is_shown_a_step_late_is_told() -> None:
    def late(algorithm: Any) -> dict[str, list[str]]:
        parts = {"m": Mass().instance(), "s": Spring().instance()}
        system = System(parts, {"s.x": "m.pos", "m.F": "s.F"})
        return {c["component"]: c["late"] for c in explanation.order_facts(system, algorithm, INFO, None)}

    assert late(GaussSeidel(("s", "m"))) == {"s": ["m"], "m": []}
    assert late(GaussSeidel(("m", "s"))) == {"s": [], "m": []}
    assert late(Consistent(Jacobi())) == {"s": [], "m": []}


def test_an_assumed_loop_and_differences_are_told() -> None:
    parts = {"a": Gain().instance(), "b": Scripted([port("u", "input"), port("y", "output", depends_on=None)])}
    system = System(parts, {"a.u": Link("b.y"), "b.u": "a.y"})
    (loop,) = explanation.system_facts(system, Jacobi(), INFO)["loops"]
    assert loop["assumed"] == ["b.y"]
    assert loop["at_start"] == "solved by Newton's method with finite differences for b"


def test_bad_input_is_one_sentence(wmr: Command) -> None:
    assert wmr("explain", "ramp-impact", "x.fmu").err == (
        "error: explain takes one scenario, or FMU files only, not ramp-impact, x.fmu\n"
    )
    said = wmr("explain", "ramp-impct")
    assert said.code == 1
    assert "did you mean 'ramp-impact'" in said.err


def test_who_is_trusted_does_not_prevent_loops_from_being_solved() -> None:
    what = "algebraic loops solved at communication points"
    system = System({"old": silent(get_after_set=False)}, {})
    assert allows(system, Jacobi())[what] == (
        False, "old does not promise outputs between steps (FMI 2.0); name it in run.trusted to have it tried",
    )  # fmt: skip
    assert allows(system, Consistent(Jacobi(), trusted=("old",)))[what][0]
