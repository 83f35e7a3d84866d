"""Normal jerk of the robot seen from the side, as a law needs it: affine in the traction (thesis 4.5, corrected).

Level or pitched, both axles on the ground, traction and its share held while the acceleration is differentiated:

    J = J_0 + J_1 F                     F: traction of all driven wheels, N; J: component along the body's z axis

The acceleration a = a_0 + a_1 F has a_1 of the posture alone and a_0 quadratic in the speed; along the motion

    p' = -omega,   theta' = kappa v_t,   v_x' = a_x - omega v_z

it stays affine, so the ideal force is F* = -J_0 / J_1, with a pole where J_1 = 0.  Body axes x forward, z up, omega > 0
nose-down, pitch p nose-up; theta_k absolute slopes, kappa_k curvatures of the wheel-centre path, (rear, front).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca

DEFINITIONS = ("body", "inertial", "thesis", "partial")


@dataclass(frozen=True)
class Frame:
    """What the law knows of its robot: numbers or symbols, SI units; ``arm`` = 1 for traction at the ground, 0 at c."""

    m: Any
    I_y: Any
    L_f: Any
    L_r: Any
    h: Any
    R: Any
    share: Any = 0.0  # of the traction on the front axle: 0 rear, 0.5 four-wheel, 1 front drive
    arm: float = 1.0
    g: Any = 9.81


@dataclass(frozen=True)
class Motion:
    """One state of a robot that rolls on both axles, and the forces on it for a traction F."""

    v_z: Any
    omega: Any
    along: Any  # (2,) speed of the wheel centres along the ground, rear and front
    normal: Any  # (2,) normal force of each axle
    a_x: Any
    a_z: Any
    alpha: Any


def rolling(robot: Frame, pitch: Any, slope: Any, v_x: Any) -> tuple[Any, Any, Any]:
    """Return v_z, omega and the speeds (2,) of the wheel centres along the ground of a robot that rolls with *v_x*."""
    n, A, c = _directions(robot, pitch, slope)
    Rn = [_moment(c[k], n[k]) for k in range(2)]
    det = n[0][1] * Rn[1] - n[1][1] * Rn[0]
    v_z = (-n[0][0] * Rn[1] + n[1][0] * Rn[0]) * v_x / det
    omega = (-n[0][1] * n[1][0] + n[1][1] * n[0][0]) * v_x / det
    along = [A[k][0] * (v_x + omega * c[k][1]) + A[k][1] * (v_z - omega * c[k][0]) for k in range(2)]
    return v_z, omega, along


def motion(robot: Frame, pitch: Any, slope: Any, bend: Any, v_x: Any, F: Any, omega: Any = None) -> Motion:
    """Return the motion at (pitch, slope (2,)) with ``bend`` = kappa (2,); *omega* in place of the rolling one."""
    n, A, c = _directions(robot, pitch, slope)
    v_z, turning, along = rolling(robot, pitch, slope, v_x)
    omega = turning if omega is None else omega
    r = [(c[k][0] - robot.arm * robot.R * n[k][0], c[k][1] - robot.arm * robot.R * n[k][1]) for k in range(2)]
    Rn, Ra = [_moment(c[k], n[k]) for k in range(2)], [_moment(r[k], A[k]) for k in range(2)]
    gravity = (-robot.g * ca.sin(pitch), -robot.g * ca.cos(pitch))
    push = ((1 - robot.share) * F, robot.share * F)
    free = [gravity[i] + sum(A[k][i] * push[k] for k in range(2)) / robot.m for i in range(2)]
    spin = sum(Ra[k] * push[k] for k in range(2)) / robot.I_y
    P = [[_dot(n[i], n[j]) / robot.m + Rn[i] * Rn[j] / robot.I_y for j in range(2)] for i in range(2)]
    gap = [_dot(n[k], free) + Rn[k] * spin - omega**2 * _dot(n[k], c[k]) - bend[k] * along[k] ** 2 for k in range(2)]
    det = P[0][0] * P[1][1] - P[0][1] * P[1][0]
    normal = [-(P[1][1] * gap[0] - P[0][1] * gap[1]) / det, -(P[0][0] * gap[1] - P[1][0] * gap[0]) / det]
    a = [free[i] + sum(n[k][i] * normal[k] for k in range(2)) / robot.m for i in range(2)]
    return Motion(v_z, omega, along, normal, a[0], a[1], spin + sum(Rn[k] * normal[k] for k in range(2)) / robot.I_y)


def jerk(robot: Frame, definition: str, pitch: Any, slope: Any, bend: Any, bend_rate: Any, v_x: Any) -> tuple[Any, Any]:
    """Return J_0 (m/s3) and J_1 (m/(s3.N)) of one of `DEFINITIONS`, as CasADi expressions.

    ``body``: a_z', felt on board.  ``inertial``: a_z' - omega a_x.  ``thesis``: d2(v_z)/dt2 = a_z' + v_x alpha
    + omega v_x' (Eq 4.54 without its omissions).  ``partial``: d a_z / d gamma of the front slope with omega held, in
    m/(s2.rad): the condition of the papers, free of speed and curvature at omega = 0.
    """
    y, F = ca.SX.sym("y", 6), ca.SX.sym("F")  # pitch, slopes, curvatures, v_x
    if definition == "partial":
        held = ca.SX.sym("omega")
        at = motion(robot, y[0], [y[1], y[2]], [0, 0], 0, F, held)
        J = ca.jacobian(at.a_z, y[2])
        _, omega, _ = rolling(robot, pitch, slope, v_x)
        at_state = [ca.vertcat(pitch, *slope, 0, 0, 0), omega]
    else:
        held = ca.SX.sym("bend_rate", 2)
        at = motion(robot, y[0], [y[1], y[2]], [y[3], y[4]], y[5], F)
        v_x_rate = at.a_x - at.omega * at.v_z
        flow = ca.vertcat(-at.omega, y[3] * at.along[0], y[4] * at.along[1], held, v_x_rate)
        J = ca.jtimes(at.a_z, y, flow)
        J += {"body": 0, "inertial": -at.omega * at.a_x, "thesis": y[5] * at.alpha + at.omega * v_x_rate}[definition]
        at_state = [ca.vertcat(pitch, *slope, *bend, v_x), ca.vertcat(*bend_rate)]
    parts = [ca.substitute(J, F, 0), ca.substitute(ca.jacobian(J, F), F, 0)]  # affine: its slope holds anywhere
    J_0, J_1 = ca.substitute(parts, [y, held], at_state)
    return J_0, J_1


def ideal_force(
    robot: Frame, definition: str, front: float, v_x: float, pitch: float = 0.0, rear: float = 0.0
) -> float:
    """Return the traction, N, without normal jerk on straight slopes (rad, absolute) at *v_x* (m/s): -J_0 / J_1.

    At a speed of 0 only ``partial`` has one: the papers' force with omega = 0.
    """
    J_0, J_1 = (float(ca.evalf(ca.SX(J))) for J in jerk(robot, definition, pitch, [rear, front], [0, 0], [0, 0], v_x))
    return -J_0 / J_1


def _directions(robot: Frame, pitch: Any, slope: Any) -> tuple[Any, Any, Any]:
    """Return normals, traction directions and wheel centres, [rear, front], each (x, z)."""
    gamma = [slope[k] - pitch for k in range(2)]
    n = [(-ca.sin(g), ca.cos(g)) for g in gamma]
    A = [(ca.cos(g), ca.sin(g)) for g in gamma]
    return n, A, [(-robot.L_r, -robot.h), (robot.L_f, -robot.h)]


def _moment(arm: Any, force: Any) -> Any:
    return arm[1] * force[0] - arm[0] * force[1]


def _dot(a: Any, b: Any) -> Any:
    return a[0] * b[0] + a[1] * b[1]
