"""What every traction controller of the rover shares: what it measures, what it asks for, and that it is sampled."""

from __future__ import annotations

from typing import Any

from cosim import Component, input, output, parameter, state


class TractionController(Component):
    """Ports of a traction controller: contacts and the reduced model of the body in, a traction demand per wheel out.

    Sampled: inputs are read at the ticks of ``period`` and the outputs held in between.  Wheels in the order
    front-left, front-right, rear-left, rear-right.  A law writes the states ``demand`` and ``on`` (and more of its own)
    in ``sync``.
    """

    period = parameter(1e-3, "s", "sample period")

    gap = input("m", "measured deformation of each wheel, compression negative", shape=4)
    gap_rate = input("m/s", "its time derivative", shape=4)
    normal_force = input("N", "measured normal force of each wheel", shape=4)
    P = input("1/kg", "gap acceleration of each wheel per normal force of each wheel", shape=(4, 4))
    U = input("1/kg", "gap acceleration of each wheel per traction of each wheel", shape=(4, 4))
    b_free = input("m/s2", "gap acceleration without normal force and traction", shape=4)

    demand = state([0.0] * 4, "N", "traction demand held between samples", nominal=100.0)
    on = state(0.0, "1", "1 while the law acts, else 0")

    traction_demand = output("N", "traction asked of each wheel, forward positive", shape=4)
    active = output("1", "1 while the law acts, else 0")

    def outputs(s: Any) -> dict[str, Any]:
        return {"traction_demand": s.demand, "active": s.on}
