"""Units spelt the Modelica way (``N.s/m``, ``m/s2``, ``kg.m2``, ``1``), stored as FMI base-unit exponents and a factor.

The exporter writes what the wiring check compares: exponents over FMI's eight base units (radian included), a factor
and an offset to that base.  Dimensionless is the explicit unit ``"1"``; there is no wildcard.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from math import isclose, pi

from .errors import DeclarationError

BASE = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")  # the order of FMI's BaseUnit attributes

# symbol: (factor, offset, exponents of the base units)
_SYMBOLS: dict[str, tuple[float, float, dict[str, int]]] = {
    **{name: (1.0, 0.0, {name: 1}) for name in BASE},
    "g": (1e-3, 0.0, {"kg": 1}),
    "min": (60.0, 0.0, {"s": 1}),
    "h": (3600.0, 0.0, {"s": 1}),
    "deg": (pi / 180, 0.0, {"rad": 1}),
    "rev": (2 * pi, 0.0, {"rad": 1}),
    "degC": (1.0, 273.15, {"K": 1}),
    "Hz": (1.0, 0.0, {"s": -1}),
    "N": (1.0, 0.0, {"kg": 1, "m": 1, "s": -2}),
    "Pa": (1.0, 0.0, {"kg": 1, "m": -1, "s": -2}),
    "bar": (1e5, 0.0, {"kg": 1, "m": -1, "s": -2}),
    "J": (1.0, 0.0, {"kg": 1, "m": 2, "s": -2}),
    "W": (1.0, 0.0, {"kg": 1, "m": 2, "s": -3}),
    "C": (1.0, 0.0, {"A": 1, "s": 1}),
    "V": (1.0, 0.0, {"kg": 1, "m": 2, "s": -3, "A": -1}),
    "Ohm": (1.0, 0.0, {"kg": 1, "m": 2, "s": -3, "A": -2}),
    "F": (1.0, 0.0, {"kg": -1, "m": -2, "s": 4, "A": 2}),
    "H": (1.0, 0.0, {"kg": 1, "m": 2, "s": -2, "A": -2}),
    "T": (1.0, 0.0, {"kg": 1, "s": -2, "A": -1}),
    "l": (1e-3, 0.0, {"m": 3}),
}
_PREFIXES = {"n": 1e-9, "u": 1e-6, "m": 1e-3, "c": 1e-2, "k": 1e3, "M": 1e6, "G": 1e9}
_OPERAND = re.compile(r"([A-Za-z]+)(-?\d+)?$")


@dataclass(frozen=True)
class Unit:
    """A unit: ``value_in_base = factor * value + offset``, with the base given by eight exponents."""

    exponents: tuple[int, int, int, int, int, int, int, int]
    factor: float = 1.0
    offset: float = 0.0

    def same_dimension(self, other: Unit) -> bool:
        """Whether the two differ at most by factor and offset."""
        return self.exponents == other.exponents

    def equals(self, other: Unit) -> bool:
        """Whether a number in one is the same number in the other (factors to 12 digits)."""
        return (
            self.same_dimension(other)
            and isclose(self.factor, other.factor, rel_tol=1e-12)
            and isclose(self.offset, other.offset, rel_tol=1e-12, abs_tol=1e-12)
        )

    def conversion(self, other: Unit) -> tuple[float, float]:
        """Return (a, b) such that ``a * value + b`` in *other* equals *value* in this unit."""
        return self.factor / other.factor, (self.offset - other.offset) / other.factor


def _operand(text: str, spelling: str) -> tuple[float, float, dict[str, int]]:
    match = _OPERAND.match(text)
    if not match:
        raise DeclarationError(
            f"cannot read unit {spelling!r}: {text!r} is not a symbol with an exponent, such as m or s2"
        )
    symbol, power = match[1], int(match[2] or 1)
    if symbol in _SYMBOLS:
        factor, offset, exponents = _SYMBOLS[symbol]
    elif symbol[0] in _PREFIXES and symbol[1:] in _SYMBOLS and _SYMBOLS[symbol[1:]][1] == 0:
        factor, offset, exponents = _SYMBOLS[symbol[1:]]
        factor *= _PREFIXES[symbol[0]]
    else:
        raise DeclarationError(f"cannot read unit {spelling!r}: the symbol {symbol!r} is not known")
    return factor**power, offset, {name: n * power for name, n in exponents.items()}


@cache
def parse(spelling: str) -> Unit:
    """Read a unit spelt the Modelica way: operands joined by dots, at most one division, ``(..)`` around a denominator.

    >>> parse("N.s/m").exponents
    (1, 0, -1, 0, 0, 0, 0, 0)
    >>> parse("km/h").factor == 1000 / 3600
    True

    Raises DeclarationError for a spelling or a symbol it does not know.
    """
    numerator, slash, denominator = spelling.partition("/")
    if "/" in denominator or (slash and not denominator) or not numerator:
        raise DeclarationError(f"cannot read unit {spelling!r}: write one division, such as N.s/m or W/(m2.K)")
    if denominator.startswith("(") and denominator.endswith(")"):
        denominator = denominator[1:-1]
    total, factor, shift = dict.fromkeys(BASE, 0), 1.0, 0.0
    terms = [(t, 1) for t in numerator.split(".") if t != "1"]
    terms += [(t, -1) for t in denominator.split(".")] if slash else []
    for text, side in terms:
        scale, offset, exponents = _operand(text, spelling)
        if offset and (len(terms) > 1 or text != spelling):
            raise DeclarationError(
                f"cannot read unit {spelling!r}: {text!r} has an offset and cannot be part of a product"
            )
        factor *= scale**side
        shift = offset
        for name, n in exponents.items():
            total[name] += side * n
    return Unit(tuple(total[name] for name in BASE), factor, shift)  # type: ignore[arg-type]


def rate_unit(unit: str) -> str:
    """Return the spelling of a unit per second: ``m/s`` for ``m``, ``m/s2`` for ``m/s``."""
    numerator, slash, denominator = unit.partition("/")
    if not slash:
        return f"{unit}/s"
    terms = denominator.strip("()").split(".")
    powers = {t.rstrip("0123456789"): int(t[len(t.rstrip("0123456789")) :] or 1) for t in terms}
    powers["s"] = powers.get("s", 0) + 1
    spelt = [f"{t}{n if n > 1 else ''}" for t, n in powers.items()]
    return f"{numerator}/{spelt[0] if len(spelt) == 1 else '(' + '.'.join(spelt) + ')'}"
