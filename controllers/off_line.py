"""Impact control computed before the run: the analytical model under its own control law (thesis 6.5 and 6.6).

The two axles are integrated on the reduced model, frozen at the posture of the impact, under the law 6.9 with the
planned reference 6.17:

    z'' = P F_n + U F_a + b,    F_n = max(0, -k_w z - c_w z') while z < 0, else 0
    F_a = U^-1 (z_R'' - h1 (z' - z_R') - h0 (z - z_R) - b + P (k_w z + c_w z')),    |F_a| <= mu F_n

The forces F_a(t) are what an off-line scheme plays back.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .reference import planned


@dataclass(frozen=True)
class AxleModel:
    """The reduced model of two axles in the order (rear, front): 1/kg, 1/kg, m/s2, N/m and N.s/m per axle."""

    P: np.ndarray
    U: np.ndarray
    b: np.ndarray
    k_w: float
    c_w: float = 0.0

    def normal_force(self, z: np.ndarray, rate: np.ndarray) -> np.ndarray:
        """Return F_n (2,) in N: it pushes and never pulls."""
        return np.where(z < 0, np.maximum(0.0, -self.k_w * z - self.c_w * rate), 0.0)


@dataclass(frozen=True)
class PlannedLaw:
    """The law 6.9 with a degree-7 path to ``target`` (2,) in m within T seconds; mu limits the tractions."""

    h0: float  # 1/s2
    h1: float  # 1/s
    target: np.ndarray
    T: float  # s
    mu: float = np.inf

    def traction(self, model: AxleModel, t: float, z: np.ndarray, rate: np.ndarray, start: np.ndarray) -> np.ndarray:
        """Return F_a (2,) in N at time *t* after the impact; *start* (4,): deformations and rates then.

        Nothing while an axle is off the ground: the law needs both.
        """
        F_n = model.normal_force(z, rate)
        if np.min(F_n) <= 0:
            return np.zeros(2)
        path = planned(min(t, self.T), self.T, start[:2], start[2:], self.target)
        moving = t < self.T
        wanted = moving * path.acceleration - self.h1 * (rate - moving * path.rate) - self.h0 * (z - path.z)
        limit = self.mu * F_n
        return np.clip(np.linalg.solve(model.U, wanted - model.b - model.P @ F_n), -limit, limit)


def off_line_forces(model: AxleModel, law: PlannedLaw, start: np.ndarray, time: np.ndarray) -> np.ndarray:
    """Return the axle tractions (n, 2) in N at *time* (n,) in s after the impact, from *start* (4,): z and z'."""

    def rate(t: float, x: np.ndarray) -> np.ndarray:
        z, v = x[:2], x[2:]
        F_a = law.traction(model, t, z, v, start)
        return np.append(v, model.P @ model.normal_force(z, v) + model.U @ F_a + model.b)

    # Where a wheel leaves the ground or a force meets its limit the rates jump: steps no longer than those of the table
    # keep the error of finding that instant to a step's share of the jump.
    from scipy.integrate import solve_ivp  # takes a second to import

    found = solve_ivp(rate, (0.0, time[-1]), start, t_eval=time, rtol=1e-8, atol=1e-11, max_step=time[-1] / len(time))
    return np.array([law.traction(model, t, x[:2], x[2:], start) for t, x in zip(time, found.y.T, strict=True)])
