"""One variable of a component or of a loaded FMU: the same description, wherever it came from."""

from __future__ import annotations

from dataclasses import dataclass
from math import prod
from typing import Any, Literal

from .units import Unit

Causality = Literal[
    "parameter", "input", "output", "local", "independent", "structuralParameter", "calculatedParameter"
]
FLOAT = "Float64"
CLOCK = "Clock"


@dataclass(frozen=True)
class Variable:
    """A named quantity: causality, type, shape, unit, start value and one line of meaning.

    ``type`` is the FMI 3.0 name of the scalar type (``Float64``, ``Int32``, ``Boolean``, ``String``, ``Enumeration``,
    ``Binary``, ...); ``shape`` is ``()`` for a scalar and row-major otherwise; ``unit`` is spelt the Modelica way, or
    None where the type has no unit or a foreign FMU declares none.
    """

    name: str
    causality: Causality
    type: str = FLOAT
    shape: tuple[int, ...] = ()
    unit: str | None = None
    start: Any = None
    meaning: str = ""
    variability: str = "continuous"
    nominal: float = 1.0  # size that counts as large
    depends_on: tuple[str, ...] | None = None  # outputs: the inputs that feed through at once; None: not known, so all
    unit_definition: Unit | None = None  # what a foreign FMU defines its unit to be; None: what its spelling says
    clocks: tuple[str, ...] = ()  # a clocked variable: it has a value while one of them ticks
    interval: str = ""  # of a clock: constant, fixed, tunable, changing, countdown or triggered

    @property
    def size(self) -> int:
        """Number of scalars."""
        return prod(self.shape)

    def labels(self) -> list[str]:
        """Names of the scalars, row-major, indices from 1: ``P[1,1]``, ``P[1,2]``, ..."""
        names = [self.name]
        if self.shape:
            indices = [""]
            for extent in self.shape:
                indices = [f"{i}{',' if i else ''}{j}" for i in indices for j in range(1, extent + 1)]
            names = [f"{self.name}[{i}]" for i in indices]
        return names
