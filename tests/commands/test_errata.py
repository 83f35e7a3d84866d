"""``wmr-cosim errata``: the table, one entry, the formats, and the derivation on demand."""

from __future__ import annotations

import json

import pytest
from commandline import Command

from studies.errata import REGISTER, Gap


def test_the_table_has_all_entries_and_says_what_was_found_right(wmr: Command) -> None:
    said = wmr("errata")
    assert (said.code, said.err) == (0, "")
    lines = said.out.splitlines()
    for entry in REGISTER:
        assert any(line.strip().startswith(entry.key) for line in lines), entry.key
    assert f"errors: {len(REGISTER)};" in said.out
    assert "are right" in lines[-1]


def test_a_chapter(wmr: Command) -> None:
    said = wmr("errata", "--chapter", "3")
    assert "H = V_0/(R ω_0² J_w s + (V_0 R + ω_0 J_w/m) F_n k)" in said.out
    assert "6.9" not in said.out
    said = wmr("errata", "--chapter", "9")
    assert said.code == 1
    assert "there are: 3, 4, 5, 6, 7, 8, A, B, C, papers" in said.err.replace("\n", " ")


def test_one_entry_in_full_and_derived_again(wmr: Command) -> None:
    said = wmr("errata", "6.9", "--check")
    assert said.code == 0
    assert "thesis, section 6.2" in said.out
    assert "z̈_R - K z" in said.out
    assert "impact paper 9" in said.out
    assert "confirmed: the right form is off by" in said.out


def test_an_equation_without_an_error(wmr: Command) -> None:
    said = wmr("errata", "4.46")
    assert said.code == 1
    assert said.err.strip() == "error: 4.46 G_2: derived again and found right"
    said = wmr("errata", "6.21")
    assert said.code == 1
    assert said.err.startswith("error: no error is known of equation '6.21'; did you mean '6.2'?")
    said = wmr("errata", "6.9", "--chapter", "6")
    assert "leave out --chapter or the equation" in said.err


def test_json_and_markdown_have_the_formulas_in_latex(wmr: Command) -> None:
    (row,) = json.loads(wmr("errata", "7.17 step", "--json", "--check").out)
    assert row["right_latex"] == r"F = \frac{1 - e^{-j\,W\,T}}{j\,W}"
    assert row["printed"] == "F = (1 - exp(j W T))/(j W)"
    assert row["confirmed"] is True
    assert row["right_off"] < 1e-20 < row["printed_off"]
    assert len(json.loads(wmr("errata", "--json").out)) == len(REGISTER)
    assert r"$F = \frac{1 - e^{-j\,W\,T}}{j\,W}$" in wmr("errata", "--chapter", "7", "--markdown").out


def test_what_is_not_confirmed_ends_with_1(wmr: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("studies.errata.erratum.Erratum.check", lambda entry: Gap(right=0.1, printed=1.0))
    said = wmr("errata", "6.9", "--check")
    assert said.code == 1
    assert "NOT confirmed" in said.out
    assert "not confirmed: 6.9" in said.err
