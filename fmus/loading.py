"""FMU file or component -> instance."""

from __future__ import annotations

import os

from cosim import Component
from cosim.component import table_text

from .fmi2 import Fmu2
from .fmi3 import Fmu3
from .importer import read
from .instance import FmuInstance
from .package import build


def load(path: str | os.PathLike[str], name: str = "") -> FmuInstance:
    """Return an instance of an FMI 2.0 or 3.0 co-simulation FMU, anybody's; raises ExportError."""
    archive = read(path)
    return (Fmu2 if archive.fmi == 2 else Fmu3)(archive, name)


def instantiate(component: Component, name: str = "", *, fmi: int = 3) -> FmuInstance:
    """Return an FMU instance of a component with its parameter values: built if need be, loaded, parameters set."""
    instance = load(build(component, fmi=fmi), name or type(component).__name__)
    for key, declaration in component.declarations.items():
        if key not in instance.variables:
            continue  # of size zero
        if declaration.role == "parameter":
            instance.set(key, component.values[key])
        elif declaration.role == "table":
            instance.set(key, table_text(component.values[key]))
    return instance
