"""Errors of Appendix B, the pitch equation by the absolute slope and nose-up, and of Appendix C, a mode's response."""

from __future__ import annotations

from typing import Any

import sympy as sp

from .algebra import against, numbers, with_values
from .chapter5 import coefficients
from .chapter7 import of_amplitude
from .erratum import WRONG, Erratum
from .side_view import I_y, gamma, m, side_view, theta


def with_print(which: int) -> sp.Expr:
    """Return Phi, Gamma, Lambda or K times Delta, in the letters of print."""
    return (coefficients()[which] * m**2 * I_y * side_view().P.det()).subs(theta, gamma)


def without_radius() -> tuple[dict[str, Any], sp.Expr]:
    """Return Gamma times Delta, and the tau of print, at a posture."""
    L_f, L_r, h, R, mass, turn, pitch = numbers(7)
    s, c, sp_, cp = sp.sin(turn), sp.cos(turn), sp.sin(pitch), sp.cos(pitch)
    even = 2 * (L_f**2 + L_r * L_f) * c**2 - 2 * h * (L_r + L_f) * c * s + L_r**2 - L_f**2
    names = {
        "tau_1": (L_f * (c - 1) * s - h * s**2) * sp_,
        "tau_2": (-(L_r + L_f) * c + h * (1 - c) * s + L_f * c**2 + L_r) * cp,
        "tau_3": even * cp * sp_,
        "tau_4": (L_f**2 + L_r * L_f) * c * s - h * (L_f + L_r) * s**2,
        "tau_5": -(2 * (L_f**2 + L_r * L_f) * c * s - 2 * h * (L_r + L_f) * s**2) * cp**2,
        "m": mass, "R": R,
    }  # fmt: skip
    values = dict(zip(sp.symbols("L_f L_r h R m gamma p"), (L_f, L_r, h, R, mass, turn, pitch), strict=True))
    return names, with_print(1).subs(values).subs(I_y, numbers(1, 9)[0])


ENTRIES = (
    Erratum(
        equation="B phi", chapter="B", where="Appendix B", kind=WRONG, left="phi",
        printed="(L_r + L_f)*(sin(gamma)**2*sin(p) + cos(gamma)**2*sin(gamma)) + R*sin(gamma)**2",
        right="(L_r + L_f)*(sin(gamma)**2*sin(p) + sin(gamma)*cos(gamma)*cos(p)) + R*sin(gamma)**2",
        shown="Delta times the pitch acceleration per traction at the ground; the framework paper prints cos(gamma) "
        "for "
        "cos(p) in another order",
        consequence="8 percent of the traction of Fig 5.4 at half the climb; not the shortest time, which is set by "
        "gravity",
        derive=against(lambda: with_print(0)), also=("framework paper, Appendix A",),
    ),
    Erratum(
        equation="B tau", chapter="B", where="Appendix B", kind=WRONG, left="tau",
        printed="(tau_1 + tau_2)*m*R + (tau_3 + tau_4 + tau_5)*m", right="(tau_3 + tau_4 + tau_5)*m",
        shown="Delta times the coefficient of p'^2 if the wheel centre keeps to its path; tau_1 and tau_2 come from "
        "treating "
        "the touching point as a point of the body, which a rolling wheel does not have. Delta and lambda are right",
        consequence="small: R p'^2 beside the lengths of the robot",
        derive=with_values(without_radius), also=("framework paper, Appendix A",),
    ),
    Erratum(
        equation="C.6 D_t", chapter="C", where="Appendix C", kind=WRONG, left="D_t",
        printed="(p**2*sqrt(1 - zeta**2) - omega**2*zeta**2*sqrt(1 - zeta**2) - omega**2*(1 - zeta**2)**(1/2))/Psi",
        right="(p**2 - omega**2)/Psi",
        shown="undetermined coefficients; the exponent is 3/2 in 7.29, where only the common factor is wrong. As "
        "printed the "
        "response does not start at zero. D_s is not printed at all",
        consequence="2.5e-9 at the damping of Table 8.1", derive=of_amplitude("cos", 1),
    ),
)  # fmt: skip
