"""What an author writes about one quantity of a component: its role, unit, start value, shape and meaning.

Sizes, shapes and units may be left to whoever makes the component, by the name of a structural value:

    unit = structural("N", "unit of the signal")
    shape = structural((4,), "shape of the signal")
    u = input("unit", "the signal", shape="shape")
    rate = parameter(0.0, "unit/s", "largest rate of it")
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from .component import Component

Structural = int | str | tuple[int, ...]


@dataclass(frozen=True)
class Declaration:
    """What an author wrote about one quantity.

    ``role`` is one of parameter, structural, input, state, output, event, table.
    """

    role: str
    meaning: str
    unit: str = "1"
    start: Any = 0.0
    shape: tuple[int | str, ...] = ()
    nominal: float = 1.0
    choices: tuple[str, ...] = ()
    columns: int = 0
    announce: bool | str = False
    whole: bool = False
    name: str = ""

    def __set_name__(self, owner: type, name: str) -> None:
        object.__setattr__(self, "name", name)

    def __get__(self, component: Component | None, owner: type) -> Any:
        """Give the declaration on the class, and on a component the value of a parameter."""
        if component is None:
            return self
        if self.role == "structural":
            return component.structure[self.name]
        if self.name not in component.values:
            raise AttributeError(f"{owner.__name__}.{self.name} is a {self.role}: it has a value in an instance only")
        value = component.values[self.name]
        return value if value.shape else float(value)


def _shape(shape: int | str | tuple[int | str, ...]) -> tuple[int | str, ...]:
    return shape if isinstance(shape, tuple) else (shape,)


def parameter(start: Any, unit: str, meaning: str, *, shape: int | str | tuple[int | str, ...] = ()) -> Any:
    """Declare a constant of a run; its shape is that of *start* unless given (names of structural values allowed)."""
    given = _shape(shape) if shape != () else tuple(np.shape(start))
    return Declaration("parameter", meaning, unit, start, given)


def structural(start: Structural, meaning: str, *, choices: tuple[str, ...] = ()) -> Any:
    """Declare what is known when the equations are built: one FMU per value.

    By its *start* it is an integer (a size), a tuple of integers (a shape), one of *choices*, or, a text without them,
    a unit.  Other declarations may name it in place of a shape or a unit of their own.
    """
    return Declaration("structural", meaning, start=start, choices=choices)


def input(unit: str, meaning: str, *, start: Any = 0.0, shape: int | str | tuple[int | str, ...] = ()) -> Any:
    """Declare what others drive; *start* is its value while nobody does."""
    return Declaration("input", meaning, unit, start, _shape(shape))


def state(
    start: Any,
    unit: str,
    meaning: str,
    *,
    shape: int | str | tuple[int | str, ...] = (),
    nominal: float = 1.0,
    whole: bool = False,
) -> Any:
    """Declare a state with its value at the start; *nominal* scales the integrator's absolute tolerance.

    *whole*: its values are whole numbers that count or code something, so that nothing has a derivative by it.
    """
    given = _shape(shape) if shape != () else tuple(np.shape(start))
    return Declaration("state", meaning, unit, start, given, nominal, whole=whole)


def output(unit: str, meaning: str, *, shape: int | str | tuple[int | str, ...] = ()) -> Any:
    """Declare what others may read."""
    return Declaration("output", meaning, unit, None, _shape(shape))


def event(meaning: str, *, shape: int | str | tuple[int | str, ...] = (), announce: bool | str = False) -> Any:
    """Declare a zero crossing; *announce*: a step returns early there, so that a master can bring everybody to it.

    A structural value named instead says whether: 0 for no.
    """
    return Declaration("event", meaning, shape=_shape(shape), announce=announce)


def table(columns: int, meaning: str, *, start: Any = None) -> Any:
    """Declare rows of *columns* numbers, looked up by their first, ascending column: the last row not above the key.

    A table is a parameter given as an array (rows, columns), constant in a run; the compiled code does not contain it.
    """
    return Declaration("table", meaning, start=start if start is not None else np.zeros((1, columns)), columns=columns)
