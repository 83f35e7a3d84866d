"""Equations of the thesis as they are printed, wrong where they are wrong: what its figures would be by them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from controllers.pitch_plan import Coefficients, Vehicle
from plants.planar import Bicycle, Posture
from plants.tables import G, Robot


@dataclass(frozen=True)
class PrintedBicycle(Bicycle):
    """The planar model with P as printed for a level body on the rear wheels (4.44), not symmetric."""

    traction_arm: str = "centre"

    def P(self, at: Posture) -> np.ndarray:
        """Return P (2, 2) in 1/kg: P_12 and P_21 carry -sin gamma / m and the moments of one axle twice."""
        if at.pitch or at.rear:
            raise ValueError("(4.44) is of a level body with its rear wheels on the level")
        derived, robot = super().P(at), self.robot
        Rn2 = robot.h * np.sin(at.front) - robot.L_f * np.cos(at.front)
        slip = -np.sin(at.front) / robot.m
        across = np.array([[0.0, slip + robot.L_r**2 / robot.I_y], [slip + Rn2**2 / robot.I_y, 0.0]])
        return np.diag(np.diag(derived)) + across


def appendix_a_force(robot: Robot, slope: float, bend: float) -> float:
    """Return the rear traction in N at which the normal jerk of Appendix A vanishes as printed, without pitch rate.

    *bend* is d gamma / dx in rad/m.  J_cz / v_x = (Psi eta' - eta Psi') / Psi^2 bend + rho / Psi, linear in the force;
    eta' lacks a factor 2 in its fifth summand, rho sin^2 in its third.
    """
    s, c, m, L, L_r, h = np.sin(slope), np.cos(slope), robot.m, robot.L, robot.L_r, robot.h
    of_sin = h**2 - 2 * L_r * robot.L_f - robot.L_f**2
    Psi = m * (-2 * h * L * s * c + of_sin * s**2 + L**2) + robot.I_y * s**2
    Psi_slope = m * (2 * h * L * (2 * s**2 - 1) + 2 * of_sin * s * c) + 2 * robot.I_y * s * c

    def jerk(F: float) -> float:
        eta = F * L_r * L * s * c - m * L_r**2 * G * s**2
        eta_slope = F * L_r * L * (c**2 - s**2) - m * L_r**2 * G * s * c
        rho = F * L * s * c - m * L_r * G
        return float((Psi * eta_slope - eta * Psi_slope) / Psi**2 * bend + rho / Psi)

    idle = jerk(0.0)
    return idle / (idle - jerk(1.0))


def appendix_b(vehicle: Vehicle, p: np.ndarray, theta: np.ndarray) -> Coefficients:
    """Return the coefficients of the pitch equation as Appendix B prints them; it has no curvature term."""
    m, L_f, L_r, h, R = vehicle.m, vehicle.L_f, vehicle.L_r, vehicle.h, vehicle.R
    L, s, c, sp, cp = L_f + L_r, np.sin(theta), np.cos(theta), np.sin(p), np.cos(p)
    even = 2 * L_f * L * c**2 - 2 * h * L * c * s + L_r**2 - L_f**2
    odd = 2 * L_f * L * c * s - 2 * h * L * s**2
    D = vehicle.I_y * s**2 + m * (even * cp**2 + odd * cp * sp + (L_f**2 + h**2) * s**2)
    tau_1 = (L_f * (c - 1) * s - h * s**2) * sp
    tau_2 = (-L * c + h * (1 - c) * s + L_f * c**2 + L_r) * cp
    return Coefficients(
        Phi=(L * (s**2 * sp + c**2 * s) + R * s**2) / D,
        Gamma=m * ((tau_1 + tau_2) * R + even * cp * sp + odd / 2 - odd * cp**2) / D,
        Lambda=m * G * s**2 * (h * sp - L_r * cp) / D,
        K=np.zeros_like(D),
    )
