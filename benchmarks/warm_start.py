"""How long does a command take before its first step, when everything was built before?

``wmr-cosim run ramp-impact`` over 0.01 s of the rover with all plants, in a process of its own, with and without a log,
in turn; medians.  Processor time beside the clock: on a machine that does other things only that is the command's own.

    python benchmarks/warm_start.py
"""

from __future__ import annotations

import json
import resource
import subprocess
import sys
import tempfile
from statistics import median
from time import perf_counter

from rich.console import Console
from rich.table import Table

REPEATS = 5
COMMAND = [sys.executable, "-m", "studies.cli", "run", "ramp-impact", "--variant", "pd-friction", "--duration", "0.01"]


def measure(*more: str) -> tuple[float, float]:
    """Run the command; return its seconds by the clock and of the processor."""
    before, began = resource.getrusage(resource.RUSAGE_CHILDREN), perf_counter()
    subprocess.run([*COMMAND, "--json", *more], check=True, stdout=subprocess.DEVNULL)
    wall, after = perf_counter() - began, resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main() -> None:
    """Measure and print."""
    with tempfile.TemporaryDirectory() as folder:
        ways = {"without log": ("--no-log",), "with log": ("--out", folder)}
        for more in ways.values():
            measure(*more)  # builds and keeps what it can
        taken = [{name: measure(*more) for name, more in ways.items()} for _ in range(REPEATS)]
    shown = Table("", "by the clock, s", "of the processor, s", title=f"run of 100 macro steps, median of {REPEATS}")
    found = {}
    for name in ways:
        wall, processor = (median(t[name][i] for t in taken) for i in (0, 1))
        shown.add_row(name, f"{wall:.2f}", f"{processor:.2f}")
        found[name.replace(" ", "_")] = {"seconds": wall, "processor_seconds": processor}
    Console().print(shown)
    print(json.dumps(found))


if __name__ == "__main__":
    main()
