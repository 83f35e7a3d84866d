"""How a scenario says that it is run: the section ``[run]``, and the strategies of the master that it stands for."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, field_validator

from .acceleration import Method
from .algorithms import Algorithm, GaussSeidel, Jacobi, Order
from .bonds import Bond
from .conserving import Conserving, EnergyError
from .consistent import Consistent
from .control import PI, Fixed
from .extrapolation import Extrapolated
from .iterated import Iterated
from .richardson import Richardson


class _Table(BaseModel):
    """A table of numbers and choices; a text or a truth value is no number."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    @field_validator("*", mode="before")
    @classmethod
    def _number(cls, value: Any, info: Any) -> Any:
        number = cls.model_fields[info.field_name].annotation in (float, float | None)
        if number and isinstance(value, (bool, str)):
            raise ValueError(f"must be a number, not {value!r}")
        return value


class IteratedSettings(_Table):
    """``run.iterated``: how ``algorithm = "iterated"`` repeats its steps; see ``Iterated``."""

    inner: Literal["gauss-seidel", "jacobi"] = "gauss-seidel"
    method: Method = "quasi_newton"
    tolerance: float = Field(1e-8, gt=0, lt=1)
    max_iterations: int = Field(50, ge=1, strict=True)
    unconverged: Literal["raise", "warn"] = "raise"


class BondSettings(_Table):
    """One of ``run.bonds``: an effort and a flow by the inputs that they drive; see ``Bond``."""

    effort: str
    flow: str
    energy: float = Field(1.0, gt=0)  # J that counts as large


class ControlSettings(_Table):
    """``run.control``: steps as long as the estimated error allows; see ``PI``.  ``run.step`` is the first one."""

    estimate: Literal["richardson", "energy"] = "richardson"  # energy: what the coupling makes at ``run.bonds``
    tolerance_rel: float = Field(1e-4, ge=0, lt=1)
    tolerance_abs: float = Field(1e-6, gt=0)
    min_step: float = Field(0.0, ge=0)  # s
    max_step: float | None = Field(None, gt=0)  # s
    outputs: tuple[str, ...] = ()  # whose errors count, patterns; none: all connected ones


class RunSettings(_Table):
    """How the master runs: macro step and duration in s, algorithm, order, which FMI version, what is logged."""

    step: float = Field(1e-4, gt=0, strict=False)
    duration: float = Field(..., gt=0)
    algorithm: Literal["gauss-seidel", "jacobi", "iterated"] = "gauss-seidel"
    order: Order = ()
    iterated: IteratedSettings = IteratedSettings()
    extrapolate: int = Field(0, ge=0, le=2, strict=True)  # degree of the inputs' polynomials within a step
    bonds: tuple[BondSettings, ...] = ()  # connections that carry power
    conserving: bool = Field(False, strict=True)  # what held inputs miss at the bonds is added to the next step
    control: ControlSettings | None = None  # none: every step as long as ``step``
    solve_loops: bool = False  # bring all outputs up to date at every communication point
    trusted: tuple[str, ...] = ()  # who can be read after setting though FMI 2.0 does not promise it
    locate_events: bool = True
    compiled: bool | None = Field(None, strict=True)  # loop; None: where it can make the run, False: the readable one
    events: dict[str, Literal["rising", "falling", "crossing", "change"]] = Field({})  # outputs that tell of an event
    tolerance: float = Field(1e-8, gt=0, lt=1e-2)
    fmi: Literal[2, 3] = 3
    signals: tuple[str, ...] = ()  # patterns such as "wheels.*"; none: every port

    @field_validator("order", mode="before")
    @classmethod
    def _order(cls, value: Any) -> Any:
        listed = isinstance(value, (list, tuple)) and all(isinstance(name, str) for name in value)
        if not listed and value != "computed":
            raise ValueError(f'must be a list of components or "computed", not {value!r}')
        return value

    def strategy(self, order: Order) -> Algorithm:
        """Return the algorithm asked for; *order* is what Gauss-Seidel goes by."""
        how = self.iterated
        kind = how.inner if self.algorithm == "iterated" else self.algorithm
        chosen: Algorithm = Jacobi() if kind == "jacobi" else GaussSeidel(order)
        if self.algorithm == "iterated":
            chosen = Iterated(chosen, how.method, how.tolerance, how.max_iterations, how.unconverged)
        if self.extrapolate:
            chosen = Extrapolated(chosen, self.extrapolate)
        bonds = tuple(Bond(b.effort, b.flow, b.energy) for b in self.bonds)
        if self.conserving:
            chosen = Conserving(chosen, bonds)
        if self.control is not None and self.control.estimate == "energy":
            chosen = EnergyError(chosen, bonds)
        elif self.control is not None:
            chosen = Richardson(chosen, self._accuracy, outputs=self.control.outputs)
        return Consistent(chosen, self.trusted) if self.solve_loops else chosen

    def pace(self) -> Fixed | PI:
        """Return how long the steps are to be."""
        if (c := self.control) is None:
            return Fixed()
        longest = c.max_step or float("inf")
        return PI(c.tolerance_rel, c.tolerance_abs, c.min_step, longest, order=self._accuracy)

    @property
    def _accuracy(self) -> int:
        """The order of the algorithm, which estimates and step control have to know."""
        return 2 if self.conserving else 1 + self.extrapolate
