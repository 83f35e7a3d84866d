"""A whole step of a coupled system as a linear system in discrete time: x[k+1] = A x[k] + B u[k], y = C x + D u.

What the master really does is linearised: the algorithm with its delays, sampled components, states that are set at
communication points.  The matrices are central differences of the step, taken from one state by going back to it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatch
from functools import cached_property
from math import lcm
from typing import TYPE_CHECKING

import numpy as np

from .algorithms import Algorithm
from .attempt import Attempt
from .clock import seconds, ticks
from .conserving import Conserving
from .errors import CouplingError, WiringError, nearest
from .extrapolation import Extrapolated
from .instance import Instance
from .linearize import Linear, named, unconnected
from .step_checks import sample_period
from .system import Saved, System
from .variable import FLOAT, Variable
from .wiring import find

if TYPE_CHECKING:
    import control

PERTURBATION = 1e-6  # relative to the value, or to its nominal one if that is larger


def step_map(
    system: System,
    algorithm: Algorithm,
    *,
    step: float,
    inputs: Iterable[str] | None = None,
    outputs: Iterable[str] | None = None,
    states: Iterable[str] = ("*",),
    nominal: Mapping[str, float] | None = None,
) -> control.StateSpace:
    """Return the map from one communication point to a later one near the point where the initialised *system* is.

    It spans the fewest macro steps of *step* (s) after which all sample periods and all that step more seldom have come
    round: that is its ``dt``.  The states are those of the components, ``body.v[1]``, and the inputs whose old values
    still show in outputs that others are fed with.  *states* are patterns, ``body.*``: what matches none is held at
    its value, and so is every state of whole numbers, as a noise generator's.  *inputs* are unconnected ports (default:
    all), held over the map; outputs follow them at once.  Names are as in ``linearize``.

    Every number is moved by 1e-6 of its value, or of its nominal one if that is larger: 1, what a state declares, or
    *nominal* by port, ``{"body.force": 1e3}``.  Where that moves a result by little, its rounding shows.  So does 1e6
    times the tolerance of the integrators: initialise with 1e-12.  Steps are not cut at events; a derivative across
    one, or of a quantised signal, is that of what happens.  The system is left as it was.

    Raises CouplingError for a system that is not initialised, that stands in the midst of a slow component's step, or
    that cannot go back; WiringError for a component whose states cannot be set once it runs, as those of a foreign FMU.
    """
    _check(system)
    _check_memory(algorithm)
    step_ns = ticks(step, "the step")
    span = _span(system, step_ns)
    memory = [*_states(system, tuple(states)), *_held(system, algorithm)]
    free = _externals(system, unconnected(system) if inputs is None else list(inputs))
    saved = system.save(system.names)
    try:
        moved = _sized([*memory, *free], nominal or {})
        columns = _columns(_Step(system, algorithm, step_ns, span, saved), memory, moved)
    finally:
        system.restore(saved, system.names)
        system.forget(saved)
        for name in system.names:
            system.collect(name)
    return named(_linear(system, columns, memory, free), "step", None, outputs, seconds(span * step_ns))


def _check_memory(algorithm: Algorithm | None) -> None:
    while algorithm is not None:
        if isinstance(algorithm, (Extrapolated, Conserving)):
            raise CouplingError(
                f"{type(algorithm).__name__} goes by earlier points, which are no states of a map over one; "
                f"linearise the algorithm inside it"
            )
        algorithm = getattr(algorithm, "inner", None)


@dataclass(frozen=True)
class _Scalar:
    """One number of an instance that can be moved: an element of a state, or of an input."""

    instance: Instance
    variable: Variable
    element: int  # row-major

    @property
    def label(self) -> str:
        return f"{self.instance.name}.{self.variable.labels()[self.element]}"

    def value(self) -> float:
        return float(np.ravel(self.instance.get(self.variable.name))[self.element])

    def size(self) -> float:
        return PERTURBATION * max(abs(self.value()), self.variable.nominal)

    def add(self, by: float) -> None:
        name, instance = self.variable.name, self.instance
        if self.variable.causality == "input":
            instance.u[instance.u_at[name].start + self.element] += by
            instance.push()
            return
        value = np.ravel(instance.get(name)).astype(float)
        value[self.element] += by
        instance.move(name, value.reshape(self.variable.shape))


@dataclass(frozen=True)
class _Step:
    """A step of *span* macro steps that can be taken again and again from where the system was *saved*."""

    system: System
    algorithm: Algorithm
    step: int  # ns
    span: int
    saved: Saved

    @cached_property
    def following(self) -> dict[str, list[str]]:
        """Inputs that hold what their sources show, by component: all their sources step first."""
        late: dict[tuple[str, str], int] = {}
        delays = self.system.delays(self.algorithm)
        for c in self.system.connections:
            port = (c.target.component, c.target.variable.name)
            late[port] = max(late.get(port, 0), delays[c.target.port])
        return {name: [p for (n, p), delay in late.items() if n == name and not delay] for name in self.system.names}

    def back(self) -> None:
        """Go back to the start."""
        self.system.restore(self.saved, self.system.names)

    def settle(self) -> np.ndarray:
        """Bring outputs and following inputs up to date with states and other inputs; return the outputs."""
        for name in self.algorithm.sequence(self.system):
            if self.following[name]:
                self.system.feed(name, self.following[name])
            self.system.collect(name)
        return np.concatenate([np.zeros(0), *(i.y for i in self.system.instances.values())])

    def take(self) -> None:
        """Step as the master would, without locating events."""
        sequence = self.algorithm.sequence(self.system)
        start = self.saved.time[self.system.names[0]]
        for k in range(1, self.span + 1):
            due = tuple(name for name in sequence if k % self.system.every[name] == 0)
            attempt = Attempt(self.system, start + (k - 1) * self.step, start + k * self.step, due, early_return=False)
            self.algorithm.advance(attempt)
            if attempt.stopped:
                raise CouplingError(f"{attempt.stopped} ends the simulation inside the step that is to be linearised")


def _columns(step: _Step, memory: Sequence[_Scalar], moved: Sequence[_Scalar]) -> list[np.ndarray]:
    """Return the derivative of outputs at the start and *memory* at the end by each scalar *moved*."""

    def after(scalar: _Scalar, by: float) -> np.ndarray:
        step.back()
        scalar.add(by)
        shown = step.settle()
        step.take()
        return np.concatenate([shown, [s.value() for s in memory]])

    columns = []
    for scalar in moved:
        step.back()
        h = scalar.size()
        columns.append((after(scalar, h) - after(scalar, -h)) / (2 * h))
    return columns


def _linear(
    system: System, columns: Sequence[np.ndarray], memory: Sequence[_Scalar], free: Sequence[_Scalar]
) -> Linear:
    """Return the matrices of which `_columns` gives the columns, and their names."""
    shown = [f"{n}.{label}" for n, i in system.instances.items() for v in i.outputs for label in v.labels()]
    n, m = len(memory), len(shown)
    jacobian = np.array(columns).reshape(n + len(free), m + n).T
    return Linear(
        jacobian[m:, :n], jacobian[m:, n:], jacobian[:m, :n], jacobian[:m, n:],
        [s.label for s in memory], [s.label for s in free], shown,
    )  # fmt: skip


def _sized(moved: Sequence[_Scalar], nominal: Mapping[str, float]) -> list[_Scalar]:
    """Return the scalars with the *nominal* values of their ports in place of those declared."""
    ports = [f"{s.instance.name}.{s.variable.name}" for s in moved]
    for name in nominal:
        if name not in ports:
            raise WiringError(f"nominal names {name!r}, which is not moved; {nearest(name, dict.fromkeys(ports))}")
    return [
        replace(s, variable=replace(s.variable, nominal=nominal.get(port, s.variable.nominal)))
        for s, port in zip(moved, ports, strict=True)
    ]


def _check(system: System) -> None:
    if not system.time:
        raise CouplingError("the system has no values to be linearised at; initialize() it first, or run it")
    if len(set(system.time.values())) > 1:
        slow = min(system.time, key=lambda name: system.time[name])
        raise CouplingError(
            f"{slow} stands at {seconds(system.time[slow]):g} s, in the midst of its step over several macro steps; "
            "linearise where all components have met"
        )
    for name, instance in system.instances.items():
        if not instance.can.rollback:
            raise CouplingError(f"{name} cannot be taken back to an earlier state, so its step cannot be linearised")


def _span(system: System, step: int) -> int:
    """Return the number of macro steps after which everything sampled and slow has come round."""
    spans = list(system.every.values())
    for name, instance in system.instances.items():
        if (period := sample_period(instance)) is not None:
            spans.append(lcm(ticks(period, f"the period of {name}"), step) // step)
    return lcm(*spans)


def _states(system: System, patterns: Sequence[str]) -> list[_Scalar]:
    return [
        _Scalar(instance, v, i)
        for name, instance in system.instances.items()
        for v in instance.variables.values()
        if v.causality == "local" and v.type == FLOAT and v.variability != "discrete"
        if not v.name.startswith("der(") and any(fnmatch(f"{name}.{v.name}", p) for p in patterns)
        for i in range(v.size)
    ]


def _held(system: System, algorithm: Algorithm) -> list[_Scalar]:
    """Return the inputs that are a memory of their own: old values, of which outputs show something.

    An input whose source steps first holds what its source still shows, and follows it.
    """
    late = {port for port, delay in system.delays(algorithm).items() if delay}
    found: dict[tuple[str, str, int], _Scalar] = {}
    for c in system.connections:
        end, instance = c.target, system.instances[c.target.component]
        through = any(o.depends_on is None or end.variable.name in o.depends_on for o in instance.outputs)
        if end.port in late and through and c.numeric:
            for i in range(end.variable.size) if end.element is None else (end.element,):
                found[end.component, end.variable.name, i] = _Scalar(instance, end.variable, i)
    return list(found.values())


def _externals(system: System, ports: Sequence[str]) -> list[_Scalar]:
    free = set(system.unconnected)
    found = []
    for port in ports:
        end = find(system.instances, port, "input")
        for i in range(end.variable.size) if end.element is None else (end.element,):
            scalar = _Scalar(system.instances[end.component], end.variable, i)
            if not {scalar.label, f"{end.component}.{end.variable.name}"} & free:
                raise WiringError(
                    f"{scalar.label} is connected, so that it cannot be an input of the step; leave it open"
                )
            found.append(scalar)
    return found
