"""Whether two formulas are the same: both computed to 30 digits at places drawn at random."""

from __future__ import annotations

import ast
import random
from collections.abc import Callable, Iterable
from functools import cache
from typing import Any

import mpmath
import sympy as sp

from .erratum import Erratum, Gap
from .notation import FUNCTIONS

DIGITS, PLACES = 30, 5
_KNOWN = {"j": sp.I, "pi": sp.pi, "abs": sp.Abs, "max": sp.Max}


@cache
def formula(text: str) -> sp.Basic:
    """Return a formula of `notation` as a SymPy expression; a tuple as a column."""
    names = {node.id for node in ast.walk(ast.parse(text, mode="eval")) if isinstance(node, ast.Name)}
    known = {name: sp.Symbol(name) for name in names - set(FUNCTIONS)} | _KNOWN
    found = sp.sympify(text, locals=known)
    return sp.Matrix(list(found)) if isinstance(found, tuple | sp.Tuple) else found


def symbols(names: str) -> tuple[sp.Symbol, ...]:
    """Return the symbols that `formula` uses for these names."""
    return tuple(sp.Symbol(name) for name in names.split())


def against(derived: Callable[[], sp.Basic]) -> Callable[[Erratum], Gap]:
    """Return a check that compares both forms with what *derived* returns, everywhere."""

    def check(entry: Erratum) -> Gap:
        right = derived()
        return Gap(distance(formula(entry.right), right), distance(formula(entry.printed), right))

    return check


def distance(form: sp.Basic, derived: sp.Basic) -> float:
    """Return the largest difference of two expressions relative to the second, at places drawn at random."""
    names = sorted({s.name for s in form.free_symbols | derived.free_symbols})
    evaluate = sp.lambdify([sp.Symbol(n) for n in names], [sp.Matrix([form]), sp.Matrix([derived])], "mpmath", cse=True)
    draw = random.Random(7)
    worst = 0.0
    with mpmath.workdps(DIGITS):
        for _ in range(PLACES):
            a, b = evaluate(*(mpmath.mpf(draw.uniform(0.2, 0.9)) for _ in names))
            worst = max(worst, relative(a, b))
    return worst


class _Partials(ast.NodeTransformer):
    """Reads a derivative d(a, b) as the name d_a_b."""

    def visit_Call(self, node: ast.Call) -> ast.expr:
        self.generic_visit(node)
        match node:
            case ast.Call(func=ast.Name(id="d"), args=[ast.Name(id=a), ast.Name(id=b)]):
                return ast.copy_location(ast.Name(f"d_{a}_{b}", ast.Load()), node)
        return node


def value(text: str, names: dict[str, Any]) -> sp.Matrix:
    """Compute a formula of numbers and matrices, flattened; raises ShapeError where its factors do not fit."""
    code = compile(_Partials().visit(ast.parse(text, mode="eval")), text, "eval")
    known = {name: getattr(sp, name, None) for name in FUNCTIONS} | _KNOWN | {"cross": lambda a, b: a.cross(b)}
    found = eval(code, {"__builtins__": {}}, known | names)
    return sp.Matrix(list(found) if isinstance(found, tuple | sp.MatrixBase) else [found])


def with_values(given: Callable[[], tuple[dict[str, Any], Any]]) -> Callable[[Erratum], Gap]:
    """Return a check that computes both forms with the values *given* and compares them with the reference there."""

    def check(entry: Erratum) -> Gap:
        names, reference = given()
        expected = sp.Matrix(list(reference) if isinstance(reference, sp.MatrixBase) else [reference])

        def gap(form: str) -> float:
            try:
                found = value(form, names)
            except sp.matrices.exceptions.ShapeError:
                return float("inf")
            fits = found.shape == expected.shape
            return relative(found.evalf(DIGITS), expected.evalf(DIGITS)) if fits else float("inf")

        return Gap(gap(entry.right), gap(entry.printed))

    return check


def at(expressions: sp.Matrix, values: dict[sp.Symbol, Any]) -> list[sp.Float]:
    """Return the values of expressions to `DIGITS` digits."""
    with mpmath.workdps(DIGITS):
        inputs = [mpmath.mpf(sp.N(v, DIGITS)) for v in values.values()]
        return [sp.Float(v, DIGITS) for v in sp.lambdify(list(values), expressions, "mpmath", cse=True)(*inputs)]


def summation(terms: list[dict[str, Any]]) -> Callable[[sp.Expr, sp.Symbol], sp.Expr]:
    """Return what `total` of a formula adds up: its inside for the values of each term."""
    return lambda inside, over: sum(inside.subs(term) for term in terms)


def integral(inside: sp.Expr, over: sp.Symbol, low: sp.Expr, high: sp.Expr) -> sp.Float:
    """Return what `integral` of a smooth formula is."""
    with mpmath.workdps(DIGITS):
        ends = [mpmath.mpf(sp.N(end, DIGITS)) for end in (low, high)]
        return sp.Float(mpmath.quad(sp.lambdify(over, sp.N(inside, DIGITS), "mpmath"), ends), DIGITS)


def numbers(count: int, seed: int = 3) -> list[sp.Rational]:
    """Return rational numbers between 0.1 and 1, drawn at random: with them equal means equal to the last digit."""
    draw = random.Random(seed)
    return [sp.Rational(draw.randint(100, 1000), 1000) for _ in range(count)]


def relative(values: Iterable, reference: Iterable) -> float:
    """Return the largest difference of two lists of numbers over the largest of the second."""
    a, b = list(values), list(reference)
    return float(max(abs(x - y) for x, y in zip(a, b, strict=True)) / max(abs(y) for y in b))
