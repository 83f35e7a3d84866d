"""Vectors compute the same bits as one number after the other, and only where they save work are they used."""

from __future__ import annotations

import ctypes
import subprocess
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest

from cosim.compiled.build import compiler
from fmus.compile import MATHS
from fmus.package import HARNESS
from fmus.vectors import packed

x = ca.SX.sym("x", 64)
# what the FMU's own sources say of fmax and fmin: CasADi's let a number win over a NaN
HEAD = """\
#include <math.h>
#define fmax(x, y) ((x) > (y) ? (x) : (y))
#define fmin(x, y) ((x) < (y) ? (x) : (y))
"""


def searches() -> Any:
    """Return four Newton searches, their answers sorted out by every operation that has a vector."""
    found = []
    for k in range(4):
        at = x[k]
        for _ in range(6):
            value = sum(x[4 + j + 6 * k] * at**j for j in range(6)) - ca.fmax(x[30], ca.fmin(at, x[40 + k]))
            at = at - value / ca.sqrt(1 + (at * x[20]) ** 2) + 2 * at * (1 / x[50 + k])
        upper = ca.logic_not(at <= x[60])
        found.append(ca.if_else(upper, at, -ca.sin(at)) + (x[k] == x[k + 1]) + (at != x[3]) + (at < 1))
    return ca.vertcat(*found, sum(found))


def products() -> Any:
    """Return what is gathered from everywhere and used once."""
    return ca.vertcat(*(x[(7 * i) % 64] * x[(11 * i + 3) % 64] for i in range(60)))


def chain() -> Any:
    """Return one chain, in which nothing is done twice."""
    at = x[0]
    for i in range(1, 64):
        at = ca.sqrt(1 + at * x[i])
    return at


def function(expression: Any) -> ca.Function:
    return ca.Function("f", [x], [ca.cse(ca.densify(expression))])


def result(text: str, folder: Path, n: int, given: np.ndarray, *flags: str) -> bytes:
    """Compile a source whose function is called f and return the bits that it computes."""
    folder.mkdir()
    (folder / "f.c").write_text(text)
    command = [*(compiler() or ["cc"]), "-O2", *MATHS, *flags, "-shared", "-fPIC", "f.c", "-o", "f.so", "-lm"]
    subprocess.run(command, check=True, cwd=folder)
    out, pointer = np.zeros(n), ctypes.POINTER(ctypes.c_double)
    arguments, results = ((pointer * 8)(a.ctypes.data_as(pointer)) for a in (given, out))
    assert ctypes.CDLL(str(folder / "f.so")).f(arguments, results, None, None, 0) == 0
    return out.tobytes()


@pytest.mark.parametrize("odd", [None, np.nan, np.inf, 0.0, -0.0])
def test_vectors_compute_the_same_bits(odd: float | None, tmp_path: Path) -> None:
    given = np.random.default_rng(5).uniform(0.5, 1.5, 64)
    if odd is not None:
        given[::5] = odd
    f = function(searches())
    generator = ca.CodeGenerator("f.c", {"with_header": False})
    generator.add(f)
    generator.generate(f"{tmp_path}/")
    vectors = packed(f, "four")
    assert vectors is not None
    call = "int f(const double **a, double **r, long long *iw, double *w) { return four(a, r, iw, w, 0); }\n"
    ours = f'{HEAD}#include "vectors.h"\n{vectors}{call}'
    wanted = np.frombuffer(result(HEAD + (tmp_path / "f.c").read_text(), tmp_path / "plain", 5, given))
    for name, flag in {"chosen": "-DWITH_WIDE", "narrow": "-DWITHOUT_WIDE"}.items():
        found = np.frombuffer(result(ours, tmp_path / name, 5, given, f"-I{HARNESS}", flag))
        np.testing.assert_array_equal(np.isnan(found), np.isnan(wanted))
        real = ~np.isnan(wanted)
        assert found[real].tobytes() == wanted[real].tobytes()


@pytest.mark.parametrize("expression", [products, chain])
def test_what_gains_nothing_is_left_to_casadi(expression: Any) -> None:
    assert packed(function(expression()), "f") is None


def test_so_is_a_function_of_matrices() -> None:
    a = ca.MX.sym("a", 8, 8)
    assert packed(ca.Function("f", [a], [ca.solve(a, a @ a)]), "f") is None


def test_so_is_one_with_a_constant_that_has_no_spelling() -> None:
    assert packed(function(ca.vertcat(searches(), ca.inf)), "f") is None
