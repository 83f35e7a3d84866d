"""Errors of chapter 5: the pitch of a robot whose front wheels climb, and its planned trajectory."""

from __future__ import annotations

from functools import cache
from typing import Any

import sympy as sp

from .algebra import against, at, numbers, summation, symbols, with_values
from .erratum import INCOMPLETE, MISPRINT, WRONG, Erratum, Gap
from .rolling import rolling, s_d
from .side_view import (
    F_1,
    F_2,
    F_r,
    I_y,
    L_f,
    L_r,
    R,
    from_body,
    h,
    in_body,
    kappa,
    m,
    normal_of,
    p,
    side_view,
    theta,
)  # fmt: skip

TIME, DURATION = sp.symbols("t T")
PLAN = (-20, 70, -84, 35, 0, 0, 0, 0)  # the printed row, times beta


def coupling(row: int, column: int) -> sp.Expr:
    """Return an element of P by the slope seen from the body."""
    return from_body(side_view().P[row, column])


def front_normal() -> sp.Matrix:
    """Return the normal of the front slope in body axes, by the absolute slope."""
    x, z = in_body(normal_of(theta))
    return sp.Matrix([x, 0, z])


def nose_up_acceleration() -> tuple[dict[str, Any], sp.Expr]:
    """Return p'' of a body under traction and normal forces, and the moments the thesis multiplies them with."""
    given = symbols("m I_y L_f L_r h R g p theta F_r F_1 F_2")
    place = dict(zip(given, numbers(len(given)), strict=True))
    model = side_view(sp.S.Zero)
    p_dd = model.acceleration(sp.Matrix([F_1, F_2]), sp.Matrix([F_r, 0]))[2]
    gamma = place[theta] - place[p]
    sp_, cp, s, c = sp.sin(place[p]), sp.cos(place[p]), sp.sin(gamma), sp.cos(gamma)
    names = {
        "R_a1": -place[h] * cp - place[L_r] * sp_, "R_n1": -place[h] * sp_ + place[L_r] * cp,
        "R_n2": place[h] * s - place[L_f] * c, **{str(k): place[k] for k in (F_r, F_1, F_2, I_y)},
    }  # fmt: skip
    return names, at(sp.Matrix([p_dd]), place)[0]


@cache
def planned_acceleration() -> tuple[dict[str, Any], sp.Expr]:
    """Return p'' from the robot with one coordinate, on a bent slope, and the terms of 5.11."""
    motion = rolling()
    given = symbols("m I_y L_f L_r h R g p theta F_r F_f kappa s_d")
    place = dict(zip(given, numbers(len(given)), strict=True)) | {sp.Symbol("F_f"): sp.S.Zero}
    p_d = motion.rate(motion.pitch)
    rate, derived = at(motion.now(sp.Matrix([p_d, motion.rate(p_d)])), place)
    found = coefficients()
    of = dict(zip(("Phi", "Gamma", "Lam", "K"), at(found, {k: place[k] for k in given if found.has(k)}), strict=True))
    names = of | {"F_r": place[F_r], "p_d": rate, "kappa": place[kappa], "v_t": place[s_d]}
    return names, derived


@cache
def coefficients() -> sp.Matrix:
    """Return Phi, Gamma, Lambda and K of 5.11 from the model with contact forces: how p'' depends on its inputs."""
    model, bend, turn = side_view(), sp.Symbol("b"), sp.Symbol("omega")
    traction = sp.Matrix([F_r, 0])
    p_dd = model.acceleration(model.contact_forces(traction, bend), traction)[2]
    still = p_dd.subs({F_r: 0, bend: 0, turn: 0})
    return sp.Matrix([p_dd.diff(F_r), p_dd.diff(turn, 2) / 2, still, p_dd.diff(bend)])


def along_the_slope() -> sp.Expr:
    """Return the speed of the front wheel centre from its height, L sin(p) above the rear one."""
    p_d = sp.Symbol("p_d")
    return sp.diff((L_f + L_r) * sp.sin(p), p) * p_d / sp.sin(theta)


def polynomial(coefficients: tuple, time: sp.Expr) -> sp.Expr:
    """Return a polynomial of coefficients that begin with the constant."""
    return sum(c * time**i for i, c in enumerate(coefficients))


def first_rate() -> tuple[dict[str, Any], sp.Expr]:
    """Return the rate at t of a polynomial in t/T, and the sum that 5.13 prints for it."""
    C, T, t = numbers(8, 5), *numbers(2, 6)
    path = polynomial(tuple(C), TIME / DURATION)
    names = {name: sp.Symbol(name) for name in ("i", "C_i")} | {"t_n": t / T, "T": T}
    names["total"] = summation([{"i": i, "C_i": c} for i, c in enumerate(C)])
    return names, sp.diff(path, TIME).subs({TIME: t, DURATION: T})


def row_of_coefficients(entry: Erratum) -> Gap:
    """Put the row in both orders into the eight conditions of the plan."""

    def off(row: tuple) -> float:
        path = polynomial(row, TIME)
        ends = [sp.diff(path, TIME, k).subs(TIME, end) for end in (0, 1) for k in range(4)]
        return float(max(abs(a - b) for a, b in zip(ends, (0, 0, 0, 0, 1, 0, 0, 0), strict=True)))

    return Gap(off(PLAN[::-1]), off(PLAN))


def force_at_the_ends(entry: Erratum) -> Gap:
    """Compare the force of 5.17 right inside both ends with that at a tenth of the plan, and try it at the start."""
    path, slope = polynomial(PLAN[::-1], TIME) / 20, sp.sin(sp.pi * TIME) / 2
    table = ("270", "47", "0.6", "0.46", "0.4", "0.1", "9.81")  # Table 5.1, exact: Phi at the start is 0 by cancelling
    dimensions = dict(zip((m, I_y, L_f, L_r, h, R, sp.Symbol("g")), map(sp.Rational, table), strict=True))
    Phi, Gamma, Lam, _ = coefficients().subs(dimensions).subs({p: path, theta: slope}, simultaneous=True)
    quotient = sp.Matrix([sp.diff(path, TIME, 2) - Gamma * sp.diff(path, TIME) ** 2 - Lam, Phi])
    start, first, last, near = (at(quotient, {TIME: sp.Rational(t)}) for t in ("0", "1e-9", "0.999999999", "0.1"))
    small = max(abs(edge[0] / edge[1] / (near[0] / near[1])) for edge in (first, last))
    undefined = all(abs(a) < 1e-20 * abs(b) for a, b in zip(start, near, strict=True))
    return Gap(float(small), float("inf") if undefined else 0.0, tolerance=1e-6)  # F grows like t: 1e-8 of it at 1e-9


ENTRIES = (
    Erratum(
        equation="5.3 n_2", chapter="5", where="5.2", kind=INCOMPLETE, left="n_2",
        printed="(-sin(theta), 0, cos(theta))", right="(-sin(theta - p), 0, cos(theta - p))",
        shown="the normal of a slope turned into body axes. The gamma of 5.1 to 5.9 must be seen from the body, that "
        "of 5.18 and of Appendix B is absolute: one letter for theta - p and theta",
        consequence="with the profile angle of 5.18 put into 5.1 to 5.9 the manoeuvre of 1.38 s would pitch by "
        "0.63 rad in place of 0.043",
        derive=against(front_normal), also=("5.1", "5.2", "5.5", "5.7", "5.8", "5.9", "framework paper 34 to 45"),
    ),
    Erratum(
        equation="5.6 P_11", chapter="5", where="5.2", kind=WRONG, left="P_11",
        printed="1/m + ((-h*sin(p) + L_r*cos(p))*h*sin(p) + (-h*sin(p) + L_r*cos(p))*L_r*cos(p))/I_y",
        right="1/m + (-h*sin(p) + L_r*cos(p))**2/I_y",
        shown="as 4.44; the first product has the wrong sign",
        consequence="with 5.6 as printed the gain of the traction changes its sign twice and no time comes out",
        derive=against(lambda: coupling(0, 0)), also=("framework paper 42",),
    ),
    Erratum(
        equation="5.6 P_21", chapter="5", where="5.2", kind=WRONG, left="P_21",
        printed="sin(p - gamma)/m + ((h*sin(gamma) - L_f*cos(gamma))*h*sin(gamma) "
        "- (h*sin(gamma) - L_f*cos(gamma))*L_f*cos(gamma))/I_y",
        right="cos(p + gamma)/m + (L_r*cos(p) - h*sin(p))*(h*sin(gamma) - L_f*cos(gamma))/I_y",
        shown="as 4.44; P_22 is right",
        consequence="as P_11", derive=against(lambda: coupling(1, 0)), also=("framework paper 42",),
    ),
    Erratum(
        equation="5.6 P_12", chapter="5", where="5.2", kind=WRONG, left="P_12",
        printed="sin(p - gamma)/m - ((-h*sin(p) + L_r*cos(p))*h*sin(p) - (-h*sin(p) + L_r*cos(p))*L_r*cos(p))/I_y",
        right="cos(p + gamma)/m + (L_r*cos(p) - h*sin(p))*(h*sin(gamma) - L_f*cos(gamma))/I_y",
        shown="as 4.44; the printed second term is that of P_11, with the right sign there",
        consequence="as P_11", derive=against(lambda: coupling(0, 1)), also=("framework paper 42",),
    ),
    Erratum(
        equation="5.10", chapter="5", where="5.2", kind=WRONG, left="p_dd",
        printed="(R_a1*F_r + R_n1*F_1 + R_n2*F_2)/I_y", right="-(R_a1*F_r + R_n1*F_1 + R_n2*F_2)/I_y",
        shown="the work of the forces when the pitch grows. 5.1 and 5.7 count p nose-up, the moments are nose-down",
        consequence="none in the figures: Appendix B is nose-up", derive=with_values(nose_up_acceleration),
        also=("4.50 together with 5.11", "framework paper, text after 45"),
    ),
    Erratum(
        equation="5.11", chapter="5", where="5.2", kind=INCOMPLETE, left="p_dd",
        printed="Phi*F_r + Gamma*p_d**2 + Lam", right="Phi*F_r + Gamma*p_d**2 + Lam + K*kappa*v_t**2",
        shown="the motion of a robot with one coordinate on a bent slope; K = m (cos(theta) R_n1 - R_n2)/D",
        consequence="Fig 5.4 and 5.5: 1.38 s belong to a pitch of 0.064 rad with it, of 0.043 without",
        derive=with_values(planned_acceleration), also=("5.16", "5.17", "B.1", "framework paper 46, 51, 52"),
    ),
    Erratum(
        equation="5.13", chapter="5", where="5.3", kind=WRONG, left="p_d",
        printed="total(i*C_i*t_n**(i - 1), i)", right="total(i*C_i*t_n**(i - 1), i)/T",
        shown="a polynomial in t/T differentiated by t; 5.14 needs 1/T^2 and 5.15 needs 1/T^3",
        consequence="without them the manoeuvre time T would not matter in Fig 5.4 and 5.5",
        derive=with_values(first_rate), 
        also=("5.14", "5.15", "6.18", "framework paper 48 to 50", "impact paper 14 to 16"),
    ),
    Erratum(
        equation="5.15 C", chapter="5", where="5.3, text", kind=MISPRINT, left="",
        printed="C_i, i = 0 ... 7, are (-20, 70, -84, 35, 0, 0, 0, 0) beta",
        right="C_i, i = 7 ... 0, are (-20, 70, -84, 35, 0, 0, 0, 0) beta",
        shown="the eight conditions on p(0) ... p'''(1)", consequence="none",
        derive=row_of_coefficients, also=("framework paper, text after 50",),
    ),
    Erratum(
        equation="5.17", chapter="5", where="5.3", kind=INCOMPLETE, left="",
        printed="F_r = (p'' - Gamma p'^2 - Lambda)/Phi on [0, 1]",
        right="F_r = (p'' - Gamma p'^2 - Lambda)/Phi inside (0, 1), and its limit 0 at both ends",
        shown="Phi vanishes with the slope at both ends of 5.18: the quotient is 0/0 there, and F grows like the "
        "distance",
        consequence="the ends of the curves in Fig 5.4 and 5.5", derive=force_at_the_ends,
        also=("framework paper 52",),
    ),
    Erratum(
        equation="5.18", chapter="5", where="5.3", kind=INCOMPLETE, left="v_t",
        printed="v", right="(L_f + L_r)*cos(p)*p_d/sin(theta)",
        shown="the height of the front wheel centre. Slope and pitch over time fix the speed, which the chapter leaves "
        "free: with this slope and this plan the robot is at rest at both ends",
        consequence="the wheel-centre path bends without bound at both ends, so the manoeuvre of Fig 5.3 to 5.5 cannot "
        "be driven",
        derive=against(along_the_slope), also=("framework paper 53",),
    ),
)  # fmt: skip
