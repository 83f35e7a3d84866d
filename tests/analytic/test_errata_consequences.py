"""The numbers that the register quotes as consequences: what the printed forms would give, and the right ones."""

from collections.abc import Callable

import control
import numpy as np
import pytest
from scipy.optimize import brentq

from controllers.pitch_plan import planned_pitch
from controllers.slip_model import slip_transfer_function
from plants.planar import Bicycle, Posture
from plants.pulses import Pulse
from plants.shock_loads import load_factor
from plants.tables import robot
from studies.errata import CONFIRMED, find
from studies.errata.algebra import value
from studies.errata.appendix_a import ETA
from studies.errata.chapter6 import settling

SIDE = Bicycle(robot("thesis_6_1"), "centre")
P = SIDE.P(Posture(0.3))
HARD = 5.6e6  # N/m


def printed(key: str, **names: float) -> float:
    (entry,) = find(key)
    return float(value(entry.printed, names)[0])


def springs(sign: int) -> np.ndarray:
    """Return A of 6.16 with the sign of the spring term."""
    return np.block([[np.zeros((2, 2)), np.eye(2)], [sign * P * HARD, np.zeros((2, 2))]])


def test_the_printed_law_on_the_printed_plant_grows_at_324() -> None:
    """6.8 and 6.9 as printed: z'' = v - K z, v = -h_0 z - h_1 z' - K z, K = -P k_w."""
    A = springs(1)
    A[2:] += np.hstack([P * HARD - 1500 * np.eye(2), -70 * np.eye(2)])
    assert max(np.linalg.eigvals(A).real) == pytest.approx(323.6, abs=0.05)
    assert sorted(np.sqrt(np.linalg.eigvals(P * HARD))) == pytest.approx([226.6, 253.8], abs=0.05)


def test_poles_placed_on_the_printed_plant_vibrate_on_the_robot() -> None:
    B = np.vstack([np.zeros((2, 2)), SIDE.U(Posture(0.3))])
    K = control.place(springs(1), B, [-30, -40, -50, -60])
    fastest = max(np.linalg.eigvals(springs(-1) - B @ K), key=lambda pole: pole.imag)
    assert (fastest.real, fastest.imag) == (pytest.approx(-50, abs=0.5), pytest.approx(359, abs=0.5))


def test_settling_and_overshoot_of_6_3() -> None:
    assert settling(70, 1500) == pytest.approx(84, abs=0.5)
    decay, swing = 65 / 2, np.sqrt(1500 - 65**2 / 4)
    t = np.linspace(0, 0.5, 500_001)
    e = np.exp(-decay * t) * (0.02 * np.cos(swing * t) + (-0.6 + 0.02 * decay) / swing * np.sin(swing * t))
    assert min(e) / 0.02 == pytest.approx(-0.017, abs=5e-4)


def test_the_printed_path_of_6_19_ends_above_the_ground() -> None:
    v_0, T, d = -0.6, 0.1, -0.02
    last = [printed("6.19 C_4", v_0=v_0, T=T, d=d), -3 * (-15 * v_0 * T + 28 * d) / T**5,
            2 * (-18 * v_0 * T + 35 * d) / T**6, printed("6.19 C_7", v_0=v_0, T=T, d=d)]  # fmt: skip
    assert np.polynomial.Polynomial([0, v_0, 0, 0, *last])(T) == pytest.approx(1.18, abs=5e-4)


def test_slip_speed_and_curvature() -> None:
    """3.15, 4.53 and the curvature after 4.54."""
    J_w, R, m = 0.1, 0.1, 5.0
    light = slip_transfer_function(2.0, R, J_w, m, 400.0, 8.0, 0.05, as_printed=True)
    assert J_w / R**2 > m  # the wheel is heavier than what it carries
    assert light.poles()[0].real > 0
    assert slip_transfer_function(2.0, R, J_w, m, 400.0, 8.0, 0.05).poles()[0].real < 0
    _, _, omega = SIDE.climbing_twist(Posture(0.2), 2.0)
    assert 1 - SIDE.robot.h * omega / 2 == pytest.approx(1.08, abs=0.005)
    assert 1 - np.cos(0.2) == pytest.approx(0.02, abs=5e-4)


def test_the_force_without_jerk_by_appendix_A() -> None:
    """Rear drive, 0.2 rad, 2 m/s, no pitch rate; bends of 1, 2 and 5 1/m."""
    right = {found.equation: found.printed for found in CONFIRMED}
    names = {"m": 170.0, "I_y": 47.0, "L_f": 0.6, "L_r": 0.46, "h": 0.4, "g": 9.81, "xi": 9.81, "gamma": 0.2,
             "F_f": 0.0, "v_x": 2.0, "v_z": 0.0, "omega": 0.0}  # fmt: skip

    def zero(form: Callable[[str], str], bend: float) -> float:
        def jerk(F: float) -> float:
            at = names | {"F_r": F}
            computed = lambda text: float(value(text, at)[0])  # noqa: E731
            Psi, slope = computed(right["A Psi"]), computed(right["A Psi'"])
            eta = sum(computed(term) for term in ETA)
            drive = F * (0.46 * 0.6 + 0.46**2) * np.cos(2 * 0.2)  # d(eta_2)/d(gamma), printed right
            changing = (Psi * (drive + computed(form("A eta_5'"))) - eta * slope) / Psi**2
            return changing * bend * 2.0 + 2.0 * computed(form("A.3 rho")) / Psi

        return jerk(0.0) / (jerk(0.0) - jerk(1.0))

    as_printed = [zero(lambda key: find(key)[0].printed, bend) for bend in (1, 2, 5)]
    corrected = [zero(lambda key: find(key)[0].right, bend) for bend in (1, 2, 5)]
    assert as_printed == pytest.approx([1129, 718, 402], abs=0.5)
    assert corrected == pytest.approx([357, 308, 288], abs=0.5)


def pitch_rates(t: float, beta: float, P_of: Callable[[float, float], np.ndarray]) -> tuple[float, float, float]:
    """Return p'' per traction, by gravity and by p'^2 for chapter 5 with the slope of 5.18 taken as gamma; T = 1."""
    bot = Bicycle(robot("thesis_5_1"), "centre")
    p, rate, _, _ = planned_pitch(t, beta)
    gamma = 0.5 * np.sin(np.pi * t)
    at = Posture(gamma + p, pitch=p)

    def p_dd(F: float, omega: float) -> float:
        traction = np.array([F, 0.0])
        normal = -np.linalg.solve(P_of(gamma, p), bot.U(at) @ traction + bot.b(at, np.array([0, 0, omega])))
        return -bot.accelerations(at, normal, traction)[2]

    still = p_dd(0, 0)
    return p_dd(1, 0) - still, still, p_dd(0, rate) - still


def test_the_pitch_of_1_38_s_by_the_text_of_chapter_5() -> None:
    """With the right P and the profile angle taken as seen from the body; by the printed P the gain changes sign."""
    bot = robot("thesis_5_1")
    sizes = {name: getattr(bot, name) for name in ("m", "I_y", "L_f", "L_r", "h")}
    derived = lambda gamma, p: Bicycle(bot).P(Posture(gamma + p, pitch=p))  # noqa: E731

    def shortest(beta: float) -> float:
        times = np.linspace(0.01, 0.99, 99)
        found = [pitch_rates(t, beta, derived) for t in times]
        wanted = [planned_pitch(t, beta).acceleration - turn for t, (_, _, turn) in zip(times, found, strict=True)]
        return float(np.sqrt(max(w / still for w, (_, still, _) in zip(wanted, found, strict=True))))

    assert brentq(lambda beta: shortest(beta) - 1.38, 0.5, 0.75, xtol=1e-3) == pytest.approx(0.63, abs=0.005)

    def in_print(gamma: float, p: float) -> np.ndarray:
        at = sizes | {"gamma": gamma, "p": p}
        P_22 = derived(gamma, p)[1, 1]
        return np.array([[printed("5.6 P_11", **at), printed("5.6 P_12", **at)], [printed("5.6 P_21", **at), P_22]])

    gains = [pitch_rates(t, 0.0433, in_print)[0] for t in np.linspace(0.003, 0.997, 60)]
    assert np.sum(np.diff(np.sign(gains)) != 0) == 2


def test_appendix_B_and_the_shock_paper() -> None:
    at = {"L_f": 0.6, "L_r": 0.46, "R": 0.1, "gamma": 0.5, "p": 0.02}
    (phi,) = find("B phi")
    assert 1 - printed("B phi", **at) / float(value(phi.right, at)[0]) == pytest.approx(0.12, abs=0.005)
    pulse = Pulse("rectangular", 0.15)
    assert load_factor(pulse, 1 / 3.98, 3.82) == pytest.approx(7.1, abs=0.05)
    assert load_factor(pulse, 0.3, 3.82) == pytest.approx(2.7, abs=0.05)
    assert 1000 * Pulse("rectangular", 0.05).series(3.0, 20.0).mean == pytest.approx(16.7, abs=0.05)
    assert 1 - np.sqrt(1 - 5e-5**2) == pytest.approx(1.2e-9, abs=1e-10)  # 7.21; D_t of C.6 is off by zeta^2 besides
