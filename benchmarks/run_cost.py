"""What does a run of the rover with everything logged cost, and who spends it: FMUs, master or log?

4000 macro steps of ``ramp-impact`` with all plants and the PD controller, every port of every step in a Rerun file,
against the same run without a log, and that against the loop in Python, where the calls of the FMUs can be timed;
ratios taken in one run on one machine.

    python benchmarks/run_cost.py
"""

from __future__ import annotations

import json
import tempfile
from collections.abc import Callable
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

from rich.console import Console
from rich.table import Table

from cosim.instance import Instance
from studies.catalog import find_scenario
from studies.logged import log_observer
from studies.runner import execute

STEPS, REPEATS = 4000, 5


class Stopwatch:
    """Adds up the time spent inside the FMU calls of a run's instances."""

    def __init__(self) -> None:
        self.seconds = 0.0

    def watch(self, instance: Instance) -> None:
        """Time every push, step and pull of an instance from now on; the compiled loop would make none of them."""
        setattr(instance, "native", lambda: None)  # noqa: B010  (a method)
        for name in ("push", "step", "pull"):
            setattr(instance, name, self._timed(getattr(instance, name)))

    def _timed(self, call: Callable[..., Any]) -> Callable[..., Any]:
        def timed(*args: Any, **kwargs: Any) -> Any:
            began = perf_counter()
            try:
                return call(*args, **kwargs)
            finally:
                self.seconds += perf_counter() - began

        return timed


def measure(log: Path | None, *, readable: bool = False) -> dict[str, float]:
    """Run once; return wall seconds of the run, of the FMU calls in the *readable* loop, and the size of the log."""
    scenario = find_scenario("ramp-impact").load("pd-friction", [{"run": {"step": 1e-4, "duration": STEPS * 1e-4}}])
    watch = Stopwatch()

    def observers(assembly: Any, instances: dict[str, Instance], record: Any) -> list[Any]:
        for instance in instances.values() if readable else ():
            watch.watch(instance)
        return [log_observer(assembly, log, instances, record)] if log else []

    result = execute(scenario, observers)
    assert result.error is None, result.error
    return {"run": result.seconds["running"], "fmu": watch.seconds, "bytes": log.stat().st_size if log else 0}


def main() -> None:
    """Measure and print."""
    measure(None)  # builds and loads the FMUs
    with tempfile.TemporaryDirectory() as folder:
        logged = [measure(Path(folder) / f"{i}.rrd") for i in range(REPEATS)]
        plain = [measure(None) for _ in range(REPEATS)]
        python = [measure(None, readable=True) for _ in range(REPEATS)]
    run, bare = median(m["run"] for m in logged), median(m["run"] for m in plain)
    loop, fmu = (median(m[key] for m in python) for key in ("run", "fmu"))
    found = {
        "macro_steps": STEPS, "seconds": run, "macro_steps_per_second": STEPS / run,
        "bytes_per_step": logged[0]["bytes"] / STEPS,
        "share_fmus_master_and_record": bare / run, "share_log": (run - bare) / run,
        "times_faster_than_loop_in_python": loop / bare, "share_fmus_of_loop_in_python": fmu / loop,
        "times_real_time": STEPS * 1e-4 / run, "times_real_time_without_log": STEPS * 1e-4 / bare,
    }  # fmt: skip
    shown = Table("", "", title="4000 macro steps of 1e-4 s, everything logged")
    for key, value in found.items():
        shown.add_row(key.replace("_", " "), f"{value:.4g}")
    Console().print(shown)
    print(json.dumps(found))


if __name__ == "__main__":
    main()
