"""The rigid body on four contacts (thesis chapter 4 in 3-D), and the reduced model of itself for the wheels.

With n_k, A_k, l_k the normal, traction and left directions at wheel k, N_k = n_k - mu_r sign(v_k) A_k, and the arms c_k
(wheel centre) and r_k = c_k - R n_k (contact; the thesis' text uses c_k: ``traction_arm = "centre"``):

    a_c   = (sum A_k F_ak + N_k F_nk + l_k F_lk + F_ext) / m + g_B                                        (4.1, 4.19)
    alpha = I^-1 (sum r_k x (A_k F_ak + N_k F_nk + l_k F_lk) + M_ext - omega x I omega)                   (4.2, 4.20)
    gap'' = n_k . (a_c + alpha x c_k + omega x (omega x c_k)) - kappa v_t^2 / (1 - kappa gap)
          = P F_n + U F_a + b_free                                                                        (4.28, 4.29)

The gyroscopic term and the curvature term are missing in print; kappa is the curvature of the wheel-centre path.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca

from cosim import Component, event, input, output, parameter, state, structural, table

from .contact import COLUMNS, Contact, contact, faces, quaternion_rate, rotation_matrix, seek

WHEELS = range(4)
LEVEL = [[-1e9, *2 * (0, 0.1, 0, 0, 0, 0, 0), 0]]  # a path 0.1 m above world z = 0, without kinks
_CREEP = 0.01  # m/s, below which rolling resistance fades
_DRIFT = 1e-12  # of the square of the quaternion's length, which turns nothing, before it is set right


class RigidBody(Component):
    """Rigid body with four wheel contacts; forces in, motion, gaps and the reduced interface model out.

    World: x along the road, z up.  Body axes at the centre of mass: x forward, y left, z up; omega_y > 0 is nose-down,
    the output ``pitch`` is nose-up.  Wheels front-left, front-right, rear-left, rear-right.  A wheel whose centre lies
    at world y > 0 rolls on the left track.
    """

    traction_arm = structural("ground", "where traction and rolling resistance act", choices=("ground", "centre"))

    m = parameter(170.0, "kg", "mass")
    inertia = parameter([20.0, 47.0, 55.0], "kg.m2", "principal moments of inertia: roll, pitch, yaw")
    L_f = parameter(0.6, "m", "centre of mass to front axle")
    L_r = parameter(0.46, "m", "centre of mass to rear axle")
    half_track = parameter(0.29, "m", "centre plane to a wheel")
    h = parameter(0.4, "m", "centre of mass above the wheel centres")
    R = parameter(0.1, "m", "wheel radius")
    mu_r = parameter(0.0, "1", "coefficient of rolling resistance")
    g = parameter(9.81, "m/s2", "gravity, along -z of the world")
    left = table(COLUMNS, "path of the wheel centre on the left track", start=LEVEL)
    right = table(COLUMNS, "path of the wheel centre on the right track", start=LEVEL)

    normal_force = input("N", "normal force at each wheel, pushing the body", shape=4)
    traction = input("N", "traction at each wheel, forward positive", shape=4)
    lateral = input("N", "lateral force at each wheel, to the left positive", shape=4)
    steer = input("rad", "steering angle of each wheel, to the left positive", shape=4)
    force = input("N", "external force at the centre of mass, world axes", shape=3)
    moment = input("N.m", "external moment, body axes", shape=3)

    r = state([0.0, 0.0, 0.5], "m", "position of the centre of mass, world")
    q = state([1.0, 0.0, 0.0, 0.0], "1", "attitude quaternion (w, x, y, z), body to world")
    v = state([0.0, 0.0, 0.0], "m/s", "velocity of the centre of mass, world")
    omega = state([0.0, 0.0, 0.0], "rad/s", "angular velocity, body axes")
    received = state([0.0] * 4, "N.s", "normal impulse since the step began", nominal=1e-2)
    elapsed = state(0.0, "s", "time since the step began")

    face = event("a wheel changes from one face of a concave kink to the other", shape=4, announce=True)

    position = output("m", "position of the centre of mass, world", shape=3)
    orientation = output("1", "attitude quaternion (w, x, y, z), body to world", shape=4)
    velocity = output("m/s", "velocity of the centre of mass, world", shape=3)
    velocity_body = output("m/s", "velocity of the centre of mass, body axes", shape=3)
    rate = output("rad/s", "angular velocity, body axes", shape=3)
    pitch = output("rad", "pitch angle, nose-up positive")
    acceleration = output("m/s2", "acceleration of the centre of mass, body axes", shape=3)
    angular_acceleration = output("rad/s2", "angular acceleration, body axes", shape=3)
    jerk_body = output("m/s3", "rate of the body components of the acceleration, forces frozen", shape=3)
    jerk_inertial = output("m/s3", "rate of the acceleration vector, in body axes, forces frozen", shape=3)
    jerk_thesis = output("m/s3", "second rate of the body's vertical velocity (Eq 4.54), forces frozen")
    slope = output("rad", "slope of the ground under each wheel, absolute, climbing positive", shape=4)
    curvature = output("1/m", "curvature of each wheel-centre path, concave up positive", shape=4)
    gap = output("m", "signed distance of each wheel from the ground, negative when pressed", shape=4)
    gap_rate = output("m/s", "its time derivative", shape=4)
    contact_velocity = output(
        "m/s",
        "velocity of each wheel: of its centre along the wheel, and sideslip at the ground to the left",
        shape=(4, 2),
    )
    P = output("1/kg", "gap acceleration of each wheel per normal force of each wheel", shape=(4, 4))
    U = output("1/kg", "gap acceleration of each wheel per traction of each wheel", shape=(4, 4))
    V = output("1/kg", "gap acceleration of each wheel per lateral force of each wheel", shape=(4, 4))
    sideslip_mobility = output("1/kg", "most acceleration of a wheel to its left by lateral forces of 1 N", shape=4)
    b_free = output("m/s2", "gap acceleration without normal force and traction", shape=4)
    normal_impulse = output("N.s", "normal impulse received over the last step", shape=4)
    wheel_force = output("N", "force of each wheel on the body along the body's z axis", shape=4)
    axle_force = output("N", "force of each wheel on the body, body axes", shape=(4, 3))
    wheel_centre = output("m", "wheel centres, world", shape=(4, 3))
    contact_normal = output("1", "outward normals at the contacts, world", shape=(4, 3))
    traction_direction = output("1", "directions of traction, world", shape=(4, 3))
    kinetic_energy = output("J", "kinetic energy")
    potential_energy = output("J", "potential energy above world z = 0")

    def constants(s: Any) -> dict[str, Any]:
        return body_constants(s)

    def lookups(s: Any) -> dict[str, Any]:
        keys = wheel_centres(s, rotation_matrix(s.q))[:, 0]
        return {"left": keys, "right": keys}

    def sync(s: Any) -> dict[str, Any]:
        size = ca.dot(s.q, s.q)
        q = ca.if_else(ca.fabs(size - 1) > _DRIFT, s.q / ca.sqrt(size), s.q)
        return {"q": q, "received": ca.SX.zeros(4), "elapsed": 0}

    def derivatives(s: Any) -> dict[str, Any]:
        where = place(s)
        return _flow(s, motion(s, where, where.feet()))

    def crossings(s: Any) -> dict[str, Any]:
        where = place(s)
        return {"face": ca.vertcat(*(c.switch for c in contacts(s, where, where.feet())))}

    def outputs(s: Any) -> dict[str, Any]:
        where = place(s)
        near = ca.SX.sym("near", 4, 2)  # held constant while the acceleration is differentiated, see `contact.foot`
        m = motion(s, where, near)
        flow = _flow(s, m)
        v_body = m.where.rotation.T @ s.v
        rising = m.acceleration[2] - ca.cross(s.omega, v_body)[2]  # d(v_z)/dt of the body component
        names = ("r", "q", "v", "omega")
        jerks = ca.jtimes(ca.vertcat(m.acceleration, rising), ca.vertcat(*(getattr(s, n) for n in names)),
                          ca.vertcat(*(flow[n] for n in names)))  # fmt: skip
        found = {
            **_motion_outputs(s, m, v_body),
            **_contact_outputs(m),
            "jerk_body": jerks[:3],
            "jerk_inertial": jerks[:3] + ca.cross(s.omega, m.acceleration),
            "jerk_thesis": jerks[3],
        }
        return dict(zip(found, ca.substitute(list(found.values()), [near], [where.feet()]), strict=True))


def _motion_outputs(s: Any, m: Motion, v_body: Any) -> dict[str, Any]:
    return {
        "position": s.r, "orientation": s.q, "velocity": s.v, "velocity_body": v_body, "rate": s.omega,
        "pitch": ca.asin(ca.fmax(-1, ca.fmin(1, m.where.rotation[2, 0]))),
        "acceleration": m.acceleration, "angular_acceleration": m.alpha,
        "normal_impulse": s.received,
        "kinetic_energy": (s.m * ca.dot(s.v, s.v) + ca.dot(s.omega, s.inertia * s.omega)) / 2,
        "potential_energy": s.m * s.g * s.r[2],
    }  # fmt: skip


def _contact_outputs(m: Motion) -> dict[str, Any]:
    both = list(zip(m.contacts, m.wheel_velocities, strict=True))
    return {
        "slope": ca.vertcat(*(c.slope for c in m.contacts)),
        "curvature": ca.vertcat(*(c.curvature for c in m.contacts)),
        "gap": ca.vertcat(*(c.gap for c in m.contacts)),
        "gap_rate": ca.vertcat(*(ca.dot(c.normal, v) for c, v in both)),
        "contact_velocity": ca.horzcat(ca.vertcat(*(ca.dot(c.along, v) for c, v in both)), ca.vertcat(*m.sideslip)),
        "P": m.P, "U": m.U, "V": m.V, "sideslip_mobility": m.mobility, "b_free": m.b_free,
        "wheel_force": ca.vertcat(*(f[2] for f in m.forces)),
        "axle_force": ca.horzcat(*m.forces).T,
        "wheel_centre": m.where.centres,
        "contact_normal": ca.horzcat(*(m.where.rotation @ c.normal for c in m.contacts)).T,
        "traction_direction": ca.horzcat(*(m.where.rotation @ c.along for c in m.contacts)).T,
    }  # fmt: skip


def _flow(s: Any, m: Motion) -> dict[str, Any]:
    return {
        "r": s.v, "q": quaternion_rate(s.q, s.omega), "v": m.where.rotation @ m.acceleration, "omega": m.alpha,
        "received": s.normal_force, "elapsed": 1,
    }  # fmt: skip


@dataclass(frozen=True)
class Motion:
    """What the equations of motion give in one state, body axes unless said otherwise."""

    where: Place
    contacts: list[Contact]
    wheel_velocities: list[Any]  # of the centres
    sideslip: list[Any]  # velocity to the left where the lateral force acts: what it works on
    forces: list[Any]  # contact force of each wheel
    acceleration: Any
    alpha: Any
    P: Any
    U: Any
    V: Any
    mobility: Any
    b_free: Any


def wheel_arms(s: Any) -> Any:
    """Return the wheel centres c_k in body axes, (3, 4)."""
    return ca.horzcat(*(ca.vertcat(x, y, -s.h) for x in (s.L_f, -s.L_r) for y in (s.half_track, -s.half_track)))


def body_constants(s: Any) -> dict[str, Any]:
    """Return what `motion` needs of the parameters: `wheel_arms`, reciprocals of mass and moments of inertia."""
    return {"arms": wheel_arms(s), "per_mass": 1 / s.m, "per_inertia": 1 / s.inertia}


def wheel_centres(s: Any, rotation: Any) -> Any:
    """Return the wheel centres in the world, (4, 3)."""
    return ca.horzcat(*(s.r + rotation @ s.arms[:, k] for k in WHEELS)).T


@dataclass(frozen=True)
class Place:
    """Where the body is, and the ground under its wheels."""

    rotation: Any  # body to world
    centres: Any  # (4, 3) wheel centres, world
    rows: list[Any]  # of the path table of the track that each wheel is on

    def feet(self) -> Any:
        """Return where along the road the closest points of both faces to each wheel lie, (4, 2), m."""
        found = [[seek(face, self.centres[k, 0], self.centres[k, 2]) for face in faces(self.rows[k])] for k in WHEELS]
        return ca.vertcat(*(ca.horzcat(*pair) for pair in found))


def place(s: Any) -> Place:
    """Evaluate the pose, and choose the track under each wheel."""
    rotation = rotation_matrix(s.q)
    centres = wheel_centres(s, rotation)
    rows = [ca.if_else(centres[k, 1] > 0, s.left[k, :], s.right[k, :]) for k in WHEELS]
    return Place(rotation, centres, rows)


def contacts(s: Any, where: Place, near: Any) -> list[Contact]:
    """Return the four contacts, given the closest points *near* (4, 2) that `Place.feet` found."""
    return [contact(where.rows[k], near[k, :], where.rotation, where.centres[k, :].T, s.steer[k]) for k in WHEELS]


def motion(s: Any, where: Place, near: Any) -> Motion:
    """Evaluate contacts, reduced interface model and accelerations; *near* as for `contacts`."""
    rotation, arms = where.rotation, [s.arms[:, k] for k in WHEELS]
    at = contacts(s, where, near)
    v_body = rotation.T @ s.v
    velocities = [v_body + ca.cross(s.omega, c) for c in arms]
    r = [c - s.R * at[k].normal if s.traction_arm == "ground" else c for k, c in enumerate(arms)]
    along = [ca.dot(at[k].along, velocities[k]) for k in WHEELS]
    N = [at[k].normal - s.mu_r * ca.tanh(along[k] / _CREEP) * at[k].along for k in WHEELS]

    lateral = [at[j].left * s.lateral[j] for j in WHEELS]
    forces = [N[j] * s.normal_force[j] + at[j].along * s.traction[j] + lateral[j] for j in WHEELS]
    outer_force = rotation.T @ (s.force - ca.vertcat(0, 0, s.m * s.g))
    outer_moment = s.moment - ca.cross(s.omega, s.inertia * s.omega)

    def accelerations(pushes: list[Any]) -> tuple[Any, Any]:
        """Those of the body under outer forces and one force at each wheel."""
        moment = outer_moment + sum(ca.cross(r[j], pushes[j]) for j in WHEELS)
        return (outer_force + sum(pushes)) * s.per_mass, moment * s.per_inertia

    def per_newton(directions: list[Any]) -> list[tuple[Any, Any]]:
        """Those of the body under 1 N at one wheel."""
        return [(directions[j] * s.per_mass, ca.cross(r[j], directions[j]) * s.per_inertia) for j in WHEELS]

    per_normal, per_traction = per_newton(N), per_newton([c.along for c in at])
    per_lateral = per_newton([c.left for c in at])
    acceleration, alpha = accelerations(forces)

    def seen(k: int, a: Any, alpha: Any) -> Any:
        """The normal acceleration of wheel centre k for a body acceleration *a* and *alpha*."""
        return ca.dot(at[k].normal, a + ca.cross(alpha, arms[k]))

    def aside(k: int, a: Any, alpha: Any) -> Any:
        """The acceleration to the left of where wheel k slips."""
        return ca.dot(at[k].left, a + ca.cross(alpha, r[k]))

    def bent(k: int) -> Any:
        """What the turning of the body and of the normal add to it."""
        turning = ca.dot(at[k].normal, ca.cross(s.omega, ca.cross(s.omega, arms[k])))
        tightness = ca.fmax(0.05, 1 - at[k].curvature * at[k].gap)  # 0 at the centre of curvature, far from contact
        return turning - at[k].curvature * ca.dot(at[k].tangent, velocities[k]) ** 2 / tightness

    P = ca.vertcat(*(ca.horzcat(*(seen(k, *per_normal[j]) for j in WHEELS)) for k in WHEELS))
    U = ca.vertcat(*(ca.horzcat(*(seen(k, *per_traction[j]) for j in WHEELS)) for k in WHEELS))
    V = ca.vertcat(*(ca.horzcat(*(seen(k, *per_lateral[j]) for j in WHEELS)) for k in WHEELS))
    mobility = ca.vertcat(*(sum(ca.fabs(aside(k, *per_lateral[j])) for j in WHEELS) for k in WHEELS))
    free = accelerations(lateral)
    b_free = ca.vertcat(*(seen(k, *free) + bent(k) for k in WHEELS))
    return Motion(
        where, at, velocities, [ca.dot(at[k].left, v_body + ca.cross(s.omega, r[k])) for k in WHEELS],
        forces=forces, acceleration=acceleration, alpha=alpha,
        P=P, U=U, V=V, mobility=mobility, b_free=b_free,
    )  # fmt: skip
