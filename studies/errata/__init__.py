"""The errors in the printed equations of the thesis and its papers, each with its right form and a derivation.

`REGISTER` holds the entries, in the order of print; `Erratum.check` derives the right form again.  `CONFIRMED` holds
the equations that the same derivations find right, `REFERENCES` what only names something else.
"""

from __future__ import annotations

from cosim.errors import ScenarioError, nearest

from . import (
    appendices_b_c,
    appendix_a,
    chapter3,
    chapter4_general,
    chapter4_ramp,
    chapter5,
    chapter6,
    chapter7,
    chapter8,
    papers,
)
from .confirmed import CONFIRMED, RIGHT, Confirmed
from .erratum import Erratum, Gap, Tex
from .references import REFERENCES, Reference

_PARTS = (
    chapter3, chapter4_general, chapter4_ramp, chapter5, chapter6, chapter7, chapter8, appendix_a, appendices_b_c,
    papers,
)  # fmt: skip
REGISTER: tuple[Erratum, ...] = tuple(entry for part in _PARTS for entry in part.ENTRIES)
CHAPTERS = tuple(dict.fromkeys(entry.chapter for entry in REGISTER))


def of_chapter(chapter: str) -> list[Erratum]:
    """Return the entries of a chapter, an appendix (A, B, C) or the "papers", those that only touch it last."""
    if chapter not in CHAPTERS:
        raise ScenarioError(f"no errors are known of chapter {chapter!r}; there are: {', '.join(CHAPTERS)}")
    touched = [e for e in REGISTER if any(f"{a} ".startswith((f"{chapter}.", f"{chapter} ")) for a in e.also)]
    own = [e for e in REGISTER if e.chapter == chapter]
    return own + [e for e in touched if e not in own]


def find(equation: str) -> list[Erratum]:
    """Return the entries of an equation, as "6.9" or "4.44 P_12"; also where it repeats the error of another."""
    wanted = equation.strip()
    found = [e for e in REGISTER if wanted in (e.key, e.equation)]
    found = found or [e for e in REGISTER if wanted in (e.number, *e.also)]
    if not found:
        right = [c.equation for c in CONFIRMED if wanted in (c.equation, c.equation.split()[0])]
        if right:
            raise ScenarioError(f"{', '.join(right)}: derived again and found right")
        raise ScenarioError(f"no error is known of equation {wanted!r}; {nearest(wanted, [e.key for e in REGISTER])}")
    return found


__all__ = [
    "CHAPTERS", "CONFIRMED", "REFERENCES", "REGISTER", "RIGHT", "Confirmed", "Erratum", "Gap", "Reference", "Tex",
    "find", "of_chapter",
]  # fmt: skip
