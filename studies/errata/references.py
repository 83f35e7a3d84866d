"""Numbers and letters in print that name something else: reading puts them right, there is nothing to derive."""

from __future__ import annotations

from typing import NamedTuple


class Reference(NamedTuple):
    """Where it stands, what is printed and what is meant."""

    where: str
    printed: str
    meant: str


REFERENCES = (
    Reference("3.3, before 3.14", "Equation (3.88)", "3.8"),
    Reference("4.2.1, before 4.19", "Equation (12)", "4.13 (the number of the framework paper)"),
    Reference("4.2.5", "4.33 and 4.34, twice each", "two equations and a program have the number of another"),
    Reference("4.6", "Figure 4.6 (point P)", "Figure 4.7"),
    Reference("4.6", "Figure 4.8, twice", "two figures have this number"),
    Reference("Table 4.1", "R: no value, I_y: 0.1 m, m: 47 kg m2", "a row too low; m is missing (Table 6.1: 170 kg)"),
    Reference("5.2", "5.2 and 5.3, twice each", "A, N and n, then r and R_a, have these numbers"),
    Reference("5.2, 5.3 and 5.4", "R_a1 and R_n1 for whole matrices", "R_a and R_n"),
    Reference("5.2, before 5.10", "Equation (3.26)", "4.26"),
    Reference("5.3, 5.12", "G_i", "C_i"),
    Reference("6.5", "control law Eq. 6.8, twice", "6.9"),
    Reference("8.4", "Equation (7.32)", "7.33"),
    Reference("Table 8.1", "Poisson's ratio 0.33 kg", "0.33"),
    Reference("9.1", "Section (3.2.6)", "4.2.5"),
    Reference("10.2.1, 10.2.4", "Figures 9.1 and 9.2", "Figures 10.1 and 10.2"),
    Reference("Appendix A", "sin(lambda) in the slope of Psi", "sin(gamma)"),
    Reference("Appendix B", "lambda(p, lambda)", "lambda(p, gamma)"),
    Reference("framework paper, Appendix A", "ry and tau_6", "I_y and tau_5"),
    Reference("framework paper, before 46", "Equation (24)", "25"),
    Reference("ASME paper, section 3", "(8), twice", "the rate of the slope and the slope from forces"),
    Reference("ASME and TIMR papers", "L_r: front axle to centre of mass", "L_f of the thesis"),
)
