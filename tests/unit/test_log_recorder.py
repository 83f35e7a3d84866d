"""A log holds every port at every accepted step, bit by bit, and what is needed to know what it is."""

from __future__ import annotations

import gc
import json
import os
import signal
import time
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from rerun.chunk import RrdReader
from toys import Gain, Scripted, Watch, port

from cosim import Advance, Jacobi, Observer, Point, System, run
from cosim.errors import ScenarioError, StepError
from logs import recorder
from logs.inspect import describe
from logs.read import others, properties, signals, texts
from logs.recorder import RerunRecorder
from studies.catalog import find_scenario
from studies.metrics import as_mapping
from studies.origin import checkout, host
from studies.places import source_checkout
from studies.runner import Result, execute
from studies.session import log_observer

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


def watched() -> System:
    return System({"a": Watch().instance(), "g": Gain().instance()}, {"a.u": "a.y"})


class Peek(RerunRecorder):
    """A recorder that says which files there are at every point."""

    seen: list[list[str]]

    def accepted(self, point):  # type: ignore[no-untyped-def]
        super().accepted(point)
        self.seen.append(sorted(p.name for p in self.path.parent.iterdir()))


def test_odd_names_come_back(tmp_path: Path) -> None:
    """Foreign FMUs call variables what they like."""
    names = ["der(x)", "a.b[1]", "two words", "slash/ed", "ünicode"]
    path = tmp_path / "odd.rrd"
    part = Scripted([port(name, "output") for name in names])
    run(System({"my fmu": part}, {}), Jacobi(), step=MS, stop=MS, observers=[RerunRecorder(path, "x")])
    assert {p for p in signals(path) if p.startswith("my")} == {f"my fmu.{name}" for name in names}


def test_a_log_is_called_part_until_it_is_complete(tmp_path: Path) -> None:
    path = tmp_path / "run.rrd"
    observer = Peek(path, "x")
    observer.seen = []
    run(watched(), Jacobi(), step=MS, stop=5 * MS, observers=[observer])
    assert observer.seen == [[observer.part.name]] * 6
    assert observer.part.name.endswith(".rrd.part")
    assert [p.name for p in tmp_path.iterdir()] == ["run.rrd"]


def test_a_log_carries_its_blueprint(impact: tuple[Result, Path]) -> None:
    assert [b.application_id for b in RrdReader(str(impact[1])).blueprints()] == [recorder.APPLICATION]


def test_a_part_can_be_read_while_it_is_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A slow run is flushed once a second (here: at every step), long before a chunk is full."""
    monkeypatch.setattr(recorder, "FLUSH_AFTER", 0.0)
    found: list[int] = []

    class Reader(RerunRecorder):
        def accepted(self, point):  # type: ignore[no-untyped-def]
            super().accepted(point)
            found.append(len(signals(self.part)["a.y"].ns))
            assert describe(self.part)["status"].startswith("unfinished")

    run(watched(), Jacobi(), step=MS, stop=3 * MS, observers=[Reader(tmp_path / "run.rrd", "x")])
    assert found == [1, 2, 3, 4]


def test_two_runs_into_one_file_do_not_touch_each_other(tmp_path: Path) -> None:
    """One runs while the other is in its third step: each has its own file, and the last to end is the log."""
    path = tmp_path / "same.rrd"
    first, second = RerunRecorder(path, "first"), RerunRecorder(path, "second")

    class Meanwhile(Observer):
        def accepted(self, point: Point) -> None:
            if point.number == 3:
                run(watched(), Jacobi(), step=MS, stop=9 * MS, observers=[second])
                assert len(signals(path)["a.y"].ns) == 10

    run(watched(), Jacobi(), step=MS, stop=5 * MS, observers=[first, Meanwhile()])
    assert [p.name for p in tmp_path.iterdir()] == ["same.rrd"]
    assert signals(path)["a.y"].ns.tolist() == [k * MS for k in range(6)]


def test_a_run_that_fails_keeps_its_log_and_is_marked(tmp_path: Path) -> None:
    part = Scripted([port("u", "input"), port("y", "output")])
    part.script = {4: StepError("a", 3e-3, "stuck"), 1: lambda start, end: Advance(end)}
    path = tmp_path / "failed.rrd"
    with pytest.raises(StepError):
        run(System({"a": part}, {}), Jacobi(), step=MS, stop=9 * MS, observers=[RerunRecorder(path, "x")])
    assert properties(path)["outcome"] == {"status": "failed", "error": "a failed at t = 0.003 s: stuck"}
    assert signals(path)["a.y"].ns.tolist() == [0, MS, 2 * MS, 3 * MS]
    assert (3 * MS, "a failed at t = 0.003 s: stuck") in texts(path, "/log/**")


def test_an_interrupt_is_no_failure(tmp_path: Path) -> None:
    part = Scripted([port("y", "output")])
    part.script = {3: KeyboardInterrupt()}  # type: ignore[dict-item]
    path = tmp_path / "stopped.rrd"
    with pytest.raises(KeyboardInterrupt):
        run(System({"a": part}, {}), Jacobi(), step=MS, stop=9 * MS, observers=[RerunRecorder(path, "x")])
    assert properties(path)["outcome"]["status"] == "interrupted"
    assert len(signals(path)["a.y"].ns) == 3


def test_an_interrupt_in_the_midst_of_a_chunk_sends_no_row_twice(tmp_path: Path) -> None:
    class Interrupts:
        once = True

        def started(self, *about: object) -> None:
            pass

        def finished(self, *about: object) -> None:
            pass

        def emit(self, *about: object) -> None:
            if self.once:
                self.once = False
                os.kill(os.getpid(), signal.SIGINT)
                time.sleep(0.05)

    path = tmp_path / "stopped.rrd"
    observer = RerunRecorder(path, "x", scene=Interrupts(), chunk=50)
    with pytest.raises(KeyboardInterrupt):
        run(watched(), Jacobi(), step=MS, stop=999 * MS, observers=[observer])
    assert properties(path)["outcome"]["status"] == "interrupted"
    found = signals(path)
    n = len(found["a.y"].ns)
    assert n >= 50  # more, where the interrupt took its time
    for signal_ in found.values():
        assert signal_.ns.tolist() == [k * MS for k in range(n)]


def test_a_run_that_never_began_leaves_the_log_of_an_earlier_one(tmp_path: Path) -> None:
    path = tmp_path / "kept.rrd"
    run(watched(), Jacobi(), step=MS, stop=2 * MS, observers=[RerunRecorder(path, "good")])
    before = path.read_bytes()
    broken = Scripted([port("y", "output")])
    broken.exit_initialization = lambda: (_ for _ in ()).throw(StepError("a", 0, "no"))  # type: ignore[method-assign]
    with pytest.raises(StepError):
        run(System({"a": broken}, {}), Jacobi(), step=MS, stop=MS, observers=[RerunRecorder(path, "bad")])
    assert [p.name for p in tmp_path.iterdir()] == ["kept.rrd"]
    assert path.read_bytes() == before


def test_only_the_signals_asked_for(tmp_path: Path) -> None:
    path = tmp_path / "few.rrd"
    run(watched(), Jacobi(), step=MS, stop=MS, observers=[RerunRecorder(path, "x", signals=("g.*", "a.since"))])
    assert [p for p in signals(path) if not p.startswith("master.")] == ["a.since", "g.in.u", "g.y"]


def test_memory_does_not_grow_with_the_run(tmp_path: Path) -> None:
    """Python and NumPy hold as much after 30 chunks as after 10; Rerun's own memory: benchmarks/recording_cost.py."""
    held: dict[int, int] = {}

    class Weigh(Observer):
        def accepted(self, point: Point) -> None:
            if point.number in (500, 1500):
                observer._flush()  # nothing is under way
                gc.collect()
                ours = tracemalloc.take_snapshot().filter_traces([tracemalloc.Filter(False, "*casadi*")])
                held[point.number] = sum(trace.size for trace in ours.traces)

    observer = RerunRecorder(tmp_path / "long.rrd", "x", chunk=50)
    tracemalloc.start()
    try:
        run(watched(), Jacobi(), step=MS, stop=1503 * MS, observers=[observer, Weigh()])
    finally:
        tracemalloc.stop()
    # a chunk is 50 rows of 6 values, 3 integers and the wall clock, 8 bytes each: of the 20 between, none is kept
    assert held[1500] - held[500] < 20 * 50 * 10 * 8 / 4
    assert len(signals(tmp_path / "long.rrd")["a.y"].ns) == 1504


def test_a_log_that_does_not_read_back_is_not_called_complete(tmp_path: Path) -> None:
    """Cut short, and with a row fewer than steps: both stay a part, and the sentence says why."""

    class Cut(RerunRecorder):
        def _finish(self) -> None:
            data = self.part.read_bytes()
            self.part.write_bytes(data[: len(data) * 6 // 10])
            super()._finish()

    class Missing(RerunRecorder):
        def _finish(self) -> None:
            self._points += 1
            super()._finish()

    for kind, said in ((Cut, "does not read back: "), (Missing, "does not read back: it holds 6 of 7 steps")):
        path = tmp_path / kind.__name__ / "run.rrd"
        path.parent.mkdir()
        observer = kind(path, "x")
        with pytest.raises(ScenarioError, match=said):
            run(watched(), Jacobi(), step=MS, stop=5 * MS, observers=[observer])
        assert [p.name for p in path.parent.iterdir()] == [observer.part.name]


def test_where_it_was_made_is_in_it(impact: tuple[Result, Path]) -> None:
    found = properties(impact[1])
    assert found["host"] == host()
    assert found.get("checkout", {}) == checkout(source_checkout())
    assert found["provenance"]["sources"]
