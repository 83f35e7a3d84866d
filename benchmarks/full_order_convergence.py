"""What of a ramp impact converges with the nodes of the rings and with the micro step, and what does not?

The robot of table 6.1 with the wheels of table 6.2 (0.83 kg of rubber, friction 0.8 and 0.3) rolls at 2 m/s against the
ramp of 0.3 rad.  Three wheels: 1e5 N/m damped (zeta = 0.3), the same undamped, and the hard undamped one of chapter 6
(2.8e6 N/m each).  Their material is calibrated once and is the same for every number of nodes.  Of the front axle: the
peak of the normal force, its impulse until 20 ms and 300 ms after the first touch, how often it leaves the ground by
then, and the rms difference of the force from that of the finest run, relative to its rms, over both spans.

What was found: the damped wheel converges in everything, with the nodes by a factor of 5 to 8 per doubling, with the
micro step at the first order of its dampers; undamped the micro step converges at second order.  The first contact
converges for all.  The force of the hard wheel at an instant does not after 300 ms: it flies for 0.14 s between two
contacts of 11 ms, and where it lands shifts by 2 ms between 32 and 64 nodes; impulses and the number of rebounds stay.
Fewer than 4 points per node, or 16 nodes for the hard wheel, are too few: between them the ground is not felt.

    python benchmarks/full_order_convergence.py
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

import fmus
from cosim.clock import NS
from plants.full_order import FullOrderRover, stable_step
from plants.full_order_ground import ground_table
from plants.full_order_start import settled
from plants.ground import Ramp
from plants.ring_press import calibrated, damped

NODES, EACH, REFERENCE = (16, 32, 64, 128), 4, 64  # nodes; points per node; nodes that the material is calibrated with
TICK, FOOT, SPEED, LOAD = NS // 10_000, 0.63, 2.0, 170 * 9.81 / 4
TOUCH, SPANS = 7.4e-3, (0.02, 0.3)  # s: when the front wheels meet the ramp, and what is looked at from there
WHEELS = {"1e5 N/m, zeta 0.3": (1e5, 1322.8), "1e5 N/m, undamped": (1e5, 0.0), "2.8e6 N/m, undamped": (2.8e6, 0.0)}


def material(k_w: float, c_w: float) -> dict[str, float]:
    """Return the parameters of a ring with static stiffness *k_w* (N/m) and damping *c_w* (N.s/m) under its load."""
    values = FullOrderRover().values
    found = calibrated(values, REFERENCE, EACH * REFERENCE, k_w, LOAD)
    if c_w == 0:
        return found | {"c_radial": 0.0, "c_tangential": 0.0}
    return found | damped({**values, **found}, REFERENCE, EACH * REFERENCE, c_w, LOAD / k_w)


def rover(nodes: int, ring: dict[str, float], micro: float, each: int = EACH) -> FullOrderRover:
    """Return the robot before the ramp."""
    ground = ground_table(Ramp(FOOT, 0.3))
    return FullOrderRover(
        nodes=nodes, points=each * nodes, micro_step=micro, ground_left=ground, ground_right=ground, **ring
    )


def longest(nodes: int, ring: dict[str, float]) -> float:
    """Return the longest stable micro step in s."""
    return stable_step(rover(nodes, ring, 1e-9))


@dataclass(frozen=True)
class Impact:
    """The normal force (n,) of the front axle, means over the macro steps."""

    force: np.ndarray

    @property
    def figures(self) -> dict[str, Any]:
        """Peak in N, impulses in N.s, and how often both front wheels are in the air."""
        short, long = (round((TOUCH + span) * NS) // TICK for span in SPANS)
        first = round(TOUCH * NS) // TICK
        air = self.force[first:long] <= 0
        return {
            "peak": float(np.max(self.force[:long])),
            "impulse_20ms": float(np.sum(self.force[first:short])) * TICK / NS,
            "impulse_300ms": float(np.sum(self.force[first:long])) * TICK / NS,
            "rebounds": int(np.count_nonzero(np.diff(air.astype(int)) > 0)),
        }

    def apart(self, other: Impact) -> list[float]:
        """Return the rms difference over both spans, relative to the rms of *other*."""
        first, found = round(TOUCH * NS) // TICK, []
        for span in SPANS:
            end = round((TOUCH + span) * NS) // TICK
            found.append(float(np.linalg.norm(self.force[first:end] - other.force[first:end])
                               / np.linalg.norm(other.force[first:end])))  # fmt: skip
        return found


def impact(component: FullOrderRover, duration: float = TOUCH + SPANS[1]) -> Impact:
    """Run until the end of the longer span, or for *duration* (s)."""
    fmu = fmus.instantiate(component)
    for name, value in settled(component, 0.0, 0.0, SPEED).items():
        fmu.set(name, value)
    fmu.enter_initialization(0)
    fmu.push()
    fmu.exit_initialization()
    force = []
    for n in range(round(duration * NS) // TICK):
        fmu.step(n * TICK, (n + 1) * TICK)
        force.append(float(np.sum(fmu.get("normal_force")[:2])))
    fmu.close()
    return Impact(np.array(force))


def shown(console: Console, title: str, runs: dict[str, Impact]) -> dict[str, Any]:
    """Print a table of *runs*, the last of which is the finest, and return its figures."""
    table = Table(title, "peak, N", "impulse 20 ms, N.s", "300 ms", "left the ground", "rms difference 20 ms", "300 ms")
    finest, found = list(runs.values())[-1], {}
    for name, run in runs.items():
        figures, apart = run.figures, run.apart(finest)
        found[name] = figures | {"apart": apart}
        table.add_row(name, f"{figures['peak']:.0f}", f"{figures['impulse_20ms']:.2f}",
                      f"{figures['impulse_300ms']:.1f}", f"{figures['rebounds']}",
                      *(f"{100 * a:.2g} %" if a else "" for a in apart))  # fmt: skip
    console.print(table)
    return found


def main() -> None:
    """Run all and print the tables."""
    console, found = Console(width=130), {}
    for name, (k_w, c_w) in WHEELS.items():
        ring = material(k_w, c_w)
        micro = longest(max(NODES), ring)
        runs = {f"{n} nodes": impact(rover(n, ring, min(micro, 2e-5))) for n in NODES}
        found[name] = {"nodes": shown(console, f"{name}; {min(micro, 2e-5):.2g} s", runs)}
        micro = TICK / NS / np.ceil(TICK / NS / longest(32, ring))
        runs = {f"{micro / d:.3g} s": impact(rover(32, ring, micro / d)) for d in (1, 2, 4, 8)}
        found[name]["micro step"] = shown(console, f"{name}; 32 nodes", runs)
        runs = {f"{p} points": impact(rover(32, ring, micro / 2, p)) for p in (1, 2, 4, 8)}
        found[name]["points"] = shown(console, f"{name}; 32 nodes", runs)
    print(json.dumps(found))


if __name__ == "__main__":
    main()
