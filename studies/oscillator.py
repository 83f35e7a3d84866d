"""Two masses between springs, cut at the spring that couples them: the reference problem of the coupling algorithms.

    wall -k1, d1- m1 -k, d- m2 -k2- wall

The left part holds the first mass and the coupling spring; it is given the velocity of the second mass and gives the
force on it.  Force and velocity are a power bond: what one side gives, the other has to receive.  Each side keeps its
own balance exactly, so the energy of both, with what dampers took, changes only by what the coupling makes or loses.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.linalg import expm

from cosim import Component, Instance, System, input, output, parameter, state

CONNECTIONS = {"right.force": "left.force", "left.velocity": "right.velocity"}
START = (0.1, 0.0, 0.1, 0.0, 0.0)  # x1, v1, x1 - x2, x2, v2
# Force and velocity stand still at first (v1 = v2, k e = k2 x2): a first step on held inputs is wrong by O(h^3) only.
STILL = (0.11, 0.0, 0.02, 0.09, 0.0)


class LeftMass(Component):
    """m1 v1' = -k1 x1 - d1 v1 - F, with F = k e + d (v1 - v2) on the second mass and e' = v1 - v2."""

    m = parameter(1.0, "kg", "first mass")
    k_wall = parameter(4.0, "N/m", "stiffness to the wall")
    d_wall = parameter(0.0, "N.s/m", "damping to the wall")
    k = parameter(9.0, "N/m", "stiffness of the coupling spring")
    d = parameter(0.0, "N.s/m", "damping of the coupling spring")
    velocity = input("m/s", "velocity of the second mass")
    x = state(START[0], "m", "position", nominal=0.1)
    v = state(START[1], "m/s", "velocity", nominal=0.1)
    e = state(START[2], "m", "elongation of the coupling spring", nominal=0.1)
    q = state(0.0, "J", "energy that the dampers took", nominal=0.01)
    force = output("N", "force on the second mass")
    position = output("m", "position")
    energy = output("J", "kinetic and elastic energy, and what the dampers took")

    def derivatives(s: Any) -> dict[str, Any]:
        rate = s.v - s.velocity
        force = s.k * s.e + s.d * rate
        return {
            "x": s.v,
            "v": (-s.k_wall * s.x - s.d_wall * s.v - force) / s.m,
            "e": rate,
            "q": s.d_wall * s.v**2 + s.d * rate**2,
        }

    def outputs(s: Any) -> dict[str, Any]:
        return {
            "force": s.k * s.e + s.d * (s.v - s.velocity),
            "position": s.x,
            "energy": (s.m * s.v**2 + s.k_wall * s.x**2 + s.k * s.e**2) / 2 + s.q,
        }


class RightMass(Component):
    """m2 v2' = F - k2 x2."""

    m = parameter(2.0, "kg", "second mass")
    k_wall = parameter(2.0, "N/m", "stiffness to the wall")
    force = input("N", "force of the coupling spring")
    x = state(START[3], "m", "position", nominal=0.1)
    v = state(START[4], "m/s", "velocity", nominal=0.1)
    velocity = output("m/s", "velocity")
    position = output("m", "position")
    energy = output("J", "kinetic and elastic energy")

    def derivatives(s: Any) -> dict[str, Any]:
        return {"x": s.v, "v": (s.force - s.k_wall * s.x) / s.m}

    def outputs(s: Any) -> dict[str, Any]:
        return {"velocity": s.v, "position": s.x, "energy": (s.m * s.v**2 + s.k_wall * s.x**2) / 2}


def coupled(left: Instance, right: Instance, start: Sequence[float] = START, **how: Any) -> System:
    """Return the two parts as a system that starts at *start*; the rest is for ``System``."""
    places = ((left, "x"), (left, "v"), (left, "e"), (right, "x"), (right, "v"))
    for (instance, name), value in zip(places, start, strict=True):
        instance.set(name, value)
    return System({"left": left, "right": right}, CONNECTIONS, **how)


def solution(left: LeftMass, right: RightMass, t: float, start: Sequence[float] = START) -> np.ndarray:
    """Return (x1, v1, e, x2, v2) a time *t* (s) after *start*, by the exponential of the matrix of the whole."""
    p = {f"{side}_{n}": float(v) for side, part in (("l", left), ("r", right)) for n, v in part.values.items()}
    force = np.array([0.0, p["l_d"], p["l_k"], 0.0, -p["l_d"]])
    matrix = np.zeros((5, 5))
    matrix[0, 1] = matrix[2, 1] = matrix[3, 4] = 1.0
    matrix[2, 4] = -1.0
    matrix[1] = (np.array([-p["l_k_wall"], -p["l_d_wall"], 0.0, 0.0, 0.0]) - force) / p["l_m"]
    matrix[4] = (np.array([0.0, 0.0, 0.0, -p["r_k_wall"], 0.0]) + force) / p["r_m"]
    return np.asarray(expm(matrix * t) @ np.array(start))
