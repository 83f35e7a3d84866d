"""Between the full-order robot and the analytical ones: what is left between them as rings get light, stiff and smooth.

`WheelDeformation` is a wheel without mass on a linear spring that stays round; `RigidContact` one that does not give
at all.  A ring becomes the first where it is light, does not bend and is hard to sink into, all on a foundation scaled
to the same static stiffness.  The three belong together: a ring that does not bend meets the ground in a few
centimetres, and a penalty there gives as load^(2/3); with the springs of the default ring that is most of the wheel.
What it leaves falls with k_c^(-2/3), and `round_wheel` predicts it.  The sharp corner of the ramp is no obstacle.

It becomes the second as all its springs grow, on smooth ground, if it does not bend between its nodes: otherwise its
load changes from node to node, 9 % at 1e7 N/m, however small the depth.  The points do the same where few of them
touch: they have to grow faster than the root of the stiffness, and the mass has to fall.  Neither has friction here.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from cosim.errors import ScenarioError
from cosim.scenario import Scenario
from plants.full_order import FullOrderRover
from plants.tables import G, robot

from .round_wheel import Crossing, Ramp, Springs, crossing
from .runner import execute

ROBOT, SPEED, STEP = robot("thesis_6_1"), 2.0, 1e-4  # m/s, s
RAMP = Ramp(0.63, 0.3)  # the fronts meet it after 7.4 ms
_RAMP = {"kind": "ramp", "start": RAMP.start, "angle": RAMP.angle}
_HUMP = {"kind": "hump", "shape": "sin4", "start": 0.65, "length": 1.0, "height": 0.02}
K_W = 1e5  # N/m of each wheel on the ramp
ZETA = 0.3  # of the wheels on the hump
_MOBILITY = 0.0103  # 1/kg, of an axle, P of (4.44) on level ground
_DEFAULT = {name: float(getattr(FullOrderRover, name).start)
            for name in ("ring_mass", "EA", "EI", "k_contact", "k_radial", "k_tangential")}  # fmt: skip


@dataclass(frozen=True)
class Ring:
    """A ring that differs from the default one by factors: of its mass, of EI, of k_contact over k_radial.

    EA grows with EI^(2/3): it is stiff already, and what limits the micro steps.
    """

    mass: float = 1.0
    bending: float = 1.0
    contact: float = 1.0
    nodes: int = 16
    points: int = 512

    def body(self, k_w: float, c_w: float) -> dict[str, Any]:
        """Return the slot of the robot, which weighs what the analytical one does."""
        factors = {"ring_mass": self.mass, "EA": self.bending ** (2 / 3), "EI": self.bending, "k_contact": self.contact}
        d = {name: factor * _DEFAULT[name] for name, factor in factors.items()}
        return {"type": "FullOrderRover", "k_w": k_w, "c_w": c_w, "mu": 0.0, "nodes": self.nodes,
                "points": self.points, "m": ROBOT.m - 4 * d["ring_mass"], **d}  # fmt: skip


@dataclass(frozen=True)
class Difference:
    """Largest differences over a run: front axle force, relative to its largest value, and vertical speed in m/s."""

    force: float
    speed: float


Run = tuple[np.ndarray, np.ndarray]  # front axle force (n,), N, means over the steps, and vertical speed (n,), m/s


def _run(ground: dict, components: dict, duration: float) -> Run:
    table = {
        "name": "full-order-limits", "title": "limits", "claim": "", "assembly": "rover",
        "robot": {"table": "thesis_6_1"}, "start": {"speed": SPEED}, "ground": ground,
        "run": {"step": STEP, "duration": duration, "locate_events": False},
        "components": {"controller": {"type": "Uncontrolled"}, **components},
    }  # fmt: skip
    result = execute(Scenario.model_validate(table))
    if result.error is not None:
        raise ScenarioError(f"limits: {result.error}")
    F = result.signal("wheels.normal_force")
    assert F is not None
    return F[1:, :2].sum(axis=1), result.record["body.velocity"][1:, 2]


def difference(one: Run, other: Run) -> Difference:
    """Return the differences, forces smoothed over 1 ms: the points of a ring come to the ground one by one."""
    kernel = np.ones(10) / 10
    a, b = (np.convolve(run[0], kernel, mode="valid") for run in (one, other))
    return Difference(float(np.max(np.abs(a - b)) / np.max(b)), float(np.max(np.abs(one[1] - other[1]))))


@cache
def ring_on_ramp(ring: Ring, duration: float = 0.06) -> Run:
    """Return the run of a robot on rings over the ramp."""
    return _run(_RAMP, {"body": ring.body(K_W, 0.0)}, duration)


@cache
def spring_on_ramp(duration: float = 0.06) -> Run:
    """Return the run on `WheelDeformation` over the ramp."""
    return _run(_RAMP, {"wheels": {"type": "WheelDeformation", "k_w": K_W, "c_w": 0.0, "mu": 0.0}}, duration)


@cache
def predicted(contact: float, duration: float = 0.06) -> Crossing:
    """Return what a ring without mass that does not bend would do on the ramp, with its factor of k_contact."""
    R, d = ROBOT.R, _DEFAULT
    K = 2 * np.pi * R * (d["k_radial"] + d["k_tangential"])  # of both wheels of an axle
    C = 2 * 4 / 3 * contact * d["k_contact"] * np.sqrt(2 * R)
    springs = Springs(K, C).scaled(2 * K_W, ROBOT.m * G / 2)
    return crossing(ROBOT, springs, RAMP, SPEED, duration, STEP)


def towards_rigid(k_w: float, ring: Ring, duration: float = 0.2) -> Difference:
    """Return what is left to `RigidContact` on a smooth hump for wheels of *k_w* (N/m), damped by `ZETA`."""
    c_w = ZETA * float(np.sqrt(2 * k_w / _MOBILITY))  # 2 zeta sqrt(k / P) of an axle, on two wheels
    return difference(_run(_HUMP, {"body": ring.body(k_w, c_w)}, duration), rigid_on_hump(duration))


@cache
def rigid_on_hump(duration: float) -> Run:
    """Return the run on `RigidContact` over the hump."""
    return _run(_HUMP, {"wheels": {"type": "RigidContact", "mu": 0.0}}, duration)
