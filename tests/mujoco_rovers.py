"""The robot in MuJoCo, somebody else's equations and solver: rigid wheels, or wheels on springs, on planes and boxes.

Its contacts are soft: one that closes at v is slowed down like x'' + 2/T x' + x/(T z)^2 = 0, with the time constant
T and the damping ratio z of ``solref``, and lets go where the force would pull.  With z = 1 that gives back e^-2 of v,
with z = 10 less than v/400: a plastic impact.  Wheels are spheres, whose contact with the edge of a box has the exact
normal; in the plane they are the same as discs.  (A cylinder on an edge gets the normal of the box's face, which stops
the robot.)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from plants.tables import robot

ROBOT = robot("thesis_6_1")
PLANE = '<geom type="plane" size="0 0 1"/>'
J_RIM, RING = 0.01, 0.83  # kg.m2, kg: as FullOrderRover has them
AT = [(ROBOT.L_f, ROBOT.half_track), (ROBOT.L_f, -ROBOT.half_track), (-ROBOT.L_r, ROBOT.half_track),
      (-ROBOT.L_r, -ROBOT.half_track)]  # fmt: skip


def ramp(start: float, angle: float) -> str:
    """Return level ground and a slope: two half-spaces."""
    return PLANE + f'<geom type="plane" size="0 0 1" pos="{start} 0 0" euler="0 {-np.degrees(angle)} 0"/>'


def step(start: float, height: float) -> str:
    """Return level ground with a box on it."""
    return PLANE + f'<geom type="box" size="1 1 {height}" pos="{start + 1} 0 0"/>'


@dataclass
class Rover:
    """A model made of *ground*, wheels of the given XML (one per axle end), and contacts of time constant *T* (s)."""

    ground: str
    wheel: str
    friction: float | None  # None: frictionless
    T: float
    ratio: float

    def __post_init__(self) -> None:
        contact = 'condim="1"' if self.friction is None else f'condim="3" friction="{self.friction} 0 0"'
        wheels = "".join(f'<body pos="{x} {y} {-ROBOT.h}">{self.wheel}</body>' for x, y in AT)
        self.model = mujoco.MjModel.from_xml_string(f"""<mujoco>
            <option timestep="{self.T / 4}" cone="elliptic" tolerance="1e-14" iterations="300"/>
            <default><geom {contact} solref="{self.T} {self.ratio}" solimp="0.9999 0.9999 0.001 0.5 2"/></default>
            <worldbody>{self.ground}<body pos="0 0 {ROBOT.h + ROBOT.R}"><freejoint/>
            <inertial pos="0 0 0" mass="{ROBOT.m}" diaginertia="{ROBOT.I_x} {ROBOT.I_y} {ROBOT.I_z}"/>{wheels}</body>
            </worldbody></mujoco>""")
        self.data = mujoco.MjData(self.model)

    def run(self, duration: float, law: Any = None) -> np.ndarray:
        """Return rows of time, x, z, pitch and normal force of the front axle; *law* sets forces before each step."""
        rows = [self._row()]
        for _ in range(round(duration / self.model.opt.timestep)):
            if law is not None:
                law(self.data)
            mujoco.mj_step(self.model, self.data)
            rows.append(self._row())
        return np.array(rows)

    def _row(self) -> list[float]:
        rotation, q = np.zeros(9), self.data.qpos
        mujoco.mju_quat2Mat(rotation, q[3:7])
        return [self.data.time, q[0], q[2], float(np.arcsin(rotation[6])), self._front()]

    def _front(self) -> float:
        total, force = 0.0, np.zeros(6)
        for i in range(self.data.ncon):
            geoms = [self.data.contact[i].geom1, self.data.contact[i].geom2]
            body = max(self.model.geom_bodyid[g] for g in geoms)
            if body < 2 + (self.model.nbody - 2) // 2:
                mujoco.mj_contactForce(self.model, self.data, i, force)
                total += force[0]
        return total


def rigid(ground: str, T: float) -> Rover:
    """Return the robot on rigid, massless, frictionless wheels."""
    return Rover(ground, f'<geom type="sphere" size="{ROBOT.R}" mass="1e-9"/>', None, T, 10.0)


def rolling(ground: str, T: float, *, sprung: bool, friction: float = 0.8) -> Rover:
    """Return the robot on wheels that turn, *sprung* on hubs that move along x and z of the body.

    A wheel has the mass of a ring and the inertia of rim and ring about its axle, half of that about the others.
    """
    about = J_RIM + RING * ROBOT.R**2
    wheel = f"""<joint type="hinge" axis="0 1 0"/><geom type="sphere" size="{ROBOT.R}"/>
        <inertial pos="0 0 0" mass="{RING}" diaginertia="{0.5001 * about} {about} {0.5001 * about}"/>"""
    if sprung:
        wheel = f"""<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/>
            <inertial pos="0 0 0" mass="1e-6" diaginertia="1e-9 1e-9 1e-9"/><body>{wheel}</body>"""
    return Rover(ground, wheel, friction, T, 1.0 if sprung else 10.0)
