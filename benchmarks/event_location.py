"""How exactly are events met, and what does it cost?

Two bouncing masses, one of them kicked by a sampled controller, 3.5 s: how late each touch is met against its closed
form, and how many steps the masses take per touch.  Then the wheels of the thesis' ramp impact, with contact made and
lost met by everybody or not: worst error of the vertical speed against one ODE, points, and wall time of the run.

    python benchmarks/event_location.py
"""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from bouncing import KICK, PERIOD, Announcing, Ball, Switch, touches
from coupling_error import IMPACT
from rich.console import Console
from rich.table import Table

import fmus
from cosim import GaussSeidel, Record, Summary, System, run
from plants.wheel_deformation import WheelDeformation
from studies import coupling

STOP = 3.5  # s


WAYS: dict[str, tuple[type[Ball], int, str]] = {
    "announced, FMI 3.0 early return": (Announcing, 3, ""),
    "speed rises through zero, FMI 2.0 rollback": (Ball, 2, "speed rising"),
    "counter changes, FMI 2.0 rollback": (Ball, 2, "touches change"),
}


def bounce(way: str, step: float) -> dict[str, float]:
    """Run the two masses and compare."""
    ball, fmi, indicator = WAYS[way]
    parts: dict[str, Any] = {"controller": fmus.instantiate(Switch(), fmi=fmi)}
    parts |= {name: fmus.instantiate(ball(z0=h), fmi=fmi) for name, h in (("first", 1.0), ("second", 0.7))}
    counted = [0]
    for name in ("first", "second"):
        parts[name].step = _counting(parts[name].step, counted)
    port, _, kind = indicator.partition(" ")
    events = {f"{name}.{port}": kind for name in ("first", "second") if port}
    record = Record()
    with System(parts, {"second.kick": "controller.kick"}, events=events) as system:
        summary = run(system, GaussSeidel(), step=step, stop=STOP, observers=[record])
    late = []
    for name, closed in (
        ("first", list(touches(1.0, STOP))),
        ("second", list(touches(0.7, STOP, kick=KICK, period=PERIOD))),
    ):
        met = np.array([t for t, who in record.events if who == name])
        assert len(met) == len(closed), (way, name, len(met), len(closed))
        late += list(met - np.array(closed) * 1e9)
    steps = counted[0] - 2 * (summary.steps - summary.rejected)
    return {"latest": max(late), "earliest": min(late), "touches": len(late), "extra": steps / len(late)}


def _counting(step: Any, counted: list[int]) -> Any:
    def call(*arguments: Any, **how: Any) -> Any:
        counted[0] += 1
        return step(*arguments, **how)

    return call


@dataclass(frozen=True)
class Contact(coupling.Case):
    """A case whose contacts everybody meets, or not."""

    located: int = 0

    def wheels(self) -> WheelDeformation:
        return WheelDeformation(k_w=np.full(4, self.k_w), c_w=np.full(4, self.c_w), located=self.located)


def contact(located: int, step: float) -> dict[str, float]:
    """Return error, points, events and wall time of the ramp impact, the median of three runs."""
    case = Contact(**{**vars(replace(IMPACT, duration=0.3)), "located": located})
    ended: list[Summary] = []
    plain = coupling.run

    def watched(*arguments: Any, **how: Any) -> Summary:
        ended.append(plain(*arguments, **how))
        return ended[-1]

    coupling.run = watched
    try:
        errors = [coupling.worst_error(case, step) for _ in range(3)]
    finally:
        coupling.run = plain
    wall = float(np.median([summary.wall for summary in ended]))
    return {"error": errors[0], "steps": ended[0].steps, "events": ended[0].events, "wall": wall}


def main() -> None:
    """Measure and print."""
    console, found = Console(width=130), {}
    table = Table("way", "macro step, s", "touches", "met early, ns", "late, ns", "more steps of a mass per touch")
    for way in WAYS:
        for step in (1e-2, 1e-3):
            r = found[f"{way}, {step:g}"] = bounce(way, step)
            table.add_row(way, f"{step:g}", f"{r['touches']}", f"{max(0, -r['earliest']):.2g}", f"{r['latest']:.3f}",
                          f"{r['extra']:.1f}")  # fmt: skip
    console.print(table)
    table = Table("contacts of the wheels", "macro step, s", "worst error, m/s", "points", "events met", "wall, ms")
    for step in (1e-3, 1e-4):
        for located in (0, 1):
            r = found[f"contact {located}, {step:g}"] = contact(located, step)
            table.add_row("met by everybody" if located else "inside the step", f"{step:g}", f"{r['error']:.3g}",
                          f"{r['steps']}", f"{r['events']}", f"{1e3 * r['wall']:.1f}")  # fmt: skip
    console.print(table)
    print(json.dumps(found))


if __name__ == "__main__":
    main()
