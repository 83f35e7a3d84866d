"""The wheel of the full-order robot as a tyre: rolling resistance, effective radius, slip stiffness, relaxation length.

Measured on the robot that rolls on level ground, as literature measures tyres: the rolling resistance is what the free
wheels pull back over what they carry, the effective radius R_e = v / Omega of a free wheel, the slip of a driven one
kappa = (R_e Omega - v) / v, its slip stiffness C = F / kappa, and the relaxation length sigma = C / K_x with K_x the
tangential stiffness of a standing wheel (Pacejka, "Tire and vehicle dynamics", 2012, sec. 7.2).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from cosim.errors import ScenarioError
from cosim.scenario import Scenario

from .runner import Result, execute

SPEED, SETTLED, END = 2.0, 0.12, 0.28  # m/s; s, when the start has faded, and the end of a run
PUSH = 50.0  # N, traction asked of each wheel for the slip stiffness: an eighth of its load


def tangential_stiffness(ring: Mapping[str, Any], patch: float) -> float:
    """Return K_x (N/m) of a wheel whose rim is held: ring along and round the rim, and bristles on *patch* (m), in row.

    pi R (k_r + k_t), 2 pi R k_t and k_b times the patch.
    """
    R, k_r, k_t, k_b = (float(ring[n]) for n in ("R", "k_radial", "k_tangential", "k_bristle"))
    return 1 / (1 / (np.pi * R * (k_r + k_t)) + 1 / (2 * np.pi * R * k_t) + 1 / (k_b * patch))


@dataclass(frozen=True)
class Rolling:
    """A free wheel at 2 m/s: resistance over load, effective radius in m."""

    resistance: float
    radius: float


def _run(k_w: float, c_w: float, traction: float, speed: float = SPEED) -> Result:
    controller = {"type": "OpenLoopTorque", "demand": traction} if traction else {"type": "Uncontrolled"}
    table = {
        "name": "full-order-wheel", "title": "a wheel", "claim": "", "assembly": "rover", "ground": {"kind": "flat"},
        "robot": {"table": "thesis_6_1"}, "start": {"speed": speed}, "run": {"step": 1e-4, "duration": END},
        "components": {"controller": controller, "body": {"type": "FullOrderRover", "k_w": k_w, "c_w": c_w}},
    }  # fmt: skip
    result = execute(Scenario.model_validate(table))
    if result.error is not None:
        raise ScenarioError(f"wheel: {result.error}")
    return result


def _mean(result: Result, name: str) -> np.ndarray:
    """Return the mean of a port over the settled part of a run."""
    return np.asarray(result.record[name][result.record.time > SETTLED].mean(axis=0))


@cache
def free_rolling(k_w: float, c_w: float, speed: float = SPEED) -> Rolling:
    """Return what a free wheel does, the mean of all four."""
    result = _run(k_w, c_w, 0.0, speed)
    time, v = result.record.time, result.record["body.velocity"][:, 0]
    on = time > SETTLED
    slowing = -np.polyfit(time[on], v[on], 1)[0]  # of body, rings and spinning parts together
    radius = float(np.mean(_mean(result, "body.contact_velocity")[:, 0] / _mean(result, "body.wheel_spin")))
    return Rolling(slowing / 9.81, radius)


def slip_stiffness(k_w: float, c_w: float) -> float:
    """Return the slip stiffness (N) of a wheel under its share of the weight."""
    free, driven = free_rolling(k_w, c_w), _run(k_w, c_w, PUSH)
    v, spin = _mean(driven, "body.contact_velocity")[:, 0], _mean(driven, "body.wheel_spin")
    slip = float(np.mean((free.radius * spin - v) / v))
    passed = float(np.mean(_mean(driven, "body.traction"))) + free.resistance * 417.0
    return passed / slip
