"""A component is a declaration plus equations, written once; everything else is derived from it.

    class Spring(Component):
        \"\"\"Linear spring: F = -k x.\"\"\"

        k = parameter(1e3, "N/m", "stiffness")
        x = input("m", "elongation")
        F = output("N", "force on the body at the end")

        def outputs(s):
            return dict(F=-s.k * s.x)

The equations are pure functions of one namespace ``s`` that holds every declared symbol, ``s.time`` and, where it is
meaningful, ``s.dt``.  They are written with CasADi expressions (``casadi.if_else``, never a Python ``if`` on a symbol).

| function | returns | meaning |
| --- | --- | --- |
| ``derivatives(s)`` | states | dx/dt, integrated with error control |
| ``outputs(s)`` | outputs | from states, inputs, parameters and time |
| ``sync(s)`` | some states | their new values, first thing in a step after the inputs were set |
| ``flow(s)`` | states | in place of ``derivatives``: the exact solution a step ``s.dt`` later, inputs held |
| ``crossings(s)`` | events | indicators; an event is a change of sign (zero counts as positive) |
| ``jump(s)`` | some states | their values after an event; ``s.crossed.NAME`` is -1, 0 or +1, the direction |
| ``lookups(s)`` | tables | where each declared table is read; the rows found are ``s.TABLE``, (keys, columns) |
| ``constants(s)`` | any names | of parameters and ``s.dt`` alone: computed when these change, read as ``s.NAME`` |

A component with a ``flow`` that declares a parameter ``micro_step`` (in s) has it called over equal parts of a step,
none longer than that: the scheme of an explicit integration, rather than an exact solution.

A component that declares a parameter ``period`` (in s) is sampled: its ``sync`` happens at its ticks only (multiples of
the period on the time axis), every tick inside a long step included.
"""

from __future__ import annotations

from functools import cached_property
from math import prod
from typing import TYPE_CHECKING, Any, ClassVar

import casadi as ca
import numpy as np

from . import units
from .declaration import Declaration, Structural, event, input, output, parameter, state, structural, table
from .errors import DeclarationError, nearest
from .units import rate_unit
from .variable import Variable

if TYPE_CHECKING:
    from .equations import Equations
    from .twin import PythonInstance

EQUATIONS = ("derivatives", "outputs", "sync", "flow", "crossings", "jump", "lookups", "constants")
_built: dict[tuple[Any, ...], Equations] = {}
_RESERVED = {"time", "dt", "crossed", *EQUATIONS}


class Component:
    """Base of every component: collects the declarations and holds one set of parameter values, immutable."""

    declarations: ClassVar[dict[str, Declaration]] = {}
    symbols: ClassVar[Any] = ca.SX  # or casadi.MX: functions mapped over many elements then stay loops in C

    def __init_subclass__(cls) -> None:
        own = {k: v for k, v in vars(cls).items() if isinstance(v, Declaration)}
        cls.declarations = {**cls.declarations, **own}
        named = {n for n, d in cls.declarations.items() if _is_unit(d)}
        for name, d in own.items():
            if name in _RESERVED or not name.isidentifier():
                raise DeclarationError(f"{cls.__name__} cannot declare {name!r}: the name is reserved by the contract")
            if not d.meaning:
                raise DeclarationError(f"{cls.__name__}.{name} has no meaning; write one line on what it is")
            if len(d.shape) > 2:
                raise DeclarationError(f"{cls.__name__}.{name} has {len(d.shape)} dimensions; declare at most 2")
            try:
                if d.unit.removesuffix("/s") not in named:
                    units.parse(d.unit)
            except DeclarationError as error:
                raise DeclarationError(f"{cls.__name__}.{name}: {error}") from None
        for name in EQUATIONS:
            if name in vars(cls):
                setattr(cls, name, staticmethod(vars(cls)[name]))

    def __init__(self, **values: Any) -> None:
        settable = {n: d for n, d in self.declarations.items() if d.role in ("parameter", "structural", "table")}
        for name in values:
            if name not in settable:
                raise DeclarationError(f"{type(self).__name__} has no parameter {name!r}; {nearest(name, settable)}")
        self.structure: dict[str, Structural] = {
            n: self._structural(d, values.get(n, d.start)) for n, d in settable.items() if d.role == "structural"
        }
        self.values: dict[str, np.ndarray] = {
            n: self._array(d, values.get(n, d.start)) for n, d in settable.items() if d.role != "structural"
        }

    def __repr__(self) -> str:
        changed = [f"{n}={v!r}" for n, v in self.structure.items() if v != self.declarations[n].start] + [
            f"{n}={v.tolist()!r}" if v.size <= 4 else f"{n}=<{'x'.join(map(str, v.shape))}>"
            for n, v in self.values.items()
            if not np.array_equal(v, self._array(self.declarations[n], self.declarations[n].start))
        ]
        return f"{type(self).__name__}({', '.join(changed)})"

    def _repr_html_(self) -> str:
        from .show import component_html

        return component_html(self)

    def _structural(self, d: Declaration, value: Any) -> Structural:
        who = f"{type(self).__name__}.{d.name}"
        if d.choices:
            if value not in d.choices:
                raise DeclarationError(f"{who} cannot be {value!r}; it is one of {', '.join(map(repr, d.choices))}")
            return str(value)
        if _is_unit(d):
            if not isinstance(value, str):
                raise DeclarationError(f"{who} must be the spelling of a unit, such as 'm/s', not {value!r}")
            try:
                units.parse(value)
            except DeclarationError as error:
                raise DeclarationError(f"{who}: {error}") from None
            return value
        if isinstance(d.start, tuple):
            if not isinstance(value, (tuple, list)) or len(value) > 2 or not all(_is_size(n) for n in value):
                raise DeclarationError(f"{who} must be a shape of at most 2 sizes, such as [4] or [], not {value!r}")
            return tuple(int(n) for n in value)
        if not _is_size(value):
            raise DeclarationError(f"{who} must be a whole number, not {value!r}")
        return int(value)

    def shape_of(self, d: Declaration) -> tuple[int, ...]:
        """Return the shape of a declared quantity with the structural values filled in.

        A structural shape that is named alone is taken as it is; beside other sizes it is the number of its elements.
        """
        found = [n if isinstance(n, int) else self.structure[n] for n in d.shape]
        if len(found) == 1 and isinstance(found[0], tuple):
            return found[0]
        return tuple(prod(n) if isinstance(n, tuple) else int(n) for n in found)

    def unit_of(self, d: Declaration) -> str:
        """Return the unit of a declared quantity with the structural values filled in: ``unit`` or ``unit/s``."""
        name = d.unit.removesuffix("/s")
        if name not in self.structure or not _is_unit(self.declarations[name]):
            return d.unit
        given = str(self.structure[name])
        return given if name == d.unit else rate_unit(given)

    def _array(self, d: Declaration, value: Any) -> np.ndarray:
        who = f"{type(self).__name__}.{d.name} [{self.unit_of(d)}]"
        try:
            array = np.asarray(value, dtype=float)
        except (TypeError, ValueError):
            raise DeclarationError(f"{who} must be a number or an array of numbers, not {value!r}") from None
        if d.role == "table":
            if array.ndim != 2 or array.shape[1] != d.columns or not len(array):
                raise DeclarationError(f"{who} needs rows of {d.columns} numbers, not an array of shape {array.shape}")
            if np.any(np.diff(array[:, 0]) <= 0):
                raise DeclarationError(f"{who} needs its first column ascending, since rows are looked up by it")
        else:
            shape = self.shape_of(d)
            if array.shape not in (shape, ()):
                raise DeclarationError(f"{who} has shape {list(shape)}, but was given {list(array.shape)}")
            array = np.broadcast_to(array, shape)
        if not np.all(np.isfinite(array)):
            raise DeclarationError(f"{who} must be finite, not {array[~np.isfinite(array)].flat[0]}")
        array = np.array(array)
        array.flags.writeable = False
        return array

    def declared(self, role: str) -> dict[str, Declaration]:
        """Return the declarations of one role, in the order they were written."""
        return {n: d for n, d in self.declarations.items() if d.role == role}

    def replace(self, **values: Any) -> Component:
        """Return the same component with some parameters changed."""
        return type(self)(**{**self.structure, **self.values, **values})

    @cached_property
    def equations(self) -> Equations:
        """The equations as CasADi functions of flat vectors, built once per class and structural values."""
        from .equations import build
        from .kept import fingerprint, kept

        key = (type(self), *self.structure.values())
        if key not in _built:
            _built[key] = kept("equations", fingerprint(self), lambda: build(self))
        return _built[key]

    @cached_property
    def variables(self) -> dict[str, Variable]:
        """Every variable an instance has: parameters, inputs, outputs, and states with their derivatives as locals."""
        found: dict[str, Variable] = {}
        for n, d in self.declarations.items():
            if d.role == "parameter":
                found[n] = Variable(n, "parameter", shape=self.shape_of(d), unit=self.unit_of(d), start=self.values[n],
                                    meaning=d.meaning, variability="fixed")  # fmt: skip
            elif d.role == "table":
                found[n] = Variable(n, "parameter", type="String", start=table_text(self.values[n]),
                                    meaning=d.meaning, variability="fixed")  # fmt: skip
            elif d.role == "input":
                found[n] = Variable(n, "input", shape=self.shape_of(d), unit=self.unit_of(d), meaning=d.meaning,
                                    start=self._array(d, d.start))  # fmt: skip
            elif d.role == "output":
                found[n] = Variable(n, "output", shape=self.shape_of(d), unit=self.unit_of(d), meaning=d.meaning,
                                    variability="continuous", depends_on=self.equations.feedthrough[n])  # fmt: skip
            elif d.role == "state":
                found[n] = Variable(n, "local", shape=self.shape_of(d), unit=self.unit_of(d), meaning=d.meaning,
                                    start=self._array(d, d.start), nominal=d.nominal,
                                    variability="discrete" if d.whole else "continuous")  # fmt: skip
                if self.equations.ode is not None:
                    found[f"der({n})"] = Variable(f"der({n})", "local", shape=self.shape_of(d),
                                                  unit=rate_unit(self.unit_of(d)),
                                                  meaning=f"time derivative of {n}")  # fmt: skip
        return found

    def instance(self, name: str = "") -> PythonInstance:
        """Return a Python instance: CasADi's own evaluation, for tests and prototyping; experiments use the FMU."""
        from .twin import PythonInstance

        return PythonInstance(self, name or type(self).__name__)


def _is_unit(d: Declaration) -> bool:
    """Whether a declaration is a structural text that other declarations name as their unit."""
    return d.role == "structural" and isinstance(d.start, str) and not d.choices


def _is_size(value: Any) -> bool:
    return isinstance(value, (int, np.integer)) and not isinstance(value, bool) and int(value) >= 0


def table_text(rows: np.ndarray) -> str:
    """Write a table as the text an FMU takes: rows separated by ``;``, numbers by blanks, every bit kept."""
    return ";".join(" ".join(repr(float(v)) for v in row) for row in rows)


def table_rows(text: str) -> np.ndarray:
    """Read a table back from its text; raises DeclarationError if the rows differ in length or hold no numbers."""
    try:
        return np.array([[float(v) for v in row.split()] for row in text.split(";") if row.strip()], dtype=float)
    except ValueError as error:
        raise DeclarationError(f"a table's text is rows of numbers separated by ';': {error}") from None


__all__ = [
    "Component",
    "Declaration",
    "event",
    "input",
    "output",
    "parameter",
    "state",
    "structural",
    "table",
    "table_rows",
    "table_text",
]
