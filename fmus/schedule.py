"""The order of the statements of generated C: CasADi's is good for few registers, this one for processors.

CasADi finishes one expression before it begins the next.  A Newton search is a chain in which every operation waits for
the one before, and the four wheels' searches lie so far apart that no processor looks ahead from one to the other.
Here every statement comes as soon as what it needs is there: the wheels' chains run side by side.  The operations and
their operands stay what they were, so every bit does.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from heapq import heappop, heappush

_FUNCTION = re.compile(r"^static int casadi_f\d+\(.*\{\n(?P<body>(?:.*\n)*?)\}\n", re.MULTILINE)
_DECLARED = re.compile(r"\s*(casadi_real a[\w, ]+;|return 0;|)")
_COMPUTED = re.compile(r"\s*(a\d+)=(.*);")
_RESULT = re.compile(r"\s*if \(res\[0\]!=0\) (res\[0\]\[\d+\])=(.*);")
_ARGUMENT = re.compile(r"arg\[(\d)\]\? arg\[\d\]\[(\d+)\] : 0")
_VARIABLE = re.compile(r"\ba\d+\b")
_SLOW = re.compile(r"\b(sin|cos|tan|asin|acos|atan|atan2|tanh|exp|log|pow)\(")
_USUAL, _DIVISION, _ROOT, _CALL = 4, 13, 20, 60  # cycles until a result is there
_LOOKAHEAD, _WIDTH = 224, 3  # statements that a processor has in sight, and begins in a cycle
_GAIN = 0.75  # of the time; what gains less loses it again to values that no longer fit into registers
_HELD = 5  # arguments that the harness always gives: t, h, x, u, p, w are 0 to 5


@dataclass(frozen=True)
class _Statement:
    target: str  # of a result; "" for what only others need
    text: str  # with operands as b<number of the statement that computes them>
    needs: tuple[int, ...]
    cycles: int


def rescheduled(source: str) -> str:
    """Return C source by CasADi with the statements of its longer functions in an order that saves time."""
    return _FUNCTION.sub(_function, source)


def _function(found: re.Match[str]) -> str:
    statements = _statements(found["body"].splitlines())
    if statements is None:
        return found[0]
    order = _order(statements)
    if _time(statements, order) > _GAIN * _time(statements, range(len(statements))):
        return found[0]
    head = found[0][: found[0].index("\n") + 1]
    lines = (f"  {s.target or f'const casadi_real b{i}'}={s.text};\n" for i in order for s in [statements[i]])
    return f"{head}{''.join(lines)}  return 0;\n}}\n"


def _statements(lines: Sequence[str]) -> list[_Statement] | None:
    """Return the statements, each variable computed once; None for a function that holds something else."""
    found: list[_Statement] = []
    now: dict[str, int] = {}  # which statement computed what a variable holds
    for line in lines:
        computed, result = _COMPUTED.fullmatch(line), _RESULT.fullmatch(line)
        match = computed or result
        if match is None:
            if _DECLARED.fullmatch(line):
                continue
            return None
        text = match[2]
        needs = tuple(now[v] for v in _VARIABLE.findall(text))
        text = _VARIABLE.sub(lambda v: f"b{now[v[0]]}", text)
        text = _ARGUMENT.sub(lambda a: f"arg[{a[1]}][{a[2]}]" if int(a[1]) <= _HELD else a[0], text)
        found.append(_Statement("" if computed else match[1], text, needs, _cycles(text)))
        if computed:
            now[match[1]] = len(found) - 1
    return found


def _cycles(text: str) -> int:
    if _SLOW.search(text):
        return _CALL
    return _ROOT if "sqrt(" in text else _DIVISION if "/" in text else _USUAL


def _order(statements: Sequence[_Statement]) -> list[int]:
    """Return the statements so that each comes when its operands are there, the first of CasADi's order before others.

    A processor that begins one statement in a cycle and none out of turn would never wait where another could go on.
    """
    users: list[list[int]] = [[] for _ in statements]
    missing = [len(set(s.needs)) for s in statements]
    for i, statement in enumerate(statements):
        for need in set(statement.needs):
            users[need].append(i)
    ready = [i for i, n in enumerate(missing) if n == 0]  # ascending, so it is a heap
    at, waiting, order, cycle = [0] * len(statements), list[tuple[int, int]](), list[int](), 0
    while len(order) < len(statements):
        while waiting and waiting[0][0] <= cycle:
            heappush(ready, heappop(waiting)[1])
        if ready:
            i = heappop(ready)
            order.append(i)
            for user in users[i]:
                at[user] = max(at[user], cycle + statements[i].cycles)
                missing[user] -= 1
                if missing[user] == 0:
                    heappush(waiting, (at[user], user))
        cycle += 1
    return order


def _time(statements: Sequence[_Statement], order: Sequence[int]) -> int:
    """Return the cycles that a processor needs which looks `_LOOKAHEAD` statements ahead."""
    done, left = [0] * len(statements), list[int]()  # when each is computed; when all up to a place in the order are
    for place, i in enumerate(order):
        begin = max(place // _WIDTH, left[place - _LOOKAHEAD] if place >= _LOOKAHEAD else 0)
        done[i] = max([begin, *(done[need] for need in statements[i].needs)]) + statements[i].cycles
        left.append(max(done[i], left[-1] if left else 0))
    return left[-1] if left else 0
