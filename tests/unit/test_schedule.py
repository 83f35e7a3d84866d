"""Statements in another order compute the same bits, and only where that saves time are they put in another order."""

from __future__ import annotations

import ctypes
import re
import subprocess
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest

from cosim.compiled.build import compiler
from fmus.compile import MATHS
from fmus.schedule import rescheduled

x = ca.SX.sym("x", 64)


def searches() -> Any:
    """Return four Newton searches, each a chain of its own, and what they have in common."""
    found = []
    for k in range(4):
        at = x[k]
        for _ in range(6):
            value = sum(x[4 + j] * at**j for j in range(6)) - ca.fmax(x[10], ca.sin(x[11 + k]))
            at = at - value / ca.sqrt(1 + (at * x[20]) ** 2)
        found.append(ca.if_else(at > x[30], at, -at))
    return ca.vertcat(*found, sum(found))


def products() -> Any:
    """Return many short products, which a processor sees side by side as they are."""
    return ca.vertcat(*(x[i] * x[i + 1] + x[i + 2] for i in range(60)))


def chain() -> Any:
    """Return one chain, in which nothing can come sooner."""
    at = x[0]
    for i in range(1, 64):
        at = ca.sqrt(1 + at * x[i])
    return at


def source(expression: Any, tmp_path: Path) -> str:
    generator = ca.CodeGenerator("f.c", {"with_header": False})
    generator.add(ca.Function("f", [x, ca.SX.sym("u")], [ca.cse(expression)]))
    generator.generate(f"{tmp_path}/")
    return (tmp_path / "f.c").read_text()


def result(text: str, folder: Path, n: int) -> bytes:
    """Compile a source and return the bits that it computes of random numbers."""
    folder.mkdir()
    (folder / "f.c").write_text(text)
    library = folder / "f.so"
    command = [
        *(compiler() or ["cc"]),
        "-O2",
        *MATHS,
        "-shared",
        "-fPIC",
        str(folder / "f.c"),
        "-o",
        str(library),
        "-lm",
    ]
    subprocess.run(command, check=True)
    given, unused, out = np.random.default_rng(5).uniform(0.5, 1.5, 64), np.zeros(1), np.zeros(n)
    pointer = ctypes.POINTER(ctypes.c_double)
    arguments = (pointer * 8)(*(a.ctypes.data_as(pointer) for a in (given, unused)))
    results = (pointer * 8)(out.ctypes.data_as(pointer))
    assert ctypes.CDLL(str(library)).f(arguments, results, None, None, 0) == 0
    return out.tobytes()


def waits(text: str) -> list[int]:
    """Return how many statements behind each root the first one that needs it comes."""
    lines, found = text.splitlines(), []
    for i, line in enumerate(lines):
        if match := re.match(r"  (?:const casadi_real )?(\w+)=sqrt\(", line):
            needed = re.compile(rf"=.*\b{match[1]}\b")
            found.append(next(k for k, later in enumerate(lines[i + 1 :], 1) if needed.search(later)))
    return found


def test_chains_run_side_by_side_with_the_same_bits(tmp_path: Path) -> None:
    plain = source(searches(), tmp_path)
    other = rescheduled(plain)
    computed = [re.findall(r"^  (?:const casadi_real )?[ab]\d+=", text, re.MULTILINE) for text in (plain, other)]
    assert len(computed[0]) == len(computed[1])  # nothing is left out, nothing done twice
    assert result(plain, tmp_path / "plain", 5) == result(other, tmp_path / "other", 5)
    assert np.median(waits(plain)) == 1  # the next statement needs what is not there for 20 cycles
    assert np.median(waits(other)) >= 4


@pytest.mark.parametrize("expression", [products, chain])
def test_what_gains_nothing_stays_as_it_is(expression: Any, tmp_path: Path) -> None:
    plain = source(expression(), tmp_path)
    assert rescheduled(plain) == plain


def test_a_function_of_matrices_stays_as_it_is(tmp_path: Path) -> None:
    """CasADi writes calls and loops there."""
    a = ca.MX.sym("a", 8, 8)
    generator = ca.CodeGenerator("f.c", {"with_header": False})
    generator.add(ca.Function("f", [a], [ca.solve(a, a @ a)]))
    generator.generate(f"{tmp_path}/")
    plain = (tmp_path / "f.c").read_text()
    assert rescheduled(plain) == plain
