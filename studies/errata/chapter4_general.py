"""Errors of section 4.2: the body in space, its wheels, the complementarity problem."""

from __future__ import annotations

from typing import Any

import sympy as sp

from .algebra import against, numbers, symbols, value, with_values
from .erratum import INCOMPLETE, MISPRINT, WRONG, Erratum, Gap
from .motion import angular_velocity, now, polynomial, rotation, t


def turning_body() -> tuple[dict[str, Any], sp.Matrix]:
    """Return I, omega and alpha of a turning body and the moment it takes: the rate of its angular momentum."""
    turning = rotation(polynomial(1), polynomial(2), polynomial(3))
    inertia = sp.diag(*numbers(3))
    omega = angular_velocity(turning)
    momentum = turning * inertia * omega  # world axes
    moment = now(turning.T * sp.diff(momentum, t))
    return {"I": inertia, "omega": now(omega), "alpha": now(sp.diff(omega, t))}, moment


def wheel_force() -> tuple[dict[str, Any], sp.Matrix]:
    """Return the force with F_a along A, F_n along n and none across, for a steered wheel on a slope."""
    n, A = steered(sp.Rational(3, 5), sp.Rational(4, 5), sp.Rational(5, 13), sp.Rational(12, 13))
    F_a, F_n = numbers(2)
    force = sp.Matrix.hstack(A, n, A.cross(n)).T.inv() * sp.Matrix([F_a, F_n, 0])
    return {"A": A, "N": n, "F_a": F_a, "F_n": F_n}, force


def steered(s: sp.Expr, c: sp.Expr, sd: sp.Expr, cd: sp.Expr) -> tuple[sp.Matrix, sp.Matrix]:
    """Return the outward normal and the uphill direction of a slope (sine, cosine) met at a heading (sine, cosine)."""
    return sp.Matrix([-s * cd, -s * sd, c]), sp.Matrix([c * cd, c * sd, s])


def slope_normal() -> sp.Matrix:
    """Return the unit gradient of z - tan(gamma) (x cos(delta) + y sin(delta)): it points out of the ground."""
    x, y, z, gamma, delta = symbols("x y z gamma delta")
    height = z - sp.tan(gamma) * (x * sp.cos(delta) + y * sp.sin(delta))
    gradient = sp.Matrix([sp.diff(height, axis) for axis in (x, y, z)])
    return gradient / sp.sqrt(gradient.dot(gradient))


def bent_path() -> tuple[dict[str, Any], sp.Expr]:
    """Return the acceleration along the normal of a point that follows a curve z = f(x) at a varying speed."""
    x = polynomial(4)
    slope, bend = numbers(2)
    place = sp.Matrix([x, slope * x + bend * x**2 / 2])
    long = sp.sqrt(1 + slope**2)
    normal = sp.Matrix([-slope, 1]) / long
    names = {"kappa": bend / long**3, "v_t": now(sp.diff(x, t)) * long}
    return names, normal.dot(now(sp.diff(place, t, 2)))


def moment_arms(entry: Erratum) -> Gap:
    """Compare the rows of a matrix whose columns are r_k x A_k, for four wheels, with the claimed numbers of rows."""
    _, A = steered(sp.Rational(3, 5), sp.Rational(4, 5), sp.Rational(0), sp.Rational(1))
    arms = [sp.Matrix(numbers(3, k)).cross(A) for k in range(4)]
    rows = sp.Matrix.hstack(*arms).rows
    return Gap(abs(rows - 3), abs(rows - 4))


def turning_share(entry: Erratum) -> Gap:
    """Compare J with the J_k as rows and as columns with (alpha x r_k).n_k, computed wheel by wheel."""
    r = [sp.Matrix(numbers(3, k)) for k in range(2)]
    slopes = ((sp.S.Zero, sp.S.One), (sp.Rational(3, 5), sp.Rational(4, 5)))
    n, A = zip(*(steered(s, c, sp.S.Zero, sp.S.One) for s, c in slopes), strict=True)
    inverse, F = sp.diag(*numbers(3)), sp.Matrix(numbers(2, 9))
    moment = [r[k].cross(A[k]) for k in range(2)]
    alpha = inverse * (moment[0] * F[0] + moment[1] * F[1])
    reference = sp.Matrix([alpha.cross(r[k]).dot(n[k]) for k in range(2)])
    J = sp.Matrix(2, 2, lambda k, j: (inverse * moment[j]).cross(r[k]).dot(n[k]))
    off = lambda M: float((M * F - reference).norm() / reference.norm())  # noqa: E731
    return Gap(off(J), off(J.T))


def lifted_wheel(entry: Erratum) -> Gap:
    """Put a solution with one wheel on the ground and one lifting off into both forms; both should be zero."""
    P, b = sp.Matrix([[2, 1], [1, 2]]), sp.Matrix([-1, 1])
    F_n = sp.Matrix([sp.Rational(1, 2), 0])  # P_11 F_1 + b_1 = 0, and the second gap opens at P_21 F_1 + b_2 = 3/2
    names = {"a_N": P * F_n + b, "F_n": F_n}
    assert names["a_N"] == sp.Matrix([0, sp.Rational(3, 2)])
    return Gap(*(float(value(form, names).norm()) for form in (entry.right, entry.printed)))


def four_on_a_plane() -> sp.Matrix:
    """Return P (4, 4) of four wheels on a plane, without friction."""
    mass, ix, iy, front, rear, half = numbers(6)
    n = sp.Matrix([0, 0, 1])
    places = [(front, half), (front, -half), (-rear, half), (-rear, -half)]
    arms = sp.Matrix.hstack(*(sp.Matrix([x, y, -1]).cross(n) for x, y in places))
    return sp.ones(4, 4) / mass + arms.T * sp.diag(ix, iy, 1).inv() * arms


def rank_of_P(entry: Erratum) -> Gap:
    """Compare the rank of P of four wheels on a plane with 3 and with 4."""
    rank = four_on_a_plane().rank()
    return Gap(abs(rank - 3), abs(rank - 4))


ENTRIES = (
    Erratum(
        equation="4.2", chapter="4", where="4.2", kind=INCOMPLETE, left="T",
        printed="I*alpha", right="I*alpha + cross(omega, I*omega)",
        shown="the angular momentum of a turning body, differentiated in world axes",
        consequence="none in the planar chapters, where it vanishes; in 3-D roll, pitch and yaw rates couple",
        derive=with_values(turning_body), also=("4.20", "4.26", "framework paper 2, 19, 25", "DYMAC paper 2"),
    ),
    Erratum(
        equation="4.3", chapter="4", where="4.2", kind=MISPRINT, left="F_R",
        printed="A*F_n + N*F_n", right="A*F_a + N*F_n",
        shown="the force whose part along the wheel's heading is the traction; 4.8 and 4.23 have it right",
        consequence="none",
        derive=with_values(wheel_force), also=("4.6", "framework paper 28 and the text after 45"),
    ),
    Erratum(
        equation="4.9 bend", chapter="4", where="4.2.5", kind=INCOMPLETE, left="a_n",
        printed="0", right="kappa*v_t**2",
        shown="a point that follows a curve, differentiated twice; kappa is the curvature of the path of the wheel "
        "centre, the point of the body whose normal motion the ground rules",
        consequence="a_N >= 0 becomes a_N - kappa v_t^2 >= 0: contact on a crest is lost at speed, which the printed "
        "condition never says; the pitch plan and the jerk miss the same term",
        derive=with_values(bent_path), also=("4.34", "framework paper 32", "DYMAC paper 5", "ASME paper 4",
                                             "TIMR paper 4"),
    ),
    Erratum(
        equation="4.10", chapter="4", where="4.2", kind=WRONG, left="n",
        printed="(sin(gamma)*cos(delta), sin(gamma)*sin(delta), -cos(gamma))",
        right="(-sin(gamma)*cos(delta), -sin(gamma)*sin(delta), cos(gamma))",
        shown="the gradient of the height above the slope; 4.38 and 5.3 have the right sign",
        consequence="with the printed sign the condition a_N >= 0 asks the wheels to sink in",
        derive=against(slope_normal), also=("framework paper 9",),
    ),
    Erratum(
        equation="4.24", chapter="4", where="4.2.3", kind=MISPRINT, left="",
        printed="R_a and R_n are w x w matrices", right="R_a and R_n are 3 x w matrices: a column per wheel",
        shown="their columns are cross products",
        consequence="none", derive=moment_arms, also=("framework paper 23",),
    ),
    Erratum(
        equation="4.29", chapter="4", where="4.2.3", kind=MISPRINT, left="",
        printed="the J_k and S_k are the columns of J and S", right="the J_k and S_k are the rows of J and S",
        shown="(alpha x r_k).n_k computed wheel by wheel, for a level and a climbing wheel",
        consequence="none: 4.43 has them as rows; taken literally U is transposed",
        derive=turning_share, also=("framework paper 28",),
    ),
    Erratum(
        equation="4.33", chapter="4", where="4.2.5", kind=WRONG, left="0",
        printed="a_N*F_n.T", right="a_N.T*F_n",
        shown="with one wheel on the ground and one lifting off the printed product, a matrix, is not zero; nor can a "
        "matrix be minimised",
        consequence="none: what was solved must have been the scalar product",
        derive=lifted_wheel, also=("4.34", "4.33b"),
    ),
    Erratum(
        equation="4.35", chapter="4", where="4.2.5", kind=INCOMPLETE, left="",
        printed="F_n = -P^-1 b, for w wheels",
        right="P of four wheels on a plane has rank 3: only axle sums are determined, as by the planar 2 x 2 model",
        shown="the rank of P in exact numbers; with friction P is not symmetric either, so the quadratic program of "
        "4.33b need not be convex",
        consequence="none in the planar chapters; four rigid wheels need compliance or a least norm to share a load",
        derive=rank_of_P, also=("framework paper 33",),
    ),
)  # fmt: skip
