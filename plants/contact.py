"""Where a wheel meets the ground: closest point on the path of its centre, the normal, and the directions of force.

The ground is extruded along world y; a wheel's centre touches when it lies on the wheel-centre path of its track, which
`ground` tabulates.  Signed distance, not height, so that d(gap)/dt = n . v holds exactly and contact forces have a
potential.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca

ITERATIONS = 3  # of Newton, and one more in `foot`: from |x - X| = 1e-2 m to rounding
REACH = 0.5  # m, how far along the road a closest point is sought; beyond, the wheel is far above the ground
COLUMNS = 16  # x_start | xa, a0..a5 | xb, b0..b5 | parity: faces A and B, left and right of the nearest kink


@dataclass(frozen=True)
class Foot:
    """The closest point of one face of the path: all in world axes."""

    distance: Any  # m, negative when pressed into the ground
    slope: Any  # dZ/dx of the path there
    bend: Any  # d2Z/dx2


def faces(row: Any) -> tuple[tuple[Any, list[Any]], tuple[Any, list[Any]]]:
    """Return origin and coefficients of the two faces in a row of the path table: A left and B right of the kink."""
    return (row[1], [row[i] for i in range(2, 8)]), (row[8], [row[i] for i in range(9, 15)])


def _newton(face: tuple[Any, list[Any]], X: Any, Z: Any, x: Any) -> Any:
    """One step towards the closest point of a face to (X, Z): the root of (x - X) + (Z(x) - Z) Z'(x)."""
    z, first, second = _evaluate(face, x)
    slope = ca.fmax(0.3, 1 + first**2 + (z - Z) * second)  # positive near the path; a floor far above a hump
    return ca.fmax(X - REACH, ca.fmin(X + REACH, x - (x - X + (z - Z) * first) / slope))


def _evaluate(face: tuple[Any, list[Any]], x: Any) -> tuple[Any, Any, Any]:
    """Return Z, Z' and Z'' of a face, by Horner."""
    origin, a = face
    u, z, first, second = x - origin, 0, 0, 0
    for c in reversed(a):
        second, first, z = second * u + 2 * first, first * u + z, z * u + c
    return z, first, second


def seek(face: tuple[Any, list[Any]], X: Any, Z: Any) -> Any:
    """Return where along the road, in m, the closest point of a face to (X, Z) lies, but for the last Newton step."""
    x = X
    for _ in range(ITERATIONS):
        x = _newton(face, X, Z, x)
    return x


def foot(face: tuple[Any, list[Any]], X: Any, Z: Any, near: Any) -> Foot:
    """Return the closest point of a face to (X, Z), given where `seek` found it.

    The Newton step done here makes every derivative right even where *near* is held constant: so jerks need no
    derivative of the search.
    """
    x = _newton(face, X, Z, near)
    z, first, second = _evaluate(face, x)
    distance = (Z - z - (X - x) * first) / ca.sqrt(1 + first**2)
    # High above a tight hollow the search can end beside the closest point, with the wrong sign: a false contact.
    below, lean, _ = _evaluate(face, X)
    upright = (Z - below) / ca.sqrt(1 + lean**2)
    return Foot(ca.if_else(upright * distance < 0, upright, distance), first, second)


@dataclass(frozen=True)
class Contact:
    """One wheel's contact: distances in m, directions in body axes."""

    gap: Any
    switch: Any  # changes sign where the touching face changes
    slope: Any  # rad, absolute, positive when climbing towards +x
    curvature: Any  # 1/m, of the wheel-centre path, concave up positive
    normal: Any  # (3,) outward
    tangent: Any  # (3,) in the plane of the profile, uphill
    along: Any  # (3,) direction of traction: the wheel's heading on the tangent plane
    left: Any  # (3,) normal x along


def contact(row: Any, near: Any, rotation: Any, centre: Any, steer: Any) -> Contact:
    """Return the contact of a wheel whose centre is at *centre* (world, m), from its *row* of the path table.

    *near* (2,) is what `seek` found for the two faces; *rotation* turns body vectors into the world; *steer* is the
    wheel's angle to the body's x axis, left positive, rad.
    """
    X, Z = centre[0], centre[2]
    a, b = (foot(face, X, Z, near[i]) for i, face in enumerate(faces(row)))
    on_a = a.distance <= b.distance
    first, second = ca.if_else(on_a, a.slope, b.slope), ca.if_else(on_a, a.bend, b.bend)
    c = 1 / ca.sqrt(1 + first**2)
    normal = rotation.T @ ca.vertcat(-first * c, 0, c)
    heading = ca.vertcat(ca.cos(steer), ca.sin(steer), 0)
    flat = heading - ca.dot(heading, normal) * normal
    along = flat * (1 / ca.sqrt(ca.dot(flat, flat)))
    return Contact(
        gap=ca.if_else(on_a, a.distance, b.distance),
        switch=row[15] * (a.distance - b.distance),
        slope=ca.atan(first),
        curvature=second * c**3,
        normal=normal,
        tangent=rotation.T @ ca.vertcat(c, 0, first * c),
        along=along,
        left=ca.cross(normal, along),
    )


def rotation_matrix(q: Any) -> Any:
    """Return the rotation (3, 3) of a quaternion (w, x, y, z), body to world; its length does not matter."""
    w, v = q[0], ca.skew(q[1:4])
    return ca.SX.eye(3) + 2 / ca.dot(q, q) * (w * v + v @ v)


def quaternion_rate(q: Any, omega: Any) -> Any:
    """Return dq/dt for the angular velocity *omega* in body axes, rad/s."""
    w, v = q[0], q[1:4]
    return ca.vertcat(-ca.dot(v, omega), w * omega + ca.cross(v, omega)) / 2
