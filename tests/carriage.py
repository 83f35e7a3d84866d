"""One mass over each driven wheel, as in Fig 3.3 of the thesis: a component, and the same as a system for SciPy."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np
from scipy.integrate import solve_ivp

from cosim import Component, input, output, parameter, state

R, J_W, M, F_N = 0.1, 0.01, 42.5, 417.0  # m, kg.m2, kg, N: one wheel of the robot
V_MIN = 0.1  # m/s


class Carriage(Component):
    """Four masses, each on one wheel: m v' = F_a, exact for a traction held over the step; the load on the wheels."""

    m = parameter(M, "kg", "mass on each wheel")
    load = parameter(F_N, "N", "normal force of each wheel")
    F_a = input("N", "traction of each wheel", shape=4)
    v = state([0.0] * 4, "m/s", "speed of each mass")
    contact_velocity = output("m/s", "velocity of each wheel along and across", shape=(4, 2))
    normal_force = output("N", "normal force of each wheel", shape=4)
    traction = output("N", "traction of each wheel", shape=4)

    def flow(s: Any) -> dict[str, Any]:
        return dict(v=s.v + s.dt * s.F_a / s.m)

    def outputs(s: Any) -> dict[str, Any]:
        return dict(
            contact_velocity=ca.horzcat(s.v, ca.SX.zeros(4)), normal_force=s.load * ca.SX.ones(4), traction=s.F_a
        )


def slip(rim: float, speed: float) -> tuple[float, float]:
    """Return the slip ratio (3.1, 3.2; below V_MIN over the parabola that continues it), and what |rim| lacks in it."""
    larger = max(abs(rim), abs(speed))
    scale = larger if larger > V_MIN else (larger**2 / V_MIN + V_MIN) / 2
    return (rim - speed) / scale, max(0.0, abs(speed) - abs(rim)) / scale


def reference(
    torque: Callable[[float], float], mu: Callable[[float, float], float], stop: float, *, speed: float = 0.0,
    spin: float = 0.0, mass: float = np.inf,
) -> Any:  # fmt: skip
    """Integrate (spin, speed) of one wheel (3.4, 3.5) by SciPy's implicit Radau; dense output in ``sol``."""

    def rates(t: float, x: np.ndarray) -> list[float]:
        force = mu(*slip(R * x[0], x[1])) * F_N
        return [(torque(t) - R * force) / J_W, force / mass]

    return solve_ivp(rates, (0.0, stop), [spin, speed], "Radau", rtol=1e-10, atol=1e-12, dense_output=True)
