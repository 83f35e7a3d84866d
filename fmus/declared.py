"""The variables a modelDescription.xml declares, as this package sees them: arrays regrouped, units with exponents."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from typing import Any, cast

import numpy as np

from cosim import Variable
from cosim.units import BASE, Unit
from cosim.variable import Causality

# the types of FMI 2.0 by the names of 3.0
_TYPES = {"Real": "Float64", "Integer": "Int32"}
_ELEMENT = re.compile(r"(der\()?(.+)\[(\d+(?:,\d+)*)\](\))?$")


@dataclass(frozen=True)
class References:
    """How to reach a variable: one value reference, or in FMI 2.0 one per scalar, row-major."""

    type: str  # in the spelling of the FMU's own version
    values: tuple[int, ...]


def declared_variables(description: Any) -> tuple[dict[str, Variable], dict[str, References]]:
    """Return the variables by name, and how to reach each, from FMPy's model description."""
    units = {u.name: _unit(u.baseUnit) for u in description.unitDefinitions if u.baseUnit is not None}
    depends = {u.variable.name: _inputs(u.dependencies) for u in description.outputs if u.variable is not None}
    variables: dict[str, Variable] = {}
    references: dict[str, References] = {}
    for name, shape, elements in _grouped(description):
        head = elements[0]
        known = [depends.get(e.name) for e in elements]
        unit = head.unit or (head.declaredType.unit if head.declaredType is not None else None)
        variables[name] = Variable(
            name,
            cast(Causality, head.causality),
            type=_TYPES.get(head.type, head.type),
            shape=shape,
            unit=unit,
            unit_definition=units.get(unit),
            start=_start(elements, shape),
            meaning=head.description or "",
            variability=head.variability or _variability(head),
            nominal=float(getattr(head, "nominal", None) or 1.0),
            depends_on=None if None in known else tuple(dict.fromkeys(_base(n) for k in known if k for n in k)),
            clocks=tuple(c.name for c in getattr(head, "clocks", None) or ()),
            interval=getattr(head, "intervalVariability", None) or "",
        )
        references[name] = References(head.type, tuple(e.valueReference for e in elements))
    return variables, references


def _variability(variable: Any) -> str:
    """Return what the standard takes for granted where nothing is written."""
    if variable.causality in ("parameter", "structuralParameter", "calculatedParameter"):
        return "fixed"
    return "continuous" if variable.type in ("Real", "Float64", "Float32") else "discrete"


def _grouped(description: Any) -> Iterator[tuple[str, tuple[int, ...], list[Any]]]:
    """Yield name, shape and elements of each variable; the scalars of an array in FMI 2.0 become one."""
    alone = {v.name: v for v in description.modelVariables}
    if not str(description.fmiVersion).startswith("2"):
        for v in alone.values():
            yield v.name, tuple(v.shape or ()), [v]
        return
    arrays: dict[str, dict[tuple[int, ...], Any]] = {}
    for v in alone.values():
        if match := _ELEMENT.match(v.name):
            index = tuple(int(i) for i in match[3].split(","))
            arrays.setdefault(_base(v.name), {})[index] = v
    shapes = {name: _shape(found) for name, found in arrays.items() if name not in alone}
    done: set[str] = set()
    for v in alone.values():
        base = _base(v.name)
        shape = shapes.get(base) if base != v.name else None
        if shape is None:
            yield v.name, (), [v]
        elif base not in done:
            done.add(base)
            yield base, shape, [arrays[base][i] for i in _indices(shape)]


def _base(name: str) -> str:
    match = _ELEMENT.match(name)
    return f"{match[1] or ''}{match[2]}{match[4] or ''}" if match else name


def _indices(shape: tuple[int, ...]) -> list[tuple[int, ...]]:
    return list(product(*(range(1, n + 1) for n in shape)))


def _shape(found: dict[tuple[int, ...], Any]) -> tuple[int, ...] | None:
    """Return the shape if the elements fill it from index 1 and are of one kind, else None: they stay scalars."""
    if len({len(index) for index in found}) != 1:
        return None
    shape = tuple(int(n) for n in np.max(list(found), axis=0))
    kinds = {
        (v.type, v.causality, v.variability, v.unit, v.declaredType and v.declaredType.name) for v in found.values()
    }
    return shape if len(kinds) == 1 and set(found) == set(_indices(shape)) else None


def _inputs(dependencies: list[Any] | None) -> tuple[str, ...] | None:
    return None if dependencies is None else tuple(v.name for v in dependencies if v.causality == "input")


def _unit(base: Any) -> Unit:
    exponents = tuple(int(getattr(base, symbol)) for symbol in BASE)
    return Unit(cast(Any, exponents), float(base.factor), float(base.offset))


def _start(elements: list[Any], shape: tuple[int, ...]) -> Any:
    head = elements[0]
    texts = [e.start for e in elements] if len(elements) > 1 else None
    if head.start is None or (texts and None in texts):
        return None
    if head.type in ("String", "Binary"):
        return head.start
    words = texts if texts is not None else str(head.start).split()
    values = [_scalar(head.type, w) for w in words]
    return np.reshape(values, shape) if shape and len(values) == np.prod(shape) else values[0]


def _scalar(type: str, text: str) -> Any:
    if type in ("Real", "Float64", "Float32"):
        return float(text)
    if type == "Boolean":
        return text in ("true", "1")
    return int(text)
