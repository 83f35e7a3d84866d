"""How many times real time does the rover run, and who spends the time: FMUs, master, record or log?

``ramp-impact`` with all plants and the PD controller with friction, macro steps of 1e-4 s: in the readable loop with
its record, and in the compiled one with nothing kept, with its record in memory, and with every port of every step
logged beside that, without and with the scene; all ways in turn, medians.  The FMUs' part is that of each one alone in
the compiled loop with its inputs held; the master's is what a run with nothing kept takes beside that.  Times are the
processor's, of the thread that steps; those of the log's other threads (sending, and Rerun's own, which pack and write)
stand beside them.  The clock tells what a run takes altogether, opening the log and reading it back included.

    python benchmarks/rover_speed.py
"""

from __future__ import annotations

import json
import tempfile
from collections.abc import Callable
from pathlib import Path
from statistics import median
from time import perf_counter, process_time, thread_time
from typing import Any

from rich.console import Console
from rich.table import Table

from cosim import GaussSeidel, Observer, System, run
from cosim.observer import RunInfo, Summary
from cosim.scenario import Scenario
from logs.recorder import RerunRecorder
from studies.assembly import assemble
from studies.catalog import find_scenario
from studies.logged import log_observer
from studies.runner import algorithm_of, connect, execute, instantiate

STEP, REPEATS = 1e-4, 7
LONG, SHORT = 20_000, 2000  # steps in the compiled loop, and in the readable one
US = 1e6


class Clock(Observer):
    """Tells how long a run takes, in us for a step: of this thread, of others, and by the clock."""

    def __init__(self, steps: int) -> None:
        self.steps = steps

    def started(self, system: System, info: RunInfo) -> None:
        self.own, self.all, self.wall = -thread_time(), -process_time(), -perf_counter()

    def finished(self, summary: Summary) -> None:
        self.own = (self.own + thread_time()) / self.steps * US
        self.others = (self.all + process_time()) / self.steps * US - self.own
        self.wall = (self.wall + perf_counter()) / self.steps * US


def scenario(steps: int, *, compiled: bool = True) -> Scenario:
    """Return the run of so many steps."""
    settings = {"run": {"step": STEP, "duration": steps * STEP, "compiled": compiled}}
    return find_scenario("ramp-impact").load("pd-friction", [settings])


def kept(log: Path | None = None, *, steps: int = LONG, compiled: bool = True, scene: bool = True) -> Clock:
    """Run with the record in memory, and with every port logged to *log*, if there is one."""
    clock = Clock(steps)

    def recorder(*args: Any, **options: Any) -> RerunRecorder:
        return RerunRecorder(*args, **options if scene else {**options, "scene": None, "health": None})

    def observers(assembly: Any, instances: Any, record: Any) -> list[Observer]:
        return [*([log_observer(assembly, log, instances, record, recorder)] if log else []), clock]

    result = execute(scenario(steps, compiled=compiled), observers)
    assert result.error is None, result.error
    return clock


def bare() -> Clock:
    """Run with nothing kept."""
    clock, assembly = Clock(LONG), assemble(scenario(LONG))
    with connect(assembly, instantiate(assembly)) as system:
        run(system, algorithm_of(assembly), step=STEP, stop=LONG * STEP, observers=[clock], compiled=True)
    return clock


def alone() -> dict[str, float]:
    """Run every FMU of the scenario alone; return what a macro step of it takes, in us."""
    found = {}
    for name, instance in instantiate(assemble(scenario(LONG))).items():
        clock = Clock(LONG)
        with System({name: instance}, {}) as system:
            run(system, GaussSeidel(), step=STEP, stop=LONG * STEP, observers=[clock], locate_events=False,
                compiled=True)  # fmt: skip
        found[name] = clock.own
    return found


def measured() -> dict[str, Any]:
    """Return medians of all ways, in us for a macro step, and how many times real time each is."""
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder) / "run.rrd"
        ways: dict[str, Callable[[], Clock]] = {
            "readable, record": lambda: kept(steps=SHORT, compiled=False), "compiled": bare,
            "compiled, record": kept, "compiled, ports logged": lambda: kept(log, scene=False),
            "compiled, ports and scene logged": lambda: kept(log),
        }  # fmt: skip
        ways["compiled"]()  # builds and loads the FMUs
        taken = [({name: way() for name, way in ways.items()}, alone()) for _ in range(REPEATS)]
    found: dict[str, Any] = {
        name: {
            "us": (us := median(clocks[name].own for clocks, _ in taken)),
            "us_of_other_threads": median(clocks[name].others for clocks, _ in taken),
            "times_real_time": STEP * US / us,
            "times_real_time_by_the_clock": STEP * US / median(clocks[name].wall for clocks, _ in taken),
        }
        for name in ways
    }
    return {**found, "fmus": {name: median(part[name] for _, part in taken) for name in taken[0][1]}}


def main() -> None:
    """Measure and print."""
    found = measured()
    fmus, compiled = sum(found["fmus"].values()), found["compiled"]["us"]
    each = ", ".join(f"{name} {us:.2f}" for name, us in found["fmus"].items())
    Console().print(f"macro steps of {STEP:g} s, medians of {REPEATS}; FMUs alone {fmus:.2f} us: {each}")
    shown = Table("", "master", "record, log", "step, us", "x real time", "others, us", "x by the clock")
    for way, of in found.items():
        if way == "fmus":
            continue
        master = (f"{compiled - fmus:.1f}", f"{of['us'] - compiled:.1f}") if way.startswith("compiled") else ("", "")
        speed = (of["us"], of["times_real_time"], of["us_of_other_threads"], of["times_real_time_by_the_clock"])
        shown.add_row(way, *master, *(f"{n:.1f}" for n in speed))
    Console().print(shown)
    print(json.dumps(found))


if __name__ == "__main__":
    main()
