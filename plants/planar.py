"""The robot seen from the side: two axles on two slopes, in closed form (thesis chapters 4 to 6, errors corrected).

Body axes x forward, z up at the centre of mass; axles in the thesis' order (rear, front); forces are axle sums.
omega_y > 0 is nose-down and pitch p is nose-up, so p' = -omega_y.  With gamma = theta - p the slope seen from the body,

    A = (cos gamma, sin gamma)      n = (-sin gamma, cos gamma)
    c = (-L_r, -h), (L_f, -h)       r = c - R n  (c itself for traction_arm "centre": the thesis' text)
    P_ij = n_i.n_j / m + Rn_i Rn_j / I_y                      Rn = (c x n)_y                          (4.44)
    U_ij = n_i.A_j / m + Rn_i Ra_j / I_y                      Ra = (r x A)_y                          (4.43)
    b_i  = n_i.g - omega_y^2 n_i.c_i - kappa_i v_ti^2                                                 (4.46, 4.47)
    gap'' = P F_n + U F_a + b

P_12 is misprinted in (4.44) and (5.6); the curvature term is not in print.  The functions of a posture take complex
numbers too, so that derivatives are exact to rounding by complex steps.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from .tables import G, Robot

REAR, FRONT, FOUR = np.array([1.0, 0.0]), np.array([0.0, 1.0]), np.array([0.5, 0.5])  # how a drive shares its force
_COMPLEX_STEP = 1e-30


@dataclass(frozen=True)
class Posture:
    """The ground under the axles and the attitude on it."""

    front: complex  # rad, absolute slope under the front wheels, climbing positive
    rear: complex = 0.0  # rad, the same for the rear wheels
    pitch: complex = 0.0  # rad, nose-up
    curvature: tuple[float, float] = (0.0, 0.0)  # 1/m, of the wheel-centre path at rear and front, concave up positive


@dataclass(frozen=True)
class Jerk:
    """Three different quantities that go by one name; m/s3, (x, z) in body axes."""

    body: np.ndarray  # rate of the body components of the acceleration: felt on board
    inertial: np.ndarray  # components of the rate of the acceleration vector
    thesis: float  # d2(v_z)/dt2 of the body component v_z (4.54)


@dataclass(frozen=True)
class Bicycle:
    """The planar model of a robot.  A twist is (v_x, v_z, omega_y) in m/s and rad/s, body axes."""

    robot: Robot
    traction_arm: str = "ground"
    g: float = G

    @property
    def _c(self) -> np.ndarray:
        """Wheel centres in body axes, (axle, component), m."""
        return np.array([[-self.robot.L_r, -self.robot.h], [self.robot.L_f, -self.robot.h]])

    def _directions(self, at: Posture) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Return n and A (axle, component) and the moments Rn and Ra (axle) of their unit forces, m."""
        gamma = np.array([at.rear - at.pitch, at.front - at.pitch])
        sine, cosine = np.sin(gamma), np.cos(gamma)
        n, A = np.column_stack([-sine, cosine]), np.column_stack([cosine, sine])
        c = self._c
        r = c - self.robot.R * n if self.traction_arm == "ground" else c
        return n, A, _moment(c, n), _moment(r, A)

    def _gravity(self, at: Posture) -> np.ndarray:
        return -self.g * np.array([np.sin(at.pitch), np.cos(at.pitch)])

    def P(self, at: Posture) -> np.ndarray:
        """Return the gap acceleration per normal force, (2, 2), 1/kg."""
        n, _, Rn, _ = self._directions(at)
        return n @ n.T / self.robot.m + np.outer(Rn, Rn) / self.robot.I_y

    def U(self, at: Posture) -> np.ndarray:
        """Return the gap acceleration per traction, (2, 2), 1/kg."""
        n, A, Rn, Ra = self._directions(at)
        return n @ A.T / self.robot.m + np.outer(Rn, Ra) / self.robot.I_y

    def b(self, at: Posture, twist: np.ndarray) -> np.ndarray:
        """Return the gap acceleration without any contact force, (2,), m/s2."""
        n, A, _, _ = self._directions(at)
        v_x, v_z, omega = twist
        c = self._c
        along = np.sum(A * (np.array([v_x, v_z]) + omega * np.column_stack([c[:, 1], -c[:, 0]])), axis=1)
        return n @ self._gravity(at) - omega**2 * np.sum(n * c, axis=1) - np.array(at.curvature) * along**2

    def accelerations(self, at: Posture, normal: np.ndarray, traction: np.ndarray) -> np.ndarray:
        """Return (a_x, a_z, alpha_y) of the centre of mass for axle forces in N; m/s2 and rad/s2 (4.19, 4.20)."""
        n, A, Rn, Ra = self._directions(at)
        a = (normal @ n + traction @ A) / self.robot.m + self._gravity(at)
        return np.append(a, (normal @ Rn + traction @ Ra) / self.robot.I_y)

    def contact_forces(self, at: Posture, twist: np.ndarray, traction: np.ndarray) -> np.ndarray:
        """Return the normal forces (2,), in N, that keep both axles on the ground; negative: it would have to pull."""
        return -np.linalg.solve(self.P(at), self.U(at) @ traction + self.b(at, twist))  # (4.33)

    def climbing_twist(self, at: Posture, v_x: complex) -> np.ndarray:
        """Return the twist of a robot that rolls with both axles on the ground: n.(v + omega x c) = 0."""
        n, _, Rn, _ = self._directions(at)
        v_z, omega = np.linalg.solve(np.column_stack([n[:, 1], Rn]), -n[:, 0] * v_x)
        return np.array([v_x, v_z, omega])

    def psi(self, at: Posture) -> complex:
        """Return Psi = m^2 I_y det P (Appendix A), kg.m2: 0 where the axles do not determine the motion."""
        return self.robot.m**2 * self.robot.I_y * np.linalg.det(self.P(at))

    def climb_force(self, slope: float, drive: str = "rear") -> float:
        """Return the traction, in N, that holds a level robot with its fronts on a slope and its rears on the flat.

        m g L_r / L times tan (rear drive) or sin (front drive) of the slope, if traction acts at the wheel centres.
        """
        robot = self.robot
        tipping = (robot.R if self.traction_arm == "ground" else 0.0) * np.sin(slope)
        lever = {"rear": robot.L * np.cos(slope) + tipping, "front": robot.L + tipping}[drive]
        return float(robot.m * self.g * robot.L_r * np.sin(slope) / lever)

    def stationary_force(self, at: Posture, omega: float, drive: np.ndarray = REAR) -> float:
        """Return the traction, in N, at which a_z does not change with the front slope: omega and forces held.

        This is "zero jerk" in the sense of the thesis' papers; for small slopes it is twice the static `climb_force`.
        """
        at = replace(at, front=at.front + 1j * _COMPLEX_STEP)
        twist = np.array([0.0, 0.0, omega])

        def change(force: float) -> float:
            traction = force * drive
            return self.accelerations(at, self.contact_forces(at, twist, traction), traction)[1].imag / _COMPLEX_STEP

        idle = change(0.0)
        return idle / (idle - change(1.0))  # a_z is affine in the force

    def contact_loss_slope(self, omega: Callable[[float], float]) -> float | None:
        """Return the smallest front slope, in rad, at which the front axle unloads without traction, or None.

        The rears are on the flat and the body level; *omega* gives the pitch rate (rad/s) to assume at each slope.
        """
        from scipy.optimize import brentq

        def load(slope: float) -> float:
            twist = np.array([0.0, 0.0, omega(slope)])
            return float(self.contact_forces(Posture(slope), twist, np.zeros(2))[1])

        slopes = np.linspace(1e-3, np.pi / 2 - 1e-3, 400)
        lost = np.flatnonzero(np.array([load(slope) for slope in slopes]) < 0)
        return float(brentq(load, slopes[lost[0] - 1], slopes[lost[0]])) if lost.size and lost[0] else None

    def frequencies(self, at: Posture, k_w: float) -> np.ndarray:
        """Return the circular frequencies, in rad/s ascending, of the body on wheels of *k_w* N/m per axle (6.7)."""
        return np.sqrt(np.linalg.eigvalsh(k_w * self.P(at)))

    def jerk(self, at: Posture, v_x: float, traction: np.ndarray) -> Jerk:
        """Return the jerks of a robot that rolls on both axles with constant traction; curvatures held.

        The total derivative along p' = -omega, theta' = kappa v_t, v_x' = a_x - omega v_z.  The thesis keeps only the
        change with the front slope.
        """

        def motion(at: Posture, v_x: complex) -> tuple[np.ndarray, np.ndarray]:
            twist = self.climbing_twist(at, v_x)
            return twist, self.accelerations(at, self.contact_forces(at, twist, traction), traction)

        (_, v_z, omega), (a_x, a_z, alpha) = motion(at, v_x)
        _, A, _, _ = self._directions(at)
        c = self._c
        along = A @ np.array([v_x, v_z]) + omega * (A[:, 0] * c[:, 1] - A[:, 1] * c[:, 0])
        v_x_rate = a_x - omega * v_z
        turning = np.array(at.curvature) * along
        step = 1j * _COMPLEX_STEP
        moved = replace(
            at, pitch=at.pitch - omega * step, rear=at.rear + turning[0] * step, front=at.front + turning[1] * step
        )
        body = motion(moved, v_x + v_x_rate * step)[1][:2].imag / _COMPLEX_STEP
        return Jerk(
            body=body,
            inertial=body + omega * np.array([a_z, -a_x]),
            thesis=float(body[1] + v_x * alpha + omega * v_x_rate),
        )


def _moment(arm: np.ndarray, force: np.ndarray) -> np.ndarray:
    """Return the y components of arm x force."""
    return arm[:, 1] * force[:, 0] - arm[:, 0] * force[:, 1]
