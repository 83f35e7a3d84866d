"""What is wrong in print: the equation, its right form, how that is shown, and what it changes.

| kind | meaning |
| --- | --- |
| wrong | it gives wrong values |
| incomplete | a term or a condition is missing without which it does not hold |
| misprint | a slip that its surroundings put right |
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

from .notation import latex, readable

WRONG, INCOMPLETE, MISPRINT = "wrong", "incomplete", "misprint"
KINDS = (WRONG, INCOMPLETE, MISPRINT)
VISIBLE = 1e-3  # relative: what a printed form must be off by, at places chosen without looking, to count as wrong


class Gap(NamedTuple):
    """How far the right and the printed form lie from a derivation of its own, relative to what is derived."""

    right: float
    printed: float
    tolerance: float = 1e-20  # of 30 digits, with ten to spare for what cancels

    @property
    def shown(self) -> bool:
        """Whether the derivation confirms the right form and refutes the printed one."""
        return self.right <= self.tolerance and self.printed > VISIBLE


class Tex(NamedTuple):
    """The two forms in LaTeX, without delimiters, the left side included."""

    printed: str
    right: str


@dataclass(frozen=True)
class Erratum:
    """An error in print.  *printed* and *right* are formulas (`notation`) or words for what *left* is equal to.

    *equation* begins with the number; *where* is the section; *source* is the thesis or one of its papers, and *also*
    names where else the same is printed.  *derive* derives what is right from first principles and compares.
    """

    equation: str
    chapter: str
    where: str
    kind: str
    left: str
    printed: str
    right: str
    shown: str
    consequence: str
    derive: Callable[[Erratum], Gap]
    source: str = "thesis"
    also: tuple[str, ...] = ()

    @property
    def key(self) -> str:
        """What the entry is called: the equation, after the paper if it is one of a paper."""
        return self.equation if self.source == "thesis" else f"{self.source} {self.equation}"

    @property
    def number(self) -> str:
        """The number of the equation alone, with its paper."""
        return self.key.removesuffix(self.equation) + self.equation.split()[0]

    def check(self) -> Gap:
        """Derive the right form again and return how far both forms are from it."""
        return self.derive(self)

    @property
    def text(self) -> tuple[str, str]:
        """The printed and the right form, each on one readable line."""
        return self._joined(readable, self.printed), self._joined(readable, self.right)

    @property
    def latex(self) -> Tex:
        """The printed and the right form in LaTeX."""
        return Tex(self._joined(latex, self.printed), self._joined(latex, self.right))

    def _joined(self, written: Callable[[str], str], form: str) -> str:
        return f"{written(self.left)} = {written(form)}" if self.left else written(form)
