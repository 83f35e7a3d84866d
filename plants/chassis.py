"""The chassis of a scenario: the plate with other dimensions, a file of modal data, or a finite-element result."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any, cast

from cosim.errors import ScenarioError, nearest

from .chassis_fe import PlateChassis
from .chassis_files import SUFFIXES
from .chassis_modal import ChassisModal
from .chassis_modes import ModalData, load_modal_data

# what a finite-element result needs beside the file
_PLACES = ("wheels", "stations", "up", "modal_mass", "tolerance")


def chassis(
    modal_data: str | None = None, modes: int | None = None, damping: float | None = None, **given: Any
) -> ChassisModal:
    """Return a chassis with the first *modes* modes (25, or all that a file has), every ratio *damping* if it is given.

    *modal_data* is a JSON, CSV or NPZ file (`plants.chassis_files`), or a finite-element result, with its wheels and
    stations beside it (`plants.chassis_results`).  Without a file it is the plate of `plants.chassis_fe` with the
    dimensions that are *given*.  Raises ScenarioError naming the parameter for what does not fit.
    """
    if modes is not None and (isinstance(modes, bool) or not isinstance(modes, int) or modes < 1):
        raise ScenarioError(f"modes must be a whole number from 1, not {modes!r}")
    data = _plate(modes or 25, given) if modal_data is None else _from_file(Path(modal_data), given)
    found = data.component(modes)
    return found if damping is None else cast(ChassisModal, found.replace(damping=damping))


def _plate(modes: int, given: Mapping[str, Any]) -> ModalData:
    known = [f.name for f in fields(PlateChassis) if f.name != "damping"]
    for name in given:
        if name in _PLACES:
            raise ScenarioError(f"{name} belongs to a finite-element result, but there is no modal_data; name the file")
        if name not in known:
            raise ScenarioError(
                f"a chassis has no parameter {name!r}; {nearest(name, [*known, 'modal_data', 'modes'])}"
            )
    dimensions: dict[str, Any] = {
        name: tuple(value) if isinstance(value, list) else value for name, value in given.items()
    }
    plate = PlateChassis(**dimensions)
    return plate.cached_modes(max(modes, 25)).first(modes)


def _from_file(path: Path, given: Mapping[str, Any]) -> ModalData:
    if path.suffix in SUFFIXES:
        for name in given:
            raise ScenarioError(f"{name} cannot stand beside modal_data = {str(path)!r}: the file says it all")
        return load_modal_data(path)
    from .chassis_results import modes_of_result

    for name in given:
        if name not in _PLACES:
            raise ScenarioError(f"{name} cannot stand beside modal_data = {str(path)!r}; {nearest(name, _PLACES)}")
    if "wheels" not in given:
        raise ScenarioError(f"{path} is a finite-element result; say where its wheels are: wheels = [[x, y, z], ...]")
    return modes_of_result(path, **given)
