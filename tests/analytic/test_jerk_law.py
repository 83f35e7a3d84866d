"""The jerk law as a component: its force in closed form, its limits, and what it does where the jerk leaves it open."""

import numpy as np
import pytest

from controllers.jerk_traction import JerkTraction
from controllers.planar_jerk import DEFINITIONS, Frame, ideal_force
from cosim.twin import PythonInstance

CLIMBING = {"velocity_body": [1.0, 0.0, 0.0], "slope": [0.2, 0.2, 0.0, 0.0], "normal_force": [400.0] * 4}
FREE = {"J_1_min": 1e-12, "rate_max": 1e9, "torque_max": 1e4, "mu": 1e3}
NEAR = 1e-9  # relative: some hundred operations, and a guard of (1e-12 / 1e-3)^2


def sampled(component: JerkTraction, samples: int = 1, **measured: object) -> PythonInstance:
    """Return an instance after some samples of the same measurement."""
    law = component.instance("controller")
    law.enter_initialization(0)
    law.exit_initialization()
    for name, value in {**CLIMBING, **measured}.items():
        law.set(name, np.asarray(value, float))
    for k in range(samples):
        law.step(k * 1_000_000, (k + 1) * 1_000_000)
    return law


@pytest.mark.parametrize("arm", ["ground", "centre"])
@pytest.mark.parametrize("definition", DEFINITIONS)
def test_it_asks_for_the_ideal_force(definition: str, arm: str) -> None:
    """On a straight slope, split evenly between the rear wheels, and as torque at the wheel radius."""
    law = sampled(JerkTraction(definition=definition, traction_arm=arm, **FREE))
    frame = Frame(170.0, 47.0, 0.6, 0.46, 0.4, 0.1, arm=1.0 if arm == "ground" else 0.0)
    force = ideal_force(frame, definition, 0.2, 1.0)
    np.testing.assert_allclose(law.get("traction_demand"), [0, 0, force / 2, force / 2], rtol=NEAR)
    np.testing.assert_allclose(law.get("torque"), 0.1 * np.array(law.get("traction_demand")), rtol=1e-15)
    assert float(law.get("unlimited")) == 1
    assert float(law.get("jerk_expected")) == pytest.approx(0, abs=1e-9)


def test_estimated_slopes_give_the_same_force() -> None:
    """Axle forces of the same slope and traction; the filter starts at the first measurement and stays there."""
    gamma, F_n, F_t = 0.2, 400.0, np.array([0.0, 0.0, 60.0, 60.0])
    gammas = np.array([gamma, gamma, 0.0, 0.0])
    axle = np.column_stack(
        [F_t * np.cos(gammas) - F_n * np.sin(gammas), 0 * F_t, F_t * np.sin(gammas) + F_n * np.cos(gammas)]
    )
    known = sampled(JerkTraction(**FREE), samples=5)
    estimated = sampled(
        JerkTraction(slope_source="estimated", **FREE), samples=5, slope=[0.0] * 4, axle_force=axle, traction=F_t
    )
    np.testing.assert_allclose(estimated.get("axle_slope"), [0.0, 0.2], atol=1e-12)
    # 1e-12 rad of rounding, differentiated twice at 1 ms with a gain of (bandwidth period)^3, moves J_0 by 1e-6.
    np.testing.assert_allclose(estimated.get("traction_demand"), known.get("traction_demand"), rtol=1e-4)


def test_motor_friction_and_rate_limit_the_force() -> None:
    """The first limit that is met: 2 x 3 / 0.1 N of the motors, mu times the rears' load, 5e3 N/s over one sample."""
    for limit, force in (({"torque_max": 3.0}, 60.0), ({"mu": 0.05}, 40.0), ({"rate_max": 5e3}, 5.0)):
        law = sampled(JerkTraction(definition="partial", **{**FREE, **limit}))
        assert float(np.sum(law.get("traction_demand"))) == pytest.approx(force, rel=1e-12)
        assert float(law.get("unlimited")) == 0
    law = sampled(JerkTraction(definition="partial", limits="motor", **{**FREE, "mu": 0.05}))
    assert float(np.sum(law.get("traction_demand"))) > 200


def test_the_speed_decides_where_no_force_changes_the_jerk() -> None:
    """Level ground: J_0 = J_1 = 0, no 0/0, but F_v = k_v (speed - v); without k_v there is no force."""
    level = {"slope": [0.0] * 4}
    law = sampled(JerkTraction(k_v=200.0, speed=1.3, rate_max=1e9), **level)
    assert float(np.sum(law.get("traction_demand"))) == pytest.approx(60.0, rel=1e-12)
    assert float(law.get("unlimited")) == 0
    assert not np.any(sampled(JerkTraction(), **level).get("traction_demand"))


def test_it_asks_for_nothing_while_an_axle_is_in_the_air() -> None:
    """The planar model stands on both axles: without one of them its force means nothing, whatever the limits are."""
    for loads in ([0.0, 0.0, 400.0, 400.0], [400.0, 400.0, 0.0, 0.0]):
        law = sampled(JerkTraction(limits="motor", **FREE), normal_force=loads)
        assert not np.any(law.get("traction_demand"))
        assert float(law.get("active")) == 0


def test_a_four_wheel_drive_shares_the_force() -> None:
    """``share`` on the front axle, evenly between its wheels."""
    law = sampled(JerkTraction(share=0.4, **FREE))
    frame = Frame(170.0, 47.0, 0.6, 0.46, 0.4, 0.1, share=0.4)
    force = ideal_force(frame, "body", 0.2, 1.0)
    np.testing.assert_allclose(law.get("traction_demand"), force * np.array([0.2, 0.2, 0.3, 0.3]), rtol=NEAR)
