"""Every erratum is derived again: the right form holds, the printed one does not."""

from dataclasses import replace

import pytest
import sympy as sp

from studies.errata import CHAPTERS, CONFIRMED, REGISTER, RIGHT, Confirmed, Erratum, find, of_chapter
from studies.errata.algebra import at, distance, formula, numbers, symbols
from studies.errata.erratum import KINDS
from studies.errata.notation import latex, readable
from studies.errata.rolling import rolling, s_d
from studies.errata.side_view import F_f, F_r, R, body_rates, kappa, omega, side_view


@pytest.mark.parametrize("entry", REGISTER, ids=lambda entry: entry.key)
def test_the_right_form_is_derived_and_the_printed_one_is_not(entry: Erratum) -> None:
    """The tolerance of each derivation is stated where it is made; most are 30 digits at five random places."""
    gap = entry.check()
    assert gap.right <= gap.tolerance, entry.text[1]
    assert gap.printed > 1e-3, entry.text[0]
    assert gap.shown
    assert gap.tolerance < gap.printed


@pytest.mark.parametrize("found", CONFIRMED, ids=lambda found: found.equation)
def test_what_is_printed_right_is_found_right(found: Confirmed) -> None:
    """So the derivations do not refute whatever they are given."""
    assert found.gap() < RIGHT


def test_forms_that_are_swapped_are_not_shown() -> None:
    """A check reads the two forms that are displayed: with these exchanged it must refuse."""
    for key in ("3.15", "4.33", "4.44 P_12", "4.56", "6.9 gains", "6.15", "7.19", "7.25 A_t", "B tau"):
        (entry,) = find(key)
        if entry.key != "7.19":  # numerical integrals, written out in the check
            assert not replace(entry, printed=entry.right, right=entry.printed).check().shown, key


def test_a_slip_of_one_sign_is_seen() -> None:
    """In the right form of P_12, and in each of its three terms."""
    (entry,) = find("4.44 P_12")
    for old, new in (("cos(gamma)/m", "-cos(gamma)/m"), ("h*sin", "-h*sin"), ("- L_f", "+ L_f")):
        assert old in entry.right
        assert not replace(entry, right=entry.right.replace(old, new, 1)).check().shown


def test_the_two_derivations_agree() -> None:
    """Accelerations with contact forces, and with one coordinate and no contact force at all; both axles driven."""
    motion = rolling()
    given = symbols("m I_y L_f L_r h R g p theta F_r F_f kappa s_d")
    place = dict(zip(given, numbers(len(given), 11), strict=True))
    asked = sp.Matrix([motion.rate(motion.pitch), *motion.along_body(motion.acceleration)])
    p_d, a_x, a_z = at(motion.now(asked), place)
    there = place | {omega: -p_d, sp.Symbol("b"): place[kappa] * place[s_d] ** 2}
    found = at(sp.Matrix(body_rates(R, sp.Symbol("b"))[3:]), there)
    assert {F_r, F_f} <= set(given)
    for one, other in zip(found, (a_x, a_z), strict=True):
        assert abs(one / other - 1) < 1e-24


def test_P_is_symmetric_and_U_depends_on_where_traction_acts() -> None:
    model, centre = side_view(), side_view(sp.S.Zero)
    assert distance(model.P[0, 1], model.P[1, 0]) < 1e-24
    assert distance(model.P, centre.P) < 1e-24
    assert distance(model.U, centre.U) > 1e-3


def test_entries_are_complete_and_can_be_named() -> None:
    keys = [entry.key for entry in REGISTER]
    assert len(set(keys)) == len(keys)
    for entry in REGISTER:
        assert entry.kind in KINDS
        assert entry in find(entry.key)
        assert all((entry.shown, entry.consequence, entry.where, entry.printed, entry.right)), entry.key
        assert entry.printed != entry.right
        for text in (*entry.text, *entry.latex):
            assert text
            assert "**" not in text
    assert {entry.chapter for entry in REGISTER} == set(CHAPTERS)


def test_a_chapter_lists_what_is_repeated_there() -> None:
    """6.18 lacks the factors 1/T of 5.13, and 6.16 is not 16."""
    assert {"5.13", "6.9"} <= {entry.key for entry in of_chapter("6")}
    assert {entry.chapter for entry in of_chapter("3")} == {"3"}
    assert [entry.key for entry in find("6.18")] == ["5.13"]
    assert [entry.key for entry in find("4.44")] == ["4.44 P_12", "4.44 P_21"]


def test_every_formula_that_is_computed_is_the_one_displayed() -> None:
    """Text and LaTeX come from the string that the check computes; a form in print keeps its order."""
    (entry,) = find("3.15")
    assert entry.text[0] == "H = V_0/(R ω_0² J_w s + (V_0 R - ω_0 J_w/m) F_n k)"
    assert entry.latex.printed.startswith(r"H = \frac{V_{0}}{R\,\omega_{0}^{2}\,J_{w}\,s")
    assert formula(entry.printed) != formula(entry.right)
    assert readable(entry.left) == latex(entry.left) == "H"
