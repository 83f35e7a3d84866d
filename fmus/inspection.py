"""What an FMU is, and whether it keeps what it promises."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

import numpy as np
from fmpy.validation import validate_fmu

from cosim import CosimError, Instance, Variable
from cosim.clock import NS

from .importer import read
from .loading import load

STEP = NS // 1000  # 1 ms: short enough for anything that has dynamics


def info(path: str | os.PathLike[str]) -> dict[str, Any]:
    """Return what an FMU's description says, as JSON-able values; raises ExportError if it is none."""
    archive = read(path)
    return {
        "name": archive.model,
        "meaning": archive.meaning,
        "path": str(archive.path),
        "fmi": "2.0" if archive.fmi == 2 else "3.0",
        "token": archive.token,
        "platforms": list(archive.platforms),
        "capabilities": asdict(archive.can),
        "variables": [_described(v) for v in archive.variables.values()],
    }


def _described(v: Variable) -> dict[str, Any]:
    start = v.start.tolist() if isinstance(v.start, np.ndarray) else v.start
    return {
        "name": v.name,
        "causality": v.causality,
        "variability": v.variability,
        "type": v.type,
        "shape": list(v.shape),
        "unit": v.unit,
        "start": start.hex() if isinstance(start, bytes) else start,
        "meaning": v.meaning,
        "depends_on": None if v.depends_on is None else list(v.depends_on),
    }


def check(path: str | os.PathLike[str], *, isolated: bool | None = None) -> list[str]:
    """Return the problems of an FMU, none if it is sound: its description by FMPy, its behaviour by running it.

    *isolated* runs it in a process of its own, so that a crash is a problem like another.
    """
    problems = _validated(path)
    try:
        instance = load(path, isolated=isolated)
    except CosimError as error:
        return [*problems, str(error)]
    try:
        problems += _run(instance)
    except CosimError as error:
        problems.append(str(error))
    finally:
        instance.close()
    return problems


def _validated(path: str | os.PathLike[str]) -> list[str]:
    try:
        return [str(p).strip() for p in validate_fmu(str(path))]
    except Exception:  # FMPy lets through whatever a malformed archive runs into; loading it says what is wrong
        return []


def _run(instance: Instance) -> Iterator[str]:
    """Initialise, read everything, take ten steps; where it can, go back after the first five and take five again."""
    instance.enter_initialization()
    instance.push()
    instance.exit_initialization()
    yield from _reads(instance)
    _steps(instance, 0, 5)
    if not instance.can.rollback:
        _steps(instance, 5, 10)
        return
    snapshot = instance.snapshot()
    first = _steps(instance, 5, 10)
    instance.restore(snapshot)
    yield from _differences(instance, first, _steps(instance, 5, 10), "after its state was set back")
    if instance.can.serialize:
        instance.restore(instance.deserialize(instance.serialize(snapshot)))
        yield from _differences(instance, first, _steps(instance, 5, 10), "after its state went through bytes")
    instance.forget(snapshot)


def _reads(instance: Instance) -> Iterator[str]:
    for name, variable in instance.variables.items():
        if variable.type == "Clock":
            continue
        value = instance.get(name)
        if variable.type == "Float64" and not np.all(np.isfinite(value)):
            yield f"{name} is {value} after the initialisation"


def _steps(instance: Instance, first: int, last: int) -> np.ndarray:
    found = []
    for i in range(first, last):
        instance.push()
        instance.step(i * STEP, (i + 1) * STEP)
        instance.pull()
        found.append(instance.y.copy())
    return np.array(found)


def _differences(instance: Instance, first: np.ndarray, again: np.ndarray, when: str) -> Iterator[str]:
    for name, at in instance.y_at.items():
        if not np.array_equal(first[:, at], again[:, at], equal_nan=True):
            yield f"{name} is not the same {when}"
