"""Errors of sections 4.3 to 4.6: a robot on a ramp seen from the side, its jerk, and the slope from axle forces."""

from __future__ import annotations

from functools import cache
from typing import Any

import mpmath
import sympy as sp

from .algebra import DIGITS, against, at, distance, formula, numbers, symbols, with_values
from .erratum import INCOMPLETE, MISPRINT, WRONG, Erratum, Gap
from .motion import now, polynomial, rotation, t
from .rolling import rolling, s_d
from .side_view import CENTRES, I_y, body_rates, gamma, kappa, level, omega, p, side_view, theta, turned


def touching_point() -> sp.Matrix:
    """Return the point of the front wheel where its tangent runs along the ramp, on its lower side; body axes."""
    x, z = CENTRES[1]
    R, around = sp.Symbol("R"), gamma - sp.pi / 2
    return sp.Matrix([x + R * sp.cos(around), 0, z + R * sp.sin(around)])


def front_traction_arm() -> sp.Expr:
    """Return the moment about y of a unit of front traction: minus I_y p'' per force, nose-up p."""
    return level(-I_y * side_view().A[2, 1])


def coupling(row: int, column: int) -> sp.Expr:
    """Return an element of P of the level robot."""
    return level(side_view().P[row, column])


def rolling_rate() -> sp.Expr:
    """Return omega of a level robot with both wheels on the ground: the front centre moves along the slope."""
    v_x, v_z, turn = sp.symbols("v_x v_z turn")
    rear, front = (turned(*centre).diff(p).subs(p, 0) * -turn + sp.Matrix([v_x, v_z]) for centre in CENTRES)
    found = sp.solve([rear[1], front[1] * sp.cos(gamma) - front[0] * sp.sin(gamma)], [v_z, turn])
    return found[turn]


def turning_velocity() -> tuple[dict[str, Any], sp.Matrix]:
    """Return the acceleration (3,) in body axes of a turning body whose velocity has given components in its axes."""
    v, angles = sp.Matrix([polynomial(k) for k in (1, 2, 3)]), [polynomial(k) for k in (4, 5, 6)]
    names = dict(zip(("v_x", "v_y", "v_z"), now(v), strict=True))
    names |= dict(zip(("v_x_d", "v_y_d", "v_z_d"), now(sp.diff(v, t)), strict=True))
    names |= {f"omega_{axis}": now(sp.diff(angle, t)) for axis, angle in zip("xyz", angles, strict=True)}
    return names, now(sp.diff(rotation(*angles) * v, t))


def sideways() -> tuple[dict[str, Any], sp.Expr]:
    """Return the lateral component of that acceleration."""
    names, a = turning_velocity()
    return names, a[1]


def planar_normal() -> tuple[dict[str, Any], sp.Expr]:
    """Return the normal force per mass of a body that moves in its x-z plane."""
    v, pitch = sp.Matrix([polynomial(1), 0, polynomial(3)]), polynomial(5)
    a = now(sp.diff(rotation(sp.S.Zero, pitch, sp.S.Zero) * v, t))
    names = {"m": 1, "v_x": now(v[0]), "v_x_d": now(sp.diff(v[0], t)), "v_z_d": now(sp.diff(v[2], t))}
    return names | {"omega_y": now(sp.diff(pitch, t))}, a[2]


def slope_rate() -> sp.Expr:
    """Return gamma' = gamma_x x' under the front wheel centre of the level robot, whose place turns with the body."""
    v_x, gamma_x = symbols("v_x gamma_x")
    return gamma_x * (v_x - omega * sp.diff(turned(*CENTRES[1])[0], p).subs(p, 0))


def bend_of_profile() -> sp.Expr:
    """Return the curvature f''/(1 + f'^2)^(3/2) of z = f(x) with f' = tan(gamma)."""
    slope, bend = sp.tan(gamma), sp.Symbol("gamma_x") * (1 + sp.tan(gamma) ** 2)
    return bend / (1 + slope**2) ** sp.Rational(3, 2)


@cache
def jerk() -> tuple[dict[str, Any], sp.Expr]:
    """Return d^2(v_z)/dt^2 of a level robot on a bent slope from one coordinate, and what 4.54 asks for."""
    motion, b = rolling(), sp.Symbol("b")
    given = symbols("m I_y L_f L_r h R g F_r F_f kappa s_d")
    place = dict(zip(given, numbers(len(given)), strict=True)) | {p: sp.S.Zero, theta: sp.Rational(3, 10)}
    velocity = motion.along_body(motion.speed)
    twice = motion.rate(motion.rate(velocity[1]))
    asked = sp.Matrix([motion.rate(motion.pitch), *velocity, motion.s_dd, twice])
    p_d, v_x, v_z, s_dd, derived = at(motion.now(asked), place)
    _, _, alpha, a_x, a_z = body_rates(bend=b)
    by = {"gamma": theta, "theta": theta, "p": p, "omega": omega, "b": b}
    slopes = [sp.diff(a_z, symbol) for symbol in by.values()]
    there = place | {omega: -p_d, b: place[kappa] * place[s_d] ** 2}
    found = at(sp.Matrix([alpha, a_x, *slopes]), there)
    names = dict(zip(("alpha", "a_cx", *(f"d_a_cz_{name}" for name in by)), found, strict=True))
    return names | {
        "v_x": v_x, "v_z": v_z, "omega": -p_d, "gamma_x": place[kappa] / sp.cos(place[theta]), "kappa": place[kappa],
        "v_t": place[s_d], "b_d": 2 * place[kappa] * place[s_d] * s_dd,
    }, derived  # fmt: skip


def magnitude() -> tuple[dict[str, Any], sp.Expr]:
    """Return the length of the third derivative of a position in the plane, and the quantities seen from the body."""
    pitch, place = polynomial(1), sp.Matrix([polynomial(k) + numbers(1, k)[0] * t**3 for k in (2, 3)])
    turning = sp.Matrix([[sp.cos(pitch), sp.sin(pitch)], [-sp.sin(pitch), sp.cos(pitch)]])  # nose-up pitch
    v, a = (turning * sp.diff(place, t, order) for order in (1, 2))
    J, a_d = now(sp.diff(v, t, 2)), now(sp.diff(a, t))
    names = {"J_cx": J[0], "J_cz": J[1], "a_x": now(a)[0], "a_z": now(a)[1], "a_x_d": a_d[0], "a_z_d": a_d[1]}
    third = now(sp.diff(place, t, 3))
    return names | {"omega": -now(sp.diff(pitch, t))}, sp.sqrt(third.dot(third))


def slope_from_force(entry: Erratum) -> Gap:
    """Put the force of a massless wheel on its axle, the ground's traction and normal force, into both forms."""
    F_t, F_n, R_x, R_y = symbols("F_t F_n R_x R_y")
    known = {R_x: F_t * sp.cos(gamma) - F_n * sp.sin(gamma), R_y: F_t * sp.sin(gamma) + F_n * sp.cos(gamma)}
    form = lambda text: formula(text).subs(F_n, sp.sqrt(R_x**2 + R_y**2 - F_t**2)).subs(known)  # noqa: E731
    with mpmath.workdps(DIGITS):
        return Gap(*(distance(form(text), gamma) for text in (entry.right, entry.printed)))


ENTRIES = (
    Erratum(
        equation="4.39 r_2", chapter="4", where="4.3", kind=WRONG, left="r_2",
        printed="(L_f, 0, -h)", right="(L_f + R*sin(gamma), 0, -(h + R*cos(gamma)))",
        shown="the lowest point of the wheel as seen from the ramp; the tables give h from the wheel centres, so the "
        "printed point is the wheel centre, and r_1 lacks -R likewise",
        consequence="the wheel centre is the right point for the constraint 4.9, and the wrong one for traction",
        derive=against(touching_point), also=("5.2 (second)", "framework paper 37"),
    ),
    Erratum(
        equation="4.40 R_a2", chapter="4", where="4.3", kind=WRONG, left="R_a2",
        printed="-h*cos(gamma) - L_f*sin(gamma)", right="-h*cos(gamma) - L_f*sin(gamma) - R",
        shown="the work of traction that acts where the wheel touches; R_a1 lacks -R likewise. Appendix B has R, "
        "chapters 4 and 5 do not",
        consequence="with it 144 in place of 147 N hold the robot on a slope of 0.2 rad; U in 4.43 and 5.5 with h + R",
        derive=against(front_traction_arm), also=("4.43", "5.3 (second)", "5.5", "framework paper 38, 41"),
    ),
    Erratum(
        equation="4.44 P_12", chapter="4", where="4.3", kind=WRONG, left="P_12",
        printed="-sin(gamma)/m + L_r**2/I_y",
        right="cos(gamma)/m + L_r*(h*sin(gamma) - L_f*cos(gamma))/I_y",
        shown="positions of the wheel centres differentiated, with the virtual work of the normal forces; P is the "
        "kinetic energy's inverse seen at the contacts, so P_12 = P_21",
        consequence="everything that divides by P: contact forces, jerk, frequencies of the wheels. The author's code "
        "seems to have had the right one: the 0.98 rad of Fig 4.4 come out with it, not with the printed one",
        derive=against(lambda: coupling(0, 1)),
    ),
    Erratum(
        equation="4.44 P_21", chapter="4", where="4.3", kind=WRONG, left="P_21",
        printed="-sin(gamma)/m + ((h*sin(gamma) - L_f*cos(gamma))*h*sin(gamma) "
        "- (h*sin(gamma) - L_f*cos(gamma))*L_f*cos(gamma))/I_y",
        right="cos(gamma)/m + L_r*(h*sin(gamma) - L_f*cos(gamma))/I_y",
        shown="as P_12; the printed second term is that of P_22",
        consequence="as P_12", derive=against(lambda: coupling(1, 0)),
    ),
    Erratum(
        equation="4.48 omega", chapter="4", where="4.3, 4.4", kind=INCOMPLETE, left="omega",
        printed="omega_p", right="-v_x*sin(gamma)/((L_f + L_r)*cos(gamma) - h*sin(gamma))",
        shown="the velocities of the wheel centres of a level robot that keeps both on the ground. The pitch rate of "
        "4.47 "
        "and 4.48 is not free, and the speed enters b through it alone",
        consequence="Fig 4.4: the front wheels lift from 0.757 rad on at 2 m/s; the printed 0.98 rad comes out for 2 "
        "rad/s "
        "at all slopes",
        derive=against(rolling_rate), also=("4.54",),
    ),
    Erratum(
        equation="4.51 a_cy", chapter="4", where="4.5", kind=MISPRINT, left="a_cy",
        printed="v_y_d + v_x_d*omega_z - v_z*omega_x", right="v_y_d + v_x*omega_z - v_z*omega_x",
        shown="a velocity given in turning axes, differentiated in world axes",
        consequence="none, there is no lateral motion", derive=with_values(sideways),
    ),
    Erratum(
        equation="4.52 F_z", chapter="4", where="4.5", kind=MISPRINT, left="F_z",
        printed="m*(v_z_d - v_x_d*omega_y)", right="m*(v_z_d - v_x*omega_y)",
        shown="the same in the plane; 4.51 and the line after it have it right",
        consequence="none", derive=with_values(planar_normal),
    ),
    Erratum(
        equation="4.53", chapter="4", where="4.5", kind=WRONG, left="gamma_d",
        printed="gamma_x*v_x", right="gamma_x*(v_x - h*omega)",
        shown="the horizontal speed of the front wheel centre, which turns with the body; seen from the body the slope "
        "changes by omega more, even on a straight ramp",
        consequence="at 2 m/s on 0.2 rad the wheel is 8 percent faster than the centre of mass; with the missing omega "
        "it moves the zero-jerk force of Fig 4.7",
        derive=against(slope_rate), also=("ASME paper 8", "TIMR paper 7"),
    ),
    Erratum(
        equation="4.54 curvature", chapter="4", where="4.5, text", kind=WRONG, left="kappa",
        printed="gamma_x", right="gamma_x*cos(gamma)",
        shown="the curvature of z = f(x); the derivative by x is that of the angle, not by the length of the path",
        consequence="2 percent at 0.2 rad; what rolls has the curvature of the wheel-centre path anyway",
        derive=against(bend_of_profile), also=("ASME paper, text after 8", "TIMR paper, text after 7"),
    ),
    Erratum(
        equation="4.54", chapter="4", where="4.5", kind=INCOMPLETE, left="J_cz",
        printed="d(a_cz, gamma)*gamma_x*v_x + v_x*alpha + omega*(a_cx - v_z*omega)",
        right="d(a_cz, theta)*kappa*v_t - d(a_cz, p)*omega + d(a_cz, omega)*alpha + d(a_cz, b)*b_d + v_x*alpha "
        "+ omega*(a_cx - v_z*omega)",
        shown="the second derivative of v_z along the motion of a robot with one coordinate, without contact forces; "
        "theta is absolute and b = kappa v_t^2. Missing: the pitch, the changing pitch rate, the bend",
        consequence="the zero-jerk force of Fig 4.7 (367 N); 152 N on a straight ramp. What is differentiated is a "
        "component in turning axes: neither the jerk felt on board nor that of the path",
        derive=with_values(jerk), also=("A, J_cz",),
    ),
    Erratum(
        equation="4.55 J_c", chapter="4", where="4.6, text", kind=WRONG, left="J_c",
        printed="sqrt(J_cx**2 + J_cz**2)",
        right="sqrt((a_x_d + omega*a_z)**2 + (a_z_d - omega*a_x)**2)",
        shown="the third derivative of a position; second derivatives of v_x and v_z in turning axes do not add up to "
        "the length of any vector",
        consequence="none, it is not used", derive=with_values(magnitude),
    ),
    Erratum(
        equation="4.56", chapter="4", where="4.6", kind=WRONG, left="gamma",
        printed="2*atan((R_y + sqrt(R_y**2 + R_x**2 - F_t**2))/(R_x + F_t))",
        right="atan2(F_t*R_y - F_n*R_x, F_t*R_x + F_n*R_y)",
        shown="balance of a massless wheel, R being its force on the axle, F_n = sqrt(R_x^2 + R_y^2 - F_t^2). Printed "
        "with both roots and with F_a for one of the two F_t: only the minus root is the slope, and it is 0/0 for an "
        "idle wheel on the flat",
        consequence="the estimator of Fig 4.9; the angle is seen from the body, where the load cells are",
        derive=slope_from_force, also=("ASME paper 8 (second)",),
    ),
)  # fmt: skip
