"""What does the master's loop cost beside the FMUs, against the least that is possible, and against other tools?

Three lags in a ring, FMUs of our own export that take some 40 ns a step, stepped by Jacobi: by the compiled loop, by
the readable one, and by ``bare_loop.c``, a C program that does nothing else; all three in turn in one process, medians
of processor time.  The compiled loop may take 1.3 times the bare one.  Beside them what pip can install of other tools,
each in a virtual environment of its own in the user's cache, against the bare loop of the same round: see ``peers.py``.

    python benchmarks/loop_overhead.py             # installs the others when it runs for the first time: minutes
    python benchmarks/loop_overhead.py --no-peers
"""

from __future__ import annotations

import argparse
import ctypes
import json
import subprocess
import tempfile
from collections.abc import Sequence
from ctypes import c_char_p, c_double, c_int, c_long, c_uint32
from datetime import UTC, datetime
from pathlib import Path
from statistics import median
from time import thread_time
from typing import Any

import peers
from rich.console import Console
from rich.table import Table

import fmus
from cosim import Component, Jacobi, Observer, System, input, output, parameter, run, state
from cosim.compiled.build import compiler
from cosim.observer import RunInfo, Summary
from fmus.importer import library, read

SOURCE = Path(__file__).parent / "bare_loop.c"
STEP, STEPS, REPEATS = 1e-3, 1_000_000, 7
MOST = 1.3  # times the bare loop


class Lag(Component):
    """T x' = 0.9 u - x by explicit Euler steps."""

    T = parameter(1.0, "s", "time constant")
    u = input("1", "what goes in")
    x = state(1.0, "1", "what comes out")
    y = output("1", "what comes out")

    def flow(s):
        return dict(x=s.x + s.dt / s.T * (0.9 * s.u - s.x))

    def outputs(s):
        return dict(y=s.x)


class SlowLag(Lag):
    """A slower one."""

    T = parameter(3.0, "s", "time constant")
    x = state(-2.0, "1", "what comes out")


class SlowerLag(Lag):
    """The slowest."""

    T = parameter(7.0, "s", "time constant")
    x = state(0.5, "1", "what comes out")


RING: dict[str, type[Component]] = {"a": Lag, "b": SlowLag, "c": SlowerLag}


class Clock(Observer):
    """Tells the processor time from the initial values to the end; it hears of no point between."""

    def started(self, system: System, info: RunInfo) -> None:
        self.seconds = -thread_time()

    def finished(self, summary: Summary) -> None:
        self.seconds += thread_time()


class Bare:
    """The bare loop for one version of FMI."""

    def __init__(self, fmi: int, files: Sequence[Path], folder: Path) -> None:
        built = folder / f"bare{fmi}.so"
        command = [*(compiler() or ["cc"]), "-O2", f"-DFMI_VERSION={fmi}", "-shared", "-fPIC", str(SOURCE), "-ldl"]
        subprocess.run([*command, "-o", str(built)], check=True)
        self._loop = ctypes.CDLL(str(built)).bare_loop
        self._loop.restype = c_double
        self._loop.argtypes = (c_int, *(ctypes.POINTER(c_char_p),) * 2, c_uint32, c_uint32, c_long, c_double,
                               ctypes.POINTER(c_double))  # fmt: skip
        archives = [read(path) for path in files]
        self._paths = (c_char_p * len(files))(*(str(library(a)).encode() for a in archives))
        self._tokens = (c_char_p * len(files))(*(a.token.encode() for a in archives))
        self._ports = [archives[0].references[name].values[0] if name in archives[0].references else 0 for name in "uy"]
        self._n = len(files)

    def __call__(self, steps: int) -> tuple[float, list[float]]:
        """Return the seconds of processor time and the outputs in the end."""
        y = (c_double * self._n)()
        taken = self._loop(self._n, self._paths, self._tokens, *self._ports, steps, STEP, y)
        if taken < 0:
            raise RuntimeError("the bare loop could not load or step the FMUs")
        return taken, list(y)


def ours(fmi: int, steps: int, *, compiled: bool) -> tuple[float, list[float]]:
    """Run the ring with our master; as ``Bare``."""
    instances = {name: fmus.instantiate(kind(), name, fmi=fmi) for name, kind in RING.items()}
    clock = Clock()
    with System(instances, {"a.u": "c.y", "b.u": "a.y", "c.u": "b.y"}) as system:
        run(system, Jacobi(), step=STEP, stop=round(steps * STEP * 1e9), observers=[clock], compiled=compiled)
        return clock.seconds, [system[f"{name}.y"] for name in RING]


def loops(bare: dict[int, Bare]) -> dict[str, Any]:
    """Return the cost of our loops in times of the bare one, by version of FMI; the values must be the same."""
    found = {}
    for fmi, least in bare.items():
        ratios: dict[str, list[float]] = {"compiled": [], "readable": []}
        for _ in range(REPEATS):
            seconds, y = least(STEPS)
            taken, mine = ours(fmi, STEPS, compiled=True)
            slow, same = ours(fmi, STEPS // 200, compiled=False)
            assert mine == y, (mine, y)
            assert same == least(STEPS // 200)[1]
            ratios["compiled"].append(taken / seconds)
            ratios["readable"].append(200 * slow / seconds)
        found[f"fmi{fmi}"] = {name: median(r) for name, r in ratios.items()} | {"bare_us": seconds / STEPS * 1e6}
    return found


def others(bare: Bare, files: Sequence[Path], folder: Path) -> dict[str, Any]:
    """Return what the peers cost in times of the bare loop, with their versions and how far their values are off."""
    found: dict[str, Any] = {}
    ready = {name: peers.prepare(name) for name in peers.PEERS}
    for _ in range(3):
        for name, (python, why) in ready.items():
            steps = peers.PEERS[name].steps
            if why:
                found[name] = {"reason": why}
                continue
            answer = peers.measure(name, python, files, STEP, steps, folder)
            if "reason" in answer:
                found[name] = answer
                ready[name] = (python, answer["reason"])
                continue
            seconds, y = bare(steps)
            held = found.setdefault(name, {"ratios": [], "version": answer["version"], "macro_steps": steps})
            held["ratios"].append(answer["seconds"] / seconds)
            held["off"] = max(abs(a - b) for a, b in zip(answer["y"], y, strict=True))
    return {n: {**f, "ratio": median(f["ratios"])} if "ratios" in f else f for n, f in found.items()}


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--no-peers", action="store_true", help="measure our own loops only")
    asked = parser.parse_args()
    files = {fmi: [fmus.build(kind(), fmi=fmi) for kind in RING.values()] for fmi in (2, 3)}
    with tempfile.TemporaryDirectory() as folder:
        bare = {fmi: Bare(fmi, paths, Path(folder)) for fmi, paths in files.items()}
        found = loops(bare)
        beside = {} if asked.no_peers else others(bare[2], files[2], Path(folder))
    day = datetime.now(UTC).date().isoformat()
    shown = Table("", "x bare C loop", "version", "values off by", title=f"three FMUs in a ring, {day}")
    for fmi, ratios in found.items():
        for name in ("compiled", "readable"):
            shown.add_row(f"{name} loop, {fmi}", f"{ratios[name]:.2f}", "", "0")
    for name, facts in sorted(beside.items(), key=lambda item: item[1].get("ratio", 1e9)):
        if "reason" in facts:
            shown.add_row(name, "-", "", facts["reason"])
        else:
            shown.add_row(name, f"{facts['ratio']:.1f}", facts["version"], f"{facts['off']:.2g}")
    Console(width=120).print(shown)
    enough = all(ratios["compiled"] <= MOST for ratios in found.values())
    print(json.dumps({"date": day, "loops": found, "peers": beside, "at_most_1.3": enough}))


if __name__ == "__main__":
    main()
