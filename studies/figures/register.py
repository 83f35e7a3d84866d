"""All figures and tables in the order of the thesis: what `wmr-cosim figures` makes."""

from __future__ import annotations

import re
from collections.abc import Sequence

from cosim.errors import ScenarioError, nearest

from . import dimensions, manoeuvre, parameters, rigid, shock, traction, wheels
from .entry import Entry

# what each part is about; their order is that of the report
PARTS = {
    "chapter 3": "wheels and their slip control",
    "chapter 4": "a rigid robot on uneven ground: loss of contact, and the traction of least jerk",
    "chapter 5": "planning the pitch of a robot that climbs an obstacle",
    "chapter 6": "keeping deformable wheels on the ground after an impact",
    "chapter 7": "how the chassis responds to a shock: method",
    "chapter 8": "how the chassis responds to a shock: cases",
    "wheel impact paper": "chapter 6 in short",
    "smooth manoeuvre paper": "chapter 5 in short, over another obstacle",
    "DYMAC paper": "least jerk: another robot, its parameters varied",
    "ASME paper": "least jerk over a hump: longitudinal, normal and pitch",
    "TIMR paper": "least jerk: longitudinal",
    "shock paper": "three shapes of a pulse on the chassis",
    "co-simulation": "what the thesis could not do",
}
ENTRIES: tuple[Entry, ...] = (
    *parameters.ENTRIES,
    *wheels.ENTRIES,
    *rigid.ENTRIES,
    *traction.ENTRIES,
    *dimensions.ENTRIES,
    *manoeuvre.ENTRIES,
    *shock.ENTRIES,
)


def _place(entry: Entry) -> tuple[int, bool, list[int]]:
    numbers = [int(n) for n in re.findall(r"\d+", entry.key)]
    return list(PARTS).index(entry.part), "table" not in entry.key, numbers


def chosen(keys: Sequence[str] = (), among: tuple[Entry, ...] = ENTRIES) -> list[Entry]:
    """Return the entries of *keys* in the order of the report, all if none are given.

    A key is that of a figure, its beginning ("thesis 8") or a part ("chapter 8").  Raises ScenarioError for one that
    names nothing.
    """
    ordered = sorted(among, key=_place)
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
