"""Deformable wheels against closed forms: oscillators, bounces, damping, release, friction.

One long step is one integration; the integrator's tolerance is 1e-10, and errors grow over a few oscillations to some
hundred times that: results are compared to 1e-7.
"""

from typing import Any

import numpy as np
import pytest

from cosim.twin import PythonInstance
from plants.wheel_deformation import WheelDeformation

NS = 1_000_000_000
RTOL = 1e-7
K = 2e5  # N/m
MASS = np.array([30.0, 40.0, 50.0, 60.0])  # kg, at each wheel when P is diagonal
P = np.diag(1 / MASS)
OMEGA = np.sqrt(K / MASS)
G = 9.81
# A coupled, positive definite P as of a body with unequal wheels; symmetric.
COUPLED = np.array([[30, 4, -6, 2], [4, 26, 3, -5], [-6, 3, 22, 6], [2, -5, 6, 28]]) * 1e-3


def wheels(gap: Any, gap_rate: Any, *, P: np.ndarray = P, b: Any = 0.0, **values: Any) -> PythonInstance:
    parameters = {n: values.pop(n) for n in tuple(values) if n in ("c_w", "mu", "C_alpha", "v_min")}
    instance = WheelDeformation(k_w=K, **parameters).instance("wheels")
    instance.enter_initialization(0, None, 1e-10)
    for name, value in {"gap": gap, "gap_rate": gap_rate, "P": P, "b_free": b, **values}.items():
        instance.set(name, np.broadcast_to(value, instance.variables[name].shape))
    instance.exit_initialization()
    return instance


def after(instance: PythonInstance, time: float) -> PythonInstance:
    instance.step(0, round(time * NS))
    return instance


def close(actual: Any, wanted: Any, size: Any) -> None:
    np.testing.assert_allclose(actual, wanted, rtol=0, atol=RTOL * np.max(np.abs(size)))


def test_a_pressed_wheel_swings_about_its_static_deflection() -> None:
    rest, amplitude, t = -G / OMEGA**2, 1e-4, 0.1
    w = after(wheels(rest - amplitude, 0.0, b=-G), t)
    close(w.get("deformation"), rest - amplitude * np.cos(OMEGA * t), rest)
    close(w.get("deformation_rate"), amplitude * OMEGA * np.sin(OMEGA * t), amplitude * OMEGA)
    close(w.get("normal_force_end"), -K * w.get("deformation"), MASS * G)


def test_coupled_wheels_rest_at_the_static_deflection() -> None:
    """z_s = P^-1 b / k_w (with b < 0): P F_n + b = 0."""
    b = -COUPLED @ np.array([300.0, 350.0, 420.0, 380.0])
    w = after(wheels(np.linalg.solve(COUPLED, b) / K, 0.0, P=COUPLED, b=b), 0.2)
    close(w.get("normal_force"), [300.0, 350.0, 420.0, 380.0], 400)
    close(w.get("deformation_rate"), np.zeros(4), 1e-3)


@pytest.mark.parametrize("mode", range(4))
def test_coupled_wheels_swing_with_the_eigenfrequencies_of_k_P(mode: int) -> None:
    eigenvalues, modes = np.linalg.eigh(K * COUPLED)
    b = np.full(4, -12.0)
    rest = np.linalg.solve(COUPLED, b) / K
    swing, t = 1e-4 * modes[:, mode], 0.1
    w = after(wheels(rest + swing, 0.0, P=COUPLED, b=b), t)
    close(w.get("deformation"), rest + swing * np.cos(np.sqrt(eigenvalues[mode]) * t), rest)


def test_a_damped_wheel_decays_with_its_damping_ratio() -> None:
    zeta = np.array([0.05, 0.1, 0.3, 0.7])
    rest, amplitude, t = -G / OMEGA**2, 1e-4, 0.05
    w = after(wheels(rest + amplitude, 0.0, b=-G, c_w=2 * zeta * K / OMEGA), t)
    ringing = OMEGA * np.sqrt(1 - zeta**2)
    shape = np.cos(ringing * t) + zeta / np.sqrt(1 - zeta**2) * np.sin(ringing * t)
    close(w.get("deformation"), rest + amplitude * np.exp(-zeta * OMEGA * t) * shape, rest)


def test_a_bouncing_wheel_leaves_and_returns_on_time() -> None:
    """Touching at -v, a wheel leaves at +v after (2 / omega)(pi - atan(omega v / g)), and flies for 2 v / g."""
    v = 0.3
    leave = 2 / OMEGA * (np.pi - np.arctan(OMEGA * v / G))
    back = leave + 2 * v / G

    def touching(t: Any) -> np.ndarray:
        return -G / OMEGA**2 * (1 - np.cos(OMEGA * t)) - v / OMEGA * np.sin(OMEGA * t)

    def flying(t: Any) -> np.ndarray:
        return v * t - G / 2 * t**2

    margin = 1e-6  # s, contact must change within this of the closed form
    for k in range(4):
        for event, before, behind in ((leave[k], 1, 0), (back[k], 0, 1)):
            assert after(wheels(0.0, -v, b=-G), event - margin).get("contact")[k] == before
            assert after(wheels(0.0, -v, b=-G), event + margin).get("contact")[k] == behind
    t = float(np.min(leave)) / 2
    close(after(wheels(0.0, -v, b=-G), t).get("deformation"), touching(t), 1e-3)
    t = float(np.max(leave)) + 0.01
    assert np.all(t < back)
    close(after(wheels(0.0, -v, b=-G), t).get("deformation"), flying(t - leave), 1e-2)
    t = float(np.max(back)) + 0.005
    close(after(wheels(0.0, -v, b=-G), t).get("deformation"), touching(t - back), 1e-2)


def test_a_damped_wheel_is_released_before_it_has_regained_its_shape() -> None:
    """Without other forces z'' = 0 at release: tan(w t) = 2 s w / (s^2 - w^2) with decay s and ringing frequency w."""
    v, zeta = 0.5, np.array([0.1, 0.3, 0.5, 0.8])
    decay, ringing = zeta * OMEGA, OMEGA * np.sqrt(1 - zeta**2)
    release = np.arctan2(2 * decay * ringing, decay**2 - ringing**2) / ringing
    fading = v * np.exp(-decay * release)
    z = -fading / ringing * np.sin(ringing * release)
    rate = -fading * (np.cos(ringing * release) - decay / ringing * np.sin(ringing * release))
    assert np.all(z < 0)
    t = float(np.max(release)) + 1e-3
    w = after(wheels(0.0, -v, c_w=2 * zeta * K / OMEGA), t)
    close(w.get("deformation_rate"), rate, v)
    close(w.get("deformation"), z + rate * (t - release), 1e-2)
    np.testing.assert_array_equal(w.get("contact"), 0)
    assert np.any(w.get("deformation") < 0)  # one at least is still pressed, and does not push
    # All energy is back in motion or dissipated, what is left in a pressed spring excepted.
    stored = K * np.minimum(w.get("deformation"), 0) ** 2 / 2
    close(w.get("dissipated_energy"), np.sum(MASS * (v**2 - rate**2) / 2 - stored), np.sum(MASS * v**2 / 2))


@pytest.mark.parametrize("rate", [-0.2, 0.0, 0.2])
def test_a_step_may_begin_with_a_wheel_just_touching(rate: float) -> None:
    """With gap == 0 the indicator is 0: down, at rest and up from there follow the closed forms."""
    t = 2e-3
    w = after(wheels(0.0, rate, b=-G), t)
    touching = -G / OMEGA**2 * (1 - np.cos(OMEGA * t)) + rate / OMEGA * np.sin(OMEGA * t)
    close(w.get("deformation"), touching if rate <= 0 else rate * t - G / 2 * t**2, 1e-3)


def test_the_mean_force_carries_the_momentum() -> None:
    """A full bounce without gravity returns 2 m v; the mean is that over the step."""
    v, t = 0.3, 0.2
    w = after(wheels(0.0, -v), t)
    close(w.get("normal_impulse"), 2 * MASS * v, 2 * MASS * v)
    np.testing.assert_allclose(w.get("normal_force") * t, w.get("normal_impulse"), rtol=1e-12)


@pytest.mark.parametrize("sign", [1, -1])
def test_traction_follows_the_demand_where_friction_allows(sign: int) -> None:
    """Over half a sine of force, clip(D, mu F) is the sine below D = mu F_max sin(a), and D for pi - 2 a of it."""
    v, mu, demand = 0.3, 0.5, 300.0
    peak = mu * K * v / OMEGA
    assert np.all(peak > demand)
    a = np.arcsin(demand / peak)
    half = float(np.max(np.pi / OMEGA)) + 1e-3
    w = after(wheels(0.0, -v, mu=mu, traction_demand=sign * demand), half)
    wanted = sign * (2 * peak * (1 - np.cos(a)) + demand * (np.pi - 2 * a)) / OMEGA / half
    close(w.get("traction"), wanted, peak)


def test_traction_acts_on_the_deformation_through_U() -> None:
    U = np.array([[0.004] * 4] * 2 + [[-0.003] * 4] * 2)
    demand, t, rest = 20.0, 0.05, -G / OMEGA**2
    w = after(wheels(rest, 0.0, b=-G, U=U, traction_demand=demand), t)
    lifted = U @ np.full(4, demand) / OMEGA**2
    close(w.get("traction"), np.full(4, demand), demand)
    close(w.get("deformation"), rest + lifted * (1 - np.cos(OMEGA * t)), rest)


def test_sideslip_pushes_back_with_the_cornering_stiffness() -> None:
    """For small angles F_l = -C_alpha v_l / |v_a|: off by (v_min / v_a)^2 / 2, alpha^2 / 3 and (S / room)^2 / 2."""
    velocity = np.array([[2.0, 1e-3], [2.0, -1e-3], [-2.0, 1e-3], [2.0, 0.0]])
    w = after(wheels(-G / OMEGA**2, 0.0, b=-G, contact_velocity=velocity, C_alpha=5e3, v_min=0.01), 1e-2)
    wanted = -5e3 * velocity[:, 1] / 2.0
    np.testing.assert_allclose(w.get("lateral"), wanted, rtol=1e-4, atol=0)  # largest: (2.5 N / 235 N)^2 / 2 = 6e-5
    close(w.get("sliding_energy"), -w.get("lateral") @ velocity[:, 1] * 1e-2, 1e-4)


def test_strong_sideslip_takes_all_that_the_traction_leaves() -> None:
    """F_l -> sqrt((mu F_n)^2 - F_a^2): at S = 100 room the law is 5e-5 below it."""
    load, demand, mu = MASS * G, 100.0, 0.8
    velocity = np.tile([0.0, 1.0], (4, 1))
    w = after(wheels(-load / K, 0.0, b=-G, contact_velocity=velocity, C_alpha=1e5, mu=mu, traction_demand=demand), 1e-2)
    np.testing.assert_allclose(w.get("lateral"), -np.sqrt((mu * load) ** 2 - demand**2), rtol=1e-4)


def test_before_the_first_step_the_force_is_that_of_the_start_values() -> None:
    instance = WheelDeformation(k_w=K, c_w=100.0).instance()
    instance.set("z", np.array([-1e-3, -2e-3, 0.0, 1e-3]))
    instance.set("z_rate", np.array([-0.1, 3.0, 0.0, -1.0]))
    np.testing.assert_allclose(instance.get("normal_force"), [210.0, 100.0, 0.0, 0.0], rtol=1e-14)
    np.testing.assert_array_equal(instance.get("traction"), 0)
    np.testing.assert_array_equal(instance.get("lateral"), 0)


def test_outputs_are_read_from_states_alone() -> None:
    """No input feeds through: the body, whose outputs the wheels read, closes no algebraic loop."""
    assert set(WheelDeformation().equations.feedthrough.values()) == {()}


def test_the_event_separates_pushing_from_not_pushing() -> None:
    """The indicator has the sign of what the force depends on, so no kink of the force lies inside an integration."""
    instance = WheelDeformation(k_w=K, c_w=500.0).instance()
    zero = instance.eq.zero
    assert zero is not None
    rng = np.random.default_rng(8)
    pushing = 0
    for _ in range(500):
        instance.set("z", rng.uniform(-2e-3, 1e-3, 4))
        instance.set("z_rate", rng.uniform(-1, 1, 4))
        indicator = np.asarray(zero(0, 0, instance.x, instance.u, instance.p, [], [])).ravel()
        np.testing.assert_array_equal(indicator > 0, instance.get("normal_force_end") > 0)
        pushing += int(np.sum(indicator > 0))
    assert 200 < pushing < 1800
