"""Formulas as text and in LaTeX: precedence, order, names; and the pages made of them."""

import xml.etree.ElementTree as ET

import pytest

from studies.errata import REGISTER, find
from studies.errata.notation import latex, readable
from studies.errata.pages import markdown, register_html


@pytest.mark.parametrize(
    ("written", "text", "tex"),
    [
        ("-sin(p)/m + L_r**2/I_y", "-sin(p)/m + L_r²/I_y", r"\frac{-\sin(p)}{m} + \frac{L_{r}^{2}}{I_{y}}"),
        ("b + a*c", "b + a c", r"b + a\,c"),
        ("a - (b - c)", "a - (b - c)", r"a - (b - c)"),
        ("a - b - c", "a - b - c", "a - b - c"),
        ("a/(b*c)", "a/(b c)", r"\frac{a}{b\,c}"),
        ("a/b*c", "a/b c", r"\frac{a}{b}\,c"),
        ("a + (-b)", "a + (-b)", r"a + (-b)"),
        ("(a + b)**2", "(a + b)²", r"(a + b)^{2}"),
        ("x**(3/2)", "x^(3/2)", r"x^{\frac{3}{2}}"),
        ("sin(2*p)**2", "sin²(2 p)", r"\sin^{2}(2\,p)"),
        ("z_R_dd", "z\u0308_R", r"\ddot{z}_{R}"),
        ("Delta_omega_D", "Δω_D", r"\Delta \omega_{D}"),
        ("phi.T*R", "φᵀ R", r"\phi^{T}\,R"),
        ("(Phi.T*M*Phi)**-1*R", "(Φᵀ M Φ)⁻¹ R", r"(\Phi^{T}\,M\,\Phi)^{-1}\,R"),
        ("I*alpha + cross(omega, I*omega)", "I α + ω × (I ω)", r"I\,\alpha + \omega \times (I\,\omega)"),
        ("(0, -h)", "(0, -h)", r"\begin{pmatrix}0 \\ -h\end{pmatrix}"),
        ("d(a_cz, gamma)*v", "∂a_cz/∂γ v", r"\frac{\partial a_{cz}}{\partial \gamma}\,v"),
        ("integral(h, t, 0, inf)/2", "(∫[0..∞] h dt)/2", r"\frac{\int_{0}^{\infty} h\,dt}{2}"),
        ("total(a_j, j)", "Σ_j a_j", r"\sum_{j} a_{j}"),
        ("max(0, -k*z)", "max(0, -k z)", r"\max(0, -k\,z)"),
        ("a_N >= 0", "a_N ≥ 0", r"a_{N} \geq 0"),
        ("sqrt(abs(x))", "sqrt(|x|)", r"\sqrt{\left|x\right|}"),
        ("rows of 5 % & more", "rows of 5 % & more", r"\text{rows of 5 \% \& more}"),
    ],
)  # fmt: skip
def test_a_formula_is_written_in_its_own_order(written: str, text: str, tex: str) -> None:
    assert readable(written) == text
    assert latex(written) == tex


def test_a_formula_without_a_notation_is_refused() -> None:
    with pytest.raises(ValueError, match="no notation for x if y else z"):
        readable("x if y else z")


def test_the_markdown_table_has_a_row_for_each_entry() -> None:
    lines = markdown().splitlines()
    assert len(lines) == 2 + len(REGISTER)
    assert {line.replace(r"\|", "").count("|") for line in lines} == {7}
    (row,) = [line for line in lines if line.startswith("| 6.6 ")]
    assert r"$z = \frac{-F_{n}}{k_{w}}$" in row


def test_the_section_for_a_page_is_well_formed_and_needs_nothing() -> None:
    section = ET.fromstring(register_html(find("4.10") + find("8.7") + find("6.9 gains")))
    assert len(section.findall("table")[0].findall("tbody/tr")) == 3
    assert len(section.findall(".//{http://www.w3.org/1998/Math/MathML}math")) == 4  # the gains are words
    assert not section.findall(".//script")
    assert "h_0 = 1500" in "".join(section.itertext())
