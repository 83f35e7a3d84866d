"""How long may a macro step be? The longest one with an error below 1e-3 of the largest vertical speed.

The error is that of the vertical speed against the same equations in one ODE (relative tolerance 1e-12): on the thesis'
ramp, uncontrolled, hard undamped wheels, the kink located inside a macro step, 0.3 s with its rebounds, at every 1 ms;
and beside it on a smooth hump on damped wheels, where nothing is hard, at every 10 ms.  Steps are divisors of that.
Where even the shortest one tried is not enough, its error is shown, and a ratio is a lower bound.

    python benchmarks/allowed_step.py
"""

from __future__ import annotations

import json
import sys
import warnings
from dataclasses import dataclass

import numpy as np
from rich.console import Console
from rich.table import Table

from cosim import Algorithm, GaussSeidel, Iterated, Record, run
from cosim.clock import ticks
from plants.ground import Ground, Hump, Ramp
from plants.tables import ROBOTS
from studies.coupling import Case, Coupling, coupled, reference

TARGET = 1e-3
AT_LEAST = 100.0  # how much longer the steps of the reduced model may be on the ramp
IN_TURN = GaussSeidel(("wheels", "body"))
CASES = {
    "ramp": Case(ROBOTS["thesis_6_1"], Ground.same(Ramp(start=0.63, angle=0.3)), k_w=2.8e6, x=7e-5),
    "damped hump": Case(
        ROBOTS["thesis_6_1"], Ground.same(Hump(start=0.8, length=1.0)), k_w=1e5, c_w=1322.8, speed=1.0, duration=1.5
    ),
}
LOOKED_AT = {"ramp": 1_000_000, "damped hump": 10_000_000}  # ns, between points
# coupling, algorithm, and the shortest step tried (ns): where the readable loop makes the run, that takes a while
WAYS: dict[str, tuple[Coupling, Algorithm, int]] = {
    "force/displacement, Gauss-Seidel": ("classical", IN_TURN, 500),
    "force/displacement, iterated": ("classical", Iterated(IN_TURN, max_iterations=20, unconverged="warn"), 50_000),
    "reduced model": ("reduced", IN_TURN, 500),
}


@dataclass(frozen=True)
class Allowed:
    """The longest step within the target and its error, or the shortest one tried (*enough* is False); s."""

    step: float
    error: float  # of the largest vertical speed
    enough: bool


def error(case: Case, coupling: Coupling, algorithm: Algorithm, step: int, every: int) -> float:
    """Return the largest error at the points *every* so many ns, as a share of the largest vertical speed."""
    record, exact = Record(["body.velocity"]), reference(case, every * 1e-9)
    with coupled(case, coupling) as system, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of steps across the loss of contact, which do not settle
        run(system, algorithm, step=step, stop=ticks(case.duration, "duration"), observers=[record])
    speed = record["body.velocity"][record.time_ns % every == 0, 2]
    return float(np.max(np.abs(speed - exact.vertical_speed)) / np.max(np.abs(exact.vertical_speed)))


def allowed(case: Case, every: int, coupling: Coupling, algorithm: Algorithm, shortest: int) -> Allowed:
    """Find the longest step within the target: halved until it is, as long ones cost little, then by bisection."""
    steps = [n for n in range(every, shortest - 1, -1) if every % n == 0]
    failed, at = -1, 0
    while (best := error(case, coupling, algorithm, steps[at], every)) > TARGET:
        if at == len(steps) - 1:
            return Allowed(steps[at] * 1e-9, best, enough=False)
        failed, at = at, next((i for i, n in enumerate(steps) if 2 * n <= steps[at]), len(steps) - 1)
    while at > failed + 1:
        middle = (failed + at) // 2
        if (found := error(case, coupling, algorithm, steps[middle], every)) <= TARGET:
            at, best = middle, found
        else:
            failed = middle
    return Allowed(steps[at] * 1e-9, best, enough=True)


def main() -> None:
    """Measure and print."""
    shown = Table("coupling", *CASES, title=f"longest macro step with an error below {TARGET:g} of the largest speed")
    found = {way: {name: allowed(case, LOOKED_AT[name], *WAYS[way]) for name, case in CASES.items()} for way in WAYS}
    for way, row in found.items():
        cells = [f"{'' if a.enough else '< '}{a.step:.3g} s ({a.error:.2g})" for a in row.values()]
        shown.add_row(way, *cells)
    first, last = found["force/displacement, Gauss-Seidel"], found["reduced model"]
    ratios = {name: last[name].step / first[name].step for name in CASES}
    cells = [f"{'' if first[name].enough else '> '}{ratio:.3g}" for name, ratio in ratios.items()]
    shown.add_row("reduced model / Gauss-Seidel", *cells)
    Console(width=120).print(shown)
    wrong = [] if last["ramp"].enough and ratios["ramp"] >= AT_LEAST else ["the reduced model allows too short a step"]
    print(*wrong, sep="\n")
    table = {way: {name: vars(a) for name, a in row.items()} for way, row in found.items()}
    print(json.dumps({"target": TARGET, "found": table, "ratios": ratios, "wrong": wrong}))
    if wrong:
        sys.exit(1)


if __name__ == "__main__":
    main()
