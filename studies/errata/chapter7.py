"""Errors of chapter 7 and Appendix C: modes of the chassis, their response to a pulse."""

from __future__ import annotations

from collections.abc import Callable
from math import exp, pi
from typing import Any

import mpmath
import numpy as np
import sympy as sp

from .algebra import against, distance, formula, integral, numbers, summation, symbols, with_values
from .erratum import INCOMPLETE, MISPRINT, WRONG, Erratum, Gap
from .vibration import DAMPED, PSI, amplitudes, left_side, omega, p, partial_sum, response, time, zeta


def plate_energies() -> tuple[sp.Expr, sp.Expr]:
    """Return the largest strain energy of a wave sin(k x) of amplitude 1, and the kinetic one per omega^2, per area."""
    E, nu, h, k, rho, depth = symbols("E nu h k rho z")
    strain = E / (1 - nu**2) * (depth * k**2) ** 2 / 2  # a plate bends into z w'' and cannot contract sideways
    return tuple(sp.integrate(density, (depth, -h / 2, h / 2)) for density in (strain, rho / 2))


def stiffness() -> sp.Expr:
    """Return K of 7.2: the strain energy is K k^4 / 2."""
    return 2 * plate_energies()[0] / sp.Symbol("k") ** 4


def plate_wave() -> sp.Expr:
    """Return omega^2 of the wave: strain over kinetic energy."""
    E, K = symbols("E K")
    strain, kinetic = plate_energies()
    return (strain / kinetic).subs(E, sp.solve(stiffness() - K, E)[0])


def two_masses() -> tuple[dict[str, Any], sp.Matrix]:
    """Return X'' of a body of two masses at rest under forces, with eigenvectors whose largest component is 1."""
    m_1, m_2, a, *forces = numbers(5)
    M, Phi = sp.diag(m_1, m_2), sp.Matrix([[1, 1], [a, -m_1 / (a * m_2)]])  # orthogonal through M
    R = sp.Matrix(forces)
    return {"Phi": Phi, "M": M, "R": R}, Phi.inv() * M.inv() * R


def free_vibration(entry: Erratum) -> Gap:
    """Put both forms into the equation of a mode without force: what is left, relative to omega^2."""

    def left(text: str) -> float:
        x = formula(text).subs(sp.Symbol("omega_D"), DAMPED)
        return distance(omega**2 + left_side(x), omega**2)

    return Gap(left(entry.right), left(entry.printed))


def mode(**more: sp.Expr) -> dict[str, Any]:
    """Return the numbers of one mode, with its damped frequency."""
    values = dict(zip(("omega", "zeta", "W", "T", "t", "p"), numbers(6, 2), strict=True))
    return values | {"omega_D": values["omega"] * sp.sqrt(1 - values["zeta"] ** 2)} | more


def frequency_response() -> tuple[dict[str, Any], sp.Expr]:
    """Return the response to exp(j W t) over that force, put into the equation of the mode."""
    given, W = mode(), sp.Symbol("W")
    H = sp.exp(sp.I * W * time) / left_side(sp.exp(sp.I * W * time))
    return given, sp.simplify(H).subs({W: given["W"], omega: given["omega"], zeta: given["zeta"]})


def transform_of_impulse(entry: Erratum) -> Gap:
    """Integrate the impulse response from 0 and from -20 decay times; at zero frequency it should be 1/omega^2."""
    given = {k: float(v) for k, v in mode().items()}
    decay, wd = given["zeta"] * given["omega"], given["omega_D"]
    h = lambda t: mpmath.exp(-decay * t) * mpmath.sin(wd * t) / wd  # noqa: E731
    area = lambda low, high: mpmath.quad(h, mpmath.linspace(low / decay, high / decay, 60))  # noqa: E731
    after, before = area(0, 60), area(-20, 0)
    off = lambda H: float(abs(H * given["omega"] ** 2 - 1))  # noqa: E731
    return Gap(off(after), off(after + before), tolerance=1e-9)  # quadrature in double precision


def pulse_transform() -> tuple[dict[str, Any], sp.Expr]:
    """Return the Fourier integral of a unit pulse, in exact numbers."""
    given = mode()
    return given, sp.integrate(sp.exp(-sp.I * given["W"] * time), (time, 0, given["T"]))


def back_transform(entry: Erratum) -> Gap:
    """Compare both inverse transforms with the response of a mode to a unit pulse, at a time after it."""
    w, z, T, t = 2.0, 0.2, 1.0, 1.5
    wd, W = w * np.sqrt(1 - z**2), np.linspace(-2000, 2000, 800_001)
    spectrum = T * np.sinc(W * T / 2 / pi) * np.exp(-0.5j * W * T) / (w**2 - W**2 + 2j * z * w * W)
    step = lambda u: (1 - np.exp(-z * w * u) * (np.cos(wd * u) + z * w / wd * np.sin(wd * u))) / w**2  # noqa: E731
    x = step(t) - step(t - T)
    inverse = lambda kernel: abs(np.trapezoid(spectrum * kernel, W).real / (2 * pi) / x - 1)  # noqa: E731
    return Gap(inverse(np.exp(1j * W * t)), inverse(1.0), tolerance=1e-5)  # |F H| < 2/W^3: beyond 2000 some 1e-7


def pulse_series(index: str) -> tuple[dict[str, Any], sp.Expr]:
    """Return a cut-off series of a repeated pulse at a time, by its kernel, and its coefficients (a_j: cosines)."""
    width, period, at, count = 0.3, 1.0, 0.17, 6
    base = 2 * pi / period
    terms = [{f"a_{index}": 2 * np.sin(k * base * width) / (k * base * period),
              f"b_{index}": 2 * (1 - np.cos(k * base * width)) / (k * base * period),
              f"p_{index}": k * base} for k in range(1, count + 1)]  # fmt: skip
    names = {name: sp.Symbol(name) for name in (*terms[0], index)}
    names |= {"t": at, "a_0": 2 * width / period, "total": summation(terms)}
    return names, sp.Float(partial_sum(width, period, count, at))


def to_rounding(given: Callable[[], tuple[dict[str, Any], Any]]) -> Callable[[Erratum], Gap]:
    """Return `with_values` for numbers in double precision."""

    def check(entry: Erratum) -> Gap:
        return with_values(given)(entry)._replace(tolerance=1e-12)

    return check


def duhamel() -> tuple[dict[str, Any], sp.Expr]:
    """Return the response to sin(p t) from rest by undetermined coefficients, at a time."""
    given = mode(tau=sp.Symbol("tau"), integral=integral)
    at = {omega: given["omega"], zeta: given["zeta"], p: given["p"], time: given["t"]}
    return given, response("sin").subs(at)


def of_amplitude(force: str, which: int) -> Callable[[Erratum], Gap]:
    """Return the check of an amplitude of `vibration`, with the Psi of print; omega_D is no symbol of its own."""

    def check(entry: Erratum) -> Gap:
        derived = amplitudes(force)[which] * PSI / sp.Symbol("Psi")
        form = lambda text: formula(text).subs(sp.Symbol("omega_D"), DAMPED)  # noqa: E731
        return Gap(distance(form(entry.right), derived), distance(form(entry.printed), derived))

    return check


def first_mode_after_3_s(entry: Erratum) -> Gap:
    """Compare what is left of the first mode after the period of the series with both statements."""
    left = exp(-5e-5 * 2 * pi * 24 * 3)
    return Gap(abs(left - 0.98), left, tolerance=0.005)  # half a percent of rounding


_FREE = "exp(-zeta*omega*t)*(a*sin(omega_D*t) + b*cos(omega_D*t))"
_SERIES = "total(a_j*cos(p_j*t) + b_j*sin(p_j*t), j)"
_DUHAMEL = "integral(sin(p*tau)*exp(-zeta*omega*(t - tau))*sin(omega_D*(t - tau)), tau, 0, t)"

ENTRIES = (
    Erratum(
        equation="7.1", chapter="7", where="7.2", kind=WRONG, left="omega**2",
        printed="K*k**4/rho", right="K*k**4/(rho*h)",
        shown="the frequency of a wave sin(k x) by the energies of strain and motion through the thickness. Printed is "
        "-K del^4 w = rho w''; with the density of Table 8.1 it must be rho h w''. 7.2 is right",
        consequence="none, the frequencies are those of a finite element model", derive=against(plate_wave),
    ),
    Erratum(
        equation="7.10", chapter="7", where="7.4", kind=INCOMPLETE, left="X_dd + Lam*X",
        printed="Phi.T*R", right="(Phi.T*M*Phi)**-1*Phi.T*R",
        shown="two masses at rest under forces, with eigenvectors of largest component 1: the printed one needs "
        "Phi^T M Phi = 1, which is not said",
        consequence="accelerations are wrong by the modal masses for eigenvectors normalised otherwise",
        derive=with_values(two_masses), also=("7.13", "7.33", "shock paper 4, 6"),
    ),
    Erratum(
        equation="7.11 free", chapter="7", where="7.4", kind=WRONG, left="x_i",
        printed="a*sin(omega*t) + b*cos(omega*t)", right=_FREE,
        shown="put into the equation of a mode without force; 7.21 and 7.26 print the decay but still omega for "
        "omega_D",
        consequence="none, a and b are zero", derive=free_vibration, also=("7.21", "7.26"),
    ),
    Erratum(
        equation="7.15 limits", chapter="7", where="7.4", kind=MISPRINT, left="H",
        printed="integral(h*exp(-j*W*t), t, -inf, inf)", right="integral(h*exp(-j*W*t), t, 0, inf)",
        shown="the impulse response 7.14 is zero before the impulse; what is printed for it grows without bound there",
        consequence="none", derive=transform_of_impulse,
    ),
    Erratum(
        equation="7.15", chapter="7", where="7.4", kind=WRONG, left="H",
        printed="1/((W + zeta*omega)**2 + omega_D**2)", right="1/((j*W + zeta*omega)**2 + omega_D**2)",
        shown="exp(j W t) put into the equation of a mode",
        consequence="as printed there is no resonance; no figure uses it", derive=with_values(frequency_response),
    ),
    Erratum(
        equation="7.17 step", chapter="7", where="7.5", kind=MISPRINT, left="F",
        printed="(1 - exp(j*W*T))/(j*W)", right="(1 - exp(-j*W*T))/(j*W)",
        shown="integrated", consequence="none", derive=with_values(pulse_transform),
    ),
    Erratum(
        equation="7.17", chapter="7", where="7.5", kind=WRONG, left="F",
        printed="-sin(W*T)/W", right="2*sin(W*T/2)/W*exp(-j*W*T/2)",
        shown="integrated; what is printed is minus its real part",
        consequence="zeros of the spectrum at multiples of pi/T in place of 2 pi/T: Fig 7.3 if it was drawn from it",
        derive=with_values(pulse_transform),
    ),
    Erratum(
        equation="7.19", chapter="7", where="7.5", kind=WRONG, left="x_i",
        printed="integral(F*H, W, -inf, inf)/(2*pi)", right="integral(F*H*exp(j*W*t), W, -inf, inf)/(2*pi)",
        shown="both integrals, numerically, against the response to a pulse in closed form",
        consequence="none, it is not used", derive=back_transform,
    ),
    Erratum(
        equation="7.19 period", chapter="7", where="7.5, text", kind=WRONG, left="",
        printed="within 3 s the transient of the first pulse has died out",
        right="after 3 s 98 percent of the first mode are left; it does not matter, since the response starts from "
        "rest",
        shown="exp(-zeta omega t) with zeta = 5e-5 and 24 Hz: the decay takes 133 s",
        consequence="none for times within the period", derive=first_mode_after_3_s,
    ),
    Erratum(
        equation="7.20", chapter="7", where="7.5", kind=INCOMPLETE, left="r",
        printed=_SERIES, right=f"a_0/2 + {_SERIES}",
        shown="the series of a pulse, cut off, by Dirichlet's kernel; a_0/2 is the pulse's share of the period",
        consequence="16.7 N of a pulse of 1000 N and 0.05 s are missing, a force that pushes backwards for 2.95 s",
        derive=to_rounding(lambda: pulse_series("j")), also=("8.1", "shock paper 8"),
    ),
    Erratum(
        equation="7.21", chapter="7", where="7.5", kind=WRONG, left="x",
        printed=f"{_DUHAMEL}/omega", right=f"{_DUHAMEL}/omega_D",
        shown="the integral in exact numbers, against a response found by undetermined coefficients; 7.11 and 7.14 "
        "have it "
        "right",
        consequence="1.2e-9 at the damping of Table 8.1", derive=with_values(duhamel), also=("7.26",),
    ),
    Erratum(
        equation="7.25 A_t", chapter="7", where="7.5", kind=WRONG, left="A_t",
        printed="-p/omega*(-zeta**2*omega**2 - p**2 + omega_D**2)/Psi",
        right="-p/omega_D*(-zeta**2*omega**2 - p**2 + omega_D**2)/Psi",
        shown="undetermined coefficients. All eight amplitudes of 7.25 and 7.29 are too small by sqrt(1 - zeta^2), "
        "which "
        "follows from 7.21 and 7.26, and right but for that",
        consequence="1.2e-9 at the damping of Table 8.1", derive=of_amplitude("sin", 0),
        also=("7.29", "C.3", "C.6"),
    ),
)  # fmt: skip
