"""The impact controllers as components: the observer between ticks and in the air, when a law acts, and its limits."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.linalg import expm

from controllers import state_space as ss
from controllers.axles import wheel_forces_from_axles, wheel_motions_from_axles, wheels_from_axles
from controllers.observer import observer_gain
from controllers.pd_impact import PdImpact
from controllers.pole_placement import PolePlacement
from cosim import Component
from plants.planar import Bicycle, Posture
from plants.tables import ROBOTS

K_W, PERIOD = 2.8e6, 1e-3  # N/m of a wheel, s
SIDE, AT = Bicycle(ROBOTS["thesis_6_1"]), Posture(0.3)
P, U, B = SIDE.P(AT), SIDE.U(AT), SIDE.b(AT, np.zeros(3))
MODEL = ss.impact_model(P, U, 2 * K_W)
P4, U4, B4 = wheels_from_axles(P), wheels_from_axles(U), np.array([B[1], B[1], B[0], B[0]])
STATIC = np.repeat(ss.static_deflection(P, B, 2 * K_W)[::-1], 2)  # fl, fr, rl, rr


def law(**more: Any) -> PolePlacement:
    L = wheels_from_axles(observer_gain(MODEL, ss.conjugate_poles([400, 500], 0.8), 2 * K_W, 0.0, PERIOD))
    K = ss.pole_gain(MODEL, ss.conjugate_poles([150, 200], 0.7), PERIOD)
    values = {
        "K_z": wheel_forces_from_axles(K[:, :2]), "K_rate": wheel_forces_from_axles(K[:, 2:]), "k_w": K_W,
        "z_per_b": wheel_motions_from_axles(np.linalg.inv(P * 2 * K_W)), "P_model": P4, "U_model": U4,
        "L_z": L[:4], "L_rate": L[4:], "feedback": "observer", "limits": "motor", "F_max": 1e9, "period": PERIOD,
    }  # fmt: skip
    return PolePlacement(**{**values, **more})


class Ticker:
    """Feeds a controller one tick after the other."""

    def __init__(self, component: Component, **start: Any) -> None:
        self.period, self.number = round(1e9 * component.period), 0
        self.instance = component.instance()
        for name, value in {"P": P4, "U": U4, "b_free": B4, **start}.items():
            self.instance.set(name, value)
        self.instance.enter_initialization(0)
        self.instance.exit_initialization()

    def __call__(self, **inputs: Any) -> Any:
        for name, value in inputs.items():
            self.instance.set(name, value)
        self.instance.step(self.number * self.period, (self.number + 1) * self.period)
        self.number += 1
        return self.instance


def test_prediction_is_the_exact_solution() -> None:
    """A tick on, against SciPy's matrix exponential: Runge-Kutta 4 in two halves, 254 rad/s over 1 ms."""
    z, rate = np.array([-1e-3, -1e-3, -2e-4, -2e-4]), np.array([-0.3, -0.3, 0.1, 0.1])
    tick = Ticker(law(L_z=0.0, L_rate=0.0), z_next=z, z_rate_next=rate)
    after = tick(normal_force=[400.0] * 4)
    A = np.block([[np.zeros((4, 4)), np.eye(4), np.zeros((4, 1))],
                  [-P4 * K_W, np.zeros((4, 4)), (U4 @ after.get("traction_demand") + B4)[:, None]],
                  [np.zeros((1, 9))]])  # fmt: skip
    exact = (expm(A * PERIOD) @ np.concatenate([z, rate, [1.0]]))[:8]
    found = np.concatenate([after.get("z_next"), after.get("z_rate_next")])
    # (254 rad/s * 0.5 ms)^5 / 120 = 3e-7 in either half, of the motion over it
    assert np.max(np.abs(found - exact) / np.repeat([1.3e-3, 0.33], 4)) < 1e-6


def test_a_wheel_in_the_air_corrects_nothing() -> None:
    """No force, no information: the estimate flies on by b_free and by what the other axle does."""
    z, rate = np.array([1e-3, 1e-3, -2e-4, -2e-4]), np.array([0.4, 0.4, 0.0, 0.0])
    tick = Ticker(law(), z_next=z, z_rate_next=rate)
    after = tick(normal_force=[0.0, 0.0, K_W * 2e-4, K_W * 2e-4])  # the rears say what was predicted
    np.testing.assert_array_equal(after.get("estimate"), z)
    assert after.get("active") == 0
    np.testing.assert_array_equal(after.get("traction_demand"), 0)
    # rears: z'' = -2 k P_11 z + b; fronts: only b_free and the rears' push, over 1 ms
    push = np.repeat([-2 * K_W * P[1, 0], -2 * K_W * P[0, 0]], 2) * -2e-4 + B4
    # the force of the rears changes by |z''| T^2 / 2 of 0.2 mm: 3 %
    np.testing.assert_allclose(after.get("z_rate_next") - rate, push * PERIOD, rtol=0.05)


@pytest.mark.parametrize("model", ["axles", "wheels"])
def test_one_wheel_in_the_air(model: str) -> None:
    """It silences its axle where the mean of the axle is what is estimated, and itself alone where it is a wheel."""
    tick = Ticker(law(model=model), z_next=[-1e-4] * 4)
    estimate = tick(normal_force=[0.0, 300.0, 300.0, 300.0]).get("estimate")
    corrected = estimate != -1e-4
    assert corrected[2:].all()
    if model == "axles":  # the rears' gain couples into the fronts, by the same amount left and right
        np.testing.assert_array_equal(estimate[0], estimate[1])
    surprise = np.array([0.0, 20.0, 20.0, 20.0]) if model == "wheels" else np.array([0.0, 0.0, 20.0, 20.0])
    np.testing.assert_allclose(estimate, -1e-4 + law(model=model).L_z @ surprise, rtol=1e-12)


def test_estimate_does_not_wind_up_behind_a_limit() -> None:
    """Fed with what was really asked for, the observer of a saturated law stays with the wheels it watches.

    The plant is the model itself, sampled exactly; so the estimate ends at it, whatever the limit did.
    """
    for limit in (1e9, 50.0):
        tick = Ticker(law(F_max=limit), z_next=STATIC)
        x = np.concatenate([STATIC * 1.5, [0.0] * 4])
        plant = ss.sampled(ss.impact_model(P4, U4, K_W), PERIOD)
        constant = ss.sampled(ss.impact_model(P4, np.eye(4), K_W), PERIOD).B @ B4
        cut = False
        for _ in range(60):
            after = tick(normal_force=-K_W * x[:4])
            cut |= bool(np.any(after.get("saturated")))
            estimate = after.get("estimate")
            last = x[:4]
            x = plant.A @ x + plant.B @ after.get("traction_demand") + constant
        assert cut == (limit < 1e3)
        # exp(-320 rad/s * 60 ms) = 5e-9 of the start, then the 3e-7 of the Runge-Kutta steps
        np.testing.assert_allclose(estimate, last, atol=1e-6 * np.max(np.abs(STATIC)))


@pytest.mark.parametrize("component", [law(feedback="measured"), PdImpact(k_w=K_W, F_max=1e9, limits="motor")])
def test_a_law_acts_only_while_it_can(component: Component) -> None:
    """Off with a wheel in the air, off on the flat where U has rank 1, off again after being on."""
    forces, flat = [400.0] * 4, wheels_from_axles(SIDE.U(Posture(0.0)))
    tick = Ticker(component, gap=2 * STATIC)
    for given, on in (
        ({"normal_force": forces}, 1),
        ({"normal_force": [0.0, *forces[1:]]}, 0),
        ({"normal_force": forces, "U": flat}, 0),
        ({"U": U4}, 1),
    ):
        after = tick(**given)
        assert after.get("active") == on
        assert bool(np.any(after.get("traction_demand"))) == bool(on)


def test_placed_poles_are_off_on_a_posture_they_were_not_made_for() -> None:
    """Rears on the slope and fronts on the flat beyond it: U is as well conditioned, but some tractions work backwards.

    The eigenvalues of U U_design^-1 are 1.3 and -1.0.
    """
    other = SIDE.U(Posture(front=0.0, rear=0.3))
    assert np.linalg.cond(other) < 1e2
    tick = Ticker(law(feedback="measured"), gap=2 * STATIC)
    assert tick(normal_force=[400.0] * 4).get("active") == 1
    assert tick(U=wheels_from_axles(other)).get("active") == 0


def test_demand_respects_friction_and_motor() -> None:
    forces = np.array([400.0, 300.0, 200.0, 100.0])
    tick = Ticker(law(feedback="measured", limits="friction", mu=0.5, F_max=120.0), gap=4 * STATIC)
    after = tick(normal_force=forces)
    assert np.all(np.abs(after.get("traction_demand")) <= np.minimum(0.5 * forces, 120.0) * (1 + 1e-15))
    np.testing.assert_array_equal(after.get("saturated"), 1)


def test_static_reference_asks_for_nothing_in_equilibrium() -> None:
    for component in (law(feedback="measured"), PdImpact(k_w=K_W, F_max=1e9, limits="motor")):
        after = Ticker(component, gap=STATIC)(normal_force=-K_W * STATIC)
        np.testing.assert_allclose(after.get("reference"), STATIC, rtol=1e-12)
        # K |z_s| is of order 2e3 N, and the bounded least squares is exact to 1e-12 of what it solves for
        np.testing.assert_allclose(after.get("traction_demand"), 0, atol=1e-6)
