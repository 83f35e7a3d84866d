"""How many times real time does the rover run, and who spends the time: FMUs, master or log?

``ramp-impact`` with all plants and the PD controller with friction, macro steps of 1e-4 s, in the readable and in the
compiled loop, without a log and with every port of every step logged; all ways in turn, medians.  The FMUs' part is
that of each one alone in the compiled loop with its inputs held, which a step costs as much as in the run; the master's
is what a run without a log takes beside that.  Times are the processor's, of the thread that steps: other work of the
machine is not in them.  Of the log's own thread the clock tells.

    python benchmarks/rover_speed.py
"""

from __future__ import annotations

import json
import tempfile
from collections.abc import Callable
from pathlib import Path
from statistics import median
from time import perf_counter, thread_time
from typing import Any

from rich.console import Console
from rich.table import Table

from cosim import GaussSeidel, Observer, System, run
from cosim.observer import RunInfo, Summary
from studies.assembly import assemble
from studies.catalog import find_scenario
from studies.logged import log_observer
from studies.runner import execute, instantiate

STEP, STEPS, REPEATS = 1e-4, 4000, 5
US = 1e6


class Clock(Observer):
    """Tells how long a run takes, in s of this thread and by the clock; it is the first and the last to be told."""

    def started(self, system: System, info: RunInfo) -> None:
        self.own, self.wall = -thread_time(), -perf_counter()

    def finished(self, summary: Summary) -> None:
        self.own += thread_time()
        self.wall += perf_counter()


def whole(log: Path | None, *, compiled: bool) -> Clock:
    """Run the scenario once."""
    settings = {"run": {"step": STEP, "duration": STEPS * STEP, "compiled": compiled}}
    clock = Clock()

    def observers(assembly: Any, instances: Any, record: Any) -> list[Observer]:
        return [*([log_observer(assembly, log, instances, record)] if log else []), clock]

    result = execute(find_scenario("ramp-impact").load("pd-friction", [settings]), observers)
    assert result.error is None, result.error
    return clock


def alone() -> dict[str, float]:
    """Run every FMU of the scenario alone; return the seconds of each for a macro step."""
    found = {}
    settings = {"run": {"step": STEP, "duration": STEPS * STEP}}
    for name, instance in instantiate(assemble(find_scenario("ramp-impact").load("pd-friction", [settings]))).items():
        clock = Clock()
        with System({name: instance}, {}) as system:
            run(system, GaussSeidel(), step=STEP, stop=STEPS * STEP, observers=[clock], locate_events=False,
                compiled=True)  # fmt: skip
        found[name] = clock.own / STEPS
    return found


def measured() -> dict[str, Any]:
    """Return medians of all ways, in us for a macro step, and how many times real time each is."""
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder) / "run.rrd"
        ways: dict[str, Callable[[], Clock]] = {
            "readable": lambda: whole(None, compiled=False), "readable, logged": lambda: whole(log, compiled=False),
            "compiled": lambda: whole(None, compiled=True), "compiled, logged": lambda: whole(log, compiled=True),
        }  # fmt: skip
        ways["compiled"]()  # builds and loads the FMUs
        taken = [({name: way() for name, way in ways.items()}, alone()) for _ in range(REPEATS)]
    found: dict[str, Any] = {
        name: {
            "us": (us := median(clocks[name].own for clocks, _ in taken) / STEPS * US),
            "times_real_time": STEP * US / us,
            "times_real_time_by_the_clock": STEP * STEPS / median(clocks[name].wall for clocks, _ in taken),
        }
        for name in ways
    }
    parts = {name: median(part[name] for _, part in taken) * US for name in taken[0][1]}
    return {**found, "fmus": parts}


def main() -> None:
    """Measure and print."""
    found = measured()
    fmus = sum(found["fmus"].values())
    shown = Table("", "FMUs, us", "master and record, us", "log, us", "step, us", "x real time", "by the clock",
                  title=f"{STEPS} macro steps of {STEP:g} s, median of {REPEATS}")  # fmt: skip
    for loop in ("readable", "compiled"):
        bare = found[loop]["us"]
        for way in (loop, f"{loop}, logged"):
            of = found[way]
            numbers = (fmus, bare - fmus, of["us"] - bare, of["us"], of["times_real_time"])
            shown.add_row(way, *(f"{n:.1f}" for n in (*numbers, of["times_real_time_by_the_clock"])))
    Console().print(shown)
    Console().print("FMUs alone, us: " + ", ".join(f"{name} {us:.1f}" for name, us in found["fmus"].items()))
    print(json.dumps(found))


if __name__ == "__main__":
    main()
