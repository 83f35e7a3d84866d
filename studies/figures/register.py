"""All figures and tables in the order of the thesis: what `wmr-cosim figures` makes."""

from __future__ import annotations

import re
from collections.abc import Sequence

from cosim.errors import ScenarioError, nearest

from . import dimensions, fullorder, impact, jerk, manoeuvre, parameters, rigid, shock, traction, wheels
from .entry import Entry
from .parts import PARTS

ENTRIES: tuple[Entry, ...] = (
    *parameters.ENTRIES,
    *wheels.ENTRIES,
    *rigid.ENTRIES,
    *traction.ENTRIES,
    *dimensions.ENTRIES,
    *manoeuvre.ENTRIES,
    *impact.ENTRIES,
    *jerk.ENTRIES,
    *shock.ENTRIES,
    *fullorder.ENTRIES,
)


def _place(entry: Entry) -> tuple[int, bool, list[int]]:
    numbers = [int(n) for n in re.findall(r"\d+", entry.key)]
    return list(PARTS).index(entry.part), "table" not in entry.key, numbers


def chosen(keys: Sequence[str] = ()) -> list[Entry]:
    """Return the entries of *keys* in the order of the report, all if none are given.

    A key is that of a figure, its beginning ("thesis 8") or a part ("chapter 8").  Raises ScenarioError for one that
    names nothing.
    """
    ordered = sorted(ENTRIES, key=_place)
    found: set[str] = set()
    for key in keys:
        named = [e.key for e in ordered if _names(key.strip().lower(), e)]
        if not named:
            known = [e.key for e in ordered] + list(dict.fromkeys(e.part for e in ordered))
            raise ScenarioError(f"there is no figure {key!r}; {nearest(key, known)}")
        found |= set(named)
    return [e for e in ordered if not keys or e.key in found]


def _names(key: str, entry: Entry) -> bool:
    known = entry.key.lower()
    return key in (known, entry.part.lower()) or known.startswith((f"{key} ", f"{key}."))
