"""What the master can step: one interface for a Python instance and a loaded FMU.

Life: constructed (parameters and start values may be set), ``enter_initialization``, inputs pushed and outputs pulled
as often as needed, ``exit_initialization``, then ``push``, ``step``, ``pull`` until ``close``.

All Float64 inputs of an instance live in one flat buffer ``u``, all Float64 outputs in ``y``, arrays row-major, in the
order of ``inputs`` and ``outputs``: the master moves a whole component with one indexed copy.  A system binds them
to parts of one array, so that what everybody shows is one row.  Every other type goes through ``set`` and ``get``.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from .errors import WiringError, nearest
from .variable import FLOAT, Variable

if TYPE_CHECKING:
    from .compiled import Native


@dataclass(frozen=True)
class Capabilities:
    """What an instance declares it can do."""

    rollback: bool = False  # snapshot and restore
    serialize: bool = False  # snapshots to bytes and back
    early_return: bool = False  # a step may end before its time, at an event
    directional_derivatives: bool = False
    variable_step: bool = True
    get_after_set: bool = True  # outputs follow inputs that were set, without a step; FMI 2.0 does not promise it
    event_mode: bool = False  # events are handled between steps, and some ports change there only
    input_derivatives: int = 0  # highest order of the time derivatives of inputs that a step takes


@dataclass(frozen=True)
class Advance:
    """How a step ended: the tick reached, and why it ended there."""

    reached: int  # ns; the first tick at or after the event when the step returned early
    early: bool = False  # an announced event lies in the last nanosecond, be that before the end asked for or at it
    terminated: bool = False  # the component asks to end the simulation
    discarded: bool = False  # it is early not for an event, but since it takes no step that long


@dataclass(frozen=True)
class Update:
    """What an instance in event mode asks for after it has updated its discrete states."""

    again: bool = False  # another round at the same instant
    terminated: bool = False  # the end of the simulation


class Instance(ABC):
    """A component with values; see the module for its life."""

    name: str
    variables: Mapping[str, Variable]
    can: Capabilities
    discrete: frozenset[str] = frozenset()  # ports that are set and read in event mode only
    active: frozenset[str] = frozenset()  # clocks that tick at this instant, inputs and outputs

    def __init__(self, name: str, variables: Mapping[str, Variable]) -> None:
        self.name, self.variables = name, variables
        self.inputs = tuple(v for v in variables.values() if v.causality == "input" and v.type == FLOAT)
        self.outputs = tuple(v for v in variables.values() if v.causality == "output" and v.type == FLOAT)
        self.u = np.concatenate([np.zeros(0)] + [np.ravel(_start(v)) for v in self.inputs])
        self.y = np.zeros(sum(v.size for v in self.outputs))
        self.u_at, self.y_at = _slices(self.inputs), _slices(self.outputs)

    def bind(self, u: np.ndarray, y: np.ndarray) -> None:
        """Keep the buffers ``u`` and ``y`` in these contiguous arrays from now on; their values move along."""
        u[:], y[:] = self.u, self.y
        self.u, self.y = u, y

    def variable(self, name: str) -> Variable:
        """Return a variable's description; raises WiringError naming the nearest one if there is none."""
        if name not in self.variables:
            raise WiringError(f"{self.name} has no variable {name!r}; {nearest(name, self.variables)}")
        return self.variables[name]

    @abstractmethod
    def set(self, name: str, value: Any) -> None:
        """Set one variable of any type: a parameter or start value before initialisation, an input at any time."""

    @abstractmethod
    def get(self, name: str) -> Any:
        """Return one variable of any type; arrays have their shape."""

    @abstractmethod
    def enter_initialization(self, start: int = 0, stop: int | None = None, tolerance: float | None = None) -> None:
        """Begin initialisation at tick *start*; *tolerance* is the relative one of the component's own integrator."""

    @abstractmethod
    def exit_initialization(self) -> None:
        """End initialisation: the component is ready to step from its start tick."""

    @abstractmethod
    def push(self) -> None:
        """Hand the buffer ``u`` to the component."""

    @abstractmethod
    def pull(self) -> None:
        """Fill the buffer ``y`` from the component."""

    @abstractmethod
    def step(self, start: int, end: int, *, early_return: bool = False) -> Advance:
        """Advance from tick *start* to *end*, or to an announced event if *early_return*; raises StepError."""

    def set_input_derivatives(self, values: list[np.ndarray]) -> None:
        """Let the inputs of the next step be polynomials in time, *values* their derivatives of order 1, 2, ...

        They are those at the start of the step; each has the layout of ``u``, in the unit of the input per s, s2, ...
        There are at most ``can.input_derivatives`` of them, and they hold for one step.  Raises WiringError where the
        instance does not take them.
        """
        if values:
            raise WiringError(
                f"{self.name} takes {self.can.input_derivatives or 'no'} derivatives of its inputs, not {len(values)}"
            )

    # events, of an instance with ``can.event_mode``: enter; tick, push, pull, update as often as needed; leave

    def next_event(self) -> int | None:
        """Return the tick by which the instance must be in event mode again; None: it does not know of any."""
        return None

    def enter_event_mode(self) -> None:
        """Begin to handle events where the instance is; clocks of its own that are due tick."""
        raise self._no_event_mode()

    def tick(self, clocks: Iterable[str]) -> None:
        """Let triggered input clocks tick at this instant."""
        raise self._no_event_mode()

    def update_discrete_states(self) -> Update:
        """Go on to the next instant of the same time: clocks stop ticking, discrete states take their new values."""
        raise self._no_event_mode()

    def enter_step_mode(self) -> None:
        """End the handling of events: the instance is ready to step."""
        raise self._no_event_mode()

    def _no_event_mode(self) -> WiringError:
        return WiringError(f"{self.name} has no event mode")

    @abstractmethod
    def snapshot(self) -> Any:
        """Return everything that the future depends on; exact to the bit."""

    @abstractmethod
    def restore(self, snapshot: Any) -> None:
        """Go back to a snapshot of this instance; it may be restored any number of times."""

    def forget(self, snapshot: Any) -> None:  # noqa: B027
        """Free a snapshot that will not be restored any more."""

    @abstractmethod
    def serialize(self, snapshot: Any) -> bytes:
        """Return a snapshot as bytes."""

    @abstractmethod
    def deserialize(self, data: bytes) -> Any:
        """Return the snapshot that *data* holds; it may come from another instance of the same component."""

    def native(self) -> Native | None:
        """Return where the instance's C functions are, for the compiled loop; None: stepping it takes Python."""
        return None

    def move(self, name: str, value: Any) -> None:
        """Set a state at a communication point; raises WiringError unless the instance can, as most FMUs cannot."""
        raise WiringError(f"the states of {self.name} cannot be set once it runs")

    @abstractmethod
    def directional_derivative(self, unknowns: list[str], knowns: list[str], seed: np.ndarray) -> np.ndarray:
        """Return d(unknowns)/d(knowns) times *seed*, both flattened; unknowns are outputs or ``der(state)``."""

    def close(self) -> None:  # noqa: B027
        """Free what the instance holds; it cannot be used afterwards."""


def _start(v: Variable) -> np.ndarray:
    return np.broadcast_to(np.asarray(0.0 if v.start is None else v.start, float), v.shape)


def _slices(variables: tuple[Variable, ...]) -> dict[str, slice]:
    found, at = {}, 0
    for v in variables:
        found[v.name] = slice(at, at + v.size)
        at += v.size
    return found
