"""The robot on round wheels without mass that may press both faces of a ramp at once: what a stiff, light ring becomes.

A ring that does not bend is a circle of radius R on a spring K, the same in all directions, that sinks by d_i into the
faces i of the ground.  Without mass and friction its centre u lies where the energy is least,

    K |u - c|^2 / 2 + sum 2/5 C d_i^(5/2),   d_i = max(0, R - n_i . (u - x_i)),   C = 4/3 k_c sqrt(2 R)

c is the hub; a face pushes with C d_i^(3/2), the sum of a penalty k_c d per length over the part of the circle below
it.  K and C in series carry a load progressively; as k_c grows, all that is left is K, and u is the point of the
path of the centre that is closest to the hub: `WheelDeformation`, but for the corner of that path.  Planar and
without co-simulation: an independent reference.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, root

from plants.tables import G, Robot

_NEWTON = 60
_CLOSE = 1e-13  # m


@dataclass(frozen=True)
class Springs:
    """Of one axle: K in N/m, C in N/m^(3/2)."""

    K: float
    C: float

    def depth(self, load: float) -> float:
        """Return the depth (m) of the hubs on level ground under *load* (N)."""
        return load / self.K + (load / self.C) ** (2 / 3)

    def scaled(self, k_w: float, load: float) -> Springs:
        """Return both scaled alike, so that *load* over depth is *k_w* (N/m)."""

        def off(log: float) -> float:
            return Springs(self.K * np.exp(log), self.C * np.exp(log)).depth(load) * k_w / load - 1

        scale = float(np.exp(brentq(off, -30, 30, xtol=1e-12)))
        return Springs(self.K * scale, self.C * scale)


@dataclass(frozen=True)
class Ramp:
    """Level ground at height 0, and from x = ``start`` (m) on a slope of ``angle`` (rad)."""

    start: float
    angle: float

    @property
    def faces(self) -> tuple[np.ndarray, np.ndarray]:
        """A point on both (2,), and the normals (2, 2), (x, z)."""
        return np.array([self.start, 0.0]), np.array([[0.0, 1.0], [-np.sin(self.angle), np.cos(self.angle)]])


def pushes(springs: Springs, ramp: Ramp, R: float, hub: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the force (2,) on a hub (2,) and the normal forces (2,) of the two faces, N."""
    corner, normals = ramp.faces
    u = hub.copy()
    for _ in range(_NEWTON):
        d = np.maximum(0, R - normals @ (u - corner))
        gradient = springs.K * (u - hub) - springs.C * d**1.5 @ normals
        second = springs.K * np.eye(2) + (1.5 * springs.C * np.sqrt(d) * normals.T) @ normals
        step = np.linalg.solve(second, gradient)
        u = u - step
        if np.max(np.abs(step)) < _CLOSE:
            break
    F = springs.C * np.maximum(0, R - normals @ (u - corner)) ** 1.5
    return F @ normals, F


@dataclass(frozen=True)
class Crossing:
    """Times (n,), mean normal force of the front axle (n,) since the time before, vertical speed (n,); s, N, m/s."""

    time: np.ndarray
    force: np.ndarray
    speed: np.ndarray
    both: float  # s, how long the front wheels pressed both faces, to the length of a step


def crossing(robot: Robot, springs: Springs, ramp: Ramp, speed: float, duration: float, step: float) -> Crossing:
    """Return how the robot, at rest on its springs but for its *speed* (m/s), meets the ramp."""
    arms = (robot.L_f, -robot.L_r)

    def accelerations(pose: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return (a_x, a_z, pitch acceleration) and the normal forces (2,) of the front axle."""
        c, s = np.cos(pose[2]), np.sin(pose[2])
        forces = []
        turning, total = 0.0, np.array([0.0, -G * robot.m])
        for L in arms:
            arm = np.array([L * c + robot.h * s, L * s - robot.h * c])
            push, normal = pushes(springs, ramp, robot.R, pose[:2] + arm)
            turning, total = turning + arm[0] * push[1] - arm[1] * push[0], total + push
            forces.append(normal)
        return np.array([*total / robot.m, turning / robot.I_y]), forces[0]

    def rate(_: float, y: np.ndarray) -> np.ndarray:
        a, F = accelerations(y[:3])
        return np.array([*y[3:6], *a, F.sum()])

    loads = robot.m * G * np.array([robot.L_r, robot.L_f]) / robot.L
    front, rear = (robot.R - springs.depth(float(load)) for load in loads)
    pitch = np.arcsin((front - rear) / robot.L)
    guess = np.array([front - robot.L_f * np.sin(pitch) + robot.h * np.cos(pitch), pitch])
    rest = root(lambda p: accelerations(np.array([0.0, *p]))[0][1:], guess).x
    time = step * np.arange(round(duration / step) + 1)
    start = [0.0, *rest, speed, 0.0, 0.0, 0.0]
    y = solve_ivp(rate, (0, time[-1]), start, t_eval=time, rtol=1e-8, atol=1e-10, max_step=5 * step).y
    both = sum(step for pose in y[:3].T if np.all(accelerations(pose)[1] > 0))
    return Crossing(time[1:], np.diff(y[6]) / step, y[4, 1:], both)
