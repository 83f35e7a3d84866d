"""A log holds every port at every accepted step, bit by bit, and what is needed to know what it is."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from rerun.chunk import RrdReader
from toys import Gain, Scripted, Watch, port

from cosim import Jacobi, System, run
from logs import recorder
from logs.inspect import describe
from logs.read import others, properties, signals, texts
from logs.recorder import RerunRecorder
from studies.catalog import find_scenario
from studies.logged import log_observer
from studies.metrics import as_mapping
from studies.origin import checkout, host
from studies.places import source_checkout
from studies.runner import Result, execute

MS = 1_000_000


def entry(instance_port: str, causality: str) -> str:
    """Return what the reader calls a port."""
    component, _, name = instance_port.partition(".")
    return f"{component}.in.{name}" if causality == "input" else instance_port


@pytest.fixture(scope="module")
def impact(tmp_path_factory: pytest.TempPathFactory) -> tuple[Result, Path]:
    """Return 20 ms of the ramp impact, whose edge is met at 7.4 ms, and its log, of several chunks."""
    path = tmp_path_factory.mktemp("log") / "impact.rrd"
    file = find_scenario("ramp-impact")
    scenario = file.load("uncontrolled", file.overrides(["run.duration=0.02"]))

    def observers(assembly, instances, record):  # type: ignore[no-untyped-def]
        made = log_observer(assembly, path, instances, record)
        made.rows = 64
        return [made]

    return execute(scenario, observers), path


def test_every_port_has_the_bits_of_the_run(impact: tuple[Result, Path]) -> None:
    result, path = impact
    found, record = signals(path, "/plant/**"), result.record
    variables = {p: record._ports[p].variable for p in record.ports()}
    assert {entry(p, v.causality) for p, v in variables.items()} == set(found)
    for name, v in variables.items():
        logged = found[entry(name, v.causality)]
        np.testing.assert_array_equal(logged.ns, record.time_ns, err_msg=name)
        mine = np.ascontiguousarray(record[name].reshape(len(record), -1))
        assert logged.values.tobytes() == mine.tobytes(), name  # -0.0 and NaN count, too


def test_units_names_shapes_and_meanings_come_back(impact: tuple[Result, Path]) -> None:
    result, path = impact
    found = signals(path)
    for name in result.record.ports():
        v = result.record._ports[name].variable
        logged = found[entry(name, v.causality)]
        assert (logged.unit, logged.names, logged.shape, logged.meaning) == (v.unit, v.labels(), v.shape, v.meaning)
    assert found["master.step_size"].unit == "s"
    assert found["master.gap_mismatch"].unit == "m"


def test_what_was_taken_back_is_no_point(impact: tuple[Result, Path]) -> None:
    result, path = impact
    (start, end, reached, component), *_ = result.record.rejections
    assert component == "body"
    assert start < reached < end  # the edge lies inside a macro step
    ns = signals(path)["body.position"].ns
    assert reached in ns
    assert np.all(np.diff(ns) > 0)
    sizes = signals(path)["master.step_size"].values[:, 0]
    np.testing.assert_array_equal(sizes[1:], np.diff(ns) * 1e-9)  # no step overlaps another
    assert texts(path, "/events/**") == [(t, f"{who}: event at {t} ns") for t, who in result.record.events]


def test_configuration_provenance_and_verdict_are_in_it(impact: tuple[Result, Path]) -> None:
    result, path = impact
    found = properties(path)
    assert json.loads(found["run"]["config_json"]) == result.scenario.model_dump(mode="json")
    assert found["run"]["step_s"] == 1e-4
    tokens = [v for k, v in found["provenance"].items() if k.startswith("token_")]
    assert len(tokens) == len(result.assembly.components)
    assert all(len(token) > 30 for token in tokens)
    assert found["outcome"]["status"] == "complete"
    assert result.summary is not None
    assert (found["outcome"]["steps"], found["outcome"]["rejected"]) == (result.summary.steps, result.summary.rejected)
    known = {k: v for k, v in as_mapping(result.metrics).items() if v is not None}
    assert {k: v for k, v in found["metrics"].items() if v is not None} == known
    assert describe(path)["units"]["metrics"] == {m.key: m.unit for m in result.metrics}


def test_ports_of_other_types_are_exact(tmp_path: Path) -> None:
    """A number that no double holds, text and bytes come back as they were."""
    large = 2**53 + 1
    values = {"n": large, "on": True, "says": "läuft, [ok]", "raw": b"\x00\xff", "small": -7}
    types = {"n": "Int64", "on": "Boolean", "says": "String", "raw": "Binary", "small": "Int8"}
    part = Scripted([port(name, "output", kind) for name, kind in types.items()])
    part.get = lambda name: values[name]  # type: ignore[method-assign]
    path = tmp_path / "types.rrd"
    run(System({"a": part}, {}), Jacobi(), step=MS, stop=2 * MS, observers=[RerunRecorder(path, "types")])
    found = others(path)
    assert {name: found[f"a.{name}"][1] for name in types} == {name: [[v]] * 3 for name, v in values.items()}
    assert found["a.n"][0].tolist() == [0, MS, 2 * MS]
    assert signals(path)["a.small"].values.ravel().tolist() == [-7.0] * 3  # and a number can be plotted


def test_odd_names_come_back(tmp_path: Path) -> None:
    """Foreign FMUs call variables what they like."""
    names = ["der(x)", "a.b[1]", "two words", "slash/ed", "ünicode"]
    path = tmp_path / "odd.rrd"
    part = Scripted([port(name, "output") for name in names])
    run(System({"my fmu": part}, {}), Jacobi(), step=MS, stop=MS, observers=[RerunRecorder(path, "x")])
    assert {p for p in signals(path) if p.startswith("my")} == {f"my fmu.{name}" for name in names}


def test_a_log_carries_its_blueprint(impact: tuple[Result, Path]) -> None:
    assert [b.application_id for b in RrdReader(str(impact[1])).blueprints()] == [recorder.APPLICATION]


def test_only_the_signals_asked_for(tmp_path: Path) -> None:
    path = tmp_path / "few.rrd"
    system = System({"a": Watch().instance(), "g": Gain().instance()}, {"a.u": "a.y"})
    run(system, Jacobi(), step=MS, stop=MS, observers=[RerunRecorder(path, "x", signals=("g.*", "a.since"))])
    assert [p for p in signals(path) if not p.startswith("master.")] == ["a.since", "g.in.u", "g.y"]


def test_where_it_was_made_is_in_it(impact: tuple[Result, Path]) -> None:
    found = properties(impact[1])
    assert found["host"] == host()
    assert found.get("checkout", {}) == checkout(source_checkout())
    assert found["provenance"]["sources"]
