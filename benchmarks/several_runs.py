"""Variants in turn, in threads, or in processes: what is faster?

Four variants of ``ramp-impact-realistic`` with logs, everything built before: in turn, two at once in threads as
``compare --jobs 2`` runs them, and two at once in processes, which import everything again and hand back their figures
only; all ways in turn, medians.  The clock tells what a machine with nothing else to do would show; the processor's
time tells what the ways cost beside each other.

    python benchmarks/several_runs.py
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from statistics import median
from time import perf_counter

from rich.console import Console
from rich.table import Table

from cosim.errors import CosimError
from studies.catalog import find_scenario
from studies.parallel import together
from studies.session import run_scenario
from studies.terminal import SILENT

SCENARIO, VARIANTS, REPEATS = "ramp-impact-realistic", ("uncontrolled", "pd", "lqr", "pole-placement"), 3


def threads(folder: Path, jobs: int) -> None:
    """Run the variants as ``compare`` does."""
    file = find_scenario(SCENARIO)
    scenarios = [file.load(variant) for variant in VARIANTS]
    for done in together(scenarios, lambda scenario, bar: run_scenario(scenario, folder, bar), SILENT, jobs):
        assert not isinstance(done, CosimError)


def processes(folder: Path, jobs: int) -> None:
    """Run every variant by a command of its own."""

    def one(variant: str) -> None:
        command = [sys.executable, "-m", "studies.cli", "run", SCENARIO, "--variant", variant, "--out", str(folder)]
        subprocess.run([*command, "--json"], check=True, stdout=subprocess.DEVNULL)

    with ThreadPoolExecutor(jobs) as pool:
        list(pool.map(one, VARIANTS))


def main() -> None:
    """Measure and print."""
    ways = {"in turn": (threads, 1), "two threads": (threads, 2), "two processes": (processes, 2)}
    taken: dict[str, list[tuple[float, float]]] = {name: [] for name in ways}
    with tempfile.TemporaryDirectory() as folder:
        threads(Path(folder), 1)  # builds what is not built
        for _ in range(REPEATS):
            for name, (way, jobs) in ways.items():
                before, began = sum(os.times()[:4]), perf_counter()
                way(Path(folder), jobs)
                taken[name].append((perf_counter() - began, sum(os.times()[:4]) - before))
    shown = Table("", "by the clock, s", "of the processors, s", title=f"{len(VARIANTS)} variants, logged")
    found = {}
    for name, times in taken.items():
        wall, processor = (median(t[i] for t in times) for i in (0, 1))
        shown.add_row(name, f"{wall:.2f}", f"{processor:.2f}")
        found[name.replace(" ", "_")] = {"seconds": wall, "processor_seconds": processor}
    Console().print(shown)
    print(json.dumps({**found, "processors": os.cpu_count(), "load": os.getloadavg()[0]}))


if __name__ == "__main__":
    main()
