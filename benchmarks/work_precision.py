"""What does accuracy cost? Error against a monolithic reference over wall time, for every coupling algorithm.

(a) two masses between springs, against the closed form; (b) the first contact of the rover with the thesis' ramp on
hard undamped wheels, uncontrolled, against the same equations in one ODE (relative tolerance 1e-12).  Plain Jacobi and
Gauss-Seidel run in the compiled loop, everything else in the readable one.

    python benchmarks/work_precision.py
"""

from __future__ import annotations

import json
import math
import sys
import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from rich.console import Console
from rich.table import Table

import fmus
from cosim import (
    PI,
    Algorithm,
    Bond,
    Conserving,
    EnergyError,
    Extrapolated,
    Fixed,
    GaussSeidel,
    Iterated,
    Jacobi,
    Record,
    Richardson,
    run,
)
from plants.ground import Ground, Ramp
from plants.tables import ROBOTS
from studies.coupling import Case, Coupling, coupled, exactly, kink
from studies.oscillator import STILL, LeftMass, RightMass, solution
from studies.oscillator import coupled as two_masses
from studies.places import run_folder

NS = 1_000_000_000
REPEATS = 3  # wall times are medians of so many, taken in turn
BOND = Bond("right.force", "left.velocity", 0.065)  # J, the energy at the start
PARTS = LeftMass(d_wall=0.2), RightMass()
ANGLE = 0.3  # rad
IMPACT = Case(ROBOTS["thesis_6_1"], Ground.same(Ramp(start=0.63, angle=ANGLE)), k_w=2.8e6, x=7e-5, duration=0.02)


@dataclass(frozen=True)
class Outcome:
    """One run."""

    error: float  # m (a), m/s (b)
    wall: float  # s
    steps: int
    event: int = -1  # ns, the first


Attempted = Callable[[float], Outcome]  # of a step in s, or of a tolerance


@dataclass(frozen=True)
class Way:
    """A way of coupling: runs for values of its *knob* (the step in s, or the tolerance), and the order claimed."""

    label: str
    attempt: Attempted
    knobs: tuple[float, ...]
    order: int
    paced: bool = False
    gain: float = math.inf  # of a paced one: the most that an error of 1 in all judged outputs becomes


def oscillator(algorithm: Algorithm, step: float, control: Fixed | PI = Fixed()) -> Outcome:  # noqa: B008
    """Run problem (a) for 2 s; the error is the largest of both positions at 16 points of the run, in m."""
    record = Record(["left.position", "right.position"])
    with two_masses(*(fmus.instantiate(part, fmi=2) for part in PARTS), STILL) as system:
        summary = run(system, algorithm, step=round(step * NS), stop=2 * NS, observers=[record], control=control,
                      tolerance=1e-11)  # fmt: skip
    wrong = 0.0
    for i in np.unique(np.linspace(1, len(record) - 1, 16).astype(int)):
        exact = solution(*PARTS, record.time_ns[i] / NS, STILL)
        wrong = max(wrong, abs(record["left.position"][i] - exact[0]), abs(record["right.position"][i] - exact[3]))
    return Outcome(float(wrong), summary.wall, summary.steps)


def rover(coupling: Coupling, algorithm: Algorithm, step: float, control: Fixed | PI = Fixed()) -> Outcome:  # noqa: B008
    """Run problem (b) for 20 ms; the error is the largest of the vertical speed at all points, in m/s."""
    record = Record(["body.velocity"])
    with coupled(IMPACT, coupling) as system, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of steps across the loss of contact, which do not settle
        summary = run(system, algorithm, step=round(step * NS), stop=round(IMPACT.duration * NS), observers=[record],
                      control=control)  # fmt: skip
    wrong = np.max(np.abs(record["body.velocity"][:, 2] - exactly(IMPACT, record.time_ns).vertical_speed))
    return Outcome(float(wrong), summary.wall, summary.steps, record.events[0][0])


def masses() -> list[Way]:
    """Return the ways of problem (a)."""
    fixed: dict[str, tuple[Algorithm, int]] = {
        "Jacobi": (Jacobi(), 1),
        "Gauss-Seidel": (GaussSeidel(), 1),
        "iterated": (Iterated(), 1),
        "Jacobi, lines": (Extrapolated(Jacobi(), 1), 2),
        "Jacobi, parabolas": (Extrapolated(Jacobi(), 2), 3),
        "iterated, lines": (Extrapolated(Iterated(), 1), 2),
        "iterated, parabolas": (Extrapolated(Iterated(), 2), 3),
        "Jacobi, impulses conserved": (Conserving(Jacobi(), (BOND,)), 2),
        "Gauss-Seidel, impulses conserved": (Conserving(GaussSeidel(), (BOND,)), 2),
    }
    judged = ("*.position", "*.velocity")
    # an error of position stays one, one of velocity becomes one by 1 / w, at most 1 s; energy says nothing of phase
    paced: dict[str, tuple[Algorithm, int, float]] = {
        "Gauss-Seidel, PI by Richardson": (Richardson(GaussSeidel(), outputs=judged), 1, 2.0),
        "Gauss-Seidel, PI by energy": (EnergyError(GaussSeidel(), (BOND,)), 1, math.inf),
        "iterated, lines, PI by Richardson": (Richardson(Extrapolated(Iterated(), 1), 2, outputs=judged), 2, 2.0),
    }
    steps, tolerances = (1 / 25, 1 / 50, 1 / 100, 1 / 200), (1e-3, 1e-4, 1e-5)
    return [
        *(Way(name, lambda h, a=a: oscillator(a, h), steps, order) for name, (a, order) in fixed.items()),
        *(
            Way(name, lambda tol, a=a, p=p: oscillator(a, 1e-3, PI(0.0, tol, order=p)), tolerances, p, True, gain)
            for name, (a, p, gain) in paced.items()
        ),
    ]


def contact() -> list[Way]:
    """Return the ways of problem (b)."""
    in_turn = GaussSeidel(("wheels", "body"))
    couplings: dict[str, tuple[Coupling, Algorithm, int]] = {
        "reduced model": ("reduced", in_turn, 2),
        "force/displacement, Gauss-Seidel": ("classical", in_turn, 1),
        "force/displacement, Jacobi": ("classical", Jacobi(), 1),
        "force/displacement, iterated": ("classical", Iterated(in_turn, max_iterations=20, unconverged="warn"), 1),
    }
    # an error of position becomes one of velocity at 254 rad/s, the faster of the two natural frequencies
    judged = Richardson(in_turn, 2, outputs=("body.position",))

    def as_asked(tolerance: float) -> Outcome:
        return rover("reduced", judged, 1e-5, PI(0.0, tolerance, order=2))

    steps = (4e-4, 2e-4, 1e-4, 5e-5)
    return [
        *(Way(name, lambda h, c=c, a=a: rover(c, a, h), steps, p) for name, (c, a, p) in couplings.items()),
        Way("reduced model, PI by Richardson", as_asked, (1e-6, 1e-7, 1e-8), 2, True, 254.0),
    ]


def measured(way: Way) -> list[Outcome]:
    """Run a way for each of its knobs, several times in turn: what came out, with median wall times."""
    runs = [[way.attempt(knob) for knob in way.knobs] for _ in range(REPEATS)]
    return [replace(each[0], wall=float(np.median([o.wall for o in each]))) for each in zip(*runs, strict=True)]


def order_of(way: Way, found: list[Outcome]) -> float:
    """Return the slope of the error over the step, or over the mean one."""
    steps = [1 / o.steps for o in found] if way.paced else way.knobs
    return float(np.polyfit(np.log(steps), np.log([o.error for o in found]), 1)[0])


def failures(way: Way, found: list[Outcome], order: float) -> list[str]:
    """Return what does not hold of a way, as sentences."""
    wrong, exact = [], kink(IMPACT, ANGLE)
    if not way.paced and not way.order - 0.3 < order < way.order + 0.7:
        wrong.append(f"{way.label}: the observed order {order:.2f} is not the {way.order} that is claimed")
    if way.paced:
        wrong += [
            f"{way.label}: the error {o.error:.1e} is above what {o.steps} steps of {tolerance:g} can make"
            for o, tolerance in zip(found, way.knobs, strict=True) if o.error > way.gain * o.steps * tolerance
        ]  # fmt: skip
    wrong += [
        f"{way.label}: the event at {o.event} ns is not within 1 ns of {exact} ns"
        for o in found if o.event >= 0 and abs(o.event - exact) > 1
    ]  # fmt: skip
    return wrong


def picture(results: dict[str, tuple[list[tuple[Way, list[Outcome]]], str]], path: Path) -> None:
    """Draw error over wall time."""
    figure = Figure(figsize=(13, 6), layout="constrained")
    for axes, (title, (rows, unit)) in zip(figure.subplots(1, 2), results.items(), strict=True):
        for way, found in rows:
            style = "o--" if way.paced else "o-"
            axes.loglog([o.wall for o in found], [o.error for o in found], style, label=way.label, markersize=4)
        axes.set(title=title, xlabel="wall time of the run, s", ylabel=f"largest error, {unit}")
        axes.grid(True, which="major", alpha=0.3)
        axes.legend(fontsize=7)
    figure.savefig(path, dpi=100)


def main() -> None:
    """Measure, print, draw, judge."""
    results: dict[str, tuple[list[tuple[Way, list[Outcome]]], str]] = {}
    report: dict[str, Any] = {}
    wrong: list[str] = []
    for title, ways, unit in (("two masses", masses(), "m"), ("first contact", contact(), "m/s")):
        shown = Table("coupling", f"error, {unit} (steps, wall time in ms)", "order", "claimed", title=title)
        rows = results.setdefault(title, ([], unit))[0]
        for way in ways:
            found = measured(way)
            order = order_of(way, found)
            rows.append((way, found))
            wrong += failures(way, found, order)
            cells = "   ".join(f"{o.error:.1e} ({o.steps}, {o.wall * 1e3:.3g})" for o in found)
            shown.add_row(way.label, cells, f"{order:.2f}", str(way.order))
            report[f"{title}: {way.label}"] = {
                "knobs": way.knobs, "errors": [o.error for o in found], "steps": [o.steps for o in found],
                "wall": [o.wall for o in found], "order": order,
            }  # fmt: skip
        Console(width=150).print(shown)
    path = run_folder() / "work_precision.png"
    picture(results, path)
    print(f"picture: {path}", *wrong, sep="\n")
    print(json.dumps({"found": report, "wrong": wrong}))
    if wrong:
        sys.exit(1)


if __name__ == "__main__":
    main()
