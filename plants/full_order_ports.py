"""What the robot of full order shows to others: the ports of the rigid body and of the wheels, under the same names.

A controller of the analytical robot reads gaps, normal forces and the reduced model P, U, b_free.  Here they are those
of the rigid body in the pose of the body, on hubs that the chassis has bent: what such a controller would compute from
what it measures.  The rings, the rims and the modes are not in P, U and b_free: that is what the controller does not
know.
"""

from __future__ import annotations

from functools import lru_cache
from types import SimpleNamespace
from typing import Any

import casadi as ca

from cosim import Component, input, output

from .chassis_modal import ChassisModal
from .contact import COLUMNS
from .rigid_body import RigidBody, body_constants, motion, place
from .wheel_drive import WheelDrive

WHEELS = range(4)
NAMES = ("fl", "fr", "rl", "rr")


class FullOrderPorts(Component):
    """Inputs and outputs of `FullOrderRover`; forces are means over the communication step unless said otherwise."""

    torque = WheelDrive.torque
    steer = RigidBody.steer
    traction_demand = input("N", "traction asked of each wheel, forward positive", shape=4)
    force = RigidBody.force
    moment = RigidBody.moment
    hub_force = input("N", "external force on each hub, world axes", shape=(4, 3))

    position = output("m", "position of the body's centre of mass, world", shape=3)
    orientation = RigidBody.orientation
    velocity = output("m/s", "velocity of the body's centre of mass, world", shape=3)
    velocity_body = output("m/s", "the same in body axes", shape=3)
    rate = RigidBody.rate
    pitch = RigidBody.pitch
    acceleration = output("m/s2", "mean acceleration over the step, body axes", shape=3)
    angular_acceleration = output("rad/s2", "mean angular acceleration over the step, body axes", shape=3)
    wheel_spin = output("rad/s", "spin of each rim in the body", shape=4)
    steer_angle = output("rad", "steering angle that each wheel has, to the left positive", shape=4)
    slip = output("1", "slip ratio of each rim at the end of the step, as if it rolled on the radius R", shape=4)
    slip_angle = WheelDrive.slip_angle
    slip_speed = WheelDrive.slip_speed

    normal_force = output("N", "mean normal force of each wheel", shape=4)
    normal_force_end = output("N", "normal force of each wheel at the end of the step", shape=4)
    traction = output("N", "mean traction, forward positive: friction along the ground, and what is laid on", shape=4)
    lateral = output("N", "mean lateral force, to the left positive", shape=4)
    friction_limit = output(
        "N", "friction available: mu_s times the mean normal force; without limit 1e6 times", shape=4
    )
    sliding = output("1", "share of the normal impulse of each wheel that was carried by what slid", shape=4)
    axle_force = output("N", "mean force of each wheel on the body, body axes", shape=(4, 3))
    wheel_force = output("N", "the same along the body's z axis", shape=4)
    contact = output("1", "1 where a wheel presses the ground, else 0", shape=4)
    wheel_centre = output("m", "hubs, world", shape=(4, 3))

    gap = output("m", "distance of each hub from where a round wheel would touch, negative when pressed", shape=4)
    gap_rate = RigidBody.gap_rate
    deformation = output("m", "the gap again, as wheel plants call it", shape=4)
    deformation_rate = output("m/s", "its time derivative", shape=4)
    contact_velocity = output("m/s", "velocity of each hub along its heading, and to the left", shape=(4, 2))
    slope = RigidBody.slope
    curvature = RigidBody.curvature
    contact_normal = RigidBody.contact_normal
    traction_direction = RigidBody.traction_direction
    P = output("1/kg", "gap acceleration of each wheel per normal force of each, rigid body", shape=(4, 4))
    U = output("1/kg", "gap acceleration of each wheel per traction of each, rigid body", shape=(4, 4))
    b_free = output("m/s2", "gap acceleration without normal force and traction, rigid body", shape=4)

    ring_nodes = output("m", "nodes of the rings, world: x, y, z of each wheel's in turn", shape=("seen", 12))
    ring_normal = output("N", "normal force of the ground on each, world", shape=("seen", 12))
    ring_friction = output("N", "friction of the ground on each, world", shape=("seen", 12))

    station_acceleration = output("m/s2", "mean elastic acceleration at the stations, upwards", shape="stations")
    modal_displacement = ChassisModal.modal_displacement
    strain_energy = ChassisModal.strain_energy
    elastic_kinetic_energy = ChassisModal.elastic_kinetic_energy

    kinetic_energy = output("J", "kinetic energy of body, rims, rings and modes")
    potential_energy = output("J", "work against gravity since the start")
    elastic_energy = output("J", "energy stored in rings and modes")
    contact_energy = output("J", "energy stored in contacts and bristles")
    dissipated_energy = output("J", "energy lost in dampers and friction since the start")
    slip_energy = output("J", "the part of it that friction took")
    work = output("J", "work of motors, of what is laid on and of external forces since the start")
    momentum = output("N.s", "linear momentum, world", shape=3)
    angular_momentum = output("N.m.s", "angular momentum about the world's origin", shape=3)
    stable_step = output("s", "longest micro step that is stable for these parameters")


SENSED = ("gap", "gap_rate", "contact_velocity", "slope", "curvature", "contact_normal", "traction_direction",
          "P", "U", "b_free")  # fmt: skip
_GIVEN: dict[str, Any] = {
    "q": 4, "r": 3, "v": 3, "omega": 3, "m": 1, "inertia": 3, "L_f": 1, "L_r": 1, "half_track": 1, "h": 1, "R": 1,
    "g": 1, "force": 3, "moment": 3, "lateral": 4, "steer": 4,
}  # fmt: skip


@lru_cache(maxsize=1)
def sensed() -> ca.Function:
    """Return (values of _GIVEN, rows (4, 16), lift (4), lift_rate (4)) -> the outputs SENSED, from `rigid_body`."""
    s: dict[str, Any] = {name: ca.SX.sym(name, n) for name, n in _GIVEN.items()}
    rows, lift, lift_rate = ca.SX.sym("rows", 4, COLUMNS), ca.SX.sym("lift", 4), ca.SX.sym("lift_rate", 4)
    none = ca.SX.zeros(4)
    body = SimpleNamespace(**s, left=rows, right=rows, normal_force=none, traction=none, mu_r=0,
                           traction_arm="ground")  # fmt: skip
    vars(body).update(body_constants(body))
    where = place(body)
    near = where.feet()
    m = motion(body, where, near)
    at = m.contacts
    # a hub lifted by the chassis is further away by the part of the lift along the normal
    upright = [c.normal[2] for c in at]
    speed = [ca.dot(c.normal, v) for c, v in zip(at, m.wheel_velocities, strict=True)]
    found = {
        "gap": ca.vertcat(*(at[k].gap + upright[k] * lift[k] for k in WHEELS)),
        "gap_rate": ca.vertcat(*(speed[k] + upright[k] * lift_rate[k] for k in WHEELS)),
        "contact_velocity": ca.horzcat(
            ca.vertcat(*(ca.dot(at[k].along, m.wheel_velocities[k]) for k in WHEELS)), ca.vertcat(*m.sideslip)),
        "slope": ca.vertcat(*(c.slope for c in at)), "curvature": ca.vertcat(*(c.curvature for c in at)),
        "contact_normal": ca.horzcat(*(where.rotation @ c.normal for c in at)).T,
        "traction_direction": ca.horzcat(*(where.rotation @ c.along for c in at)).T,
        "P": m.P, "U": m.U, "b_free": m.b_free,
    }  # fmt: skip
    return ca.Function("sensed", [*s.values(), rows, lift, lift_rate], ca.cse([found[n] for n in SENSED]),
                       [*s, "rows", "lift", "lift_rate"], list(SENSED))  # fmt: skip


def seen(s: Any, omega: Any, lift: Any, lift_rate: Any, lateral: Any) -> dict[str, Any]:
    """Return the outputs SENSED of the robot, in MX."""
    given = {**{n: getattr(s, n) for n in _GIVEN if n not in ("omega", "lateral", "steer")}}
    given |= {"omega": omega, "lateral": lateral, "steer": s.steered}
    rows = path_rows(s)
    values = sensed().call([*(given[n] for n in _GIVEN), rows, lift, lift_rate])
    return dict(zip(SENSED, values, strict=True))


def path_rows(s: Any) -> Any:
    """Return the rows (4, 16) of the paths under the wheels: the left ones are on the left track."""
    return ca.vertcat(s.left[0, :], s.right[0, :], s.left[1, :], s.right[1, :])


def rows_of(s: Any, k: int) -> Any:
    """Return the ground (13, points) under the points of wheel *k*: left wheels roll on the left track."""
    table = (s.ground_left if k % 2 == 0 else s.ground_right).T
    first = s.points * (k // 2)
    return table[:, first : first + s.points]


def packed(s: Any, names: tuple[str, ...]) -> Any:
    """Return parameters as one column."""
    return ca.vertcat(*(getattr(s, name) for name in names))
