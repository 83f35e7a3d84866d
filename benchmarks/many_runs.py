"""Does anything pile up over thousands of runs in one process: memory, handles, files, libraries, processes?

A mass and a spring as FMUs, coupled, another stiffness in every run: with instances that are reset (``fmus.Pool``),
with new ones for every run, or with reset ones in processes of their own.  Counted after a tenth of the runs and at
their end.

    python benchmarks/many_runs.py                    # 10 000 runs each way: some minutes
    python benchmarks/many_runs.py --runs 300 --way new --json
"""

from __future__ import annotations

import argparse
import gc
import json
import os
import sys
import tempfile
from pathlib import Path
from time import perf_counter

import fmus
from cosim import Component, GaussSeidel, System, input, output, parameter, run, state

WAYS = ("reset", "new", "isolated")


class Mass(Component):
    """m v' = F, exact for a force held over the step."""

    F = input("N", "force")
    x = state(1.0, "m", "position")
    v = state(0.0, "m/s", "velocity")
    pos = output("m", "position")

    def flow(s):
        return dict(x=s.x + s.dt * s.v + s.dt**2 / 2 * s.F, v=s.v + s.dt * s.F)

    def outputs(s):
        return dict(pos=s.x)


class Spring(Component):
    """F = -k x."""

    k = parameter(4.0, "N/m", "stiffness")
    x = input("m", "elongation")
    F = output("N", "force on the body at its end")

    def outputs(s):
        return dict(F=-s.k * s.x)


def one_run(way: str, pool: fmus.Pool, stiffness: float) -> float:
    """Run once and return where the mass ends."""
    how = {"isolated": True} if way == "isolated" else {}
    make = fmus if way == "new" else pool
    instances = {
        "spring": make.instantiate(Spring(k=stiffness), "spring", fmi=2, **how),
        "mass": make.instantiate(Mass(), "mass", fmi=3, **how),
    }
    with System(instances, {"mass.F": "spring.F", "spring.x": "mass.pos"}) as system:
        run(system, GaussSeidel(), step=1e-2, stop=0.2)
        end = float(system["mass.pos"])
        if way != "new":
            pool.release(instances.values())
            system.instances.clear()  # they are not to be closed
    return end


def held() -> dict[str, int]:
    """Return what this process and its children hold."""
    gc.collect()
    status = dict(line.split(":", 1) for line in Path("/proc/self/status").read_text().splitlines())
    maps = {line.split()[-1] for line in Path("/proc/self/maps").read_text().splitlines() if ".so" in line}
    children = Path(f"/proc/self/task/{os.getpid()}/children").read_text().split()
    return {
        "memory_kB": int(status["VmRSS"].split()[0]),
        "handles": len(os.listdir("/proc/self/fd")),
        "temporary files": len(os.listdir(tempfile.gettempdir())),
        "cached files": sum(len(files) for _, _, files in os.walk(fmus.cache_folder())),
        "libraries": len(maps),
        "processes": len(children),
    }


def measure(way: str, runs: int) -> dict[str, object]:
    """Return what is held after a tenth of the runs and at their end, and how long a run takes."""
    with fmus.Pool(step=1e-2) as pool:
        for i in range(runs // 10):
            one_run(way, pool, 1.0 + i)
        before, began = held(), perf_counter()
        for i in range(runs // 10, runs):
            one_run(way, pool, 1.0 + i)
        per_run = (perf_counter() - began) / (runs - runs // 10)
        return {"way": way, "runs": runs, "ms_per_run": 1e3 * per_run, "before": before, "after": held()}


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--runs", type=int, default=10_000)
    parser.add_argument("--way", choices=WAYS)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    # folders of its own: other processes leave files in the common ones
    with tempfile.TemporaryDirectory() as folder:
        tempfile.tempdir = folder
        os.environ["WMR_COSIM_CACHE"] = os.path.join(folder, "cache")
        for way in (options.way,) if options.way else WAYS:
            found = measure(way, options.runs)
            if options.json:
                json.dump(found, sys.stdout)
                continue
            before, after = found["before"], found["after"]
            assert isinstance(before, dict)
            assert isinstance(after, dict)
            print(f"{way}: {found['runs']} runs, {found['ms_per_run']:.2f} ms each")
            for what in before:
                print(f"  {what:16} {before[what]:8} -> {after[what]:8}")


if __name__ == "__main__":
    main()
