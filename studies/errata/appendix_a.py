"""Errors of Appendix A: the accelerations of the level robot on a ramp in closed form, and their slopes."""

from __future__ import annotations

from functools import cache

import sympy as sp

from .algebra import against, formula, numbers, symbols, with_values
from .erratum import MISPRINT, WRONG, Erratum
from .side_view import I_y, body_rates, level, m, side_view

_L = "(L_r + L_f)"
# What is right, term by term, each with sin = s and so on written out; omega is nose-down.
XI = (
    f"F_f*({_L}**2*cos(gamma) - h*{_L}*sin(gamma))",
    f"F_r*(-h*{_L}*sin(gamma)*cos(gamma) + {_L}**2*cos(gamma)**2)",
    f"m*sin(gamma)*cos(gamma)*(2*v_z*omega*h*{_L} - L_r*g*{_L} + h*omega**2*(L_f*L_r + L_r**2))",
    "m*sin(gamma)**2*(h*L_r*g + L_r*omega**2*(L_r*L_f - h**2) + v_z*omega*(L_f**2 + 2*L_r*L_f - h**2))",
    "-I_y*sin(gamma)**2*(v_z*omega - L_f*omega**2)",
    f"-m*v_z*omega*{_L}**2",
)
ETA = (
    f"F_f*L_r*{_L}*sin(gamma)",
    "F_r*(L_r*L_f + L_r**2)*sin(gamma)*cos(gamma)",
    f"m*(-2*v_x*omega*h*{_L} + omega**2*(2*h**2*L_f + 2*h**2*L_r - L_r*L_f**2 - L_f*L_r**2))*sin(gamma)*cos(gamma)",
    "I_y*(v_x*omega - omega**2*h)*sin(gamma)**2",
    "m*(v_x*omega*(h**2 - L_f**2 - 2*L_r*L_f) - L_r**2*g "
    "+ h*omega**2*(3*L_f*L_r + L_r**2 + L_f**2 - h**2))*sin(gamma)**2",
    f"m*(-h*omega**2 + v_x*omega)*{_L}**2",
)
RHO = (
    f"-F_f*{_L}*sin(gamma) - F_r*{_L}*sin(gamma)*cos(gamma) "
    f"+ m*(omega**2*(L_f*{_L}*sin(gamma)*cos(gamma) - h*{_L}*sin(gamma)**2) + L_r*g*sin(gamma)**2)"
)


@cache
def numerators() -> sp.Matrix:
    """Return Psi times v_x', v_z' and alpha_y; traction at the wheel centres, as in chapter 4."""
    return level(m**2 * I_y * side_view(sp.S.Zero).P.det() * body_rates(sp.S.Zero))[:3, :]


def term(row: int, right: tuple[str, ...], which: int) -> sp.Expr:
    """Return one term of a numerator: what the derivation leaves when the others are taken away."""
    return numerators()[row] - sum(formula(other) for k, other in enumerate(right) if k != which)


def slope(which: int) -> sp.Expr:
    """Return the derivative of a term of eta by gamma."""
    return sp.diff(term(1, ETA, which), sp.Symbol("gamma"))


def listed() -> tuple[dict, sp.Expr]:
    """Return a sum of six numbers under the names of the derivatives of eta_1 to eta_6."""
    values = numbers(6)
    return {f"d_eta_{k}_gamma": v for k, v in enumerate(values, 1)}, sum(values)


def normal_acceleration() -> sp.Expr:
    """Return a_cz in the symbols of print."""
    eta, Psi = symbols("eta Psi")
    beside = level(body_rates(sp.S.Zero))[4] - numerators()[1] / level(m**2 * I_y * side_view(sp.S.Zero).P.det())
    return eta / Psi + beside


_LISTED = " + ".join(f"d(eta_{k}, gamma)" for k in range(1, 6))

ENTRIES = (
    Erratum(
        equation="A.1 xi_4", chapter="A", where="Appendix A", kind=WRONG, left="xi_4",
        printed="m*sin(gamma)**2*(h*L_r*g + L_r*omega**2*(L_r*L_f - h**2) + v_z*omega*(L_f**2 + L_r*L_f - h**2))",
        right=XI[3],
        shown="Psi v_x' of the robot with two normal forces, less the other five terms. Psi and xi_1 to xi_3 are right",
        consequence="Fig 4.7 and 4.8 if they were computed with it", derive=against(lambda: term(0, XI, 3)),
    ),
    Erratum(
        equation="A.1 xi_5", chapter="A", where="Appendix A", kind=WRONG, left="xi_5",
        printed="-I_y*sin(gamma)**2*(v_z*omega + L_f*omega**2)", right=XI[4], shown="as xi_4",
        consequence="as xi_4", derive=against(lambda: term(0, XI, 4)),
    ),
    Erratum(
        equation="A.1 xi_6", chapter="A", where="Appendix A", kind=WRONG, left="xi_6",
        printed=f"-m*v_z*omega*{_L}", right=XI[5], shown="as xi_4; the units of the printed one do not fit",
        consequence="as xi_4", derive=against(lambda: term(0, XI, 5)),
    ),
    Erratum(
        equation="A.2 eta_1", chapter="A", where="Appendix A", kind=WRONG, left="eta_1",
        printed=f"F_f*{_L}*sin(gamma)", right=ETA[0],
        shown="Psi v_z', less the other five terms, which are right; the units of the printed one do not fit",
        consequence="front drive only", derive=against(lambda: term(1, ETA, 0)),
    ),
    Erratum(
        equation="A.3 rho", chapter="A", where="Appendix A", kind=WRONG, left="rho",
        printed=f"F_f*{_L}*sin(gamma) + F_r*{_L}*sin(gamma)*cos(gamma) "
        f"+ m*(omega**2*(-L_f*{_L}*sin(gamma)*cos(gamma) + h*{_L}*sin(gamma)**2) - L_r*g)",
        right=RHO,
        shown="Psi alpha_y. All terms have the nose-up sign, while A.1, A.2 and 4.51 count omega_y nose-down",
        consequence="the second term of the normal jerk has the wrong sign: as printed the appendix gives 1129, 718 "
        "or 402 N without jerk at 0.2 rad, for bends of 1, 2 or 5 1/m; without its errors 357, 308 or 288 "
        "N", derive=against(lambda: numerators()[2]),
    ),
    Erratum(
        equation="A.3 rho_3", chapter="A", where="Appendix A", kind=WRONG, left="rho_3",
        printed=f"m*(omega**2*(-L_f*{_L}*sin(gamma)*cos(gamma) + h*{_L}*sin(gamma)**2) - L_r*g)",
        right=f"m*(omega**2*(-L_f*{_L}*sin(gamma)*cos(gamma) + h*{_L}*sin(gamma)**2) - L_r*g*sin(gamma)**2)",
        shown="the same without traction, nose-up: gravity must vanish with the slope",
        consequence="as printed the robot pitches on the flat",
        derive=against(lambda: -numerators()[2].subs({"F_r": 0, "F_f": 0})),
    ),
    Erratum(
        equation="A.5", chapter="A", where="Appendix A", kind=MISPRINT, left="a_cz",
        printed="rho/Psi - v_x*omega", right="eta/Psi - v_x*omega",
        shown="the acceleration less the rate of v_z, eta/Psi; the jerk below it has it right",
        consequence="none", derive=against(normal_acceleration),
    ),
    Erratum(
        equation="A eta_1'", chapter="A", where="Appendix A", kind=WRONG, left="d(eta_1, gamma)",
        printed="F_f*(L_r*L_f + L_r**2)", right="F_f*(L_r*L_f + L_r**2)*cos(gamma)",
        shown="eta_1 differentiated", consequence="front drive only", derive=against(lambda: slope(0)),
    ),
    Erratum(
        equation="A eta_5'", chapter="A", where="Appendix A", kind=WRONG, left="d(eta_5, gamma)",
        printed="m*(v_x*omega*(h**2 - L_f**2 - 2*L_r*L_f) - L_r**2*xi "
        "+ h*omega**2*(3*L_f*L_r + L_r**2 + L_f**2 - h**2))*sin(gamma)*cos(gamma)",
        right="2*m*(v_x*omega*(h**2 - L_f**2 - 2*L_r*L_f) - L_r**2*g "
        "+ h*omega**2*(3*L_f*L_r + L_r**2 + L_f**2 - h**2))*sin(gamma)*cos(gamma)",
        shown="eta_5 differentiated: the factor 2 is lost, and xi stands for g",
        consequence="gravity's part of the jerk is halved", derive=against(lambda: slope(4)),
    ),
    Erratum(
        equation="A eta'", chapter="A", where="Appendix A", kind=MISPRINT, left="d(eta, gamma)",
        printed=f"{_LISTED} + d(eta_5, gamma)", right=f"{_LISTED} + d(eta_6, gamma)",
        shown="eta has six terms, the last one of which does not depend on gamma", consequence="none",
        derive=with_values(listed),
    ),
)  # fmt: skip
