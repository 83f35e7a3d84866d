"""The flexible chassis in modal coordinates (thesis chapters 7 and 8), advanced exactly.

Every elastic mode, with its shape mass-normalised (Phi^T M Phi = I, which 7.10 needs), obeys

    q'' + 2 zeta w q' + w^2 q = phi_wheels^T F                      (7.10)

F held over a step dt, q relative to its static value d = f/w^2 moves as e^{-zeta w t} (cos w_d t, sin w_d t), so

    q(dt)  = d + E ((q - d) (C + zeta w S) + q' S)                  E = e^{-zeta w dt}, C = cos w_d dt,
    q'(dt) = E (q' (C - zeta w S) - (q - d) w^2 S)                  S = sin(w_d dt) / w_d
"""

from __future__ import annotations

from math import pi
from typing import Any

import casadi as ca
import numpy as np

from cosim import Component, input, output, parameter, state, structural


class ChassisModal(Component):
    """Elastic modes of the chassis, driven by the vertical forces at its four wheel nodes.

    Elastic motion only: the six rigid modes are the rigid body's.  Wheels in the order front-left, front-right,
    rear-left, rear-right; stations as numbered in the modal data.  Accelerations depend on how many modes are kept.
    """

    modes = structural(25, "number of elastic modes")
    stations = structural(20, "number of stations at which the acceleration is given")

    frequency = parameter(25.0, "Hz", "undamped natural frequencies", shape="modes")
    damping = parameter(5e-5, "1", "damping ratios zeta, below 1", shape="modes")
    wheel_shape = parameter(
        0.0, "1", "vertical mode shapes at the wheel nodes, mass-normalised (kg^-1/2)", shape=(4, "modes")
    )
    station_shape = parameter(
        0.0, "1", "vertical mode shapes at the stations, mass-normalised (kg^-1/2)", shape=("stations", "modes")
    )

    wheel_force = input("N", "vertical force of each wheel on the chassis, upwards", shape=4)

    modal_q = state(0.0, "m", "modal coordinates (m kg^1/2)", shape="modes", nominal=1e-3)
    modal_rate = state(0.0, "m/s", "their time derivatives (m kg^1/2 / s)", shape="modes", nominal=1e-2)

    acceleration = output(
        "m/s2", "elastic acceleration at the stations, upwards, right after the input", shape="stations"
    )
    modal_displacement = output("m", "modal coordinates (m kg^1/2)", shape="modes")
    strain_energy = output("J", "energy stored in the elastic modes")
    elastic_kinetic_energy = output("J", "kinetic energy of the elastic modes")

    def constants(s: Any) -> dict[str, Any]:
        w = 2 * pi * s.frequency  # rad/s
        wd = w * ca.sqrt(1 - s.damping**2)
        decay = ca.exp(-s.damping * w * s.dt)
        C, S = ca.cos(wd * s.dt), ca.sin(wd * s.dt) / wd
        return {
            "w2": w**2, "drag": 2 * s.damping * w, "softness": 1 / w**2,
            "q_by_q": decay * (C + s.damping * w * S), "q_by_rate": decay * S,
            "rate_by_q": -decay * w**2 * S, "rate_by_rate": decay * (C - s.damping * w * S),
        }  # fmt: skip

    def flow(s: Any) -> dict[str, Any]:
        still = _modal_force(s) * s.softness
        off = s.modal_q - still
        return {
            "modal_q": still + s.q_by_q * off + s.q_by_rate * s.modal_rate,
            "modal_rate": s.rate_by_q * off + s.rate_by_rate * s.modal_rate,
        }

    def derivatives(s: Any) -> dict[str, Any]:
        return {
            "modal_q": s.modal_rate,
            "modal_rate": _modal_force(s) - s.drag * s.modal_rate - s.w2 * s.modal_q,
        }

    def outputs(s: Any) -> dict[str, Any]:
        return {
            "acceleration": _in_strands(s.station_shape, ChassisModal.derivatives(s)["modal_rate"]),
            "modal_displacement": s.modal_q,
            "strain_energy": _in_strands(s.w2.T, s.modal_q**2) / 2,
            "elastic_kinetic_energy": _in_strands(s.modal_rate.T, s.modal_rate) / 2,
        }


def _modal_force(s: Any) -> Any:
    """Return phi_wheels^T F (modes,)."""
    return s.wheel_shape.T @ s.wheel_force


def _in_strands(matrix: Any, vector: Any) -> Any:
    """Return their product, summed in four strands, which a processor adds side by side."""
    four = [matrix[:, k::4] @ vector[k::4] for k in range(4)]
    return (four[0] + four[1]) + (four[2] + four[3])


def static_deflection(chassis: Component, wheel_force: np.ndarray) -> np.ndarray:
    """Return the modal coordinates (modes,) under constant wheel forces (4,) in N: q = f / w^2."""
    values = chassis.values
    return values["wheel_shape"].T @ wheel_force / (2 * pi * values["frequency"]) ** 2
