"""C for a CasADi function that does the same arithmetic of several wheels at once.

The equations of four wheels are four copies of the same operations on other numbers.  Operations of the same shape are
put together, four to a pack, and a pack is one operation on a vector of four.  Each number is computed from the same
operands by the same operation as alone, so every bit stays.  Vectors are an extension of the C of GCC and Clang; for
other compilers CasADi's own C stands beside this.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from math import isfinite

import casadi as ca

LANES = 4
_GATHERED = "((Four){"  # how a vector of values from here and there begins,
_GATHERING = 6  # and about how many operations it takes
_WORTH = 0.75  # of the operations: a function that does not come below is left to CasADi

_SCALAR = {
    ca.OP_ASSIGN: "{0}", ca.OP_ADD: "{0} + {1}", ca.OP_SUB: "{0} - {1}", ca.OP_MUL: "{0} * {1}",
    ca.OP_DIV: "{0} / {1}", ca.OP_NEG: "-{0}", ca.OP_SQ: "{0} * {0}", ca.OP_TWICE: "2 * {0}", ca.OP_INV: "1 / {0}",
    ca.OP_SQRT: "sqrt({0})", ca.OP_FMAX: "fmax({0}, {1})", ca.OP_FMIN: "fmin({0}, {1})", ca.OP_FABS: "fabs({0})",
    ca.OP_LT: "{0} < {1}", ca.OP_LE: "{0} <= {1}", ca.OP_EQ: "{0} == {1}", ca.OP_NE: "{0} != {1}",
    ca.OP_NOT: "!{0}", ca.OP_AND: "{0} && {1}", ca.OP_OR: "{0} || {1}", ca.OP_IF_ELSE_ZERO: "{0} ? {1} : 0",
    ca.OP_SIN: "sin({0})", ca.OP_COS: "cos({0})", ca.OP_TAN: "tan({0})", ca.OP_ASIN: "asin({0})",
    ca.OP_ACOS: "acos({0})", ca.OP_ATAN: "atan({0})", ca.OP_ATAN2: "atan2({0}, {1})", ca.OP_TANH: "tanh({0})",
    ca.OP_EXP: "exp({0})", ca.OP_LOG: "log({0})", ca.OP_POW: "pow({0}, {1})", ca.OP_CONSTPOW: "pow({0}, {1})",
    ca.OP_FLOOR: "floor({0})", ca.OP_CEIL: "ceil({0})",
}  # fmt: skip
_VECTOR = {
    ca.OP_ADD: "{0} + {1}", ca.OP_SUB: "{0} - {1}", ca.OP_MUL: "{0} * {1}", ca.OP_DIV: "{0} / {1}",
    ca.OP_NEG: "-{0}", ca.OP_SQ: "{0} * {0}", ca.OP_TWICE: "SAME(2.0) * {0}", ca.OP_INV: "SAME(1.0) / {0}",
    ca.OP_SQRT: "SQRT({0})", ca.OP_FMAX: "PICK({0} > {1}, {0}, {1})", ca.OP_FMIN: "PICK({0} < {1}, {0}, {1})",
    ca.OP_LT: "TRUTH({0} < {1})", ca.OP_LE: "TRUTH({0} <= {1})", ca.OP_EQ: "TRUTH({0} == {1})",
    ca.OP_NE: "TRUTH({0} != {1})", ca.OP_NOT: "TRUTH({0} == SAME(0.0))",
    ca.OP_IF_ELSE_ZERO: "(Four)(({0} != SAME(0.0)) & (Mask){1})",
}  # fmt: skip
_SLOW = (ca.OP_DIV, ca.OP_INV, ca.OP_SQRT)  # worth a detour
_GAIN = 4.0  # operations that four in one save, at most, for those who gather the operands


@dataclass
class _Value:
    """One number of the computation: an element of an argument, a constant, or an operation on earlier ones."""

    op: int
    args: tuple[int, ...]
    shape: int  # the same for values made by the same operations from the same kinds of leaves
    height: int = 0  # operations between it and the leaves
    leaf: str = ""  # C of an argument's element or a constant
    address: int = -1  # of that element
    pack: int = -1
    lane: int = 0


@dataclass
class _Computation:
    """The values of a function in order, which of them are its results, and the packs of values computed together."""

    values: list[_Value] = field(default_factory=list)
    results: list[int] = field(default_factory=list)
    packs: list[tuple[int, ...]] = field(default_factory=list)


def packed(function: ca.Function, name: str) -> str | None:
    """Return C called *name* of an SX function of one result, or None where vectors save little.

    The caller gives every argument that the function uses, and room for the result that overlaps none of them.
    """
    computation = _read(function)
    if computation is None:
        return None
    _pack(computation)
    statements = list(_statements(computation))
    work = len(statements) + _GATHERING * sum(text.count(_GATHERED) for text in statements)
    if work > _WORTH * sum(not v.leaf for v in computation.values):
        return None
    lines = [
        f"static WIDE int {name}(const double **arg, double **res, long long *iw, double *w, int mem)",
        "{",
        *(f"    {text};" for text in (*statements, *_stores(computation))),
        "    (void)iw, (void)w, (void)mem;",
        "    return 0;",
        "}",
    ]
    return "\n".join(lines) + "\n"


def _read(function: ca.Function) -> _Computation | None:
    """Return what a function computes, or None if that is no SX function or holds an operation that has no C here."""
    if not function.is_a("SXFunction"):
        return None
    found, at = _Computation(), dict[int, int]()  # which value a place of CasADi's work vector holds
    shapes: dict[tuple[object, ...], int] = {}
    values = found.values
    key: tuple[object, ...]
    for i in range(function.n_instructions()):
        op, ins, outs = function.instruction_id(i), function.instruction_input(i), function.instruction_output(i)
        if op == ca.OP_OUTPUT:
            found.results.append(at[ins[0]])  # element by element, as they are dense
            continue
        if op == ca.OP_INPUT:
            key, value = (op, ins[0]), _Value(op, (), 0, leaf=f"arg[{ins[0]}][{ins[1]}]", address=ins[1])
        elif op == ca.OP_CONST:
            number = float(function.instruction_constant(i))
            key, value = (op, repr(number)), _Value(op, (), 0, leaf=f"({number!r})")
            if not isfinite(number):
                return None
        elif op in _SCALAR:
            args = tuple(at[a] for a in ins)
            key = (op, *(values[a].shape for a in args))
            value = _Value(op, args, 0, height=1 + max(values[a].height for a in args))
        else:
            return None
        value.shape = shapes.setdefault(key, len(shapes))
        at[outs[0]] = len(values)
        values.append(value)
    return found


def _pack(c: _Computation) -> None:
    """Put values of the same shape together where that pays.

    Values computed from packs follow the lanes of these.  Of others those that share an operand belong together, as the
    products of a matrix and a vector: four neighbours, where that makes neighbours in memory of the other operands,
    else one of each quarter, since CasADi's order has one wheel after the other.
    """
    classes: dict[tuple[int, int], list[int]] = defaultdict(list)
    for i, v in enumerate(c.values):
        if v.op in _VECTOR:
            classes[v.height, v.shape].append(i)
    for _, members in sorted(classes.items()):
        left: list[int] = []
        beside: dict[tuple[int, ...], list[int]] = defaultdict(list)
        for i in members:
            packs = tuple(c.values[a].pack for a in c.values[i].args)
            (beside[packs] if max(packs) >= 0 else left).append(i)
        for group in beside.values():
            left += _follow(c, group)
        left.sort(key=lambda i: (*(c.values[a].address for a in c.values[i].args), i))
        for group in _by_operand(c, left):
            quarter = len(group) // LANES
            near = [tuple(group[LANES * n : LANES * (n + 1)]) for n in range(quarter)]
            if not (near and any(_is_row(c, operand) for operand in _operands(c, near[0]))):
                near = [tuple(group[n + quarter * lane] for lane in range(LANES)) for n in range(quarter)]
            for four in near:
                _accept(c, four)


def _by_operand(c: _Computation, members: Sequence[int]) -> list[list[int]]:
    """Return *members* by the operand that most of the others have too."""
    often = Counter(a for i in members for a in set(c.values[i].args))
    groups: dict[int, list[int]] = defaultdict(list)
    for i in members:
        shared = max(c.values[i].args, key=lambda a: often[a])
        groups[shared if often[shared] >= LANES else -1].append(i)
    return list(groups.values())


def _follow(c: _Computation, members: Sequence[int]) -> list[int]:
    """Pack *members*, whose arguments lie in the same packs, lane by lane; return those left over."""
    lanes: list[list[int]] = [[] for _ in range(LANES)]
    for i in members:
        lanes[next(c.values[a].lane for a in c.values[i].args if c.values[a].pack >= 0)].append(i)
    whole = min(len(lane) for lane in lanes)
    left = [i for lane in lanes for i in lane[whole:]]
    for group in zip(*(lane[:whole] for lane in lanes), strict=True):
        if not _accept(c, group):
            left += group
    return left


def _accept(c: _Computation, group: tuple[int, ...]) -> bool:
    gain = _GAIN * (4 if c.values[group[0]].op in _SLOW else 1)
    if sum(_cost(c, operand) for operand in _operands(c, group)) > gain:
        return False
    for lane, i in enumerate(group):
        c.values[i].pack, c.values[i].lane = len(c.packs), lane
    c.packs.append(group)
    return True


def _operands(c: _Computation, group: tuple[int, ...]) -> list[tuple[int, ...]]:
    return list(zip(*(c.values[i].args for i in group), strict=True))


def _cost(c: _Computation, operand: tuple[int, ...]) -> float:
    """Return about how many operations it takes to have these values in one vector."""
    values = [c.values[i] for i in operand]
    if _is_pack(c, operand):
        return 0.0
    if len(set(operand)) == 1 or _is_row(c, operand):
        return 0.5
    if all(v.leaf for v in values):
        return 1.5
    return 2.5 if len({v.pack for v in values}) <= 2 and all(v.pack >= 0 for v in values) else 3.0


def _is_pack(c: _Computation, operand: tuple[int, ...]) -> bool:
    pack = c.values[operand[0]].pack
    return pack >= 0 and c.packs[pack] == operand


def _is_row(c: _Computation, operand: tuple[int, ...]) -> bool:
    """Whether the values are neighbours in memory."""
    values = [c.values[i] for i in operand]
    if any(v.op != ca.OP_INPUT for v in values):
        return False
    kind, first = values[0].shape, values[0].address
    return all(v.shape == kind and v.address == first + lane for lane, v in enumerate(values))


def _statements(c: _Computation) -> Iterator[str]:
    """Yield what computes the values, those first that nothing keeps waiting; between them are those of other lanes."""
    last = {pack: max(group) for pack, group in enumerate(c.packs)}
    done: set[int] = set()
    for i in sorted(range(len(c.values)), key=lambda i: (c.values[i].height, last.get(c.values[i].pack, i), i)):
        v = c.values[i]
        if v.leaf or v.pack in done:
            continue
        if v.pack < 0:
            yield f"const double a{i} = {_SCALAR[v.op].format(*(_scalar(c, a) for a in v.args))}"
            continue
        done.add(v.pack)
        operands = (_vector(c, operand) for operand in _operands(c, c.packs[v.pack]))
        yield f"const Four b{v.pack} = {_VECTOR[v.op].format(*operands)}"


def _stores(c: _Computation) -> Iterator[str]:
    """Yield what puts the results into their places, four neighbours at once where they are a pack."""
    n = 0
    while n < len(c.results):
        four = tuple(c.results[n : n + LANES])
        if _is_pack(c, four):
            yield f"TO(res[0] + {n}) = b{c.values[four[0]].pack}"
            n += LANES
        else:
            yield f"res[0][{n}] = {_scalar(c, four[0])}"
            n += 1


def _scalar(c: _Computation, i: int) -> str:
    v = c.values[i]
    return v.leaf or (f"b{v.pack}[{v.lane}]" if v.pack >= 0 else f"a{i}")


def _vector(c: _Computation, operand: tuple[int, ...]) -> str:
    values = [c.values[i] for i in operand]
    if _is_pack(c, operand):
        return f"b{values[0].pack}"
    if len(set(operand)) == 1:
        return f"SAME({_scalar(c, operand[0])})"
    if _is_row(c, operand):
        return f"FROM(&{values[0].leaf})"
    return f"{_GATHERED}{', '.join(_scalar(c, i) for i in operand)}}})"
