"""Many runs as one table: every log of a folder with its properties and verdict, filtered and sorted."""

from __future__ import annotations

import operator
import re
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from cosim.errors import ScenarioError, nearest

from .read import properties

_OPERATORS: dict[str, Callable[[Any, Any], bool]] = {
    "<=": operator.le, ">=": operator.ge, "!=": operator.ne, "=": operator.eq, "<": operator.lt, ">": operator.gt,
}  # fmt: skip
_CONDITION = re.compile(r"\s*([\w.]+)\s*(<=|>=|!=|=|<|>)\s*(.+?)\s*$")
_TITLES = ("run", "outcome", "metrics", "provenance")  # whose keys may be used without their title


def runs(folder: Path) -> list[dict[str, Any]]:
    """Return a flat row per log of *folder* (unfinished ones too): ``path``, ``status`` and all properties by key.

    A key of two tables is that of the first of run, outcome, metrics, provenance; ``metrics.front_off`` is exact.
    Combined logs, which are no runs, are left out.  Raises ScenarioError if there is no such folder.
    """
    if not folder.is_dir():
        raise ScenarioError(f"there is no folder {folder} of logs; make some with wmr-cosim run or compare")
    found = []
    for path in sorted([*folder.rglob("*.rrd"), *folder.rglob("*.rrd*.part")]):
        try:
            tables = properties(path)
        except ScenarioError as error:
            found.append({"path": str(path), "status": "unreadable", "error": str(error)})
            continue
        if "run" in tables:
            found.append(_row(path, tables))
    return found


def _row(path: Path, tables: dict[str, dict[str, Any]]) -> dict[str, Any]:
    row: dict[str, Any] = {"path": str(path), "status": tables.get("outcome", {}).get("status", "incomplete")}
    for title in _TITLES:
        for key, value in tables.get(title, {}).items():
            row[f"{title}.{key}"] = value
            row.setdefault(key, value)
    return row


def select(rows: Iterable[dict[str, Any]], conditions: Iterable[str], sort: str | None = None) -> list[dict[str, Any]]:
    """Return the rows that meet all *conditions*, such as ``scenario=ramp-impact`` or ``front_off<10``, sorted.

    *sort* is a key, largest first if it begins with ``-``; rows without it come last.  Raises ScenarioError for a
    condition that cannot be read and for a key that no row has.
    """
    kept = list(rows)
    keys = {key for row in kept for key in row}
    for condition in conditions:
        match = _CONDITION.match(condition)
        if match is None:
            raise ScenarioError(
                f"cannot read the condition {condition!r}; write it like scenario=ramp-impact or speed_min>0"
            )
        key, sign, text = match.groups()
        _known(key, keys)
        kept = [row for row in kept if key in row and _holds(row[key], sign, text)]
    if sort:
        key, falling = sort.removeprefix("-"), sort.startswith("-")
        _known(key, keys)
        have = [row for row in kept if row.get(key) is not None]
        have.sort(key=lambda row: (isinstance(row[key], str), row[key]), reverse=falling)
        kept = have + [row for row in kept if row.get(key) is None]
    return kept


def _known(key: str, keys: set[str]) -> None:
    if keys and key not in keys:
        raise ScenarioError(f"no log has a property or metric {key!r}; {nearest(key, sorted(keys))}")


def _holds(value: Any, sign: str, text: str) -> bool:
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        try:
            return _OPERATORS[sign](float(value), float(text))
        except ValueError:
            return sign == "!="
    return _OPERATORS[sign](str(value), text)
