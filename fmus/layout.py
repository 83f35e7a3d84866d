"""Where each scalar of a component lies in an FMU: one row of slots, whose numbers are the value references.

    time | parameters | inputs | states | outputs | derivatives of the states | tables (strings)

In FMI 3.0 an array is one variable with the reference of its first slot, in FMI 2.0 each slot is a variable.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from cosim import Component, Variable
from cosim.symbols import Block


@dataclass(frozen=True)
class Layout:
    """The slots of a component with the default values of its class; only the structural values are its own."""

    component: Component

    @classmethod
    def of(cls, component: Component) -> Layout:
        """Return the layout of *component*'s class and structural values."""
        return cls(type(component)(**component.structure))

    @cached_property
    def first(self) -> dict[str, int]:
        """First slot of each kind, and ``end``, one behind the last."""
        eq = self.component.equations
        sizes = {
            "p": _size(eq.parameters),
            "u": _size(eq.inputs),
            "x": _size(eq.states),
            "y": _size(eq.outputs),
            "dx": _size(eq.states) if eq.ode is not None else 0,
        }
        first, at = {}, 1
        for kind, size in sizes.items():
            first[kind] = at
            at += size
        return {**first, "end": at}

    @cached_property
    def reference(self) -> dict[str, int]:
        """Value reference of every variable: its first slot, and behind the slots the tables."""
        eq, first = self.component.equations, self.first
        found = {"time": 0}
        for kind, blocks in (("p", eq.parameters), ("u", eq.inputs), ("x", eq.states), ("y", eq.outputs)):
            found |= {b.name: first[kind] + b.at.start for b in blocks}
        if eq.ode is not None:
            found |= {f"der({b.name})": first["dx"] + b.at.start for b in eq.states}
        return found | {b.name: first["end"] + i for i, b in enumerate(eq.tables)}

    @cached_property
    def variables(self) -> list[Variable]:
        """The variables that the FMU declares, in the order of declaration; those of size zero have nothing to say."""
        return [v for v in self.component.variables.values() if v.size]

    def labels(self) -> list[str]:
        """Names of the slots."""
        names = [""] * self.first["end"]
        names[0] = "time"
        for v in self.variables:
            if v.type != "String":
                at = self.reference[v.name]
                names[at : at + v.size] = scalar_names(v)
        return names

    def start(self) -> np.ndarray:
        """Start values of parameters, inputs and states, in the order of their slots."""
        values = np.zeros(self.first["y"])
        for v in self.variables:
            if v.start is not None and v.type != "String":
                at = self.reference[v.name]
                values[at : at + v.size] = np.ravel(np.broadcast_to(v.start, v.shape))
        return values[1:]

    def dependencies(self) -> np.ndarray:
        """Return what outputs and derivatives depend on: (slots from ``y`` to ``end``, slots below ``y``), booleans.

        Parameters are left out: they are no knowns once the initialisation has ended.
        """
        eq, first = self.component.equations, self.first
        unknowns = [f for f in (eq.out, eq.ode) if f is not None]
        found = np.zeros((first["end"] - first["y"], first["y"]), bool)
        row = 0
        for function in unknowns:
            n = function.size1_out(0)
            for argument, at in ((0, 0), (2, first["x"]), (3, first["u"])):
                depends = _sparsity(function, argument)
                if eq.where is not None:
                    depends |= _sparsity(function, 5) @ self._rows_of_keys() @ _sparsity(eq.where, argument)
                found[row : row + n, at : at + depends.shape[1]] |= depends
            row += n
        return found

    def _rows_of_keys(self) -> np.ndarray:
        """Which looked-up numbers (rows) each key (columns) decides."""
        tables = self.component.equations.tables
        n_keys = sum(b.shape[0] for b in tables)
        found = np.zeros((_size(tables), n_keys), bool)
        key = 0
        for block in tables:
            for i in range(block.shape[0]):
                at = block.at.start + i * block.shape[1]
                found[at : at + block.shape[1], key] = True
                key += 1
        return found


def scalar_names(variable: Variable) -> list[str]:
    """Names of a variable's scalars as the structured naming convention has them: ``der(z[2])``, not ``der(z)[2]``."""
    if not variable.name.startswith("der("):
        return variable.labels()
    state = Variable(variable.name[4:-1], "local", shape=variable.shape)
    return [f"der({label})" for label in state.labels()]


def _size(blocks: tuple[Block, ...]) -> int:
    return blocks[-1].at.stop if blocks else 0


def _sparsity(function: ca.Function, argument: int) -> np.ndarray:
    return np.array(ca.DM(function.jac_sparsity(0, argument), 1), dtype=float) != 0
