"""The C of a component: its equations by CasADi, and the description of its slots that the harness reads."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np

from cosim.component import table_text
from cosim.equations import reads

from .layout import Layout
from .vectors import LANES, packed

PREFIX = "eq_"  # a function's name becomes a C identifier: alone, "jump" or "out" might collide


# The directional derivatives are the longest function and the least called: optimising them took most of the compile
# time (15 of 20 s for the rigid body).
_UNHURRIED = """\
#if defined(__clang__)
#pragma clang optimize off
#elif defined(__GNUC__)
#pragma GCC push_options
#pragma GCC optimize("O0")
#endif
"""
_HURRIED = """\
#if defined(__clang__)
#pragma clang optimize on
#elif defined(__GNUC__)
#pragma GCC pop_options
#endif
"""


def equations_source(layout: Layout) -> str:
    """Return the C of the component's equation functions."""
    options = {"with_header": False, "main": False, "mex": False, "with_mem": False}
    generator = ca.CodeGenerator("equations.c", options)
    functions = layout.component.equations.functions()
    if "zero" in functions:  # both are asked for at the end of a step, and much is common to them
        functions["out"] = _together(functions["out"], functions["zero"])
    exported = [_exported(f, PREFIX + name) for name, f in functions.items()]
    for function in exported:
        generator.add(function)
    with tempfile.TemporaryDirectory() as folder:
        generator.generate(f"{folder}/")
        source = Path(folder, "equations.c").read_text()
    begin, end = source.index(f"/* {PREFIX}jvp:"), source.index(f"CASADI_SYMBOL_EXPORT int {PREFIX}jvp(")
    source = "".join((source[:begin], _UNHURRIED, source[begin:end], _HURRIED, source[end:]))
    found = ((f.name(), packed(f, f"packed_{f.name()}")) for f in exported if f.name() != f"{PREFIX}jvp")
    vectors = [f"{text}#define {name} packed_{name}\n" for name, text in found if text is not None]
    return "".join((source, "#ifdef WITH_VECTORS\n", *vectors, "#endif\n"))


def _together(one: ca.Function, other: ca.Function) -> ca.Function:
    """Return the function of both results, one behind the other."""
    arguments = _arguments(one)
    return ca.Function(one.name(), arguments, [ca.vertcat(one(*arguments), other(*arguments))])


def _exported(function: ca.Function, name: str) -> ca.Function:
    """Return the function under another name, with what it computes more than once computed once."""
    arguments = _arguments(function)
    return ca.Function(name, arguments, ca.cse(function.call(arguments)))


def _arguments(function: ca.Function) -> Any:
    return function.mx_in() if function.is_a("MXFunction") else function.sx_in()


def model_source(layout: Layout, identifier: str, token: str, fmi: int) -> str:
    """Return the C that describes the component to the harness and includes its equations."""
    eq, first, start = layout.component.equations, layout.first, layout.start()
    extent = np.zeros(first["end"], int)
    extent[0] = 1
    for v in layout.variables:
        if v.type != "String":
            extent[layout.reference[v.name]] = v.size
    functions = eq.functions()
    events = [
        label
        for b in eq.events
        for label in ([b.name] if not b.shape else [f"{b.name}[{i + 1}]" for i in range(b.shape[0])])
    ]
    tables = [
        f"{{{_quoted(b.name)}, {b.shape[0]}, {b.shape[1]}, {_quoted(table_text(layout.component.values[b.name]))}}}"
        for b in eq.tables
    ]
    period = -1 if eq.period is None else first["p"] + eq.period
    alone, decides = eq.deciding()
    filling = [1.0] * (-len(eq.nominal) % LANES)  # up to whole vectors
    sizes = {
        "n_p": first["u"] - first["p"],
        "n_u": first["x"] - first["u"],
        "n_x": first["y"] - first["x"],
        "n_y": first["dx"] - first["y"],
        "n_g": len(events),
        "n_w": sum(b.shape[0] * b.shape[1] for b in eq.tables),
        "n_keys": sum(b.shape[0] for b in eq.tables),
        "n_tables": len(eq.tables),
        "of_states_alone": int(alone),
        "sync_looks_up": int(eq.sync is not None and reads(eq.sync, "w")),
        "n_k": eq.once.numel_out() if eq.once else 0,
        "period": period,
        "micro": -1 if eq.micro is None else first["p"] + eq.micro,
        "n_iw": max(f.sz_iw() for f in functions.values()),
        "n_work": max(f.sz_w() for f in functions.values()),
    }
    members = [f".identifier = {_quoted(identifier)}", f".token = {_quoted(token)}"]
    members += [f".{name} = {value}" for name, value in {**first, **sizes}.items()]
    arrays = ("start", "nominal", "labels", "extent", "events", "announced", "decides")
    members += [f".{name} = {name}_of" for name in arrays]
    members += [".tables = tables_of", *(f".{name} = {PREFIX}{name}" for name in functions)]
    return "\n".join(
        [
            f"/* {identifier}: its equations and the description of its slots; generated. */",
            f"#define FMI_VERSION {fmi}",
            f"#define SZ_ARG {max(9, *(f.sz_arg() for f in functions.values()))}",
            f"#define SZ_RES {max(f.sz_res() for f in functions.values())}",
            _INCLUDE_EQUATIONS,
            _array("double", "start_of", [repr(float(v)) for v in start]),
            _array("double", "nominal_of", [repr(float(v)) for v in (*eq.nominal, *filling)]),
            _array("char *const", "labels_of", [_quoted(label) for label in layout.labels()]),
            _array("unsigned", "extent_of", [str(n) for n in extent]),
            _array("char *const", "events_of", [_quoted(label) for label in events]),
            _array("unsigned char", "announced_of", [str(int(a)) for a in eq.announced]),
            _array("unsigned char", "decides_of", [str(int(d)) for d in decides]),
            _array("TableLayout", "tables_of", tables, "{0}"),
            "static const Model model = {\n    " + ",\n    ".join(members) + "};",
            "",
        ]
    )


_INCLUDE_EQUATIONS = """\
#define CASADI_SYMBOL_EXPORT static
#define casadi_int long long
/* fmax and fmin of <math.h> are calls into libm, around which no number stays in a register; written out they
 * are one instruction each.  A NaN goes on, where libm would drop it: it is found at the end of the step. */
static inline double larger(double x, double y) { return x > y ? x : y; }
static inline double smaller(double x, double y) { return x < y ? x : y; }
#define fmax(x, y) larger(x, y)
#define fmin(x, y) smaller(x, y)
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif
#include "equations.c"
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif
#undef fmax
#undef fmin"""


def _array(type: str, name: str, values: list[str], empty: str = "0") -> str:
    rows = [", ".join(values[i : i + 8]) for i in range(0, len(values), 8)] or [empty]  # C has no empty arrays
    return f"static const {type} {name}[] = {{\n    " + ",\n    ".join(rows) + "};"


def _quoted(text: str) -> str:
    """Return a C string literal; pieces, since compilers need not take more than 4095 characters in one."""
    pieces = [text[i : i + 2000].replace("\\", "\\\\").replace('"', '\\"') for i in range(0, len(text), 2000)] or [""]
    return " ".join(f'"{piece}"' for piece in pieces)
