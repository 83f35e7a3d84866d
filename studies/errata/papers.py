"""Errors of the six papers that the thesis does not repeat: framework (Royal Society), shock, DYMAC, ASME and TIMR."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import sympy as sp

from .algebra import against, at, integral, numbers, summation, symbols, with_values
from .chapter4_general import slope_normal, steered
from .chapter6 import numbers_in
from .chapter8 import modal_forces
from .erratum import MISPRINT, WRONG, Erratum, Gap
from .rolling import rolling, s_d
from .side_view import body_rates, kappa, omega, p, theta

FRAMEWORK, SHOCK, ASME, DYMAC = "framework paper", "shock paper", "ASME paper", "DYMAC paper"


def reaction_direction() -> sp.Matrix:
    """Return n less mu_r along the heading and mu_l to its right, for a steered wheel on a slope."""
    gamma, delta, mu_r, mu_l = symbols("gamma delta mu_r mu_l")
    n = slope_normal()
    _, A = steered(sp.sin(gamma), sp.cos(gamma), sp.sin(delta), sp.cos(delta))
    return n - mu_r * A + mu_l * A.cross(n)


def all_wheels() -> tuple[dict[str, Any], sp.Matrix]:
    """Return the force of two wheels with tractions of their own."""
    columns, F_a = [sp.Matrix(numbers(3, k)) for k in (1, 2)], sp.Matrix(numbers(2))
    names = {"A_1": columns[0], "A_2": columns[1], "A": sp.Matrix.hstack(*columns), "F_a": F_a}
    return names, columns[0] * F_a[0] + columns[1] * F_a[1]


@cache
def rate_of_a_cz() -> tuple[dict[str, Any], sp.Expr]:
    """Return the rate of the body component a_z of a level robot with one coordinate, and partial derivatives."""
    motion, b = rolling(), sp.Symbol("b")
    given = symbols("m I_y L_f L_r h R g F_r F_f kappa s_d")
    place = dict(zip(given, numbers(len(given)), strict=True)) | {p: sp.S.Zero, theta: sp.Rational(3, 10)}
    felt = motion.rate(motion.along_body(motion.acceleration)[1])
    speed = motion.along_body(motion.speed)
    asked = sp.Matrix([motion.rate(motion.pitch), motion.s_dd, *speed, *motion.rate(speed), felt])
    p_d, s_dd, v_x, _, v_x_d, v_z_d, derived = at(motion.now(asked), place)
    rates = body_rates(bend=b)
    by = {"gamma": theta, "theta": theta, "p": p, "omega": omega, "b": b}
    there = place | {omega: -p_d, b: place[kappa] * place[s_d] ** 2}
    found = at(sp.Matrix([rates[2], *(sp.diff(rates[4], symbol) for symbol in by.values())]), there)
    names = dict(zip(("alpha", *(f"d_a_cz_{name}" for name in by)), found, strict=True))
    return names | {
        "d_a_cz_v_x": sp.S.Zero, "d_a_cz_v_z": sp.S.Zero,  # the acceleration does not depend on them
        "gamma_d": place[kappa] / sp.cos(place[theta]) * v_x, "v_x_d": v_x_d, "v_z_d": v_z_d, "omega": -p_d,
        "kappa": place[kappa], "v_t": place[s_d], "b_d": 2 * place[kappa] * place[s_d] * s_dd,
    }, derived  # fmt: skip


def from_rest() -> tuple[dict[str, Any], sp.Expr]:
    """Return Duhamel's integral of an undamped mode under sin(p t): a smooth integrand, to 30 digits."""
    w, rate, t = numbers(3)
    tau = sp.Symbol("tau")
    x = integral(sp.sin(rate * tau) * sp.sin(w * (t - tau)) / w, tau, sp.S.Zero, t)
    return {"omega": w, "p": rate, "t": t}, x


def forces_on_a_mode() -> tuple[dict[str, Any], sp.Expr]:
    """Return the work of four forces on the first mode, and its shape there."""
    names, work = modal_forces(single=False)
    terms = [{"phi_ik": names["Phi"][i, 0], "F_i": names["R"][i]} for i in range(4)]
    return {name: sp.Symbol(name) for name in ("phi_ik", "F_i", "i")} | {"total": summation(terms)}, work[0]


def steady_mode() -> tuple[dict[str, Any], sp.Expr]:
    """Return the amplitude of x'' + omega^2 x = f sin(p t) by putting x = X sin(p t) into it."""
    w, rate, f = numbers(3)
    X = sp.Symbol("X")
    return {"omega_k": w, "p_j": rate, "f_k": f}, sp.solve(-(rate**2) * X + w**2 * X - f, X)[0]


def largest_response(entry: Erratum) -> Gap:
    """Compare both factors with the largest omega^2 x of an undamped mode of 3.82 Hz under one pulse of 0.15 s."""
    w, t = 2 * np.pi * 3.82, np.linspace(0, 0.6, 60_001)
    step = lambda u: np.where(u > 0, 1 - np.cos(w * u), 0)  # noqa: E731
    largest = np.max(np.abs(step(t) - step(t - 0.15)))
    right, printed = (float(abs(numbers_in(form)[0] / largest - 1)) for form in (entry.right, entry.printed))
    return Gap(right, printed, tolerance=1e-6)  # the grid of times: (w dt)^2 / 8 of the peak


_N = "mu_l*sin(delta) - sin(gamma)*cos(delta), -mu_l*cos(delta) - sin(gamma)*sin(delta), -mu_r*sin(gamma) + cos(gamma)"

ENTRIES = (
    Erratum(
        equation="4 N", chapter="papers", source=FRAMEWORK, where="2", kind=WRONG, left="N",
        printed=f"({_N})",
        right="(-mu_r*cos(gamma)*cos(delta) + mu_l*sin(delta) - sin(gamma)*cos(delta), "
        "-mu_r*cos(gamma)*sin(delta) - mu_l*cos(delta) - sin(gamma)*sin(delta), -mu_r*sin(gamma) + cos(gamma))",
        shown="the normal, less rolling resistance along the heading, and the lateral force to its right; 4.5 of the "
        "thesis "
        "is right. Rolling resistance is left in the vertical component alone",
        consequence="none, it is neglected afterwards", derive=against(reaction_direction), also=("DYMAC paper 3",),
    ),
    Erratum(
        equation="5 A", chapter="papers", source=FRAMEWORK, where="2", kind=MISPRINT, left="F",
        printed="(A_1 + A_2)*F_a", right="A*F_a",
        shown="two wheels with tractions of their own: A is a row of columns, not their sum; 4.6 has it right",
        consequence="none", derive=with_values(all_wheels),
    ),
    Erratum(
        equation="6 J_cz", chapter="papers", source=ASME, where="2", kind=WRONG, left="J_cz",
        printed="d(a_cz, gamma)*gamma_d + d(a_cz, v_x)*v_x_d + d(a_cz, v_z)*v_z_d",
        right="d(a_cz, theta)*kappa*v_t - d(a_cz, p)*omega + d(a_cz, omega)*alpha + d(a_cz, b)*b_d",
        shown="the rate of the body component of the acceleration of a robot with one coordinate; b = kappa v_t^2. The "
        "acceleration depends on pitch and pitch rate, not on v_x and v_z",
        consequence="the force without jerk: 157 N by the printed one (160 N in Fig 3), and it is that of a_cz and the "
        "pitch, not of a_cx as is claimed", derive=with_values(rate_of_a_cz), also=("ASME paper 5, 7", "TIMR paper "
        "5, 6"),
    ),
    Erratum(
        equation="5 x", chapter="papers", source=SHOCK, where="2", kind=WRONG, left="x",
        printed="sin(p*t)/(omega**2 - p**2)", right="(sin(p*t) - p/omega*sin(omega*t))/(omega**2 - p**2)",
        shown="the integral for a force sin(p t): it starts from rest, so it holds a transient too, where the text "
        "calls it "
        "the steady-state response. (Printed with f(t) for f(tau).)",
        consequence="half of the response to a shock is left out", derive=with_values(from_rest),
    ),
    Erratum(
        equation="8 f_k", chapter="papers", source=SHOCK, where="2", kind=WRONG, left="f_k",
        printed="total(F_i, i)", right="total(phi_ik*F_i, i)",
        shown="the work of the forces on a mode; the series stands for F_i and lacks its mean, as 7.20",
        consequence="all modes would be excited alike; 10 has the shapes again", derive=with_values(forces_on_a_mode),
    ),
    Erratum(
        equation="10 x_k", chapter="papers", source=SHOCK, where="2", kind=WRONG, left="x_k",
        printed="f_k/(1 - p_j**2/omega_k**2)", right="f_k/omega_k**2/(1 - p_j**2/omega_k**2)",
        shown="sin(p t) put into the equation of a mode; also each row must have the omega of the mode k, not that "
        "of the row, "
        "and keep the phase of its harmonic",
        consequence="what is called a displacement is a force; Fig 4 shows it as a dynamic load",
        derive=with_values(steady_mode),
    ),
    Erratum(
        equation="9 factor", chapter="papers", source=SHOCK, where="3, text", kind=WRONG, left="",
        printed="a rectangular shock loads the first mode with 7.1 times its peak",
        right="a rectangular shock loads the first mode with 2.0 times its peak",
        shown="an undamped mode under one pulse. The printed factor is that of the first harmonic of a pulse "
        "repeated 3.98 "
        "times a second, beside a mode of 3.82 Hz: a resonance with the rate of repetition",
        consequence="Fig 4 and the conclusion; with a period of 0.3 s it would be 2.7", derive=largest_response,
    ),
)  # fmt: skip
