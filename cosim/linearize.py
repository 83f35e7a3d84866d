"""Components and coupled systems near a point, as linear systems: x' = A x + B u, y = C x + D u, named, exact.

The derivatives are those of the equations (no differences).  Signals are deviations from the point.  A sampled
component is a system in discrete time.  What mixes both, or sets states at communication points, has no such model;
``cosim.step_map`` linearises a whole step of it.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import casadi as ca
import numpy as np

from .component import Component
from .errors import CouplingError, DeclarationError, WiringError, nearest
from .instance import Instance
from .system import System
from .twin import PythonInstance
from .variable import FLOAT, Variable
from .wiring import Connection, find

if TYPE_CHECKING:
    import control


def linearize(
    subject: Component | Instance | System,
    *,
    inputs: Iterable[str] | None = None,
    outputs: Iterable[str] | None = None,
) -> control.StateSpace:
    """Return *subject* near the point where it is, as a linear system that python-control takes.

    A sampled component becomes a system in discrete time, from what it reads at a tick to what it shows after it.

    A component is taken at its start values, an instance and an initialised system where they are.  States, inputs and
    outputs are called like the scalars of the ports, ``F`` or ``gap[2]``; those of a system ``body_gap[2]``, since
    python-control allows no dot.

    *inputs* and *outputs* choose ports, ``body.gap``, or scalars of them, ``body.gap[2]``.  Without them these are all,
    except that the inputs of a system are the unconnected ones; a connected one that is named stands for what is added
    to its source's value.

    Raises DeclarationError for a component whose states have no derivatives and are not sampled, and for the FMU of a
    sampled one; CouplingError for a system that is not initialised, that has a component which sets its states at
    communication points, or whose algebraic loops have no solution; WiringError for a name that does not exist.
    """
    if isinstance(subject, System):
        parts = _closed(subject)
        return named(parts, "system", unconnected(subject) if inputs is None else inputs, outputs)
    instance = subject.instance() if isinstance(subject, Component) else subject
    if isinstance(instance, PythonInstance) and instance.eq.period is not None and not _moves(instance):
        return named(_sampled(instance), instance.name, inputs, outputs, float(instance.p[instance.eq.period]))
    return named(_open(instance), instance.name, inputs, outputs)


@dataclass(frozen=True)
class Linear:
    """The four matrices and the names of their rows and columns."""

    A: np.ndarray
    B: np.ndarray
    C: np.ndarray
    D: np.ndarray
    states: list[str]
    inputs: list[str]
    outputs: list[str]


def named(
    linear: Linear, name: str, inputs: Iterable[str] | None, outputs: Iterable[str] | None, dt: float = 0
) -> control.StateSpace:
    """Return the chosen *inputs* and *outputs* of a linear system for python-control; *dt* in s, 0 is continuous."""
    import control

    u, y = _chosen(linear.inputs, inputs, "input"), _chosen(linear.outputs, outputs, "output")
    labels = {
        "states": linear.states,
        "inputs": [linear.inputs[i] for i in u],
        "outputs": [linear.outputs[i] for i in y],
    }
    plain = {kind: [label.replace(".", "_") for label in found] for kind, found in labels.items()}
    return control.StateSpace(
        linear.A,
        linear.B[:, u],
        linear.C[y],
        linear.D[np.ix_(y, u)],
        dt,
        name=name,
        remove_useless_states=False,
        **plain,
    )


def _chosen(labels: list[str], names: Iterable[str] | None, what: str) -> list[int]:
    """Return the positions of the ports or scalars *names* among *labels*, in the order of the names; None: all."""
    if names is None:
        return list(range(len(labels)))
    found = []
    for name in names:
        at = [i for i, label in enumerate(labels) if label == name or label.startswith(f"{name}[")]
        if not at:
            ports = dict.fromkeys(label.partition("[")[0] for label in labels)
            raise WiringError(f"there is no {what} {name!r} to linearise; {nearest(name, ports)}")
        found += at
    return found


def unconnected(system: System) -> list[str]:
    """Return the unconnected inputs of a system that are real numbers."""
    return [p for p in system.unconnected if find(system.instances, p, "input").variable.type == FLOAT]


def _open(instance: Instance) -> Linear:
    """Return the derivatives of an instance's own equations, its inputs held free."""
    rates = [name for name in instance.variables if name.startswith("der(")]
    states = [instance.variable(rate[4:-1]) for rate in rates]
    held = [name for name, v in instance.variables.items() if v.causality == "local" and name not in rates]
    if len(held) != len(states) or not instance.can.directional_derivatives:
        raise DeclarationError(
            f"{instance.name} cannot be linearised: it does not declare the derivatives of its states; "
            "linearise a step of a system with it by cosim.step_map"
        )
    knowns = [*states, *instance.inputs]
    unknowns = [*rates, *(v.name for v in instance.outputs)]
    columns = np.eye(sum(v.size for v in knowns))
    names = [v.name for v in knowns]
    rows = sum(v.size for v in (*states, *instance.outputs))
    jacobian = np.array([instance.directional_derivative(unknowns, names, seed) for seed in columns])
    jacobian = jacobian.reshape(len(columns), rows).T  # also without a column
    n = sum(v.size for v in states)
    return Linear(
        jacobian[:n, :n], jacobian[:n, n:], jacobian[n:, :n], jacobian[n:, n:],
        _labels(states), _labels(instance.inputs), _labels(instance.outputs),
    )  # fmt: skip


def _moves(instance: PythonInstance) -> bool:
    """Whether anything happens between the ticks."""
    return instance.eq.ode is not None or instance.eq.flow is not None


def _sampled(instance: PythonInstance) -> Linear:
    """Return x[k+1] = sync(x[k], u[k]), y[k] = out(x[k+1], u[k]), without the states of whole numbers."""
    eq = instance.eq
    arguments = eq.out.sx_in()
    x, u = arguments[2], arguments[3]
    ahead = eq.sync(*arguments) if eq.sync is not None else x
    shown = eq.out(*arguments[:2], ahead, *arguments[3:])
    derivatives = [ca.jacobian(f, z) for f in (ahead, shown) for z in (x, u)]
    point = (instance.t, 0.0, instance.x, instance.u, instance.p, instance.looked_up(), instance.constants(0.0))
    A, B, C, D = (np.array(m) for m in ca.Function("jacobians", arguments, derivatives)(*point))
    states = [instance.variable(b.name) for b in eq.states]
    real = [i for i, v in enumerate(v for v in states for _ in range(v.size)) if v.variability != "discrete"]
    labels = _labels(states)
    return Linear(
        A[np.ix_(real, real)], B[real], C[:, real], D,
        [labels[i] for i in real], _labels(instance.inputs), _labels(instance.outputs),
    )  # fmt: skip


def _labels(variables: Iterable[Variable]) -> list[str]:
    return [label for v in variables for label in v.labels()]


def _closed(system: System) -> Linear:
    """Return the system with its wires closed, u = K y + e, seen from the inputs e of every port to all outputs.

    x' = A x + B u, y = C x + D u of all components side by side give y = (1 - D K)^-1 (C x + D e).
    """
    if not system.time:
        raise CouplingError("the system has no values to be linearised at; initialize() it first, or run it")
    parts = {name: _open(_continuous(instance)) for name, instance in system.instances.items()}
    A, B, C, D = (_diagonal([getattr(p, matrix) for p in parts.values()]) for matrix in "ABCD")
    labels = {
        kind: [f"{name}.{label}" for name, p in parts.items() for label in getattr(p, kind)]
        for kind in ("states", "inputs", "outputs")
    }
    K = np.zeros((len(labels["inputs"]), len(labels["outputs"])))
    row, column = ({label: i for i, label in enumerate(labels[kind])} for kind in ("inputs", "outputs"))
    for c in system.connections:
        for target, source in _scalars(c):
            K[row[target], column[source]] = c.factor
    loop = np.eye(len(D)) - D @ K
    if len(loop) and np.linalg.cond(loop) > 1 / np.finfo(float).eps:
        raise CouplingError("the system cannot be linearised: outputs that feed through at once form a singular loop")
    inner = np.linalg.solve(loop, np.hstack([C, D]))
    C, D = inner[:, : C.shape[1]], inner[:, C.shape[1] :]
    return Linear(A + B @ K @ C, B + B @ K @ D, C, D, labels["states"], labels["inputs"], labels["outputs"])


def _continuous(instance: Instance) -> Instance:
    """Refuse an instance that is known to set its states at communication points."""
    if isinstance(instance, PythonInstance) and instance.eq.sync is not None:
        raise CouplingError(
            f"{instance.name} sets states at communication points, so that its derivatives alone do not describe it; "
            "linearise a step of the system with cosim.step_map"
        )
    return instance


def _diagonal(blocks: list[np.ndarray]) -> np.ndarray:
    found = np.zeros((sum(b.shape[0] for b in blocks), sum(b.shape[1] for b in blocks)))
    row = column = 0
    for b in blocks:
        found[row : row + b.shape[0], column : column + b.shape[1]] = b
        row, column = row + b.shape[0], column + b.shape[1]
    return found


def _scalars(connection: Connection) -> Iterable[tuple[str, str]]:
    """Return the scalars that a connection joins, target and source."""
    if not connection.numeric:
        raise CouplingError(
            f"{connection.target.port} carries a {connection.target.variable.type}, which has no derivative"
        )
    ends = []
    for end in (connection.target, connection.source):
        labels = [f"{end.component}.{label}" for label in end.variable.labels()]
        ends.append(labels if end.element is None else [labels[end.element]])
    return zip(*ends, strict=True)
