"""What does it cost to log every port of the rover at every step: time, bytes and memory?

Time and bytes: 50 000 macro steps of ``ramp-impact`` with the PD controller, logged without and with the scene, against
the same run without a log; the best of runs in turn, since whatever else the machine does only adds.  *In the loop* is
the time that the run stands still for the recorder, by the wall clock, and its processor time, which other programs
disturb less; packing (LZ4) and writing happen in a thread of Rerun beside it, which the processor time of both threads
shows.  What a run pays once (names of all ports, verdict, reading the log back) is listed by itself.

Memory: the same ports over 10^6 steps, values of the run again and again; resident memory at a tenth and at the end.

    python benchmarks/recording_cost.py [STEPS OF THE MEMORY RUN]
"""

from __future__ import annotations

import gc
import json
import os
import sys
import tempfile
from pathlib import Path
from time import perf_counter, process_time, thread_time
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from cosim.observer import Observer, Point, RunInfo, Summary
from cosim.scenario import Scenario
from cosim.system import System
from logs.ports import Chunk
from logs.recorder import RerunRecorder
from studies.assembly import assemble
from studies.catalog import find_scenario
from studies.runner import connect, execute, instantiate
from studies.session import log_observer

STEP, STEPS, REPEATS = 5e-5, 50_000, 5
LONG = 1_000_000


class Timed(RerunRecorder):
    """A recorder that adds up the time spent in it: in the loop by wall and processor, and what is paid once."""

    loop = work = once = 0.0

    def started(self, system: System, info: RunInfo) -> None:
        began = perf_counter()
        super().started(system, info)
        self.once += perf_counter() - began

    def accepted(self, point: Point) -> None:
        began, worked = perf_counter(), thread_time()
        super().accepted(point)
        self.work += thread_time() - worked
        self.loop += perf_counter() - began

    def _send(self, chunk: Chunk) -> None:
        worked = thread_time()  # of the thread that sends, for which the loop waits
        super()._send(chunk)
        self.work += thread_time() - worked

    def finished(self, summary: Summary) -> None:
        began = perf_counter()
        self.emit()  # the last chunk, and the wait until it is in the file, are part of the loop
        between = perf_counter()
        super().finished(summary)
        self.loop += between - began
        self.once += perf_counter() - between


def scenario() -> Scenario:
    """Return the run: all plants, the PD controller."""
    return find_scenario("ramp-impact").load("pd-friction", [{"run": {"step": STEP, "duration": STEPS * STEP}}])


def measure(log: Path | None, scene: bool) -> dict[str, float]:
    """Run once; return wall and processor seconds of the run, those in the recorder, and the size of the log."""
    recorders: list[Timed] = []

    def observers(assembly: Any, instances: Any, record: Any) -> list[Observer]:
        if log is None:
            return []
        recorder = log_observer(assembly, log, instances, record, Timed)
        assert isinstance(recorder, Timed)
        recorder.scene = recorder.scene if scene else None
        recorders.append(recorder)
        return list(recorders)

    gc.collect()
    began = process_time()
    result = execute(scenario(), observers)
    assert result.error is None, result.error
    assert result.summary is not None
    found = {"cpu": process_time() - began, "run": result.seconds["running"], "steps": float(result.summary.steps)}
    if log is not None:
        found |= {"bytes": float(log.stat().st_size), "loop": recorders[0].loop, "work": recorders[0].work}
        found["once"] = recorders[0].once
    return found


def resident() -> float:
    """Return the memory of this process in MB."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6


def long_run(log: Path, steps: int) -> dict[str, float]:
    """Log *steps* points of all ports; return memory in MB at a tenth and at the end, and the size of the log."""
    assembly = assemble(scenario())
    with connect(assembly, instantiate(assembly)) as system:
        values = np.random.default_rng(1).standard_normal((1000, len(system.row))).cumsum(axis=0)
        recorder = RerunRecorder(log, "long")
        recorder.started(system, RunInfo(100_000, steps * 100_000, 0, "none"))
        early, began = 0.0, perf_counter()
        for k in range(steps):
            wall = perf_counter() - began
            recorder.accepted(Point(k, (k - 1) * 100_000, k * 100_000, wall, {}, {}, values[k % 1000]))
            if k == steps // 10:
                early = resident()
        late = resident()
        recorder.finished(Summary(steps, 0, 0, perf_counter() - began, steps * 1e-4))
        return {"steps": steps, "early": early, "late": late, "closed": resident(), "bytes": log.stat().st_size,
                "seconds": perf_counter() - began}  # fmt: skip


def main() -> None:
    """Measure and print."""
    measure(None, False)  # builds and loads the FMUs
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.rrd"
        rounds = [[measure(None, False), measure(path, False), measure(path, True)] for _ in range(REPEATS)]
        long = long_run(path, int(sys.argv[1]) if len(sys.argv) > 1 else LONG)
    bare, log, drawn = ({key: min(m[key] for m in case) for key in case[0]} for case in zip(*rounds, strict=True))
    values, ports = counts()
    n = log["steps"]
    found = {
        "ports": ports, "values_per_step": values, "steps": n,
        "us_per_step_in_the_loop_processor": log["work"] / n * 1e6,
        "us_per_step_in_the_loop": log["loop"] / n * 1e6,
        "us_per_step_in_the_loop_with_scene": drawn["loop"] / n * 1e6,
        "us_per_step_longer_run": (log["run"] - bare["run"] - log["once"]) / n * 1e6,
        "us_per_step_longer_run_with_scene": (drawn["run"] - bare["run"] - drawn["once"]) / n * 1e6,
        "us_per_step_processor_both_threads": (log["cpu"] - bare["cpu"] - log["once"]) / n * 1e6,
        "ms_once_per_run": log["once"] * 1e3,
        "us_per_step_run_without_log": bare["run"] / n * 1e6,
        "bytes_per_step": log["bytes"] / n,
        "bytes_per_value_with_time_stamps": log["bytes"] / n / values,
        "bytes_per_value_beyond_time_stamps": (log["bytes"] / n - 16 * ports) / values,
        "long_run_steps": long["steps"], "long_run_us_per_step": long["seconds"] / long["steps"] * 1e6,
        "memory_MB_at_a_tenth": long["early"], "memory_MB_at_the_end": long["late"],
        "memory_MB_after_reading_back": long["closed"], "long_run_GB": long["bytes"] / 1e9,
    }  # fmt: skip
    shown = Table("", "", title="every port of the rover at every step")
    for key, value in found.items():
        shown.add_row(key.replace("_", " "), f"{value:.4g}")
    Console().print(shown)
    print(json.dumps(found))


def counts() -> tuple[int, int]:
    """Return how many values and ports are logged at each step."""
    assembly = assemble(scenario())
    with connect(assembly, instantiate(assembly)) as system:
        ports = sum(len(i.inputs) + len(i.outputs) for i in system.instances.values())
        return len(system.row), ports


if __name__ == "__main__":
    main()
