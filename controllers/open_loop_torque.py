"""Torque for a traction as if no wheel slipped: T = R F_a, what slip control is compared with."""

from __future__ import annotations

from typing import Any

from cosim import Component, input, output, parameter


class OpenLoopTorque(Component):
    """Gives each wheel the motor torque R F_d, whatever the wheel does with it.

    Wheels in the order front-left, front-right, rear-left, rear-right; positive drives forwards.  The demand F_d is the
    parameter ``demand`` plus what an outer law asks for at the input ``outer_demand``.
    """

    demand = parameter([0.0] * 4, "N", "traction asked of each wheel")
    R = parameter(0.1, "m", "wheel radius")

    outer_demand = input("N", "traction an outer law asks of each wheel, added to the parameter", shape=4)

    torque = output("N.m", "motor torque of each wheel", shape=4)
    traction_demand = output("N", "traction asked of each wheel", shape=4)

    def outputs(s: Any) -> dict[str, Any]:
        total = s.demand + s.outer_demand
        return {"torque": s.R * total, "traction_demand": total}
