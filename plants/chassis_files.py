"""Files of modal data: the same content as JSON, as CSV (a row per mode), or as NumPy's NPZ.

| | mode by mode | shapes |
| --- | --- | --- |
| JSON | ``frequency``, ``damping``: lists | tables ``wheels`` (fl, fr, rl, rr) and ``stations`` (by name) of lists |
| CSV | columns ``frequency``, ``damping`` | columns ``wheels.fl`` ..., ``stations.NAME`` |
| NPZ | arrays ``frequency``, ``damping`` (n,) | ``wheels`` (4, n), ``stations`` (m, n), ``names`` (m,), else 1 ... m |

Frequencies in Hz, damping as ratios, shapes vertical, upwards positive and mass-normalised (kg^-1/2).
"""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np

from cosim.errors import ScenarioError

SUFFIXES = (".json", ".csv", ".npz")
Document = dict[str, Any]


def read_document(path: Path, wheels: tuple[str, ...]) -> Document:
    """Return frequency, damping, wheels and stations of a file, unchecked; raises ScenarioError if unreadable."""
    readers = {".csv": _csv, ".npz": lambda p: _npz(p, wheels)}
    try:
        return readers.get(path.suffix, _json)(path)
    except OSError as error:
        raise ScenarioError(f"cannot read the modal data {path}: {error.strerror or error}") from None


def write_document(path: Path, document: Mapping[str, Any]) -> None:
    """Write a document in the format of its suffix (JSON for any other), every bit kept."""
    shapes = {f"{group}.{name}": row for group in ("wheels", "stations") for name, row in document[group].items()}
    if path.suffix == ".csv":
        columns = {"frequency": document["frequency"], "damping": document["damping"], **shapes}
        with path.open("w", newline="", encoding="utf-8") as file:
            csv.writer(file).writerows([columns, *zip(*columns.values(), strict=True)])
    elif path.suffix == ".npz":
        wheels, stations = (np.array(list(document[group].values())) for group in ("wheels", "stations"))
        names = np.array(list(document["stations"]))
        np.savez(
            path,
            frequency=document["frequency"],
            damping=document["damping"],
            wheels=wheels,
            stations=stations,
            names=names,
        )
    else:
        path.write_text(json.dumps(document, indent=1), encoding="utf-8")


def _json(path: Path) -> Document:
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except ValueError as error:
        raise ScenarioError(f"the modal data {path} are not JSON: {error}") from None
    if not isinstance(document, dict):
        raise ScenarioError(f"the modal data {path} must be an object with frequency, damping, wheels and stations")
    return document


def _csv(path: Path) -> Document:
    """Read one row per mode under a header; lines that start with # are comments."""
    try:
        with path.open(newline="", encoding="utf-8") as file:
            rows = list(csv.reader(line for line in file if line.strip() and not line.startswith("#")))
    except (UnicodeDecodeError, csv.Error) as error:
        raise ScenarioError(f"the modal data {path} are not CSV: {error}") from None
    if len(rows) < 2:
        raise ScenarioError(f"the modal data {path} need a header and one row per mode")
    header = [name.strip() for name in rows[0]]
    found: Document = {"wheels": {}, "stations": {}}
    for number, row in enumerate(rows[1:], 1):
        if len(row) != len(header):
            raise ScenarioError(f"{path}: mode {number} has {len(row)} values, but the header has {len(header)}")
    for name, column in zip(header, zip(*rows[1:], strict=True), strict=True):
        group, dot, node = name.partition(".")
        if dot and group in ("wheels", "stations"):
            found[group][node] = list(column)
        elif name in ("frequency", "damping"):
            found[name] = list(column)
        else:
            raise ScenarioError(
                f"{path}: the column {name!r} is not known; known are frequency, damping, wheels.fl and stations.NAME"
            )
    return found


def _npz(path: Path, wheels: tuple[str, ...]) -> Document:
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
    except (ValueError, BadZipFile, EOFError) as error:
        raise ScenarioError(f"the modal data {path} are not NPZ: {error}") from None
    found: Document = {k: v for k, v in arrays.items() if k in ("frequency", "damping")}
    for group in ("wheels", "stations"):
        if group not in arrays:
            continue
        table = arrays[group]
        names = [str(n) for n in arrays["names"]] if group == "stations" and "names" in arrays else None
        names = names or (list(wheels) if group == "wheels" else [str(k + 1) for k in range(len(np.atleast_1d(table)))])
        if table.ndim != 2 or len(table) != len(names):
            raise ScenarioError(
                f"{path}: {group} has the shape {table.shape}; it must have {len(names)} rows, one per node, "
                f"and a column per mode"
            )
        found[group] = dict(zip(names, table, strict=True))
    return found
