"""How the robot of full order moves when a run starts: on round wheels without load, or settled on pressed ones."""

from __future__ import annotations

import numpy as np

from .full_order import FullOrderRover
from .full_order_ports import NAMES
from .ring_press import Press, resting
from .rover import quaternion

_FIRST = 0.02  # of the radius: where the search for a wheel's depth begins


def rolling(rover: FullOrderRover, x: float, height: float, speed: float) -> dict[str, np.ndarray]:
    """Return the start values of a robot that rolls level on undeformed wheels, its body at *height* (m)."""
    hubs = _hubs(rover, x, np.full(2, height - rover.h))
    angle = 2 * np.pi * np.arange(rover.nodes) / rover.nodes
    circle = rover.R * np.column_stack([np.sin(angle), np.cos(angle)])
    return _moving(rover, np.array([x, 0, height]), 0.0, speed, hubs, [circle, circle])


def settled(rover: FullOrderRover, x: float, ground: float, speed: float) -> dict[str, np.ndarray]:
    """Return the start values of a robot that rolls on level ground at height *ground* (m), its wheels pressed.

    The rings lie as without friction, and their nodes move along them.
    """
    wheelbase, ring_weight = rover.L_f + rover.L_r, rover.ring_mass * rover.g
    loads = rover.m * rover.g / 2 * np.array([rover.L_r, rover.L_f]) / wheelbase + ring_weight
    found: list[Press] = []
    for load in loads:
        guess = found[0].depth if found else _FIRST * rover.R
        found.append(resting(rover.values, rover.nodes, rover.points, float(load), guess))
    passed_on = np.repeat(loads - ring_weight, 2)
    bend = rover.values["wheel_shape"].T @ passed_on / (2 * np.pi * rover.values["frequency"]) ** 2
    lift = rover.values["wheel_shape"] @ bend
    heights = ground + rover.R - np.array([p.depth for p in found])
    plane = heights - lift.reshape(2, 2).mean(axis=1)
    pitch = float(np.arcsin((plane[0] - plane[1]) / wheelbase))
    along = x + np.array([rover.L_f, -rover.L_r]) * np.cos(pitch)
    middle = plane[0] - rover.L_f * np.sin(pitch) + rover.h * np.cos(pitch)
    hubs = _hubs(rover, x, heights)
    hubs[:, 0] = np.repeat(along, 2) + rover.h * np.sin(pitch)
    body = np.array([x, 0.0, middle])
    starts = _moving(rover, body, pitch, speed, hubs, [p.nodes for p in found])
    return starts | {"modal_q": bend, "pressing": np.repeat(loads, 2)}


def _hubs(rover: FullOrderRover, x: float, heights: np.ndarray) -> np.ndarray:
    """Return the hubs (4, 3) of a level robot whose axles (front, rear) are at *heights* (2,)."""
    y = rover.half_track * np.array([1, -1, 1, -1])
    return np.column_stack([x + np.repeat([rover.L_f, -rover.L_r], 2), y, np.repeat(heights, 2)])


def _moving(rover: FullOrderRover, body: np.ndarray, pitch: float, speed: float, hubs: np.ndarray,
            shapes: list[np.ndarray]) -> dict[str, np.ndarray]:  # fmt: skip
    """Return start values: the nodes of the *shapes* (n, 2) of front and rear axle move round them as the rims turn."""
    spin, n = speed / rover.R, rover.nodes
    starts = {"r": body, "q": quaternion(pitch, 0.0), "v": np.array([speed, 0, 0]), "spin": np.full(4, spin),
              "H": np.array([0, 4 * rover.J_w * spin, 0])}  # fmt: skip
    for k, name in enumerate(NAMES):
        shape = shapes[k // 2]
        tangent = (np.roll(shape, -1, axis=0) - np.roll(shape, 1, axis=0)) / (2 * np.sin(2 * np.pi / n))
        starts[f"x_{name}"] = hubs[k] + np.column_stack([shape[:, 0], np.zeros(n), shape[:, 1]])
        starts[f"v_{name}"] = np.array([speed, 0, 0]) + spin * np.column_stack(
            [tangent[:, 0], np.zeros(n), tangent[:, 1]]
        )
    return starts


__all__ = ["rolling", "settled"]
