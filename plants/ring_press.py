"""The press test of a wheel: how a ring stands on level ground, what that says of its stiffness, and calibration.

A hub that has come down by *depth* holds a frictionless ring at rest: the nodes lie where the energy of ring and
contact is least.  All stiffnesses are proportional to one scale s, so

    F(depth; s) = s F(depth; 1)

and one test, at the depth that the wanted stiffness has under the wanted load, gives the scale of a wheel: the static
radial stiffness is the secant, load over depth.  A ring's force-deflection curve is progressive: few nodes touch at
first, and the bent ring spreads the load (Gong, "A study of in-plane dynamics of tires", Delft 1993, ch. 3; Pacejka,
"Tire and vehicle dynamics", ch. 9).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np

from cosim.errors import DeclarationError

from .ring import CONTACT, FRAME, MATERIAL, UNLIMITED, around, between
from .ring_contact import COLUMNS
from .ring_wheel import ring

STIFFNESSES = ("k_radial", "k_tangential", "EA", "EI", "k_contact", "k_bristle")
DAMPINGS = ("c_radial", "c_tangential")
_ITERATIONS = 60
_SPREAD = 0.04  # m, about the length of ring that carries a load: where the search for a depth begins
_RESIDUAL = 1e-9  # of the load


@dataclass(frozen=True)
class Press:
    """A wheel at rest on level ground: depth (m), force (N), nodes (n, 2) from the hub (m), length of contact (m)."""

    depth: float
    force: float
    nodes: np.ndarray
    patch: float

    @property
    def stiffness(self) -> float:
        """Static radial stiffness, the secant, N/m."""
        return self.force / self.depth


@lru_cache(maxsize=16)
def _problem(nodes: int, points: int) -> ca.Function:
    """Return (places (2 nodes), height, angle, material, contact) -> (energy, its two derivatives, load)."""
    at, height, angle = ca.MX.sym("at", 2 * nodes), ca.MX.sym("height"), ca.MX.sym("angle")
    material, contact = ca.MX.sym("material", len(MATERIAL)), ca.MX.sym("contact", len(CONTACT))
    plane = ca.reshape(at, 2, nodes)
    x = ca.vertcat(plane[0, :], ca.MX.zeros(1, nodes), plane[1, :] + height)
    frame = ca.vertcat(ca.vec(ca.MX.eye(3)), 0, 0, height, ca.MX.zeros(FRAME - 13), angle)
    still = ca.MX.zeros(3, nodes)
    stored: Any = ring(nodes, points).energies(
        x, still, ca.MX.zeros(2, points), ca.MX.zeros(COLUMNS, points), frame, material, contact
    )
    given = [at, height, angle, material, contact]
    flat: Any = [ca.SX.sym(symbol.name(), symbol.shape) for symbol in given]
    energy: Any = ca.Function("stored", given, [stored[0] + stored[1]]).expand()(*flat)  # in scalars: faster to derive
    second, first = ca.hessian(energy, flat[0])
    return ca.Function("press", flat, [energy, first, second, -ca.gradient(energy, flat[1])])


def press(values: Mapping[str, Any], nodes: int, points: int, depth: float, angle: float = 0.0) -> Press:
    """Press a ring of the parameters *values* of `FullOrderRover` on level ground by *depth* (m).

    *angle* (rad) is how far the wheel has turned.  Raises DeclarationError if the ring finds no place to rest.
    """
    problem, R = _problem(nodes, points), float(values["R"])
    material, contact = (np.array([float(values[n]) for n in names]) for names in (MATERIAL, CONTACT))
    at = _round(nodes, R, angle)
    # the shape that it starts from is pressed flat: no node is below the ground
    at[1::2] = np.maximum(at[1::2], depth - R)
    for _ in range(_ITERATIONS):
        energy, first, second, load = (v.full() for v in problem(at, R - depth, angle, material, contact))
        step = _downhill(first.ravel(), second)
        size = 1.0
        while size > 1e-4 and float(problem(at + size * step, R - depth, angle, material, contact)[0]) > energy.item():
            size /= 2
        at = at + size * step
        if np.max(np.abs(step)) < _RESIDUAL * R:
            break
    else:
        raise DeclarationError(f"a ring pressed by {depth:.3g} m finds no place to rest; press it less, or stiffen EI")
    plane = at.reshape(nodes, 2)
    pressed = sum(
        np.count_nonzero(_points(plane, points // nodes, m)[:, 1] < depth - R) for m in range(points // nodes)
    )
    return Press(depth, load.item(), plane, pressed * 2 * R * np.sin(np.pi / nodes) * nodes / points)


def _downhill(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Return Newton's step, but downhill also where the energy is not convex: a stiff ring that starts flat buckles."""
    curvature, directions = np.linalg.eigh(second)
    return np.asarray(-directions @ ((directions.T @ first) / np.abs(curvature)))


def stored(values: Mapping[str, Any], nodes: int, points: int, wheel: Press, angle: float = 0.0) -> float:
    """Return the energy (J) of the ring and the contact of a pressed wheel."""
    material, contact = (np.array([float(values[n]) for n in names]) for names in (MATERIAL, CONTACT))
    height = float(values["R"]) - wheel.depth
    return float(_problem(nodes, points)(wheel.nodes.ravel(), height, angle, material, contact)[0])


def _round(nodes: int, R: float, angle: float) -> np.ndarray:
    """Return the places (2 nodes,) of a round ring that has turned by *angle*."""
    cosine, sine = around(nodes)
    c, s = np.cos(angle), np.sin(angle)
    return (R * np.array([c * sine + s * cosine, c * cosine - s * sine])).T.ravel()


def _points(plane: np.ndarray, each: int, m: int) -> np.ndarray:
    """Return the *m*-th of the *each* points (n, 2) between every node and the next."""
    return np.asarray(sum(w * np.roll(plane, 1 - j, axis=0) for j, w in enumerate(between(len(plane), m / each))))


@lru_cache(maxsize=64)
def _mean(material: tuple[tuple[str, float], ...], nodes: int, points: int, depth: float, turns: int) -> float:
    angles = 2 * np.pi / nodes * (np.arange(turns) + 0.5) / turns
    return float(np.mean([press(dict(material), nodes, points, depth, angle).force for angle in angles]))


def mean_load(values: Mapping[str, Any], nodes: int, points: int, depth: float, turns: int = 4) -> float:
    """Return the load (N) at *depth* (m): the mean over *turns* angles from one node on the ground to the next."""
    return _mean(tuple((n, float(values[n])) for n in (*MATERIAL, *CONTACT)), nodes, points, depth, turns)


def depth_under(values: Mapping[str, Any], nodes: int, points: int, load: float) -> float:
    """Return the depth (m) at which `mean_load` is *load* (N), by secants on their logarithms."""
    depth, before = load / (_SPREAD * float(values["k_radial"])), (0.0, 0.0)
    slope = 1.2  # of the logarithms, for a ring
    for _ in range(_ITERATIONS):
        off = np.log(mean_load(values, nodes, points, depth) / load)
        if abs(off) < 1e-6:
            return depth
        if before[0]:
            slope = (off - before[1]) / np.log(depth / before[0])
        before = (depth, off)
        depth = float(depth * np.exp(-off / slope))
    raise DeclarationError(f"no depth of a ring carries {load:.4g} N; the last one tried was {depth:.3g} m")


def calibrated(values: Mapping[str, Any], nodes: int, points: int, k_w: float, load: float) -> dict[str, float]:
    """Return the STIFFNESSES scaled so that a wheel under *load* (N) has the static radial stiffness *k_w* (N/m)."""
    scale = load / mean_load(values, nodes, points, load / k_w)
    return {name: scale * float(values[name]) for name in STIFFNESSES}


def damping(values: Mapping[str, Any], nodes: int, points: int, depth: float) -> float:
    """Return the damping (N.s/m) of a wheel that is pressed slowly at *depth* (m): power lost over speed squared.

    Only the foundation is damped; what bends and stretches is not, so this is less than c/k of it times the stiffness.
    """
    step = 1e-3 * depth
    low, high = (press(values, nodes, points, depth + d).nodes for d in (-step, step))
    rate = (high - low) / (2 * step)
    cosine, sine = around(nodes)
    outward, along = rate[:, 0] * sine + rate[:, 1] * cosine, rate[:, 0] * cosine - rate[:, 1] * sine
    length = 2 * float(values["R"]) * np.sin(np.pi / nodes)
    return float(length * (values["c_radial"] * np.sum(outward**2) + values["c_tangential"] * np.sum(along**2)))


def damped(values: Mapping[str, Any], nodes: int, points: int, c_w: float, depth: float) -> dict[str, float]:
    """Return the DAMPINGS scaled so that a wheel pressed slowly at *depth* (m) has the damping *c_w* (N.s/m)."""
    scale = c_w / damping(values, nodes, points, depth)
    return {name: scale * float(values[name]) for name in DAMPINGS}


def resting(values: Mapping[str, Any], nodes: int, points: int, load: float, guess: float) -> Press:
    """Return the wheel that carries *load* (N), from a *guess* (m) of its depth: secants on the load per depth."""
    found, before = press(values, nodes, points, guess), (0.0, 0.0)
    for _ in range(_ITERATIONS):
        if abs(found.force - load) < 1e-9 * load:
            return found
        slope = (found.force - before[1]) / (found.depth - before[0])
        before = (found.depth, found.force)
        found = press(values, nodes, points, found.depth + (load - found.force) / slope)
    raise DeclarationError(f"no depth of a ring carries {load:.4g} N; the last one tried was {found.depth:.3g} m")


def pressed(rover: Any) -> dict[str, np.ndarray]:
    """Return ``k_w`` (N/m), ``c_w`` (N.s/m), of each wheel, and ``mu`` of a `FullOrderRover`: what a press test finds.

    In the shapes that `WheelDeformation` gives them, under a quarter of the robot's weight; ``mu`` limits nothing where
    traction is laid on.
    """
    values, size = rover.values, (rover.nodes, rover.points)
    load = rover.m * rover.g / 4
    depth = depth_under(values, *size, load)
    mu = rover.mu_s if rover.laid_on < 1 else UNLIMITED
    c_w = damping(values, *size, depth)
    return {"k_w": np.full(4, load / depth), "c_w": np.full(4, c_w), "mu": np.asarray(mu, float)}
