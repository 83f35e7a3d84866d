"""Traction by position along the road, played back: a constant force, or a crossing planned before the run."""

from __future__ import annotations

from typing import Any

import casadi as ca

from cosim import Component, input, output, parameter, state, table


class ForceProfile(Component):
    """Asks for the total traction that a table gives over the position of the centre of mass, within the motor's limit.

    Rows x (m), F (N), dF/dx (N/m): from x on F grows with dF/dx until the next row.  Before the first row its force
    holds.  Wheels in the order front-left, front-right, rear-left, rear-right; the two wheels of an axle share evenly.
    """

    period = parameter(1e-3, "s", "sample period")
    R = parameter(0.1, "m", "wheel radius")
    share = parameter(0.0, "1", "part of the force on the front axle: 0 rear, 0.5 four-wheel, 1 front drive")
    torque_max = parameter(40.0, "N.m", "largest torque of a wheel's motor")
    profile = table(3, "traction of all wheels over the position of the centre of mass")

    position = input("m", "measured position of the centre of mass, world", shape=3)

    demand = state([0.0] * 4, "N", "traction demand held between samples", nominal=100.0)
    on = state(0.0, "1", "1 once the first sample was taken")

    traction_demand = output("N", "traction asked of each wheel, forward positive", shape=4)
    torque = output("N.m", "motor torque asked of each wheel, forward positive", shape=4)
    active = output("1", "1 once the first sample was taken, else 0")

    def lookups(s: Any) -> dict[str, Any]:
        return {"profile": s.position[0]}

    def outputs(s: Any) -> dict[str, Any]:
        return {"traction_demand": s.demand, "torque": s.R * s.demand, "active": s.on}

    def sync(s: Any) -> dict[str, Any]:
        x, force, growth = s.profile[0, 0], s.profile[0, 1], s.profile[0, 2]
        wanted = force + growth * ca.fmax(s.position[0] - x, 0)
        limit = s.torque_max / s.R
        front, rear = s.share * wanted / 2, (1 - s.share) * wanted / 2
        demand = ca.vertcat(front, front, rear, rear)
        return {"demand": ca.fmax(-limit, ca.fmin(limit, demand)), "on": 1}
