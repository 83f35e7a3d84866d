"""Errors of chapter 6: the wheel as a spring, the law that controls its impact, the planned deformation."""

from __future__ import annotations

import re
from functools import cache
from math import log
from typing import Any

import numpy as np
import sympy as sp

from plants.planar import Bicycle, Posture
from plants.tables import robot

from .algebra import DIGITS, against, numbers, summation, symbols, value, with_values
from .erratum import INCOMPLETE, MISPRINT, WRONG, Erratum, Gap
from .side_view import CENTRES, level, p, side_view, turned

TIME = sp.Symbol("t")


def rebound(entry: Erratum) -> Gap:
    """Let a mass leave a spring and damper: when it passes their undeformed length, nothing may pull."""
    decay, swing = numbers(2)
    mass, x = sp.Rational(2), sp.exp(-decay * TIME) * sp.sin(swing * TIME)  # indentation: m x'' + c x' + k x = 0
    leaving = {TIME: sp.pi / swing}
    names = {"k": mass * (decay**2 + swing**2), "c": 2 * mass * decay, "x": x.subs(leaving)}
    names["x_d"] = sp.diff(x, TIME).subs(leaving)
    pull = names["c"] * abs(names["x_d"])
    return Gap(*(abs(float(value(form, names)[0] / pull)) for form in (entry.right, entry.printed)))


def spring() -> sp.Expr:
    """Return the deformation, compression negative, of a spring that pushes with F_n: minus the slope of its energy."""
    z, k_w, F_n = symbols("z k_w F_n")
    return sp.solve(-sp.diff(k_w * z**2 / 2, z) - F_n, z)[0]


def sprung_body(rest: bool = False) -> tuple[dict[str, Any], sp.Matrix]:
    """Return z'' of a robot on two springs on the flat, from its energies, and what 6.7 and 6.15 ask for.

    Lifted a little from its level position, or where its energy is least.
    """
    Z, pitch = q = sp.symbols("Z pitch")
    m, I_y, k_w, g = numbers(4)
    dimensions = dict(zip(symbols("L_f L_r h"), numbers(3, 8), strict=True))
    gaps = sp.Matrix([Z + turned(*c)[1].subs(p, pitch) for c in CENTRES]).subs(dimensions)
    gaps = gaps - gaps.subs({Z: 0, pitch: 0})
    slope = sp.Matrix([k_w * gaps.dot(gaps) / 2 + m * g * Z]).jacobian(q).T
    here = {Z: sp.Rational(1, 10), pitch: sp.S.Zero}
    if rest:
        lowest = sp.nsolve(list(slope), q, (0, 0), prec=DIGITS)
        here = {Z: lowest[0], pitch: lowest[1]}
    inverse, J = sp.diag(m, I_y).inv(), gaps.jacobian(q).subs(here)
    weight = J * inverse * sp.Matrix([-m * g, 0])
    names = {"P": J * inverse * J.T, "k_w": k_w, "z": gaps.subs(here), "b": weight}
    return names, -J * inverse * slope.subs(here)


def at_rest(entry: Erratum) -> Gap:
    """Put the deformations of the robot at rest, where its energy is least, into both forms: nothing accelerates."""
    names, _ = sprung_body(rest=True)
    given = names | {"U": sp.eye(2), "F_a": sp.zeros(2, 1), "b_g": names["b"]}
    return Gap(*(float(value(form, given).norm() / names["b"].norm()) for form in (entry.right, entry.printed)))


def poles_of_springs(entry: Erratum) -> Gap:
    """Compare how far the poles of a robot on undamped springs lie from the imaginary axis, relative to their size."""
    P = Bicycle(robot("thesis_6_1"), "centre").P(Posture(0.3))

    def growth(sign: int) -> float:
        A = np.block([[np.zeros((2, 2)), np.eye(2)], [sign * P * 5.6e6, np.zeros((2, 2))]])
        poles = np.linalg.eigvals(A)
        return float(np.max(np.abs(poles.real)) / np.max(np.abs(poles)))

    return Gap(growth(-1), growth(1), tolerance=1e-9)  # a 4 x 4 eigenproblem, entries from 1 to 1e5


def tracking_law() -> sp.Expr:
    """Return the v with which the error of z'' + K z = v dies out as e'' + h_1 e' + h_0 e = 0."""
    z, z_d, z_R, z_R_d, z_R_dd, h_0, h_1, K = symbols("z z_d z_R z_R_d z_R_dd h_0 h_1 K")
    z_dd = z_R_dd - h_1 * (z_d - z_R_d) - h_0 * (z - z_R)
    return z_dd + K * z


def settling(h_0: float, h_1: float) -> float:
    """Return how long an error takes to fall to 2 percent: the slower pole of s^2 + h_1 s + h_0 decides, s."""
    return float(log(50) / min(-np.roots([1, h_1, h_0]).real))


def numbers_in(words: str) -> list[float]:
    """Return the numbers after equal signs and before units in words."""
    return [float(found) for found in re.findall(r"(?<![\w.])\d[\d.]*(?:E\d+)?", words)]


def gains(entry: Erratum) -> Gap:
    """Compare the settling time of both pairs of gains with the tenth of a second of Fig 6.7."""
    off = lambda form: abs(settling(*numbers_in(form)) / 0.1 - 1)  # noqa: E731
    return Gap(off(entry.right), off(entry.printed), tolerance=0.5)  # "about one tenth of a second"


def rest_on_the_ramp(entry: Erratum) -> Gap:
    """Compare both deformations in mm, front first, with those under the weight on 0.3 rad, 5.6e6 N/m per axle."""
    at, side = Posture(0.3), Bicycle(robot("thesis_6_1"), "centre")
    rear, front = np.linalg.solve(side.P(at), side.b(at, np.zeros(3))) / 5.6e6 * 1e3
    off = lambda form: float(np.max(np.abs(np.divide(numbers_in(form)[:2], (-front, -rear)) - 1)))  # noqa: E731
    return Gap(off(entry.right), off(entry.printed), tolerance=0.05)  # two digits


def on_the_flat(entry: Erratum) -> Gap:
    """Return |det U| where both axles are on one plane, and 1 if it vanishes there."""
    singular = level(side_view().U.det()).subs(sp.Symbol("gamma"), 0).expand()
    return Gap(float(abs(singular)), float(singular == 0))


def critical_rate() -> tuple[dict[str, Any], sp.Expr]:
    """Return the h_1 at which s^2 + h_1 s + 1500 has a double root."""
    h_1 = sp.Symbol("h_1", positive=True)
    return {"h_0": 1500}, sp.solve(h_1**2 - 4 * 1500, h_1)[0]


def softer(entry: Erratum) -> Gap:
    """Compare both stiffnesses with 75 percent of the hard wheel's."""
    return Gap(*(abs(numbers_in(form)[0] / (0.75 * 5.6e6) - 1) for form in (entry.right, entry.printed)))


@cache
def path(start: sp.Expr = sp.S.Zero) -> list[sp.Expr]:
    """Return C_0 ... C_7 of the polynomial in t from *start* with the speed v_0 to rest at d at the time T."""
    v_0, T, d = symbols("v_0 T d")
    C = sp.symbols("C_0:8")
    planned = sum(c * TIME**i for i, c in enumerate(C))
    wanted = {0: (start, v_0, 0, 0), T: (d, 0, 0, 0)}
    conditions = [sp.diff(planned, TIME, k).subs(TIME, t) - v for t, ends in wanted.items() for k, v in enumerate(ends)]
    return list(sp.linsolve(conditions, C).args[0])


def planned_deformation() -> tuple[dict[str, Any], sp.Expr]:
    """Return the planned deformation at a time, and the coefficients of 6.19 with its sign put right."""
    v_0, T, d = symbols("v_0 T d")
    given = dict(zip((v_0, T, d, TIME), numbers(4), strict=True))
    C = [c.subs(given) for c in path()]
    names = {name: sp.Symbol(name) for name in ("i", "C_i")} | {"t": given[TIME], "t_n": given[TIME] / given[T]}
    names["total"] = summation([{"i": i, "C_i": c} for i, c in enumerate(C)])
    return names, sum(c * given[TIME] ** i for i, c in enumerate(C))


_RIGHT_LAW = "-h_0*(z - z_R) - h_1*(z_d - z_R_d) + z_R_dd + K*z"

ENTRIES = (
    Erratum(
        equation="6.2", chapter="6", where="6.1", kind=INCOMPLETE, left="F",
        printed="k*x + c*x_d", right="max(0, k*x + c*x_d)",
        shown="a mass that rebounds from spring and damper: when it leaves, the damper alone would hold it back",
        consequence="the linear models of this chapter let a wheel be pulled by the ground; with F_n >= 0 an "
        "uncontrolled wheel rebounds and the law must be switched off in the air",
        derive=rebound,
    ),
    Erratum(
        equation="6.6", chapter="6", where="6.2", kind=WRONG, left="z",
        printed="F_n/k_w", right="-F_n/k_w",
        shown="the energy of a spring. a_N = z'' counts z away from the ground, as do the -0.01 and -0.02 m of 6.3: "
        "compression is negative, and a wheel that is compressed pushes",
        consequence="6.7, 6.8, 6.15, 6.16", derive=against(spring), also=("impact paper 6",),
    ),
    Erratum(
        equation="6.7", chapter="6", where="6.2", kind=WRONG, left="z_dd",
        printed="P*k_w*z + b", right="-P*k_w*z + b",
        shown="a robot on two springs, accelerated down the slope of its energy",
        consequence="the printed robot is repelled: exponential growth in place of vibrations. K = -P k_w of 6.8 is "
        "+P k_w", derive=with_values(sprung_body), also=("6.8", "impact paper 7, 8"),
    ),
    Erratum(
        equation="6.9", chapter="6", where="6.2", kind=WRONG, left="v",
        printed="-h_0*(z - z_R) - h_1*(z_d - z_R_d) + z_R_dd - K*z", right=_RIGHT_LAW,
        shown="solved for the v that leaves e'' + h_1 e' + h_0 e = 0 of 6.11 in 6.8",
        consequence="with the printed K = -P k_w the two sign errors cancel, so printed tractions are usable; the law "
        "as printed on the plant as printed grows at 324 1/s",
        derive=against(tracking_law), also=("impact paper 9",),
    ),
    Erratum(
        equation="6.9 gains", chapter="6", where="6.3, text", kind=MISPRINT, left="",
        printed="h_0 = 70, h_1 = 1500", right="h_0 = 1500, h_1 = 70",
        shown="the poles of 6.11: the printed pair settles in 84 s, not in a tenth of a second; the captions of Fig "
        "6.5 and 6.6 have it right", consequence="none", derive=gains,
    ),
    Erratum(
        equation="6.9 z_R", chapter="6", where="6.3, text", kind=WRONG, left="",
        printed="z_R = -20 mm at the front, -10 mm at the rear", right="z_R = -0.15 mm at the front, -0.15 mm at the "
        "rear",
        shown="the deformation under the weight on 0.3 rad; the printed one needs 112 and 56 kN on a robot of 1.7 kN",
        consequence="tractions of 629 and -471 kN for as long as it lasts, and no disengaging",
        derive=rest_on_the_ramp, also=("impact paper, d",),
    ),
    Erratum(
        equation="6.11 critical", chapter="6", where="6.3, text", kind=WRONG, left="h_1",
        printed="65", right="2*sqrt(h_0)",
        shown="a double root of 6.11. At 65 the front passes its reference by 1.7 percent: an eye reading",
        consequence="below 77.5 the deformation overshoots; the wheel rebounds only below 3",
        derive=with_values(critical_rate), also=("impact paper, section 3: h_0 = 1550 should be h_1^2/4 = 1225",),
    ),
    Erratum(
        equation="6.14", chapter="6", where="6.2", kind=INCOMPLETE, left="",
        printed="F_a = U^-1 (v - b_g)", right="F_a = U^-1 (v - b_g) with both axles pressed, and on different slopes",
        shown="det U vanishes where both axles are on one plane: their tractions move the contacts alike",
        consequence="the law must be off before the ramp, on it, and whenever a wheel is in the air",
        derive=on_the_flat, also=("impact paper 12",),
    ),
    Erratum(
        equation="6.14 soft", chapter="6", where="6.3, Fig 6.9", kind=MISPRINT, left="",
        printed="the soft wheel has 4.1E6 N/m", right="the soft wheel has 4.2E6 N/m",
        shown="75 percent of 5.6E6 N/m, as the text says",
        consequence="2 percent of the traction", derive=softer,
    ),
    Erratum(
        equation="6.15", chapter="6", where="6.4", kind=WRONG, left="z_dd",
        printed="P*k_w*z + U*F_a", right="-P*k_w*z + U*F_a + b_g",
        shown="the standing robot, at the least of its energy, must not accelerate. Besides the sign of 6.6 the "
        "constant b_g is dropped: it does not depend on the states, but it sets their rest",
        consequence="states must be counted from the static deflection (0.15 mm for hard wheels), and so must "
        "references", derive=at_rest,
    ),
    Erratum(
        equation="6.16", chapter="6", where="6.4", kind=WRONG, left="",
        printed="A = (0, I; P k_w, 0)", right="A = (0, I; -P k_w, 0)",
        shown="springs without dampers neither give nor take energy: all poles lie on the imaginary axis",
        consequence="printed poles at +-226.6 and +-253.8 1/s, right ones at these frequencies in rad/s; poles that "
        "are placed at -50 1/s on the printed A come to lie at -50 +- 359j on the robot", derive=poles_of_springs,
    ),
    Erratum(
        equation="6.17", chapter="6", where="6.5", kind=MISPRINT, left="p",
        printed="total(C_i*t_n**i, i)", right="total(C_i*t**i, i)",
        shown="the C_i of 6.19 carry T^-i: they belong to real time, those of chapter 5 to t/T",
        consequence="none in the figures", derive=with_values(planned_deformation), also=("impact paper 13",),
    ),
    Erratum(
        equation="6.19 C_7", chapter="6", where="6.5", kind=WRONG, left="C_7",
        printed="-10*(v_0*T + 2*d)/T**7", right="-10*(-v_0*T + 2*d)/T**7",
        shown="the eight conditions solved; the other coefficients are right",
        consequence="for 0.1 s the printed reference ends 1.18 m above the ground in place of 20 mm in the rubber",
        derive=against(lambda: path()[7]), also=("impact paper, after 17",),
    ),
    Erratum(
        equation="6.19 C_4", chapter="6", where="6.5", kind=INCOMPLETE, left="C_4",
        printed="5*(-4*v_0*T + 7*d)/T**4", right="5*(-4*v_0*T + 7*(d - d_0))/T**4",
        shown="the conditions with p(0) = d_0, which the text gives the rear wheels; all C_i need d - d_0, C_0 = d_0",
        consequence="the rear wheels' reference jumps by their static deflection",
        derive=against(lambda: path(sp.Symbol("d_0"))[4]), also=("impact paper, after 17",),
    ),
)  # fmt: skip
