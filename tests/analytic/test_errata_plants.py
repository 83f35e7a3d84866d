"""What we compute with are the right forms of the register: plants and controllers beside the formula on display."""

from dataclasses import fields
from typing import Any

import numpy as np
import pytest
import sympy as sp

from controllers.pitch_plan import coefficients, planned_pitch
from controllers.reference import planned
from controllers.slip_model import slip_transfer_function
from controllers.slope_estimator import body_slope
from controllers.state_space import impact_model, static_deflection
from plants.planar import Bicycle, Posture
from plants.pulses import Pulse
from plants.shock_fourier import coefficients as amplitudes
from plants.shock_fourier import printed_coefficients
from plants.shock_loads import Arms, rigid_reaction, still_reaction
from plants.tables import robot
from studies.errata import find
from studies.errata.algebra import value
from studies.errata.appendix_a import ETA, RHO, XI

ROBOT = robot("thesis_6_1")
CENTRE, GROUND = Bicycle(ROBOT, "centre"), Bicycle(ROBOT, "ground")
SIZES = {"m": ROBOT.m, "I_y": ROBOT.I_y, "L_f": ROBOT.L_f, "L_r": ROBOT.L_r, "h": ROBOT.h, "R": ROBOT.R, "g": 9.81}
NEAR = 1e-12  # relative: some fifty operations in double precision, each right to 1.1e-16, without much cancellation


def right(key: str, **names: Any) -> Any:
    """Return the right form of an entry for these values; a column as an array."""
    (entry,) = find(key)
    return computed(entry.right, **names)


def printed(key: str, **names: Any) -> Any:
    """Return the printed form."""
    (entry,) = find(key)
    return computed(entry.printed, **names)


def computed(form: str, **names: Any) -> Any:
    found = np.array(value(form, SIZES | names).evalf(), dtype=complex).ravel()
    found = found if np.any(found.imag) else found.real
    return found if len(found) > 1 else found[0]


def test_slip_transfer_function_3_15() -> None:
    slip, V_0, J_w, R, F_n, k, m = 0.05, 2.0, 0.1, 0.1, 400.0, 8.0, 42.5
    H = slip_transfer_function(V_0, R, J_w, m, F_n, k, slip)
    s = 3.0 + 40.0j
    names = {"V_0": V_0, "R": R, "J_w": J_w, "F_n": F_n, "k": k, "m": m, "omega_0": V_0 / (R * (1 - slip)), "s": s}
    assert H(s) == pytest.approx(right("3.15", **names), rel=NEAR)
    assert abs(H(s) / printed("3.15", **names) - 1) > 1e-3


@pytest.mark.parametrize("slope", [0.1, 0.3, 0.7])
def test_P_and_the_traction_arm_of_chapter_4(slope: float) -> None:
    P, A = CENTRE.P(Posture(slope)), CENTRE.U(Posture(slope)) - GROUND.U(Posture(slope))
    for element, key in (((0, 1), "4.44 P_12"), ((1, 0), "4.44 P_21")):
        assert P[element] == pytest.approx(right(key, gamma=slope), rel=NEAR)
        assert abs(P[element] / printed(key, gamma=slope) - 1) > 1e-3
    # a radius more of arm is R per I_y in pitch, times the moment of the normal forces
    arm = right("4.40 R_a2", gamma=slope) - printed("4.40 R_a2", gamma=slope)
    loads = np.array([ROBOT.L_r, ROBOT.h * np.sin(slope) - ROBOT.L_f * np.cos(slope)])
    np.testing.assert_allclose(A[:, 1], -arm * loads / ROBOT.I_y, rtol=1e-10)  # of a difference ten times smaller


@pytest.mark.parametrize("pitch", [-0.1, 0.15])
def test_P_of_chapter_5(pitch: float) -> None:
    P = CENTRE.P(Posture(0.4, pitch=pitch))
    for element, key in (((0, 0), "5.6 P_11"), ((0, 1), "5.6 P_12"), ((1, 0), "5.6 P_21")):
        assert P[element] == pytest.approx(right(key, p=pitch, gamma=0.4 - pitch), rel=NEAR)


@pytest.mark.parametrize("traction", [(0.0, 0.0), (180.0, -60.0)])
def test_accelerations_of_appendix_A(traction: tuple[float, float]) -> None:
    slope, twist = 0.35, np.array([1.7, 0.2, -0.6])
    names = dict(zip(("v_x", "v_z", "omega", "F_r", "F_f", "gamma"), (*twist, *traction, slope), strict=True))
    at, forces = Posture(slope), np.array(traction)
    a_x, a_z, alpha = CENTRE.accelerations(at, CENTRE.contact_forces(at, twist, forces), forces)
    numerators = [sum(computed(term, **names) for term in terms) for terms in (XI, ETA, (RHO,))]
    found = [a_x - twist[1] * twist[2], a_z + twist[0] * twist[2], alpha]
    # 100 NEAR: P, which the model inverts, has a condition of 30
    np.testing.assert_allclose(found, np.array(numerators) / CENTRE.psi(at), rtol=100 * NEAR)


def test_the_pitch_equation_of_appendix_B() -> None:
    p, theta = 0.12, 0.4
    of = coefficients(ROBOT, p, theta, ROBOT.R)
    Delta = float(GROUND.psi(Posture(theta, pitch=p)))
    assert of.Phi * Delta == pytest.approx(right("B phi", p=p, gamma=theta), rel=100 * NEAR)
    rate, kappa, v_t, F = 0.3, 0.8, 0.5, 120.0
    terms = {"Phi": of.Phi, "Gamma": of.Gamma, "Lam": of.Lambda, "K": of.K}
    planned_rate = right("5.11", F_r=F, p_d=rate, kappa=kappa, v_t=v_t, **terms)
    unit = GROUND.climbing_twist(Posture(theta, pitch=p), 1.0)
    twist = unit * (-rate / unit[2])
    along = _front_speed(twist, theta - p)
    at = Posture(theta, pitch=p, curvature=(0.0, kappa * (v_t / along) ** 2))
    forces = np.array([F, 0.0])
    alpha = GROUND.accelerations(at, GROUND.contact_forces(at, twist, forces), forces)[2]
    assert -alpha == pytest.approx(planned_rate, rel=100 * NEAR)


def _front_speed(twist: np.ndarray, gamma: float) -> float:
    v_x, v_z, omega = twist
    return float((v_x - omega * ROBOT.h) * np.cos(gamma) + (v_z - omega * ROBOT.L_f) * np.sin(gamma))


@pytest.mark.parametrize("bend", [0.0, 0.7])
def test_the_thesis_jerk_4_54_is_that_of_the_plant(bend: float) -> None:
    """Partial derivatives by complex steps of the plant's own accelerations; straight and bent slope."""
    slope, v_x, F, step = 0.25, 1.5, np.array([150.0, 0.0]), 1e-30
    at = Posture(slope, curvature=(0.0, bend))
    twist = CENTRE.climbing_twist(at, v_x)
    _, v_z, omega = twist
    along = _front_speed(twist, slope)

    def acceleration(theta: complex = 0, p: complex = 0, omega: complex = omega, b: complex = 0) -> np.ndarray:
        there = Posture(slope + theta, pitch=p)
        free = CENTRE.b(there, np.array([0.0, 0.0, omega])) - np.array([0, bend * along**2 + b])
        return CENTRE.accelerations(there, -np.linalg.solve(CENTRE.P(there), CENTRE.U(there) @ F + free), F)

    changed = {"theta": step * 1j, "p": step * 1j, "omega": omega + step * 1j, "b": step * 1j}
    slopes = {f"d_a_cz_{name}": acceleration(**{name: v})[1].imag / step for name, v in changed.items()}
    a_x, a_z, alpha = acceleration()
    rate = np.array([a_x - omega * v_z, a_z + v_x * omega, alpha])
    b_d = 2 * bend * along * _along_rate(twist, rate, slope, bend * along + omega)
    motion = {"v_t": along, "omega": omega, "alpha": alpha, "v_x": v_x, "v_z": v_z, "a_cx": a_x}
    expected = right("4.54", kappa=bend, b_d=b_d, **motion, **slopes)
    assert CENTRE.jerk(at, v_x, F).thesis == pytest.approx(expected, rel=100 * NEAR)


def _along_rate(twist: np.ndarray, rate: np.ndarray, gamma: float, turning: float) -> float:
    """Return the rate of the front speed along the slope, which turns against the body."""
    v_x, v_z, omega = twist
    across = -(v_x - omega * ROBOT.h) * np.sin(gamma) + (v_z - omega * ROBOT.L_f) * np.cos(gamma)
    return _front_speed(rate, gamma) + across * turning


def test_the_slope_estimator_4_56() -> None:
    for gamma, F_t, F_n in ((0.3, 120.0, 800.0), (0.0, 0.0, 500.0), (-0.2, -50.0, 300.0)):
        R_x = F_t * np.cos(gamma) - F_n * np.sin(gamma)
        R_y = F_t * np.sin(gamma) + F_n * np.cos(gamma)
        load = float(np.sqrt(R_x**2 + R_y**2 - F_t**2))
        by_register = right("4.56", R_x=R_x, R_y=R_y, F_t=F_t, F_n=load)
        assert float(body_slope(R_x, R_y, F_t)) == pytest.approx(by_register, abs=1e-14)
        assert by_register == pytest.approx(gamma, abs=1e-12)


def test_planned_paths_5_13_and_6_19() -> None:
    t, T, d, v_0 = 0.03, 0.1, -0.02, -0.6
    C = [0.0] * 8
    C[1], C[4], C[7] = v_0, right("6.19 C_4", v_0=v_0, T=T, d=d, d_0=0.0), right("6.19 C_7", v_0=v_0, T=T, d=d)
    C[5], C[6] = -3 * (-15 * v_0 * T + 28 * d) / T**5, 2 * (-18 * v_0 * T + 35 * d) / T**6
    assert planned(t, T, 0.0, v_0, d).z == pytest.approx(np.polynomial.Polynomial(C)(t), rel=NEAR)
    of_t_n = np.polynomial.Polynomial([0, 0, 0, 0, 35, -84, 70, -20])
    rate = of_t_n.deriv()(0.4)
    summed = {"total": lambda inside, over: rate, **{n: sp.Symbol(n) for n in ("i", "C_i", "t_n")}}
    assert planned_pitch(0.4, 1.0, 1.38).rate == pytest.approx(right("5.13", T=1.38, **summed), rel=NEAR)


def test_the_spring_of_chapter_6() -> None:
    """The model of the controllers has the A of 6.16, and its rest is where 6.15 accelerates nothing."""
    at, k_w = Posture(0.3), 2e5
    P, U = CENTRE.P(at), CENTRE.U(at)
    A = impact_model(P, U, k_w).A
    np.testing.assert_allclose(A[2:, :2], -k_w * P, rtol=NEAR)
    b = CENTRE.b(at, np.zeros(3))
    z = static_deflection(P, b, k_w)
    names = {"P": sp.Matrix(P), "z": sp.Matrix(z), "U": sp.Matrix(U), "F_a": sp.zeros(2, 1), "b_g": sp.Matrix(b)}
    np.testing.assert_allclose(right("6.15", k_w=k_w, **names), 0, atol=1e-12 * 9.81)
    assert np.linalg.norm(printed("6.15", k_w=k_w, **names)) > 1


def test_modes_and_pulses_of_chapter_7() -> None:
    w, zeta, p = np.array([[3.0]]), np.array([[0.3]]), np.array([2.0])
    ours, theirs = amplitudes(w, zeta, p), printed_coefficients(w, zeta, p)
    Psi = (9 - 4.0) ** 2 + (2 * 0.3 * 3 * 2) ** 2
    names = {"omega": 3.0, "zeta": 0.3, "p": 2.0, "omega_D": 3 * np.sqrt(1 - 0.09), "Psi": Psi}
    assert ours.A_t[0, 0] == pytest.approx(right("7.25 A_t", **names), rel=NEAR)
    assert theirs.A_t[0, 0] == pytest.approx(printed("7.25 A_t", **names), rel=NEAR)
    for name in (field.name for field in fields(ours)):  # all eight: right but for a common factor
        ratio = getattr(theirs, name) / getattr(ours, name)
        assert ratio[0, 0] == pytest.approx(np.sqrt(1 - 0.09), rel=NEAR), name
    assert ours.D_t[0, 0] == pytest.approx(right("C.6 D_t", **names), rel=NEAR)
    pulse = Pulse("rectangular", 0.05)
    assert pulse.transform(70.0) == pytest.approx(right("7.17", W=70.0, T=0.05), rel=NEAR)
    assert abs(pulse.transform(70.0) / printed("7.17", W=70.0, T=0.05) - 1) > 1e-3
    series = pulse.series(3.0, 20.0)
    summed = {"total": lambda inside, over: 0.0, "t": 0.0, **{n: sp.Symbol(n) for n in ("j", "a_j", "b_j", "p_j")}}
    assert series.mean == pytest.approx(right("7.20", a_0=2 * 0.05 / 3, **summed), rel=NEAR)


def test_reactions_of_chapter_8() -> None:
    arms, big = Arms(front=0.6, rear=0.46), robot("thesis_8_1")
    for bot in (ROBOT, big):
        found = rigid_reaction("four", arms, bot.m, bot.I_x, bot.I_y)
        names = {"m": bot.m, "I_y": bot.I_y, "l_f": 0.6, "l_r": 0.46, "r_1": 1.0}
        assert found == pytest.approx(right("8.11 spin", **names), rel=1e-9)  # -0.001 is a difference of 47 and 46.9
        assert still_reaction("four", arms) == pytest.approx(printed("8.11 spin", **names), rel=NEAR)
