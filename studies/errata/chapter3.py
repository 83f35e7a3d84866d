"""Errors of chapter 3, wheel slip."""

from __future__ import annotations

import sympy as sp

from .algebra import against, symbols
from .erratum import WRONG, Erratum


def slip_by_torque() -> sp.Expr:
    """Return d(lambda)/dT in s of one wheel under a mass, by linearising m V' = F_t and J_w omega' = T - R F_t."""
    V, omega, T, m, J_w, R, F_n, k, s = symbols("V_0 omega_0 T m J_w R F_n k s")
    slip, F_t = (R * omega - V) / (R * omega), sp.Function("F_t")
    state = sp.Matrix([V, omega])
    rates = sp.Matrix([F_t(slip) / m, (T - R * F_t(slip)) / J_w])
    slope = lambda M: M.replace(sp.Subs, lambda *_: F_n * k).doit()  # noqa: E731 the curve's slope, F_n d(mu)/d(lambda)
    A, B = slope(rates.jacobian(state)), rates.diff(T)
    return (sp.Matrix([slip]).jacobian(state) * (s * sp.eye(2) - A).adjugate() * B)[0] / (s * sp.eye(2) - A).det()


ENTRIES = (
    Erratum(
        equation="3.15", chapter="3", where="3.3", kind=WRONG, left="H",
        printed="V_0/(R*omega_0**2*J_w*s + (V_0*R - omega_0*J_w/m)*F_n*k)",
        right="V_0/(R*omega_0**2*J_w*s + (V_0*R + omega_0*J_w/m)*F_n*k)",
        shown="the two equations of motion 3.4 and 3.5 linearised and solved for slip by torque; the steps 3.6 to 3.14 "
        "are right, the sign is lost when 3.14 is solved",
        consequence="the pole of the slip is too slow, -1468 in place of -1543 1/s at 2 m/s; for wheels heavier "
        "than the robot they carry the printed one even becomes unstable",
        derive=against(slip_by_torque), also=("3.16",),
    ),
)  # fmt: skip
