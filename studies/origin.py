"""Where a run was made: state of the source checkout, host, seeds.  For the record; nothing here is compared."""

from __future__ import annotations

import os
import platform
import subprocess
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

from cosim.instance import Instance
from cosim.scenario import Scenario

from .places import source_checkout

_CPU_INFO = Path("/proc/cpuinfo")


def origin(scenario: Scenario, instances: Mapping[str, Instance]) -> dict[str, dict[str, Any]]:
    """Return the tables ``checkout``, ``host`` and ``seeds`` of a run; empty where there is nothing to tell."""
    return {"checkout": checkout(source_checkout()), "host": host(), "seeds": seeds(scenario, instances)}


@cache
def checkout(root: Path | None) -> dict[str, Any]:
    """Return ``git_commit`` of a source checkout and whether tracked files differ from it, ``git_dirty``.

    Empty for an installed package, a copy without history, and where git is missing.  Asked once, since the modules
    that run are those loaded then.
    """
    if root is None or not (root / ".git").exists():
        return {}
    command = ["git", "-C", str(root), "status", "--porcelain=v2", "--branch", "--untracked-files=no"]
    try:
        lines = subprocess.run(command, capture_output=True, text=True, timeout=10, check=True).stdout.splitlines()
    except (OSError, subprocess.SubprocessError):
        return {}
    commit = next((line.split()[-1] for line in lines if line.startswith("# branch.oid ")), "")
    return {"git_commit": commit, "git_dirty": any(not line.startswith("#") for line in lines)}


@cache
def host() -> dict[str, Any]:
    """Return ``machine`` (x86_64, ...), ``cpu`` (its model, as far as known) and the number of ``cpus``."""
    model = platform.processor()
    if _CPU_INFO.is_file():
        named = (line for line in _CPU_INFO.read_text(errors="replace").splitlines() if line.startswith("model name"))
        model = next(named, model).partition(":")[2].strip() or model
    return {"machine": platform.machine(), "cpu": model or "unknown", "cpus": os.cpu_count()}


def seeds(scenario: Scenario, instances: Mapping[str, Instance]) -> dict[str, list[Any]]:
    """Return the seeds that a run depends on, as ``name`` and ``value``: of components, and others in the scenario."""
    found = {
        f"{name}.seed": int(instance.get("seed"))
        for name, instance in instances.items()
        if "seed" in instance.variables and instance.variables["seed"].causality == "parameter"
    }
    table = scenario.model_dump(mode="json")
    del table["components"]  # as they are: their seeds are known, also where the scenario leaves them as they are
    found |= dict(_seeds(table, ()))
    return {"name": list(found), "value": list(found.values())}


def _seeds(value: Any, path: tuple[str, ...]) -> Iterator[tuple[str, int]]:
    if isinstance(value, Mapping):
        for key, inner in value.items():
            yield from _seeds(inner, (*path, str(key)))
    elif isinstance(value, list):
        for i, inner in enumerate(value):
            yield from _seeds(inner, (*path, str(i + 1)))
    elif path and path[-1] == "seed":
        yield ".".join(path), int(value)
