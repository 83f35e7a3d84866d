"""Power bonds: connections in pairs, an effort one way and a flow back, whose product is power (force and velocity).

What one side gives over a step the other should receive, but each sees the other's value held.  A side of force F and
velocity v, that are given to the other as F~ and held from it as v~, gives the work of F v~; the other receives that of
F~ v.  The difference is energy that the coupling made: the residual of the bond (Sadjina, Kyllingstad, Skjong, Pedersen
2016: Energy conservation and power bonds in co-simulations; here by the trapezoidal rule over the step).  An output
that an input reaches at once jumps where that is set, at the start of a step, which the rule does not see: there the
residual lacks a part of its own order.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from .clock import seconds
from .errors import CouplingError, nearest
from .extrapolation import Extrapolated
from .observer import Observer, Point, RunInfo
from .units import BASE, Unit, parse
from .variable import Variable
from .wiring import Connection

if TYPE_CHECKING:
    from .system import System

WATT = parse("W")


@dataclass(frozen=True)
class Bond:
    """An *effort* and a *flow*, each named by the input it drives: one at either end.  *energy* counts as large (J)."""

    effort: str
    flow: str
    energy: float = 1.0

    @property
    def label(self) -> str:
        """How the bond is called in sentences."""
        return f"{self.effort} * {self.flow}"


@dataclass(frozen=True)
class Signal:
    """A connection: where ``System.row`` has what the target holds and what the source shows, arrays of one length."""

    held: np.ndarray
    shown: np.ndarray
    factor: float
    offset: float
    target: str

    def passed(self, row: np.ndarray) -> np.ndarray:
        """Return what the source shows, in the unit of the target."""
        return self.factor * row[self.shown] + self.offset


@dataclass(frozen=True)
class Wired:
    """A bond of a system."""

    bond: Bond
    effort: Signal
    flow: Signal
    watt: float  # of the unit that effort (as held) times flow (as shown) have

    def residual(self, before: np.ndarray, after: np.ndarray, length: int) -> float:
        """Return the energy in J that the coupling made in a step of *length* ns between two rows of the system."""
        efforts = self.effort.passed(before) + self.effort.passed(after)
        flows = before[self.flow.shown] + after[self.flow.shown]
        held = (after[self.flow.held] - self.flow.offset) / self.flow.factor
        return self.watt * seconds(length) / 2 * float(after[self.effort.held] @ flows - efforts @ held)


def wired(system: System, bonds: tuple[Bond, ...], algorithm: Any) -> tuple[Wired, ...]:
    """Return the *bonds* of a system; raises CouplingError for what is no bond, or not held over one step."""
    if not bonds:
        raise CouplingError("there are no power bonds; name some, such as Bond('mass.force', 'spring.velocity')")
    while algorithm is not None:
        if isinstance(algorithm, Extrapolated):
            raise CouplingError("power bonds ask for inputs held over a step, which Extrapolated moves; leave it out")
        algorithm = getattr(algorithm, "inner", None)
    return tuple(_wired(system, bond) for bond in bonds)


def _wired(system: System, bond: Bond) -> Wired:
    effort, flow = _connection(system, bond.effort), _connection(system, bond.flow)
    ends = [(c.source.component, c.target.component) for c in (effort, flow)]
    if ends[0] != ends[1][::-1]:
        raise CouplingError(
            f"{bond.label} is no power bond: the effort goes from {effort.source.port} to {effort.target.port}, but "
            f"the flow from {flow.source.port} to {flow.target.port}, which is not the way back"
        )
    for name in ends[0]:
        if system.every[name] > 1:
            raise CouplingError(f"the power bond {bond.label} asks {name} to step at every macro step")
    if effort.target.shape != flow.source.shape:
        raise CouplingError(
            f"{bond.label} is no power bond: the effort has shape {list(effort.target.shape)} and the flow "
            f"{list(flow.source.shape)}; name single elements or ports of one shape"
        )
    watt = _watts(bond, effort.target.variable, flow.source.variable)
    return Wired(bond, _signal(system, effort), _signal(system, flow), watt)


def _connection(system: System, target: str) -> Connection:
    found = {c.target.port: c for c in system.connections if c.numeric}
    if target not in found:
        raise CouplingError(f"no connection for a power bond drives {target!r}; {nearest(target, found)}")
    return found[target]


def _signal(system: System, c: Connection) -> Signal:
    held, shown = (e.positions(system.place(e.component, e.variable)) for e in (c.target, c.source))
    return Signal(held, shown, c.factor, c.offset, c.target.component)


def _watts(bond: Bond, effort: Variable, flow: Variable) -> float:
    """Return the factor from the product of two units to W; rad counts as 1, and no unit as the one that fits."""
    known = [u for v in (effort, flow) if (u := _unit(v)) is not None]
    if len(known) < 2:
        return 1.0
    product = [a + b for a, b in zip(known[0].exponents, known[1].exponents, strict=True)]
    if any(a != b for a, b, base in zip(product, WATT.exponents, BASE, strict=True) if base != "rad"):
        raise CouplingError(f"{bond.label} is no power bond: {effort.unit} times {flow.unit} is no power")
    return known[0].factor * known[1].factor / WATT.factor


def _unit(variable: Variable) -> Unit | None:
    return variable.unit_definition or (parse(variable.unit) if variable.unit else None)


class Residuals(Observer):
    """The residuals of the *bonds* in every accepted step: its end ``times`` (n,) in ns, ``energy`` (n, bonds) in J."""

    def __init__(self, *bonds: Bond) -> None:
        self.bonds = bonds
        self.times: list[int] = []
        self._energy: list[list[float]] = []
        self._row = np.zeros(0)

    @property
    def energy(self) -> np.ndarray:
        """The energy that the coupling made in each step."""
        return np.array(self._energy).reshape(-1, len(self.bonds))

    def started(self, system: System, info: RunInfo) -> None:
        """Find the bonds."""
        self._wired = wired(system, self.bonds, None)

    def accepted(self, point: Point) -> None:
        """Compare what was given with what was received."""
        if point.end > point.start:
            self.times.append(point.end)
            self._energy.append([w.residual(self._row, point.row, point.end - point.start) for w in self._wired])
        self._row = point.row.copy()
