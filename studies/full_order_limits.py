"""Between the full-order robot and the analytical ones: what is left between them as rings get light, stiff and smooth.

`WheelDeformation` is a wheel without mass on a linear spring that stays round; `RigidContact` one that does not give
at all.  A ring comes nearer to the first as it gets lighter and bends less, its foundation scaled to the same static
stiffness, but does not reach it: on a sharp ramp a sixth of the force is left however stiff it is.  To the second its
motion converges on smooth ground as everything gets stiffer, its force does not.  Neither has friction here.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from cosim.errors import ScenarioError
from cosim.scenario import Scenario
from plants.full_order import FullOrderRover

from .runner import execute

_BASE: dict[str, Any] = {
    "name": "full-order-limits", "title": "limits", "claim": "", "assembly": "rover", "robot": {"table": "thesis_6_1"},
    "start": {"speed": 2.0}, "components": {"controller": {"type": "Uncontrolled"}},
}  # fmt: skip
_RAMP = {"kind": "ramp", "start": 0.63, "angle": 0.3}  # the fronts meet it after 7.4 ms
_HUMP = {"kind": "hump", "shape": "sin4", "start": 0.65, "length": 1.0, "height": 0.02}
K_W = 1e5  # N/m of each wheel on the ramp
DEFAULTS = {name: float(getattr(FullOrderRover, name).start) for name in ("ring_mass", "J_w", "EA", "EI")}


@dataclass(frozen=True)
class Difference:
    """Largest differences over a run: front axle force, relative to its largest value, and vertical speed in m/s."""

    force: float
    speed: float


def _run(ground: dict, components: dict, duration: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return time (n,), front axle force (n,) and vertical speed (n,)."""
    table = {**_BASE, "ground": ground, "run": {"step": 1e-4, "duration": duration, "locate_events": False},
             "components": {**_BASE["components"], **components}}  # fmt: skip
    result = execute(Scenario.model_validate(table))
    if result.error is not None:
        raise ScenarioError(f"limits: {result.error}")
    F = result.signal("wheels.normal_force")
    assert F is not None
    return result.record.time, F[:, :2].sum(axis=1), result.record["body.velocity"][:, 2]


def _difference(one: tuple, other: tuple) -> Difference:
    """Return the differences, forces smoothed over 1 ms: the nodes of a ring come to the ground one by one."""
    kernel = np.ones(10) / 10
    a, b = (np.convolve(run[1], kernel, mode="valid") for run in (one, other))
    return Difference(float(np.max(np.abs(a - b)) / np.max(b)), float(np.max(np.abs(one[2] - other[2]))))


def towards_deformation(rings: list[tuple[float, float]], duration: float = 0.06) -> list[Difference]:
    """Return what is left to `WheelDeformation` on the ramp for *rings*: factors of mass, and of EI and EA.

    The mass is that of the rings and the inertia of the rims.
    """
    wheels = {"type": "WheelDeformation", "k_w": K_W, "c_w": 0.0, "mu": 0.0}
    reference = _run(_RAMP, {"wheels": wheels}, duration)
    found = []
    for mass, stiff in rings:
        body = {"type": "FullOrderRover", "k_w": K_W, "c_w": 0.0, "mu": 0.0, "ring_mass": mass * DEFAULTS["ring_mass"],
                "J_w": mass * DEFAULTS["J_w"], "EA": stiff * DEFAULTS["EA"], "EI": stiff * DEFAULTS["EI"]}  # fmt: skip
        found.append(_difference(_run(_RAMP, {"body": body}, duration), reference))
    return found


def towards_rigid(wheels: list[tuple[float, int]], duration: float = 0.5) -> list[Difference]:
    """Return what is left to `RigidContact` on a smooth hump for *wheels* of k_w (N/m) and points, damped by ζ = 0.3.

    A ring that rolls on points s apart rises and falls by s^2 / (8 R), which must be small beside its depth W / k_w.
    """
    reference = _run(_HUMP, {"wheels": {"type": "RigidContact", "mu": 0.0}}, duration)
    found = []
    for k_w, points in wheels:
        c_w = 0.3 * np.sqrt(2 * k_w / 0.0103)  # 2 zeta sqrt(k / P) of an axle, on two wheels
        body = {"type": "FullOrderRover", "k_w": k_w, "c_w": float(c_w), "mu": 0.0, "points": points}
        found.append(_difference(_run(_HUMP, {"body": body}, duration), reference))
    return found
