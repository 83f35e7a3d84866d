"""Algebraic loops solved: Newton's method on u = K y(u) + c, the connected inputs u of a loop and the outputs y.

The derivatives dy/du are the components' own where they declare them, else finite differences.  A step that does not
make the residual smaller is halved.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from .errors import CosimError, CouplingError
from .structure import Loop, Port

if TYPE_CHECKING:
    from .instance import Instance
    from .system import System
    from .wiring import Connection

TOLERANCE = 1e-10  # of a residual that no step makes smaller, relative to the larger of the value and its nominal
ITERATIONS = 50
HALVINGS = 30  # of one step
PASSES = 20  # of what is not Float64, each with the numbers solved anew
ROUNDING = float(np.finfo(float).eps)
ADVICE = "it breaks where one of these outputs comes from a state instead of directly from an input"


class Wires:
    """Float64 connections as positions in the row of a system: ``row[targets] = factor * row[sources] + offset``."""

    def __init__(self, system: System, connections: Sequence[Connection]) -> None:
        ends = [[e.positions(system.place(e.component, e.variable)) for e in (c.target, c.source)] for c in connections]
        empty = np.zeros(0, int)
        self.targets = np.concatenate([empty, *(target for target, _ in ends)])
        self.sources = np.concatenate([empty, *(source for _, source in ends)])
        sizes = [len(target) for target, _ in ends]
        self.factor = np.repeat([c.factor for c in connections], sizes)
        self.offset = np.repeat([c.offset for c in connections], sizes)
        self.connections = [c for c, n in zip(connections, sizes, strict=True) for _ in range(n)]  # per scalar

    def values(self, row: np.ndarray) -> np.ndarray:
        """Return what the sources hand over now."""
        return self.factor * row[self.sources] + self.offset


@dataclass(frozen=True)
class _Member:
    """A component of a loop: the scalars it is given and shows there, as positions in the row."""

    instance: Instance
    inputs: list[str]
    outputs: list[str]
    given: np.ndarray  # all scalars of the inputs
    shown: np.ndarray  # all scalars of the outputs


class LoopSolver:
    """The equations of one loop, solved again and again from where they were last."""

    def __init__(self, system: System, loop: Loop) -> None:
        self.system, self.loop, self.row = system, loop, system.row
        ports = set(loop.ports)
        into = [c for c in system.connections if _target(c) in ports]
        inside = [c for c in into if _source(c) in ports]
        self.wires = Wires(system, [c for c in inside if c.numeric])
        self.outside = Wires(system, [c for c in into if c.numeric and _source(c) not in ports])
        self.others = [c for c in into if not c.numeric]
        self.members = [self._member(name) for name in loop.components]
        self.nominal = np.array([_nominal(c) for c in self.wires.connections])
        self.declared = {m.instance.name: m.instance.can.directional_derivatives for m in self.members}
        self.iterations = 0  # of the last solution
        self._matrix: np.ndarray | None = None  # 1 - K dy/du where it was formed last

    def _member(self, name: str) -> _Member:
        instance = self.system.instances[name]
        mine = [instance.variable(port) for component, port in self.loop.ports if component == name]
        inputs = [v for v in mine if v.causality == "input" and v.name in instance.u_at]
        outputs = [v for v in mine if v.causality == "output" and v.name in instance.y_at]
        given, shown = (
            np.concatenate([np.zeros(0, int)] + [np.r_[self.system.place(name, v)] for v in variables])
            for variables in (inputs, outputs)
        )
        return _Member(instance, [v.name for v in inputs], [v.name for v in outputs], given, shown)

    def solve(self, when: str) -> None:
        """Bring every port of the loop to its solution; raises CouplingError, which says *when*, if none is found.

        What is not Float64 is handed on until it does not change any more.
        """
        self.row[self.outside.targets] = self.outside.values(self.row)
        for _ in range(PASSES):
            before = [self._hand_on(c) for c in self.others]
            self._newton(when)
            if all(np.array_equal(_passed(self.system, c), v) for c, v in zip(self.others, before, strict=True)):
                return
        raise CouplingError(
            f"the algebraic loop {self.loop} does not settle {when}: values that are no real numbers still change "
            f"after {PASSES} passes, of {', '.join(c.target.port for c in self.others)}; {ADVICE}"
        )

    def _hand_on(self, c: Connection) -> Any:
        value = _passed(self.system, c)
        self.system.instances[c.target.component].set(c.target.variable.name, value)
        return value

    # Newton

    def _newton(self, when: str) -> None:
        """Solve for the Float64 inputs: to rounding, or until no step helps and the tolerance is met."""
        self.iterations = 0
        x = self.row[self.wires.targets]
        g = self._evaluate(x)
        if not np.all(np.isfinite(g)):
            raise CouplingError(self._sentence(when, x, g, "a start value nearer to a solution may help"))
        while len(x) and (self._matrix is None or not self._exact(x, g)):
            close = bool(np.all(np.abs(g - x) <= TOLERANCE * self._scale(x, g)))
            found = self._step(when, x, g, close=close) if self.iterations < ITERATIONS else None
            if found is not None:
                x, g = found
                self.iterations += 1
            elif close:
                self._evaluate(x)
                return
            else:
                why = "no step makes it smaller, so there may be no solution"
                if self.iterations == ITERATIONS:
                    why = "a start value nearer to a solution may help"
                raise CouplingError(self._sentence(when, x, g, why))

    def _exact(self, x: np.ndarray, g: np.ndarray) -> bool:
        return bool(np.all(np.abs(g - x) <= 4 * ROUNDING * np.maximum(np.abs(x), np.abs(g))))

    def _step(self, when: str, x: np.ndarray, g: np.ndarray, *, close: bool) -> tuple[np.ndarray, np.ndarray] | None:
        """Return the next iterate, the full step or a part of it; None if nothing makes the residual smaller."""
        if self._matrix is not None:  # the derivatives of the last time often do
            found = self._search(x, g, np.linalg.solve(self._matrix, g - x), halvings=1, smaller=0.1)
            if found is not None:
                return found
            self._evaluate(x)
        found = self._search(x, g, self._direction(when, x, g), halvings=2 if close else HALVINGS)
        if found is None and not close and any(self.declared.values()):
            self.declared = dict.fromkeys(self.declared, False)  # derivatives may be declared and wrong
            self._evaluate(x)
            found = self._search(x, g, self._direction(when, x, g))
        return found

    def _search(
        self, x: np.ndarray, g: np.ndarray, step: np.ndarray, *, halvings: int = HALVINGS, smaller: float = 1.0
    ) -> tuple[np.ndarray, np.ndarray] | None:
        """Return where a share of the *step* makes the residual *smaller* by that factor at least; None: nowhere."""
        scale = self._scale(x, g)
        before = smaller * np.linalg.norm((g - x) / scale)
        share = 1.0
        for _ in range(halvings):
            trial = x + share * step
            try:
                reached = self._evaluate(trial)
            except CosimError:  # the component refuses such inputs
                reached = np.full(len(x), np.nan)
            if np.linalg.norm((reached - trial) / scale) < (1 - 1e-4 * share) * before:  # False for NaN
                return trial, reached
            share /= 2
        return None

    def _evaluate(self, x: np.ndarray) -> np.ndarray:
        """Give the loop these inputs and return what its wires hand back."""
        self.row[self.wires.targets] = x
        for member in self.members:
            member.instance.push()
            member.instance.pull()
        return self.wires.values(self.row)

    def _scale(self, x: np.ndarray, g: np.ndarray) -> np.ndarray:
        return np.maximum(np.maximum(np.abs(x), np.abs(g)), self.nominal)

    def _direction(self, when: str, x: np.ndarray, g: np.ndarray) -> np.ndarray:
        """Return Newton's step."""
        slope = np.zeros((len(self.row), len(x)))  # of the whole row, by the inputs
        column = {int(at): j for j, at in enumerate(self.wires.targets)}
        for member in self.members:
            for k, at in enumerate(member.given):
                if (j := column.get(int(at))) is not None:
                    slope[member.shown, j] = self._column(member, k, int(at), x[j], self.nominal[j])
        self._matrix = None
        matrix = np.eye(len(x)) - self.wires.factor[:, None] * slope[self.wires.sources]
        scale = self._scale(x, g)
        if not np.all(np.isfinite(matrix)) or np.linalg.cond(matrix * scale / scale[:, None]) > 0.1 / ROUNDING:
            why = "its equations are singular there, as they are without a solution or with more than one"
            raise CouplingError(self._sentence(when, x, g, why))
        self._matrix = matrix
        return np.linalg.solve(matrix, g - x)

    def _column(self, member: _Member, k: int, at: int, value: float, nominal: float) -> np.ndarray:
        """Return d(outputs)/d(one scalar of the inputs) of a member."""
        instance = member.instance
        if self.declared[instance.name]:
            seed = np.zeros(len(member.given))
            seed[k] = 1.0
            try:
                return instance.directional_derivative(member.outputs, member.inputs, seed)
            except (CosimError, NotImplementedError):  # declared, but not given here
                self.declared[instance.name] = False
        before = self.row[member.shown]
        self.row[at] = value + ROUNDING**0.5 * max(abs(value), nominal)
        instance.push()
        instance.pull()
        slope = (self.row[member.shown] - before) / (self.row[at] - value)
        self.row[at] = value
        instance.push()
        instance.pull()
        return slope

    def _sentence(self, when: str, x: np.ndarray, g: np.ndarray, why: str) -> str:
        worst = int(np.argmax(np.nan_to_num(np.abs(g - x) / self._scale(x, g), nan=np.inf)))
        wire = self.wires.connections[worst]
        unit = wire.target.variable.unit
        unit = "" if unit in (None, "1") else f" {unit}"
        at = self.wires.targets[worst] - self.system.place(wire.target.component, wire.target.variable).start
        n = self.iterations
        return (
            f"the algebraic loop {self.loop} is not solved {when}: after {n} iteration{'s' * (n != 1)} "
            f"{wire.target.component}.{wire.target.variable.labels()[at]} is {x[worst]:.9g}{unit} where "
            f"{wire.source.port} gives {g[worst]:.9g}{unit}, a residual of {g[worst] - x[worst]:.3g}{unit}; "
            f"{why}; {ADVICE}"
        )


def _target(c: Connection) -> Port:
    return c.target.component, c.target.variable.name


def _source(c: Connection) -> Port:
    return c.source.component, c.source.variable.name


def _passed(system: System, c: Connection) -> Any:
    return c.passed(system.instances[c.source.component].get(c.source.variable.name))


def _nominal(c: Connection) -> float:
    """Return the size that counts as large for a target; its source's if it declares none itself."""
    own = abs(c.target.variable.nominal)
    return own if own not in (0.0, 1.0) else abs(c.factor * c.source.variable.nominal) or 1.0
