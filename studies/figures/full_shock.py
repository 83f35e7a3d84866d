"""Three pulses on a wheel of the standing full-order robot (shock paper, Fig 5)."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

import fmus
from cosim.clock import ticks
from plants.full_order import FullOrderRover
from plants.full_order_start import settled
from plants.ground import Flat, Ground
from plants.pulses import Pulse
from plants.shock import GRAVITY
from plants.tables import robot

from ..designs import Context
from ..designs.full_order import full_order
from ..shock.cases import platform
from ..shock.collision import Impact, replayed, station_positions
from .claim import Claim, graded
from .sheet import LINES, Sheet, panels

SHAPES = ("rectangular", "half-sine", "triangular")
PEAK, DURATION = 1500.0, 0.15  # N, s, as printed
STEP, SECONDS = 1e-4, 0.3  # s
TABLE = "thesis_8_1"
ASSUMED = "the pulse pushes the front left hub up; wheels of 1e5 N/m with ζ = 0.3, chassis of the plate with 25 modes"


@cache
def rover() -> FullOrderRover:
    """Return the robot with its payload, on wheels that a robot could have."""
    context = Context(robot(TABLE), Ground.same(Flat()), 0.0, 0.0, SECONDS, {})
    made = full_order({"k_w": 1e5, "c_w": 1322.8, "chassis": {"modes": 25}}, context)
    assert isinstance(made, FullOrderRover)
    return made


@cache
def response(shape: str) -> tuple[np.ndarray, np.ndarray]:
    """Return time (n,) in s and the acceleration (n,) in g of station 1 under a pulse: rigid and elastic together."""
    pulse = Pulse(shape, DURATION)
    instance = fmus.instantiate(rover(), "body")
    try:
        for name, value in settled(rover(), 0.0, 0.0, 0.0).items():
            instance.set(name, value)
        instance.enter_initialization(0)
        instance.push()
        instance.exit_initialization()
        return _driven(instance, pulse)
    finally:
        instance.close()


def _driven(instance: Any, pulse: Pulse) -> tuple[np.ndarray, np.ndarray]:
    h, n = ticks(STEP, "step"), round(SECONDS / STEP)
    load, force, rigid = np.zeros((4, 3)), np.zeros((n + 1, 4)), np.zeros((n + 1, 20))
    x, y = station_positions(robot(TABLE))
    force[0] = instance.get("pressing") - rover().ring_mass * rover().g  # what the chassis stands on
    for k in range(n):
        load[0, 2] = PEAK * pulse.force(np.array([(k + 0.5) * STEP]))[0]
        instance.set("hub_force", load)
        instance.step(k * h, (k + 1) * h)
        force[k + 1] = instance.get("wheel_force") + load[:, 2]
        alpha = instance.get("angular_acceleration")
        rigid[k + 1] = instance.get("acceleration")[2] + alpha[0] * y - alpha[1] * x
    time = np.arange(n + 1) * STEP
    elastic = replayed(Impact(time, force, np.zeros_like(rigid), rigid), platform(25))
    return time, np.asarray((rigid + elastic)[:, 0] / GRAVITY)


def figure() -> Sheet:
    """Return Fig 5: acceleration at station 1 under a rectangular, a half-sine and a triangular pulse."""
    title = "Acceleration at station 1 under three pulses, full-order robot (shock paper, Fig 5)"
    drawn, axes = panels(title, 1, 1, figsize=(9, 4))
    columns: dict[str, np.ndarray] = {}
    for shape, colour in zip(SHAPES, LINES, strict=False):
        time, a = response(shape)
        columns |= {"time [s]": time, f"{shape} [g]": a}
        axes[0, 0].plot(time, a, color=colour, lw=0.9, label=f"{shape}, peak {np.max(np.abs(a)):.2f} g")
    axes[0, 0].set(xlabel="time / s", ylabel="acceleration of station 1 / g")
    axes[0, 0].legend(frameon=False, fontsize=8)
    return Sheet(title, columns, drawn, (ASSUMED,))


def claims() -> list[Claim]:
    """Return the verdict on the order of the three."""
    peaks = {shape: float(np.max(np.abs(response(shape)[1]))) for shape in SHAPES}
    return [
        Claim(
            "shock paper, Fig 5",
            "the rectangular pulse generates the highest acceleration, the sinusoidal and the triangular one less",
            f"peaks at station 1: {', '.join(f'{shape} {peak:.2f} g' for shape, peak in peaks.items())}",
            graded(peaks["rectangular"] > peaks["half-sine"] > peaks["triangular"],
                   peaks["rectangular"] == max(peaks.values())),
            peaks,
            assumption=ASSUMED,
        )
    ]  # fmt: skip
