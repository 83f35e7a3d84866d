"""The rover as one ODE: body and wheel springs in a single system, the reference for every coupled run.

The same equations as `RigidBody` and `WheelDeformation`, without any exchange: the deformation is the gap, the normal
force follows it continuously.  Integrated with a tight tolerance it is what co-simulation is measured against.
"""

from __future__ import annotations

from typing import Any

import casadi as ca

from cosim import event, input, output, parameter
from cosim.symbols import Namespace

from .rigid_body import RigidBody


class MonolithicRover(RigidBody):
    """Rigid body on four unilateral spring-damper wheels (thesis 6.6, with the signs of a spring that pushes).

        F_n = max(0, -k_w gap - c_w gap') while gap < 0, else 0
        F_a = clip(traction_demand, +-mu F_n)

    The inputs normal_force, traction and lateral of the body are computed inside and have no effect.
    """

    k_w = parameter([1e5, 1e5, 1e5, 1e5], "N/m", "radial stiffness of each wheel")
    c_w = parameter([0.0, 0.0, 0.0, 0.0], "N.s/m", "radial damping of each wheel")
    mu = parameter(0.8, "1", "friction coefficient between tyre and ground")
    traction_demand = input("N", "demanded traction of each wheel", shape=4)
    touch = event("a wheel makes or loses contact", shape=4)
    release = event("a wheel's spring and damper cease to push", shape=4)
    spring_force = output("N", "normal force of each wheel", shape=4)
    elastic_energy = output("J", "energy stored in the wheel springs")

    def derivatives(s: Any) -> dict[str, Any]:
        return RigidBody.derivatives(_loaded(s))

    def outputs(s: Any) -> dict[str, Any]:
        full = _loaded(s)
        gap = RigidBody.outputs(s)["gap"]
        stored = ca.sum1(s.k_w * ca.fmin(gap, 0) ** 2) / 2
        return {**RigidBody.outputs(full), "spring_force": full.normal_force, "elastic_energy": stored}

    def crossings(s: Any) -> dict[str, Any]:
        found = RigidBody.outputs(s)
        push = -s.k_w * found["gap"] - s.c_w * found["gap_rate"]
        return {**RigidBody.crossings(s), "touch": found["gap"], "release": push}


def _loaded(s: Any) -> Namespace:
    """Return the namespace with the contact forces of the current state in place of the inputs."""
    found = RigidBody.outputs(s)
    push = ca.fmax(0, -s.k_w * found["gap"] - s.c_w * found["gap_rate"])
    force = ca.if_else(found["gap"] < 0, push, 0)
    full = Namespace(**vars(s))
    full.normal_force = force
    full.traction = ca.fmax(-s.mu * force, ca.fmin(s.mu * force, s.traction_demand))
    full.lateral = ca.SX.zeros(4)
    return full
