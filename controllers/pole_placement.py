"""State feedback of the wheel-ground impact, designed at one posture (thesis 6.4, Eq 6.16 with the right signs).

    F_a = F_R - K (x - x_R),   x = (z, z'),   x_R = (z_R, 0)
    z_R = z_0 + Z b_free,      F_R = F_0 - G b_free

K places the closed-loop poles or is that of an LQR, in discrete time (`state_space.pole_gain`, `lqr_gain`).  The
reference is either the static deflection, Z = (P k_w)^-1, which needs no steady traction, or a chosen z_0, held by the
traction U^-1 (P k_w z_0 - b_free).
"""

from __future__ import annotations

from typing import Any

import casadi as ca

from cosim import parameter

from .impact import ImpactController, can_act, decided, feedback, force_limit


class PolePlacement(ImpactController):
    """State feedback of the wheel deformations with constant gains, for the posture that they were designed for.

    It acts only while all wheels carry force, the axle form of U is well conditioned, and U is near that of the design:
    on another posture, with the rears on the slope for instance, the same gains may drive the motion that they should
    damp.  Otherwise it asks for nothing.  A demand beyond a wheel's limit is cut off there; its observer sees what is
    left.  The model of four wheels knows no side forces: where tyres grip sideways, control the axles.
    """

    K_z = parameter([[0.0] * 4] * 4, "N/m", "traction of each wheel per deformation of each wheel")
    K_rate = parameter([[0.0] * 4] * 4, "N.s/m", "traction of each wheel per rate of each wheel")
    z_0 = parameter([0.0] * 4, "m", "reference deformation where b_free is 0")
    z_per_b = parameter([[0.0] * 4] * 4, "s2", "reference deformation per b_free")
    F_0 = parameter([0.0] * 4, "N", "steady traction where b_free is 0")
    F_per_b = parameter([[0.0] * 4] * 4, "kg", "steady traction per b_free")

    def sync(s: Any) -> dict[str, Any]:
        now, limit = feedback(s), force_limit(s)
        z_R = s.z_0 + s.z_per_b @ s.b_free
        F_R = s.F_0 + s.F_per_b @ s.b_free
        wanted = F_R - s.K_z @ (now.z - z_R) - s.K_rate @ now.rate
        demand = ca.fmax(-limit, ca.fmin(limit, wanted))
        return decided(s, now, can_act(s, designed=True), demand, limit, z_R, s.P_model, s.U_model)
