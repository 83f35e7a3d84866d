"""What connects to what: the text of a connection checked against the two ends it names.

A connection is written target first, ``{"wheels.gap": "body.gap"}``, so that an input has one source by construction.
``"body.P[2,3]"`` is one element of an array, indices from 1.  Both ends must agree in type, shape and unit; where the
same quantity is counted in different units, a ``Link`` says that the number is to be converted.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from . import units
from .errors import DeclarationError, WiringError, nearest
from .instance import Instance
from .variable import FLOAT, Variable

_ELEMENT = re.compile(r"(.+)\[(\d+(?:,\s*\d+)*)\]$")


@dataclass(frozen=True)
class Link:
    """The source of a connection, and how its number becomes the target's.

    ``convert=True`` computes the conversion from the two units.  ``factor`` and ``offset`` give it instead
    (target = factor x source + offset), which is also the way to a port of a foreign FMU that declares no unit.
    """

    source: str
    convert: bool = False
    factor: float | None = None
    offset: float = 0.0


@dataclass(frozen=True)
class End:
    """One end of a connection: a port of a component, or one element of it (row-major position)."""

    component: str
    variable: Variable
    element: int | None = None

    @property
    def port(self) -> str:
        """The name others use: ``body.P[2,3]``."""
        name = self.variable.name if self.element is None else self.variable.labels()[self.element]
        return f"{self.component}.{name}"

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of what is connected."""
        return self.variable.shape if self.element is None else ()

    def positions(self, where: slice) -> np.ndarray:
        """Return the positions in the component's buffer, where the whole port lies at *where*."""
        every = np.arange(where.start, where.stop)
        return every if self.element is None else every[[self.element]]

    def __str__(self) -> str:
        return f"{self.port} [{self.variable.unit or 'no unit'}]"


@dataclass(frozen=True)
class Connection:
    """A checked connection: target = factor x source + offset."""

    target: End
    source: End
    factor: float = 1.0
    offset: float = 0.0

    @property
    def numeric(self) -> bool:
        """Whether the value travels through the Float64 buffers."""
        return self.target.variable.type == FLOAT

    def passed(self, value: Any) -> Any:
        """Return what the target is given for a *value* of the source that is not Float64."""
        if (self.factor, self.offset) == (1.0, 0.0):
            return value
        return self.factor * np.asarray(value) + self.offset


def wire(
    instances: Mapping[str, Instance], connections: Mapping[str, str | Link | Mapping[str, Any]]
) -> tuple[Connection, ...]:
    """Check every connection; raises WiringError with one sentence about the first that cannot be made."""
    made = tuple(_connect(instances, target, _link(target, source)) for target, source in connections.items())
    taken: dict[tuple[str, str, int], Connection] = {}
    for connection in made:
        end = connection.target
        for element in range(end.variable.size) if end.element is None else (end.element,):
            other = taken.setdefault((end.component, end.variable.name, element), connection)
            if other is not connection:
                label = End(end.component, end.variable, element if end.variable.shape else None).port
                raise WiringError(
                    f"{label} has two sources, {other.source.port} and {connection.source.port}; connect it once"
                )
    return made


def _link(target: str, source: str | Link | Mapping[str, Any]) -> Link:
    if isinstance(source, Link):
        return source
    if isinstance(source, str):
        return Link(source)
    known = [f.name for f in fields(Link)]
    for key in source:
        if key not in known:
            raise WiringError(f"the connection of {target} has no setting {key!r}; {nearest(key, known)}")
    if "source" not in source:
        raise WiringError(f"the connection of {target} names no source; write source = 'component.port'")
    return Link(**source)


def find(instances: Mapping[str, Instance], text: str, causality: str) -> End:
    """Return the *causality* (input or output) that *text* names; raises WiringError with the nearest one."""
    component, _, port = text.partition(".")
    if component not in instances:
        raise WiringError(f"{text!r} names no component; {nearest(component, instances)}")
    variables = instances[component].variables
    element = None
    if port not in variables and (match := _ELEMENT.match(port)) and match[1] in variables:
        port, element = match[1], [int(i) for i in match[2].split(",")]
    known = [name for name, v in variables.items() if v.causality == causality]
    if port not in variables:
        raise WiringError(f"{component} has no {causality} {port!r}; {nearest(port, known)}")
    variable = variables[port]
    if variable.causality != causality:
        role = "driven" if causality == "input" else "a source"
        raise WiringError(
            f"{component}.{port} is declared as {variable.causality} and cannot be {role}; "
            f"{causality}s of {component}: {', '.join(known) or 'none'}"
        )
    return End(component, variable, None if element is None else _position(text, variable, element))


def _position(text: str, variable: Variable, index: list[int]) -> int:
    inside = len(index) == len(variable.shape) and all(1 <= i <= n for i, n in zip(index, variable.shape, strict=True))
    if not inside:
        raise WiringError(
            f"{text} does not exist: {variable.name} has shape {list(variable.shape)}, and indices start at 1"
        )
    return int(np.ravel_multi_index([i - 1 for i in index], variable.shape))


def _connect(instances: Mapping[str, Instance], target_text: str, link: Link) -> Connection:
    target, source = find(instances, target_text, "input"), find(instances, link.source, "output")
    ends = f"cannot connect {source} to {target}"
    if source.variable.type != target.variable.type:
        raise WiringError(
            f"{ends}: types {source.variable.type} and {target.variable.type} differ; connect ports of the same type"
        )
    if source.shape != target.shape:
        raise WiringError(
            f"{ends}: shapes {list(source.shape)} and {list(target.shape)} differ; "
            f"connect whole ports of the same shape, or single elements such as {_example(source, target)}"
        )
    if target.variable.type != FLOAT and (target.element is not None or source.element is not None):
        raise WiringError(f"{ends}: elements of {target.variable.type} arrays cannot be connected; connect whole ports")
    factor, offset = _conversion(source, target, link, ends)
    return Connection(target, source, factor, offset)


def _example(source: End, target: End) -> str:
    first = [End(e.component, e.variable, 0) if e.shape else e for e in (source, target)]
    return f"{first[0].port} to {first[1].port}"


def _conversion(source: End, target: End, link: Link, ends: str) -> tuple[float, float]:
    """Return factor and offset of the connection, or refuse it because of its units."""
    given = link.factor is not None or link.offset != 0
    chosen = (1.0 if link.factor is None else float(link.factor), float(link.offset))
    identity = chosen == (1.0, 0.0)
    if (link.convert or not identity) and not target.variable.type.startswith("Float"):
        raise WiringError(f"{ends}: a {target.variable.type} cannot be converted; connect it without a conversion")
    if given and link.convert and not identity:
        raise WiringError(f"{ends}: convert=True and a factor or offset exclude each other; give one of them")
    a, b = _unit(source, ends), _unit(target, ends)
    if a is None and b is None:
        return chosen
    if a is None or b is None:
        if given:
            return chosen
        silent = source if a is None else target
        raise WiringError(
            f"{ends}: {silent.port} declares no unit; "
            f"write Link({link.source!r}, factor=1.0) if the two numbers mean the same"
        )
    if not a.same_dimension(b):
        raise WiringError(f"{ends}: dimensions differ")
    if not identity:
        return chosen
    if a.equals(b):
        return 1.0, 0.0
    factor, offset = a.conversion(b)
    if link.convert:
        return factor, offset
    by = f"{factor!r}" + (f" with {offset!r} added" if offset else "")
    raise WiringError(
        f"{ends}: the number would have to be multiplied by {by}; "
        f"write Link({link.source!r}, convert=True) to have it converted"
    )


def _unit(end: End, ends: str) -> units.Unit | None:
    """Return the unit of an end; what a foreign FMU defines goes before the spelling."""
    variable = end.variable
    if variable.unit_definition is not None or variable.unit is None:
        return variable.unit_definition
    try:
        return units.parse(variable.unit)
    except DeclarationError as error:
        raise WiringError(f"{ends}: {error}") from None
