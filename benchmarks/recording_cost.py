"""What does it cost to log every port of the rover at every step: time, bytes and memory?

Time and bytes: 50 000 macro steps of ``ramp-impact`` with the PD controller, logged without and with the scene, against
the same run without a log; the best of runs in turn, since whatever else the machine does only adds, and the median
of the differences of neighbours.  *In the loop* is the time that the run stands still for the recorder, by the wall
clock; sending happens in a thread beside it, packing (LZ4) and writing in one of Rerun, which the processor time of all
threads shows.  *Rerun alone* is the same columns sent as fast as it takes them, without a run beside it.  What a run
pays once (names of all ports, verdict, reading the log back) is listed by itself.

Memory: a run of 10^6 steps with a log and its record; resident memory at a tenth, at the end, and after the verdict.
So long a log has no index of its chunks, which Rerun would keep in memory until the end.

    python benchmarks/recording_cost.py [STEPS OF THE MEMORY RUN]
"""

from __future__ import annotations

import gc
import json
import os
import sys
import tempfile
from functools import partial
from pathlib import Path
from statistics import median
from time import perf_counter, process_time, thread_time
from typing import Any

from rich.console import Console
from rich.table import Table

from cosim.observer import Block, Observer, Point, RunInfo, Summary
from cosim.scenario import Scenario
from cosim.system import System
from logs.ports import Chunk, index
from logs.recorder import RerunRecorder
from studies.assembly import assemble
from studies.catalog import find_scenario
from studies.logged import log_observer
from studies.runner import connect, execute, instantiate

STEP, STEPS, REPEATS = 5e-5, 50_000, 5
AGAIN = 50  # times that a chunk is sent to see what Rerun takes
LONG = 1_000_000


class OneByOne(Observer):
    """Wants every point at once, so that nobody is told of blocks."""

    def accepted(self, point: Point) -> None:
        """Do nothing with it."""


class Meter(Observer):
    """Reads the processor time of the whole process when a run begins and ends."""

    began = ended = 0.0

    def started(self, system: System, info: RunInfo) -> None:
        self.began = process_time()

    def finished(self, summary: Summary) -> None:
        self.ended = process_time()


class Timed(RerunRecorder):
    """A recorder that adds up the time spent in it: in the loop, in the sender's thread, and what is paid once."""

    loop = sender = once = began = ended = 0.0

    def started(self, system: System, info: RunInfo) -> None:
        began = perf_counter()
        super().started(system, info)
        self.once += perf_counter() - began
        self.began = process_time()

    def accepted(self, point: Point) -> None:
        began = perf_counter()
        super().accepted(point)
        self.loop += perf_counter() - began

    def accepted_block(self, block: Block) -> None:
        began = perf_counter()
        super().accepted_block(block)
        self.loop += perf_counter() - began

    def _send(self, chunk: Chunk) -> None:
        began = thread_time()
        super()._send(chunk)
        self.sender += thread_time() - began

    def finished(self, summary: Summary) -> None:
        began = perf_counter()
        self.emit()  # the last chunk, and the wait until it is in the file, are part of the loop
        self.loop += perf_counter() - began
        self.ended, began = process_time(), perf_counter()
        super().finished(summary)
        self.once += perf_counter() - began


class Alone(RerunRecorder):
    """Sends a full chunk of the run again and again, while nothing else goes on: what Rerun takes by itself."""

    wall = cpu = 0.0  # s for a step

    def _send(self, chunk: Chunk) -> None:
        if chunk.full and not self.wall:
            began, busy = perf_counter(), process_time()
            for k in range(AGAIN):
                at = index(chunk.ns + k * int(chunk.n * STEP * 1e9), chunk.step + k * chunk.n)
                chunk.send(partial(self._once_more, at))
            self._flush()
            self.wall, self.cpu = ((now / AGAIN / chunk.n) for now in (perf_counter() - began, process_time() - busy))
        super()._send(chunk)

    def _once_more(self, at: Any, path: str, columns: Any) -> None:
        self.recording.send_columns(path, at, columns)


class Memory(Observer):
    """Takes the resident memory of the process at a tenth of a run of *steps* and at its end, in MB."""

    def __init__(self, steps: int) -> None:
        self.steps, self.early, self.late = steps, 0.0, 0.0

    def accepted_block(self, block: Block) -> None:
        """Look once a tenth is passed."""
        if not self.early and block.first + len(block.rows) >= self.steps / 10:
            self.early = resident()

    def accepted(self, point: Point) -> None:
        """Look once a tenth is passed."""
        if not self.early and point.number >= self.steps / 10:
            self.early = resident()

    def finished(self, summary: Summary) -> None:
        self.late = resident()


def scenario(steps: int = STEPS) -> Scenario:
    """Return the run: all plants, the PD controller."""
    return find_scenario("ramp-impact").load("pd-friction", [{"run": {"step": STEP, "duration": steps * STEP}}])


def measure(log: Path | None, scene: bool = False, *, blocks: bool = True) -> dict[str, float]:
    """Run once; return wall and processor seconds of the run, those in the recorder, and the size of the log."""
    meters: list[Meter | Timed] = []

    def observers(assembly: Any, instances: Any, record: Any) -> list[Observer]:
        meter = log_observer(assembly, log, instances, record, Timed) if log is not None else Meter()
        assert isinstance(meter, Meter | Timed)
        if isinstance(meter, Timed) and not scene:
            meter.scene = None
        meters.append(meter)
        return [*meters, *([] if blocks else [OneByOne()])]

    gc.collect()
    result = execute(scenario(), observers)
    assert result.error is None, result.error
    assert result.summary is not None
    meter = meters[0]
    found = {"cpu": meter.ended - meter.began, "run": result.seconds["running"], "steps": float(result.summary.steps)}
    if isinstance(meter, Timed):
        found |= {"loop": meter.loop, "sender": meter.sender, "once": meter.once}
        found |= {"bytes": float(meter.path.stat().st_size), "preparing": result.seconds["preparing"]}
        found["run"] -= meter.once
    return found


def rerun_alone(log: Path) -> dict[str, float]:
    """Return what sending, packing and writing a step take without a run beside them, in us."""
    alone: list[Alone] = []

    def observers(assembly: Any, instances: Any, record: Any) -> list[Observer]:
        recorder = log_observer(assembly, log, instances, record, Alone)
        assert isinstance(recorder, Alone)
        recorder.scene = None
        alone.append(recorder)
        return [recorder]

    execute(scenario(10_000), observers)
    return {"us_per_step_of_rerun_alone": alone[0].wall * 1e6,
            "us_per_step_of_rerun_alone_processor_all_threads": alone[0].cpu * 1e6}  # fmt: skip


def resident() -> float:
    """Return the memory of this process in MB."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6


def long_run(log: Path, steps: int) -> dict[str, float]:
    """Run *steps* with log, scene and record; return memory in MB on the way and after the verdict, and the rest."""
    memory = Memory(steps)
    began = perf_counter()
    result = execute(scenario(steps), lambda *of: [memory, log_observer(of[0], log, of[1], of[2])])
    assert result.error is None, result.error
    return {
        "long_run_steps": len(result.record) - 1, "long_run_seconds": perf_counter() - began,
        "long_run_log_GB": log.stat().st_size / 1e9, "memory_MB_at_a_tenth": memory.early,
        "memory_MB_at_the_end": memory.late, "memory_MB_after_the_verdict": resident(),
        "bytes_per_step_kept_in_memory": (memory.late - memory.early) * 1e6 / (0.9 * steps),
    }  # fmt: skip


def best(cases: list[dict[str, float]]) -> dict[str, float]:
    """Return the least of every figure."""
    return {key: min(case[key] for case in cases) for key in cases[0]}


def main() -> None:
    """Measure and print."""
    measure(None)  # builds and loads the FMUs
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.rrd"
        rounds = [
            [measure(None), measure(path), measure(path, True), measure(path, blocks=False)] for _ in range(REPEATS)
        ]
        alone = rerun_alone(path)
        long = long_run(path, int(sys.argv[1]) if len(sys.argv) > 1 else LONG)
    bare, log, drawn, single = (best(list(case)) for case in zip(*rounds, strict=True))
    longer, longer_drawn = (median(r[k]["run"] - r[0]["run"] for r in rounds) for k in (1, 2))
    values, ports = counts()
    n = log["steps"]
    found = {
        "ports": ports, "values_per_step": values, "steps": n,
        "us_per_step_in_the_loop": log["loop"] / n * 1e6,
        "us_per_step_in_the_loop_with_scene": drawn["loop"] / n * 1e6,
        "us_per_step_in_the_loop_point_by_point": single["loop"] / n * 1e6,
        "us_per_step_longer_run": longer / n * 1e6,
        "us_per_step_longer_run_with_scene": longer_drawn / n * 1e6,
        "us_per_step_processor_all_threads": (log["cpu"] - bare["cpu"]) / n * 1e6,
        "us_per_step_processor_sender": log["sender"] / n * 1e6,
        "us_per_step_run_without_log": bare["run"] / n * 1e6,
        "logged_steps_per_second": n / log["run"],
        "ms_once_before_the_run": log["preparing"] * 1e3, "ms_once_in_the_run": log["once"] * 1e3,
        "bytes_per_step": log["bytes"] / n,
        "bytes_per_value_with_time_stamps": log["bytes"] / n / values,
        "bytes_per_value_beyond_time_stamps": (log["bytes"] / n - 16 * ports) / values,
        **alone, **long,
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
