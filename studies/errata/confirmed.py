"""Printed equations that the derivations find right: so the method does not refute whatever it is given."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import sympy as sp

from .algebra import distance, formula, symbols
from .appendices_b_c import with_print
from .appendix_a import ETA, XI, term
from .chapter6 import path
from .chapter7 import stiffness
from .motion import rotation, t
from .papers import reaction_direction
from .side_view import I_y, from_body, gamma, in_body, level, m, normal_of, side_view, tangent_of, theta
from .vibration import DAMPED, left_side, time

RIGHT = 1e-20  # relative, of 30 digits: ten to spare for what cancels
_SIDE = sp.S.Zero  # traction at the wheel centres, as in the text of chapters 4 and 5


class Confirmed(NamedTuple):
    """An equation, its printed form and what it should be."""

    equation: str
    printed: str
    derive: Callable[[], sp.Basic]

    def gap(self) -> float:
        """Return how far the printed form lies from the derived one."""
        return distance(formula(self.printed), self.derive())


def _level(name: str, row: int, column: int = 0) -> Callable[[], sp.Basic]:
    return lambda: level(getattr(side_view(_SIDE), name)[row, column])


def _pitched(name: str, row: int, column: int = 0) -> Callable[[], sp.Basic]:
    return lambda: from_body(getattr(side_view(_SIDE), name)[row, column])


def _slip_change() -> sp.Expr:
    """Return the change of 3.1 with speed and spin."""
    V, spin, R, dV, dspin = symbols("V_0 omega_0 R Delta_V Delta_omega")
    slip = (R * spin - V) / (R * spin)
    return sp.diff(slip, V) * dV + sp.diff(slip, spin) * dspin


def _turning_velocity() -> sp.Matrix:
    """Return a_x and a_z of a velocity given in turning axes, differentiated in world axes."""
    v, v_d = (sp.Matrix(symbols(f"v_x{d} v_y{d} v_z{d}")) for d in ("", "_d"))
    angles = [rate * t for rate in symbols("omega_x omega_y omega_z")]
    a = sp.diff(rotation(*angles) * (v + v_d * t), t).subs(t, 0)
    return sp.Matrix([a[0], a[2]])


def _diagonal_reaction() -> sp.Expr:
    """Return r_3 of 8.3 and 8.4."""
    I_d, D, dt, d_f, d_r, r_1, r_3 = symbols("I_d Delta_omega Delta_t d_f d_r r_1 r_3")
    return sp.solve(I_d * D - (r_1 * d_f - r_3 * d_r) * dt, r_3)[0]


def _impulse_response() -> sp.Expr:
    """Return the free motion that starts with unit speed: its slope at 0 is 1 and the equation holds."""
    decay = sp.Symbol("d")
    trial = sp.exp(-decay * time) * sp.sin(DAMPED * time) / DAMPED
    return trial.subs(decay, sp.solve(left_side(trial).subs(time, 0), decay)[0])


def _amplification() -> sp.Expr:
    """Return 1 / |H(p)|^2: exp(j p t) and exp(-j p t) put into the equation of a mode."""
    waves = [sp.exp(sign * sp.I * sp.Symbol("p") * time) for sign in (1, -1)]
    return left_side(waves[0]) / waves[0] * left_side(waves[1]) / waves[1]


_EVEN = "(2*(L_f**2 + L_r*L_f)*cos(gamma)**2 - 2*h*(L_r + L_f)*cos(gamma)*sin(gamma) + L_r**2 - L_f**2)"
_ODD = "(2*(L_f**2 + L_r*L_f)*cos(gamma)*sin(gamma) - 2*h*(L_r + L_f)*sin(gamma)**2)"
_ARM_2, _LOAD_2 = "(h*cos(gamma) + L_f*sin(gamma))", "(h*sin(gamma) - L_f*cos(gamma))"
_ARM_1, _LOAD_1 = "(h*cos(p) + L_r*sin(p))", "(L_r*cos(p) - h*sin(p))"
_SQUARE = f"1/m + ({_LOAD_2}*h*sin(gamma) - {_LOAD_2}*L_f*cos(gamma))/I_y"

CONFIRMED = (
    Confirmed("3.8", "-1/(R*omega_0)*Delta_V + V_0/(R*omega_0**2)*Delta_omega", _slip_change),
    Confirmed(
        "4.5", "(-mu_r*cos(gamma)*cos(delta) + mu_l*sin(delta) - sin(gamma)*cos(delta), "
        "-mu_r*cos(gamma)*sin(delta) - mu_l*cos(delta) - sin(gamma)*sin(delta), -mu_r*sin(gamma) + cos(gamma))",
        reaction_direction,
    ),
    Confirmed("4.41 R_n2", "h*sin(gamma) - L_f*cos(gamma)", lambda: level(-I_y * side_view(_SIDE).N[2, 1])),
    Confirmed("4.38 n_2", "(-sin(gamma), cos(gamma))", lambda: level(in_body(normal_of(theta)))),
    Confirmed("4.43 U_11", "-h*L_r/I_y", _level("U", 0, 0)),
    Confirmed("4.43 U_21", "-sin(gamma)/m + (-h**2*sin(gamma) + h*L_f*cos(gamma))/I_y", _level("U", 1, 0)),
    Confirmed("4.43 U_12", "sin(gamma)/m - (h*cos(gamma) + L_f*sin(gamma))*L_r/I_y", _level("U", 0, 1)),
    Confirmed("4.43 U_22", f"(-{_ARM_2}*h*sin(gamma) + {_ARM_2}*L_f*cos(gamma))/I_y", _level("U", 1, 1)),
    Confirmed("4.44 P_11", "1/m + L_r**2/I_y", _level("P", 0, 0)),
    Confirmed("4.44 P_22", _SQUARE, _level("P", 1, 1)),
    Confirmed("4.46 G_2", "-g*cos(gamma)", _level("G", 1)),
    Confirmed("4.47 rear", "omega**2*h", _level("a_w", 0)),
    Confirmed("4.47 front", "omega**2*(L_f*sin(gamma) + h*cos(gamma))", _level("a_w", 1)),
    Confirmed(
        "4.51 a_cx, a_cz", "(v_x_d + v_z*omega_y - v_y*omega_z, v_z_d + v_y*omega_x - v_x*omega_y)", _turning_velocity
    ),
    Confirmed("5.1 A_1", "(cos(p), -sin(p))", lambda: in_body(tangent_of(_SIDE))),
    Confirmed("5.3 n_1", "(sin(p), cos(p))", lambda: in_body(normal_of(_SIDE))),
    Confirmed("5.4 R_n1", "-h*sin(p) + L_r*cos(p)", lambda: -I_y * side_view(_SIDE).N[2, 0]),
    Confirmed("5.5 U_11", f"({_ARM_1}*h*sin(p) - {_ARM_1}*L_r*cos(p))/I_y", _pitched("U", 0, 0)),
    Confirmed(
        "5.5 U_21", "(-cos(gamma)*sin(p) - sin(gamma)*cos(p))/m "
        f"+ (-{_ARM_1}*h*sin(gamma) + {_ARM_1}*L_f*cos(gamma))/I_y", _pitched("U", 1, 0),
    ),
    Confirmed(
        "5.5 U_12", "(cos(gamma)*sin(p) + sin(gamma)*cos(p))/m "
        f"+ ({_ARM_2}*h*sin(p) - {_ARM_2}*L_r*cos(p))/I_y", _pitched("U", 0, 1),
    ),
    Confirmed("5.5 U_22", f"(-{_ARM_2}*h*sin(gamma) + {_ARM_2}*L_f*cos(gamma))/I_y", _pitched("U", 1, 1)),
    Confirmed("5.6 P_22", _SQUARE, _pitched("P", 1, 1)),
    Confirmed("5.7 G_2", "g*(sin(p)*sin(gamma) - cos(p)*cos(gamma))", _pitched("G", 1)),
    Confirmed("5.8 rear", "omega**2*(L_r*sin(p) + h*cos(p))", _pitched("a_w", 0)),
    Confirmed("5.8 front", "omega**2*(L_f*sin(gamma) + h*cos(gamma))", _pitched("a_w", 1)),
    Confirmed("6.19 C_6", "2*(-18*v_0*T + 35*d)/T**6", lambda: path()[6]),
    Confirmed("6.19 C_5", "-3*(-15*v_0*T + 28*d)/T**5", lambda: path()[5]),
    Confirmed("7.2", "E*h**3/(12*(1 - nu**2))", stiffness),
    Confirmed("7.14", "exp(-zeta*omega*t)*sin(omega*sqrt(1 - zeta**2)*t)/(omega*sqrt(1 - zeta**2))", _impulse_response),
    Confirmed("7.25 Psi", "p**4 - 2*p**2*omega**2 + 4*zeta**2*p**2*omega**2 + omega**4", _amplification),
    Confirmed("8.5", "-I_d*Delta_omega/(d_r*Delta_t) + r_1*d_f/d_r", _diagonal_reaction),
    *(Confirmed(f"A.1 xi_{k}", XI[k - 1], partial(term, 0, XI, k - 1)) for k in (1, 2, 3)),
    *(Confirmed(f"A.2 eta_{k}", ETA[k - 1], partial(term, 1, ETA, k - 1)) for k in range(2, 7)),
    Confirmed(
        "A Psi", "m*(-2*h*(L_r + L_f)*sin(gamma)*cos(gamma) + (h**2 - 2*L_r*L_f - L_f**2)*sin(gamma)**2 "
        "+ 2*L_r*L_f + L_f**2 + L_r**2) + I_y*sin(gamma)**2",
        lambda: level(m**2 * I_y * side_view(_SIDE).P.det()),
    ),
    Confirmed(
        "A Psi'", "m*(2*h*(L_r + L_f)*(2*sin(gamma)**2 - 1) + 2*(h**2 - 2*L_r*L_f - L_f**2)*sin(gamma)*cos(gamma)) "
        "+ 2*I_y*sin(gamma)*cos(gamma)",
        lambda: sp.diff(level(m**2 * I_y * side_view(_SIDE).P.det()), gamma),
    ),
    Confirmed(
        "B Delta", f"I_y*sin(gamma)**2 + m*({_EVEN}*cos(p)**2 + {_ODD}*cos(p)*sin(p) + (L_f**2 + h**2)*sin(gamma)**2)",
        lambda: (m**2 * I_y * side_view(_SIDE).P.det()).subs(theta, gamma),
    ),
    Confirmed("B lambda", "sin(p)*sin(gamma)**2*m*g*h - cos(p)*sin(gamma)**2*m*g*L_r", lambda: with_print(2)),
)  # fmt: skip
