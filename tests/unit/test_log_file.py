"""The file of a log: what it is called and holds while a run goes, fails, is interrupted, or shares its folder."""

from __future__ import annotations

import gc
import os
import signal
import time
import tracemalloc
import warnings
from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pytest
from rerun.chunk import RrdReader
from toys import Gain, Scripted, Watch, port

from cosim import Advance, Jacobi, Observer, Point, System, run
from cosim.errors import ScenarioError, StepError
from cosim.observer import RunInfo, Summary
from logs import recorder
from logs.inspect import describe
from logs.ports import Chunk
from logs.read import properties, signals, texts
from logs.recorder import RerunRecorder

MS = 1_000_000


def watched() -> System:
    return System({"a": Watch().instance(), "g": Gain().instance()}, {"a.u": "a.y"})


class Peek(RerunRecorder):
    """A recorder that says which files there are at every point."""

    seen: list[list[str]]

    def accepted(self, point):  # type: ignore[no-untyped-def]
        super().accepted(point)
        self.seen.append(sorted(p.name for p in self.path.parent.iterdir()))


def test_a_log_is_called_part_until_it_is_complete(tmp_path: Path) -> None:
    path = tmp_path / "run.rrd"
    observer = Peek(path, "x")
    observer.seen = []
    run(watched(), Jacobi(), step=MS, stop=5 * MS, observers=[observer])
    assert observer.seen == [[observer.part.name]] * 6
    assert observer.part.name.endswith(".rrd.part")
    assert [p.name for p in tmp_path.iterdir()] == ["run.rrd"]


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
    assert properties(path)["outcome"] == {"status": "failed", "error": "a failed at t = 0.003 s: stuck (step 4)"}
    assert signals(path)["a.y"].ns.tolist() == [0, MS, 2 * MS, 3 * MS]
    assert (3 * MS, "a failed at t = 0.003 s: stuck (step 4)") in texts(path, "/log/**")


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
    part = Scripted([port("y", "output")])  # CasADi, which the others compute with, turns an interrupt into an error
    with pytest.raises(KeyboardInterrupt):
        run(System({"a": part}, {}), Jacobi(), step=MS, stop=99_999 * MS, observers=[observer])
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


def test_memory_does_not_grow_with_the_run(tmp_path: Path) -> None:
    """Python and NumPy hold as much after 30 chunks as after 10; Rerun's own memory: benchmarks/recording_cost.py."""
    held: dict[int, int] = {}

    class Weigh(Observer):
        def accepted(self, point: Point) -> None:
            if point.number in (500, 1500):
                observer.emit()  # nothing is under way
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


@pytest.mark.parametrize("room", [0, 10**9])
def test_a_log_whose_index_would_take_too_much_memory_has_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, room: int
) -> None:
    """It is whole all the same, and says that it is complete."""
    monkeypatch.setattr(recorder, "INDEX", room)
    path = tmp_path / "run.rrd"
    run(watched(), Jacobi(), step=MS, stop=5 * MS, observers=[RerunRecorder(path, "x")])
    with nullcontext() if room else pytest.raises(RuntimeError, match="without footer"), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        RrdReader(str(path)).store()
    assert len(signals(path)["a.y"].ns) == 6
    assert describe(path)["status"] == "complete"


def test_a_slow_run_of_many_minutes_is_flushed_less_often(tmp_path: Path) -> None:
    """An hour at a step each second: 20 chunks in the first 20 s, then each a twentieth longer than those before."""
    sent: list[int] = []

    class Sent(RerunRecorder):
        def _send(self, chunk: Chunk) -> None:
            sent.append(chunk.n)
            super()._send(chunk)

    made, observer = watched(), Sent(tmp_path / "run.rrd", "x")
    observer.started(made, RunInfo(MS, 3600 * MS, 0, "test"))
    for k in range(3600):
        observer.accepted(Point(k, max(k - 1, 0) * MS, k * MS, 1.0 * k, {}, {}, made.row))
    observer.finished(Summary(3599, 0, 0, 3600.0, 3.6))
    assert 20 + 20 * np.log(3600 / 20) / 2 < len(sent) < 20 + 20 * np.log(3600 / 20) + 1
    assert sum(sent) == 3600
    assert max(sent) <= 3600 * 0.05 + 1


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
