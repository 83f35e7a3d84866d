"""Motor-driven spinning wheels (thesis chapter 3): torque in, traction by slip out.

    J_w w' = T - R F_a                                             (3.5)
    F_a = mu_a(lambda, sigma) F_n                                  (3.3; Dugoff or Magic Formula, see `tyre`)

The spin is stiff: with the speed V of the wheel held it has, about rolling, the pole -R^2 F_n C_x / (J_w V), -1668 1/s
at 2 m/s for a wheel of 0.01 kg m2 under 417 N with C_x = 8, and 40 times that at rest.  It is integrated here, between
communication points, with the velocity of the wheel and its normal force held.  The wheels are given the *mean* of F_a
over the step, so what the spin loses is what the body gains.  Measured: a step of 1e-4 s of all four wheels costs 4 us
at 2 m/s, 6 us starting from rest with v_min = 0.1 m/s, 43 us with v_min = 0.01 m/s.
"""

from __future__ import annotations

from typing import Any

import casadi as ca

from cosim import Component, input, output, parameter, state, structural
from cosim.errors import DeclarationError

from .tyre import LAWS, Tyre, friction_coefficients, wheel_slip


class WheelDrive(Component):
    """Four wheels that spin under a motor torque and drive by slipping.

    Wheels in the order front-left, front-right, rear-left, rear-right; positive torque, spin and slip drive forwards.

    The traction asked of the wheel plant is what slip ratio and slip angle together leave to it, and the lateral demand
    what they leave to that.  The wheel plant cuts the traction at its own mu F_n; with ``sideslip = "demand"`` it takes
    the lateral force too, inside the rest of the friction ellipse, else it makes one by its cornering stiffness.  A
    demanded lateral force is held over a macro step: at rest it chatters (tried) unless the step is below some 2.5e-3 s
    per m/s of ``v_min``.

    Raises DeclarationError for a friction curve of negative or no stiffness, or one that changes its sign.
    """

    law = structural("magic", "friction curve: Dugoff's, or the Magic Formula", choices=LAWS)

    R = parameter(0.1, "m", "wheel radius")
    J_w = parameter(0.01, "kg.m2", "moment of inertia of a wheel about its axle, motor included")
    mu = parameter(0.8, "1", "largest friction coefficient of the curve")
    C_x = parameter(8.0, "1", "slope of the traction coefficient over the slip ratio, at zero slip")
    C_y = parameter(12.0, "1/rad", "cornering stiffness of a wheel over its normal force")
    C = parameter(1.65, "1", "shape factor of the Magic Formula, at most 2; above 1 the curve has a peak")
    E = parameter(0.0, "1", "curvature factor of the Magic Formula; at most 1")
    v_min = parameter(0.1, "m/s", "speed below which slip is taken from sliding velocity alone, so that rest has one")

    torque = input("N.m", "motor torque of each wheel", shape=4)
    contact_velocity = input("m/s", "velocity of each wheel along its heading and across, to the left", shape=(4, 2))
    normal_force = input("N", "normal force of each wheel", shape=4)

    omega = state([0.0] * 4, "rad/s", "spin of each wheel", nominal=1.0)
    traction_sum = state([0.0] * 4, "N.s", "traction impulse since the step began", nominal=0.1)
    lateral_sum = state([0.0] * 4, "N.s", "lateral impulse since the step began", nominal=0.1)
    turning_sum = state([0.0] * 4, "N.m.s", "angular momentum each wheel gained since the step began", nominal=0.01)
    elapsed = state(0.0, "s", "time since the step began")
    worked = state(0.0, "J", "work of the motors since the start")
    lost = state(0.0, "J", "energy dissipated by the slip ratio since the start")

    traction_demand = output("N", "mean traction of each wheel over the step, forward positive", shape=4)
    lateral_demand = output("N", "mean lateral force over the step by the same curve, to the left positive", shape=4)
    reaction = output("N.m", "mean moment on the body of what turns the wheels faster, body axes, unsteered", shape=3)
    slip = output("1", "slip ratio at the end of the step", shape=4)
    slip_angle = output("rad", "angle from heading to velocity at the end of the step, to the left positive", shape=4)
    slip_speed = output("m/s", "speed that the slip ratio is measured against", shape=4)
    spin = output("rad/s", "spin of each wheel at the end of the step", shape=4)
    motor_energy = output("J", "work of the motors since the start")
    slip_energy = output("J", "energy dissipated by the slip ratio since the start")

    def __init__(self, **values: Any) -> None:
        super().__init__(**values)
        for name in ("C_x", "C_y"):
            if not self.values[name] > 0:
                raise DeclarationError(
                    f"WheelDrive.{name} is {self._told(name)}: a friction curve of negative or no stiffness pushes a "
                    "slipping wheel on instead of holding it; give the slope of the curve at zero slip, above 0"
                )
        for name in ("R", "J_w", "mu", "C", "v_min"):
            if not self.values[name] > 0:
                raise DeclarationError(f"WheelDrive.{name} is {self._told(name)}; it must be positive")
        C, E = float(self.values["C"]), float(self.values["E"])
        most = 2.0 if E < 1 else 3.0  # beyond it C atan(...) reaches pi
        if E > 1 or most < C:
            raise DeclarationError(
                f"WheelDrive.C = {C:g} with E = {E:g} lets the Magic Formula push in the direction of a large slip; "
                "keep E at most 1 and C at most 2 (3 with E = 1)"
            )

    def _told(self, name: str) -> str:
        return f"{float(self.values[name]):g} {self.declarations[name].unit}".removesuffix(" 1")

    def sync(s: Any) -> dict[str, Any]:
        none = ca.SX.zeros(4)
        return {"traction_sum": none, "lateral_sum": none, "turning_sum": none, "elapsed": 0}

    def derivatives(s: Any) -> dict[str, Any]:
        traction, lateral = _forces(s)
        turning = s.torque - s.R * traction
        along = s.contact_velocity[:, 0]
        return {
            "omega": turning / s.J_w,
            "traction_sum": traction,
            "lateral_sum": lateral,
            "turning_sum": turning,
            "elapsed": 1,
            "worked": ca.dot(s.torque, s.omega),
            "lost": ca.dot(traction, s.R * s.omega - along),
        }

    def outputs(s: Any) -> dict[str, Any]:
        began = s.elapsed > 0  # before the first step the mean is what there is now
        span = ca.if_else(began, s.elapsed, 1)
        traction, lateral = _forces(s)
        slip = _slip(s)
        along, across = s.contact_velocity[:, 0], s.contact_velocity[:, 1]
        turning = ca.if_else(began, s.turning_sum / span, s.torque - s.R * traction)
        return {
            "traction_demand": ca.if_else(began, s.traction_sum / span, traction),
            "lateral_demand": ca.if_else(began, s.lateral_sum / span, lateral),
            "reaction": ca.vertcat(0, -ca.sum1(turning), 0),
            "slip": slip.ratio,
            "slip_angle": ca.atan2(across, ca.sqrt(along**2 + s.v_min**2)),
            "slip_speed": slip.speed,
            "spin": s.omega,
            "motor_energy": s.worked,
            "slip_energy": s.lost,
        }


def _slip(s: Any) -> Any:
    return wheel_slip(s.R * s.omega, s.contact_velocity[:, 0], s.contact_velocity[:, 1], s.v_min)


def _forces(s: Any) -> tuple[Any, Any]:
    """Return traction and lateral force (4 each) of the current spin."""
    mu_a, mu_l = friction_coefficients(Tyre(s.law, s.mu, s.C_x, s.C_y, s.C, s.E), _slip(s))
    return mu_a * s.normal_force, mu_l * s.normal_force


def tyre_of(drive: WheelDrive) -> Tyre:
    """Return the friction curve of a drive, in numbers."""
    v = drive.values
    numbers = {name: float(v[name]) for name in ("mu", "C_x", "C_y", "C", "E")}
    return Tyre(str(drive.structure["law"]), **numbers)
