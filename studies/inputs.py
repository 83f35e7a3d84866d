"""What a run was made from beside its configuration: the files it read and the sources it ran, as hashes."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any

from cosim.kept import written
from cosim.scenario import Scenario

Tables = Mapping[str, Mapping[str, Any]]  # of properties of a log
_LONGEST = 1024  # characters of a path
_COMPUTING = ("cosim", "plants", "controllers", "fmus", "studies")
_SOURCES = (".py", ".c", ".h")


def files(scenario: Scenario) -> dict[str, list[str]]:
    """Return the files that a scenario names (grounds in CSV, foreign FMUs): ``name``, ``path`` in full, ``sha256``."""
    names = sorted({text for text in _strings(scenario.model_dump(mode="json")) if _is_file(text)})
    return {"name": names, "path": [os.path.abspath(n) for n in names], "sha256": [digest(Path(n)) for n in names]}


def recorded(tables: Tables) -> dict[str, tuple[str, str]]:
    """Return the files that the run of a log with these properties read, by name: full path and SHA-256."""
    held = tables.get("files", {})
    columns = [[c] if isinstance(c, str) else list(c) for c in (held.get(k) or [] for k in ("name", "path", "sha256"))]
    return {name: (path, sha) for name, path, sha in zip(*columns, strict=True)}


def placed(scenario: Scenario, files: Mapping[str, tuple[str, str]]) -> Scenario:
    """Return a scenario that names its recorded *files* in full, so that it can be run from another folder."""
    return Scenario.model_validate(
        _renamed(scenario.model_dump(mode="json"), {n: path for n, (path, _) in files.items()})
    )


def _renamed(value: Any, names: Mapping[str, str]) -> Any:
    if isinstance(value, str):
        return names.get(value, value)
    if isinstance(value, dict):
        return {key: _renamed(inner, names) for key, inner in value.items()}
    return [_renamed(inner, names) for inner in value] if isinstance(value, list) else value


def digest(path: Path) -> str:
    """Return the SHA-256 of a file."""
    return sha256(path.read_bytes()).hexdigest()


@cache
def sources() -> str:
    """Return one hash over all sources that the numbers of a run depend on."""
    root, found = Path(__file__).resolve().parent.parent, sha256()
    for package in _COMPUTING:
        for path in written(root / package):
            if path.suffix in _SOURCES:
                found.update(f"{path.relative_to(root)}\0".encode() + path.read_bytes())
    return found.hexdigest()[:16]


def _strings(value: Any) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, Mapping):
        for inner in value.values():
            yield from _strings(inner)
    elif isinstance(value, (list, tuple)):
        for inner in value:
            yield from _strings(inner)


def _is_file(text: str) -> bool:
    try:
        return 0 < len(text) < _LONGEST and "\n" not in text and Path(text).is_file()
    except OSError:  # a name that is too long for a file
        return False
