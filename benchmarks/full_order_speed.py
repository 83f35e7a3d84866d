"""What does a second of the full-order robot cost, compiled and in straightforward NumPy?

Rings of 32 nodes with 128 contact points, the lowest modes of the chassis, the ramp of the impact study: while rolling,
and in the collision.  Both ways start from the same states and take the same micro steps; that NumPy computes the same
equations is checked first: with the wheels pressed by 2 kN all states agree to rounding, amplified by 2000 micro steps.
Processor time of one thread, medians of runs in turn.

    python benchmarks/full_order_speed.py
"""

from __future__ import annotations

import json
from collections.abc import Callable
from time import process_time
from typing import Any

import numpy as np
from full_order_numpy import NumpyRover, numpy_rover, wheels_apart
from rich.console import Console
from rich.table import Table

import fmus
from cosim.clock import NS
from plants.chassis_fe import PlateChassis
from plants.full_order import FullOrderRover
from plants.full_order_ground import ground_table
from plants.full_order_start import settled
from plants.ground import Ramp

MODES, MICRO, MACRO, REPEATS = 4, 2e-5, 1e-3, 5
FOOT, SPEED, TORQUE = 0.62, 2.0, np.full(4, 0.5)
AGREE, AT_END = 1e-8, 40  # relative, macro steps until when agreement is checked: the wheels press with 2 kN
PHASES = {"rolling": 5, "collision": AT_END}


def rover(nodes: int = 32, points: int = 128) -> FullOrderRover:
    """Return the robot with the first modes of the default chassis."""
    chassis = PlateChassis().cached_modes(MODES)
    ground = ground_table(Ramp(FOOT, 0.3))
    return FullOrderRover(
        nodes=nodes, points=points, modes=MODES, micro_step=MICRO, ground_left=ground, ground_right=ground,
        frequency=chassis.frequency, damping=chassis.damping, wheel_shape=chassis.wheel_shape,
    )  # fmt: skip


def compiled(component: FullOrderRover, starts: dict[str, Any]) -> fmus.FmuInstance:
    """Return the FMU of *component* at t = 0."""
    fmu = fmus.instantiate(component)
    for name, value in starts.items():
        fmu.set(name, value)
    fmu.set("torque", TORQUE)
    fmu.enter_initialization(0)
    fmu.push()
    fmu.exit_initialization()
    return fmu


def advance(model: NumpyRover, n: int) -> None:
    """Take macro step *n* in NumPy."""
    model.begin()
    count = round(MACRO / MICRO)
    for i in range(count):
        model.step(n * MACRO + i * MICRO, MACRO / count, TORQUE)


def difference(fmu: fmus.FmuInstance, model: NumpyRover) -> dict[str, float]:
    """Return for every state how far the two are apart, relative to its largest value, as far as that is not tiny."""
    found = {}
    for name, value in wheels_apart(model.state).items():
        theirs = np.asarray(fmu.get(name))
        found[name] = float(np.max(np.abs(theirs - value)) / max(1e-3, np.max(np.abs(theirs))))
    return found


def timed(way: Callable[[], None]) -> float:
    """Return seconds of processor time."""
    began = process_time()
    way()
    return process_time() - began


def main() -> None:
    """Check, time in turn, print."""
    component = rover()
    starts = settled(component, 0.0, 0.0, SPEED)
    fmu, model, kept = compiled(component, starts), numpy_rover(component, starts), {}
    for n in range(AT_END):
        for phase, at in PHASES.items():
            if n == at - 1:
                kept[phase] = (n, fmu.snapshot(), dict(model.state))
        fmu.step(n * NS // 1000, (n + 1) * NS // 1000)
        advance(model, n)
    apart = difference(fmu, model)
    assert max(apart.values()) < AGREE, apart
    found: dict[str, Any] = {"worst_difference": max(apart.values()), "peak": float(np.max(fmu.get("normal_force")))}
    table = Table("phase", "way", "times real time", "us per micro step", "ns per node and micro step", "ratio")
    for phase, (n, snapshot, state) in kept.items():
        seconds: dict[str, list[float]] = {"FMU": [], "NumPy": []}
        for _ in range(REPEATS):
            fmu.restore(snapshot)
            seconds["FMU"].append(timed(lambda n=n: fmu.step(n * NS // 1000, (n + 1) * NS // 1000)))  # type: ignore[misc]
            model.state = dict(state)
            seconds["NumPy"].append(timed(lambda n=n: advance(model, n)))  # type: ignore[misc]
        cost = {way: float(np.median(s)) / (MACRO / MICRO) for way, s in seconds.items()}
        for way, each in cost.items():
            of = {"real_time": each / MICRO, "us": 1e6 * each, "ns_per_node": 1e9 * each / (4 * component.nodes),
                  "ratio": each / cost["FMU"]}  # fmt: skip
            found[f"{phase}, {way}"] = of
            table.add_row(phase, way, *(f"{v:.3g}" for v in of.values()))
    Console(width=120).print(table)
    print(json.dumps(found))


if __name__ == "__main__":
    main()
