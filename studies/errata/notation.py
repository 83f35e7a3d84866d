r"""One formula, three uses: written in Python's notation it can be computed, read in a terminal and set in LaTeX.

    -sin(gamma)/m + L_r**2/I_y

is read as -sin(γ)/m + L_r²/I_y.  Unlike a computer algebra system this keeps terms and factors in the order in which
they are printed.  Beyond numbers, names and arithmetic: ``z_d``, ``z_dd``, ``z_ddd`` are time derivatives, a tuple is a
column, ``x.T`` a transpose, ``==`` and ``>=`` relations, and `cross`, `d`, `integral`, `total` stand for ×, a
derivative, ∫ and Σ.  Any other text is words.
"""

from __future__ import annotations

import ast
import re
from functools import cache

GREEK = dict(
    alpha="α", beta="β", gamma="γ", delta="δ", zeta="ζ", eta="η", theta="θ", kappa="κ", mu="μ", nu="ν", xi="ξ", rho="ρ",
    tau="τ", phi="φ", omega="ω", lam="λ", Phi="Φ", Psi="Ψ", Lam="Λ", Gamma="Γ", Delta="Δ", pi="π", inf="∞",
)  # fmt: skip
_LATEX_NAMES = {"lam": "lambda", "Lam": "Lambda", "atan": "arctan", "atan2": "operatorname{atan2}", "inf": "infty"}
FUNCTIONS = ("sin", "cos", "tan", "atan", "atan2", "exp", "sqrt", "abs", "max")
_DOTS = {"d": ("\u0307", "dot"), "dd": ("\u0308", "ddot"), "ddd": ("\u20db", "dddot")}
_SUPERSCRIPT = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")
_SUM, _PRODUCT, _POWER, _ATOM = range(4)  # how tightly a part holds together
_RELATIONS = {ast.Eq: ("=", "="), ast.GtE: ("≥", r"\geq"), ast.LtE: ("≤", r"\leq"), ast.NotEq: ("≠", r"\neq")}


@cache
def tree(formula: str) -> ast.expr | None:
    """Return the syntax of a formula, or None if it is words."""
    try:
        return ast.parse(formula, mode="eval").body
    except SyntaxError:
        return None


def readable(formula: str) -> str:
    """Return a formula as one line of text; words as they are."""
    found = tree(formula)
    return formula if found is None else _Text().of(found)


def latex(formula: str) -> str:
    """Return a formula in LaTeX, without delimiters; words as text in it."""
    found = tree(formula)
    if found is not None:
        return _Latex().of(found)
    return r"\text{" + re.sub(r"([#%&_$])", r"\\\1", formula) + "}"


class _Text:
    """Walks a formula and writes it as text."""

    def of(self, node: ast.expr) -> str:
        return self.write(node)[0]

    def write(self, node: ast.expr) -> tuple[str, int]:
        """Return the text of a part and how tightly it holds together."""
        match node:
            case ast.Name(id=name):
                return self.name(name), _ATOM
            case ast.Constant(value=value):
                return str(value), _ATOM
            case ast.UnaryOp(op=ast.USub(), operand=inner):
                return "-" + self.held(inner, _PRODUCT), _PRODUCT
            case ast.BinOp(left=a, op=ast.Add() | ast.Sub() as op, right=b):
                added = isinstance(op, ast.Add)
                term = self.held(b, _SUM if added else _PRODUCT)
                term = self.parentheses(term) if term.startswith("-") else term
                return self.held(a, _SUM) + (" + " if added else " - ") + term, _SUM
            case ast.BinOp(left=a, op=ast.Mult(), right=b):
                return self.product(a, b), _PRODUCT
            case ast.BinOp(left=a, op=ast.Div(), right=b):
                return self.quotient(a, b), _PRODUCT
            case ast.BinOp(left=a, op=ast.Pow(), right=b):
                return self.power(a, b), _POWER
            case ast.Attribute(value=inner, attr="T"):
                return self.transpose(self.held(inner, _ATOM)), _POWER
            case ast.Tuple(elts=parts):
                return self.column([self.of(part) for part in parts]), _ATOM
            case ast.Compare(left=a, ops=[op], comparators=[b]):
                return f"{self.of(a)} {self.relation(op)} {self.of(b)}", _SUM
            case ast.Call(func=ast.Name(id=name), args=arguments):
                return self.call(name, arguments)
        raise ValueError(f"no notation for {ast.unparse(node)}")

    def held(self, node: ast.expr, least: int) -> str:
        """Return the text of a part, in parentheses if it holds less tightly than is needed."""
        text, tight = self.write(node)
        return text if tight >= least else self.parentheses(text)

    def parentheses(self, text: str) -> str:
        return f"({text})"

    def name(self, name: str) -> str:
        if name.startswith("Delta_"):
            return GREEK["Delta"] + self.name(name.removeprefix("Delta_"))
        head, _, tail = name.partition("_")
        parts = tail.split("_") if tail else []
        mark = _DOTS[parts.pop()][0] if parts and parts[-1] in _DOTS else ""
        return GREEK.get(head, head) + mark + "".join(f"_{GREEK.get(p, p)}" for p in parts)

    def product(self, a: ast.expr, b: ast.expr) -> str:
        return f"{self.held(a, _PRODUCT)} {self.held(b, _POWER)}"

    def quotient(self, a: ast.expr, b: ast.expr) -> str:
        return f"{self.held(a, _PRODUCT)}/{self.held(b, _POWER)}"

    def power(self, a: ast.expr, b: ast.expr) -> str:
        match a, b:
            case ast.Call(func=ast.Name(id="sin" | "cos" | "tan" as name), args=[inner]), ast.Constant(value=int()):
                return self.function(name, self.raised(b), self.of(inner))
        return self.held(a, _ATOM) + self.raised(b)

    def function(self, name: str, exponent: str, inside: str) -> str:
        return f"{name}{exponent}({inside})"

    def raised(self, exponent: ast.expr) -> str:
        text = self.of(exponent)
        if re.fullmatch(r"-?\d+", text):
            return text.translate(_SUPERSCRIPT)
        return f"^{text}" if len(text) == 1 else f"^({text})"

    def transpose(self, text: str) -> str:
        return f"{text}ᵀ"

    def column(self, parts: list[str]) -> str:
        return f"({', '.join(parts)})"

    def relation(self, op: ast.cmpop) -> str:
        return _RELATIONS[type(op)][0]

    def call(self, name: str, arguments: list[ast.expr]) -> tuple[str, int]:
        match name, arguments:
            case "cross", [a, b]:
                return f"{self.held(a, _ATOM)} × {self.held(b, _ATOM)}", _SUM
            case "integral", [inside, over, low, high]:
                return f"∫[{self.of(low)}..{self.of(high)}] {self.of(inside)} d{self.of(over)}", _SUM
            case "total", [inside, over]:
                return f"Σ_{self.of(over)} {self.held(inside, _PRODUCT)}", _SUM
            case "d", [a, b]:
                return f"∂{self.held(a, _ATOM)}/∂{self.of(b)}", _PRODUCT
            case "abs", [a]:
                return f"|{self.of(a)}|", _ATOM
            case _ if name in FUNCTIONS:
                return self.function(name, "", ", ".join(self.of(a) for a in arguments)), _ATOM
        return f"{self.name(name)}({', '.join(self.of(a) for a in arguments)})", _ATOM


class _Latex(_Text):
    """Walks a formula and writes it in LaTeX."""

    def parentheses(self, text: str) -> str:
        tall = any(part in text for part in (r"\frac", r"\int", r"\sum", r"\begin"))
        return rf"\left({text}\right)" if tall else f"({text})"

    def name(self, name: str) -> str:
        if name.startswith("Delta_"):
            return r"\Delta " + self.name(name.removeprefix("Delta_"))
        head, _, tail = name.partition("_")
        parts = tail.split("_") if tail else []
        dots = _DOTS[parts.pop()][1] if parts and parts[-1] in _DOTS else ""
        letter = self._letter(head)
        return (rf"\{dots}{{{letter}}}" if dots else letter) + (
            "_{" + " ".join(self._letter(p) for p in parts) + "}" if parts else ""
        )

    def _letter(self, part: str) -> str:
        if part in GREEK:
            return "\\" + _LATEX_NAMES.get(part, part)
        return part if len(part) < 3 or part.isdigit() else rf"\mathrm{{{part}}}"

    def product(self, a: ast.expr, b: ast.expr) -> str:
        return rf"{self.held(a, _PRODUCT)}\,{self.held(b, _POWER)}"

    def quotient(self, a: ast.expr, b: ast.expr) -> str:
        return rf"\frac{{{self.of(a)}}}{{{self.of(b)}}}"

    def raised(self, exponent: ast.expr) -> str:
        return f"^{{{self.of(exponent)}}}"

    def function(self, name: str, exponent: str, inside: str) -> str:
        return rf"\{_LATEX_NAMES.get(name, name)}{exponent}" + self.parentheses(inside)

    def transpose(self, text: str) -> str:
        return f"{text}^{{T}}"

    def column(self, parts: list[str]) -> str:
        return r"\begin{pmatrix}" + r" \\ ".join(parts) + r"\end{pmatrix}"

    def relation(self, op: ast.cmpop) -> str:
        return _RELATIONS[type(op)][1]

    def call(self, name: str, arguments: list[ast.expr]) -> tuple[str, int]:
        match name, arguments:
            case "cross", [a, b]:
                return rf"{self.held(a, _ATOM)} \times {self.held(b, _ATOM)}", _SUM
            case "integral", [inside, over, low, high]:
                return rf"\int_{{{self.of(low)}}}^{{{self.of(high)}}} {self.of(inside)}\,d{self.of(over)}", _SUM
            case "total", [inside, over]:
                return rf"\sum_{{{self.of(over)}}} {self.held(inside, _PRODUCT)}", _SUM
            case "d", [a, b]:
                return rf"\frac{{\partial {self.held(a, _ATOM)}}}{{\partial {self.of(b)}}}", _PRODUCT
            case "sqrt", [a]:
                return rf"\sqrt{{{self.of(a)}}}", _ATOM
            case "exp", [a]:
                return f"e^{{{self.of(a)}}}", _POWER
            case "abs", [a]:
                return rf"\left|{self.of(a)}\right|", _ATOM
            case _ if name in FUNCTIONS:
                return self.function(name, "", ", ".join(self.of(a) for a in arguments)), _ATOM
        return self.name(name) + self.parentheses(", ".join(self.of(a) for a in arguments)), _ATOM
