"""FMU file or component -> instance, in this process or in one of its own."""

from __future__ import annotations

import os
import weakref
from dataclasses import replace
from pathlib import Path

from cosim import Component, ExportError
from cosim.component import table_text

from .event_mode import EventFmu3
from .fmi2 import Fmu2
from .fmi3 import Fmu3
from .importer import Archive, read
from .instance import FmuInstance
from .intermediate import MAX_ORDER
from .isolated import IsolatedFmu
from .package import build

_alone: dict[Path, weakref.ref[FmuInstance]] = {}  # of FMUs that can be in a process only once: the one in this


def load(
    path: str | os.PathLike[str],
    name: str = "",
    *,
    isolated: bool | None = None,
    time_limit: float | None = None,
    retry: bool = False,
    smooth: bool = False,
) -> FmuInstance | IsolatedFmu:
    """Return an instance of an FMI 2.0 or 3.0 co-simulation FMU, anybody's; raises ExportError.

    *isolated* gives it a process of its own, which it may crash or hang in without harm to this one.  By default only
    an FMU gets one that needs its tool to run, that can be in a process only once and is in this one already, or that
    is given a *time_limit*, in s: how long a call into it may last.  With *retry* a step that the FMU discards is
    repeated in shorter ones, everybody being taken back, for which all states are saved at every step.
    With *smooth* an FMI 3.0 FMU that can asks for its inputs within a step, so that they can be polynomials in time;
    FMI 2.0 ones take derivatives without that.
    """
    return opened(read(path), name, isolated=isolated, time_limit=time_limit, retry=retry, smooth=smooth)


def opened(
    archive: Archive,
    name: str = "",
    *,
    isolated: bool | None = None,
    time_limit: float | None = None,
    retry: bool = False,
    smooth: bool = False,
) -> FmuInstance | IsolatedFmu:
    """Return an instance of an FMU that was read before; as ``load``."""
    if time_limit is not None and not time_limit > 0:
        raise ExportError(f"the time limit of {archive.path.name} is {time_limit:g} s; it must be positive")
    if isolated is False and time_limit is not None:
        raise ExportError(f"{archive.path.name} can have a time limit only in a process of its own: isolated = true")
    if retry:
        archive = _retrying(archive)
    if smooth and archive.intermediate:
        archive = replace(archive, can=replace(archive.can, input_derivatives=MAX_ORDER))
    if isolated is None:
        isolated = time_limit is not None or archive.needs_tool or _present(archive)
    return IsolatedFmu(archive, name, time_limit) if isolated else in_this_process(archive, name)


def _retrying(archive: Archive) -> Archive:
    """Return an FMU whose discarded steps are taken for steps that returned early."""
    if not archive.can.rollback:
        raise ExportError(f"{archive.path.name} cannot be taken back, so steps that it discards cannot be repeated")
    return replace(archive, can=replace(archive.can, early_return=True), retry=True)


def _present(archive: Archive) -> bool:
    """Whether the FMU can be in this process only once and is."""
    instance = _alone[archive.folder]() if archive.folder in _alone else None
    return instance is not None and instance.alive


def in_this_process(archive: Archive, name: str = "") -> FmuInstance:
    """Return an instance of an unpacked FMU in this process."""
    instance = (Fmu2 if archive.fmi == 2 else EventFmu3 if archive.can.event_mode else Fmu3)(archive, name)
    if archive.once_per_process:
        _alone[archive.folder] = weakref.ref(instance)
    return instance


def instantiate(
    component: Component,
    name: str = "",
    *,
    fmi: int = 3,
    isolated: bool | None = None,
    time_limit: float | None = None,
    smooth: bool = False,
) -> FmuInstance | IsolatedFmu:
    """Return an FMU instance of a component with its parameter values: built if need be, loaded, parameters set.

    *isolated*, *time_limit* and *smooth* as for ``load``.
    """
    path, name = build(component, fmi=fmi), name or type(component).__name__
    return with_values(load(path, name, isolated=isolated, time_limit=time_limit, smooth=smooth), component)


def with_values(instance: FmuInstance | IsolatedFmu, component: Component) -> FmuInstance | IsolatedFmu:
    """Give an instance of a component's FMU the values of its parameters and tables, and return it."""
    for key, declaration in component.declarations.items():
        if key not in instance.variables:
            continue  # of size zero
        if declaration.role == "parameter":
            instance.set(key, component.values[key])
        elif declaration.role == "table":
            instance.set(key, table_text(component.values[key]))
    return instance
