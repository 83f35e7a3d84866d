"""FMI 3.0's intermediate update: an FMU asks for its inputs within a step, and is given polynomials in time.

The standard has no other way to hand over derivatives of inputs.  An FMU that is instantiated for it calls back each
time it evaluates its equations, so it has to be asked for (``fmus.load(..., smooth=True)``).
"""

from __future__ import annotations

from collections.abc import Callable
from ctypes import CFUNCTYPE, POINTER, c_bool, c_double, c_uint32, c_void_p
from typing import Any

import numpy as np

from .binding import WARNING

MAX_ORDER = 2  # of the derivatives; the polynomials are our own, so this is only the highest that is of use
_CALLBACK = CFUNCTYPE(
    None, c_void_p, c_double, c_bool, c_bool, c_bool, c_bool, POINTER(c_bool), POINTER(c_double)
)  # fmt: skip
_inputs: dict[int, Polynomials] = {}  # by the environment pointer of their instance


class Polynomials:
    """The inputs of one instance within a step: *places* in its buffer ``u``, with their value *references*."""

    def __init__(self, environment: int, references: list[int], places: np.ndarray) -> None:
        self.references = (c_uint32 * len(references))(*references)
        self.places, self.values = places, np.zeros(len(places))
        self.coefficients: list[np.ndarray] = []  # u, u', u''/2, ...; empty: the inputs are held
        self.began = 0.0  # s, where the step began
        self.status = 0  # the worst that setting them returned
        self.set_float: Callable[..., int] | None = None
        self._c: int | None = None
        _inputs[environment] = self

    def attach(self, component: int, set_float: Callable[..., int]) -> None:
        """Take the FMU's instance and its function that sets Float64 variables."""
        self._c, self.set_float = component, set_float

    def take(self, u: np.ndarray, derivatives: list[np.ndarray]) -> None:
        """Begin with the inputs *u* and their derivatives of order 1, 2, ..., of all inputs."""
        scaled = [u[self.places]]
        for order, derivative in enumerate(derivatives, 1):
            scaled.append(np.asarray(derivative, float)[self.places] / np.prod(np.arange(1, order + 1)))
        self.coefficients, self.status = scaled, 0

    def hand_over(self, time: float) -> None:
        """Set the inputs to what they are at *time*."""
        if not self.coefficients or self.set_float is None:
            return
        since = time - self.began
        self.values[:] = self.coefficients[-1]
        for coefficient in self.coefficients[-2::-1]:
            self.values *= since
            self.values += coefficient
        n = len(self.references)
        status = self.set_float(self._c, self.references, n, self.values.ctypes.data, len(self.values))
        self.status = max(self.status, status)

    @property
    def failed(self) -> bool:
        """Whether the FMU refused an input."""
        return self.status > WARNING


def forget(environment: int) -> None:
    """Forget the inputs of an instance."""
    _inputs.pop(environment, None)


@_CALLBACK
def update(environment: int | None, time: float, asked: bool, *_: Any) -> None:
    """Answer the FMU."""
    inputs = _inputs.get(environment or 0)
    if inputs is not None and asked:
        inputs.hand_over(time)
