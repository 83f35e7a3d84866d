"""Errors of chapter 8: reactions of the other wheels, modal forces, frequencies and mesh."""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np
import sympy as sp

from .algebra import against, numbers, symbols, with_values
from .chapter7 import pulse_series, to_rounding
from .erratum import INCOMPLETE, MISPRINT, WRONG, Erratum, Gap

THESIS, PAPER = (24, 54.5, 68.7, 80.3, 95.1, 140.2), (3.82, 8.67, 10.94, 12.78, 15.13, 22.31)  # modes 1 3 5 6 7 9


def modal_forces(single: bool = True) -> tuple[dict[str, Any], sp.Matrix]:
    """Return the forces on three modes of a body of four points: the work of the forces on each mode shape."""
    Phi = sp.Matrix(4, 3, numbers(12, 5))
    R = sp.Matrix([numbers(1)[0], 0, 0, 0] if single else numbers(4, 6))
    work = sp.Matrix([sum(Phi[k, i] * R[k] for k in range(4)) for i in range(3)])
    return {"Phi": Phi, "phi_1": Phi[:, 0], "R": R, "r_1": R[0]}, work


def one_mode() -> tuple[dict[str, Any], sp.Expr]:
    """Return the force on the first of these modes."""
    names, work = modal_forces(single=False)
    return names | {"phi_i": names["phi_1"]}, work[0]


def oblique_impact() -> tuple[dict[str, Any], sp.Expr]:
    """Return the angular momentum about n_d of a plate that is struck at two opposite corners, and its spin."""
    roll, pitch, x, y, front, rear = numbers(6)
    inertia = sp.diag(roll, pitch)
    impulse = sp.Matrix([y, -x]) * front - sp.Matrix([y, -x]) * rear  # r x F, corners (x, y) and (-x, -y), F upwards
    spin = inertia.inv() * impulse
    long = sp.sqrt(x**2 + y**2)
    along, across = sp.Matrix([x, y]) / long, sp.Matrix([y, -x]) / long  # the diagonal, and n_d
    names = {"I_D": across.dot(inertia * across), "I_DC": across.dot(inertia * along)}
    return names | {"Delta_omega_D": across.dot(spin), "Delta_omega_C": along.dot(spin)}, across.dot(impulse)


def rear_reaction() -> sp.Expr:
    """Return the impulse of the rear axle that stays on the flat while the front one is struck: a rigid body."""
    m, I_y, l_f, l_r, r_1 = symbols("m I_y l_f l_r r_1")
    r_3 = sp.Symbol("r_3")
    lift, spin = (r_1 + r_3) / m, (r_1 * l_f - r_3 * l_r) / I_y  # nose-up
    return sp.solve(lift - l_r * spin, r_3)[0]


def shared_reaction() -> sp.Expr:
    """Return r_3 from 8.9 and 8.10 with equal forces on the two wheels of an axle."""
    I_y, D, l_f, l_r, r_1, r_3, dt = symbols("I_y Delta_omega l_f l_r r_1 r_3 Delta_t")
    return sp.solve(I_y * D - (2 * r_1 * l_f - 2 * r_3 * l_r) * dt, r_3)[0]


def hertz(entry: Erratum) -> Gap:
    """Compare the ratio of the two lists of frequencies with 2 pi and with 1; both are rounded."""
    ratio = np.array(THESIS) / np.array(PAPER)
    rounding = max(0.05 / a + 0.005 / b for a, b in zip(THESIS, PAPER, strict=True)) + 0.5 / 24
    return Gap(float(np.max(np.abs(ratio / (2 * pi) - 1))), float(np.max(np.abs(ratio - 1))), tolerance=rounding)


def mesh(entry: Erratum) -> Gap:
    """Look for grids of 600 elements with 651 nodes: bricks, and flat ones."""
    sides = [n for n in range(1, 601) if 600 % n == 0]
    flat = {(a, 600 // a) for a in sides if (a + 1) * (600 // a + 1) == 651}
    bricks = [
        (a, b) for a in sides for b in sides
        if 600 % (a * b) == 0 and (a + 1) * (b + 1) * (600 // (a * b) + 1) == 651
    ]  # fmt: skip
    return Gap(float((30, 20) not in flat), float(not bricks))


ENTRIES = (
    Erratum(
        equation="8.1", chapter="8", where="8.3", kind=INCOMPLETE, left="r",
        printed="total(a_k*sin(p_k*t) + b_k*cos(p_k*t), k)",
        right="a_0/2 + total(a_k*cos(p_k*t) + b_k*sin(p_k*t), k)",
        shown="as 7.20, with its a of the cosines: 8.1 swaps them and lacks the mean too",
        consequence="with the coefficients of 7.20 the pulse would be another one; Fig 8.7 and 8.8 name them by sine "
        "and "
        "cosine", derive=to_rounding(lambda: pulse_series("k")), also=("shock paper 8",),
    ),
    Erratum(
        equation="8.2 f", chapter="8", where="8.4, after 8.2", kind=WRONG, left="f",
        printed="r_1*phi_1.T", right="Phi.T*R",
        shown="the work of the force on three modes: it takes the first component of every mode, where phi_1 is the "
        "first "
        "mode. It is said to follow from 7.32; that is 7.33",
        consequence="none if computed by 7.33", derive=with_values(modal_forces),
    ),
    Erratum(
        equation="8.3", chapter="8", where="8.5", kind=INCOMPLETE, left="M*Delta_t",
        printed="I_D*Delta_omega_D", right="I_D*Delta_omega_D + I_DC*Delta_omega_C",
        shown="a free plate struck at opposite corners, D about n_d and C about the diagonal: n_d is no principal "
        "axis unless roll and pitch inertia are "
        "equal, so "
        "it turns about the diagonal as well",
        consequence="8.5", derive=with_values(oblique_impact),
    ),
    Erratum(
        equation="8.7", chapter="8", where="8.5", kind=MISPRINT, left="gamma_i",
        printed="phi_i*R", right="phi_i.T*R",
        shown="the work of the forces on one mode; two columns have no product. 7.13 is right",
        consequence="none", derive=with_values(one_mode),
    ),
    Erratum(
        equation="8.11", chapter="8", where="8.6", kind=WRONG, left="r_3",
        printed="-I_y*Delta_omega/(l_r*Delta_t) + r_1*l_f/l_r",
        right="-I_y*Delta_omega/(2*l_r*Delta_t) + r_1*l_f/l_r",
        shown="8.9 and 8.10 solved: two wheels share the force of an axle",
        consequence="none where the change of the spin is taken as zero", derive=against(shared_reaction),
    ),
    Erratum(
        equation="8.11 spin", chapter="8", where="8.5, 8.6", kind=INCOMPLETE, left="r_3",
        printed="r_1*l_f/l_r", right="r_1*(m*l_f*l_r - I_y)/(I_y + m*l_r**2)",
        shown="a rigid body whose rear axle keeps to the flat. The change of the spin is never given, nor is I_d; "
        "that the "
        "angular momentum 'is a minimum' is no law of mechanics. Printed: 8.11 without it",
        consequence="the rear impulse is 0.26 of the front one for the 270 kg of Table 8.1, not 1.30, and -0.001 for "
        "170 kg",
        derive=against(rear_reaction), also=("8.5",),
    ),
    Erratum(
        equation="8.2 Hz", chapter="8", where="8.2, text and Fig 8.2", kind=WRONG, left="",
        printed="24 ... 140.2 Hz here and 3.82 ... 22.31 Hz in Table 1 of the shock paper, for one platform",
        right="the two lists differ by the factor 2 pi: one of them has its unit wrong",
        shown="six frequencies, to rounding; the text cannot say which is wrong",
        consequence="everything in chapter 8 or everything in the shock paper; 24 Hz fits what is said of the pulses",
        derive=hertz, also=("shock paper, Table 1",),
    ),
    Erratum(
        equation="8.2 mesh", chapter="8", where="8.2, text", kind=WRONG, left="",
        printed="the chassis has 600 solid elements and 651 nodes",
        right="600 elements with 651 nodes are 30 x 20 flat ones",
        shown="all grids of 600 bricks and of 600 quadrilaterals",
        consequence="the mesh cannot be rebuilt", derive=mesh,
    ),
)  # fmt: skip
