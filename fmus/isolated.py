"""An FMU in a process of its own: if it crashes, ends its process or hangs, the run ends with a sentence and its log.

It is used like an FMU in this process and gives the same bits.  A macro step costs one exchange with the other process:
inputs are written to memory that both share, the step is asked for, and the outputs are there when it is answered.
"""

from __future__ import annotations

import os
import pickle
import sys
import warnings
from collections.abc import Iterable
from typing import Any

import numpy as np

from cosim import Advance, ExportError, Instance, StepError, WiringError
from cosim.clock import seconds
from cosim.instance import Update

from .binding import Log
from .channel import CALL, DONE, STEP, STEP_FORMAT, STEPPED, STEPPED_FORMAT
from .importer import Archive, is_discrete, library
from .process import Gone, Process

START_LIMIT = 60.0  # s, for the process itself to start
CLOSE_LIMIT = 10.0  # s, for an FMU without a time limit to end


class IsolatedFmu(Instance):
    """An FMU instance in a process of its own.

    *time_limit* in s is how long one call into the FMU may last; None: for ever, until the run is interrupted.
    Raises ExportError if the FMU cannot be instantiated; StepError if it dies or exceeds the limit.
    """

    def __init__(self, archive: Archive, name: str = "", time_limit: float | None = None) -> None:
        super().__init__(name or archive.model, archive.variables)
        self.archive, self.can, self.time_limit = archive, archive.can, time_limit
        self.log, self.time = Log(), 0.0
        if self.can.event_mode:
            self.discrete = frozenset(name for name, v in archive.variables.items() if is_discrete(v))
        self._forgotten: list[int] = []
        self._pushed = self._fresh = False  # u is in the memory, but not in the FMU; y in the memory is the FMU's
        if os.name != "posix":
            raise ExportError(f"{archive.path} cannot run in a process of its own here: that needs Linux or macOS")
        library(archive)  # there is one for this machine
        self._process = Process(archive.path.name, len(self.u), len(self.y), self.log)
        self._memory = self._process.memory
        try:
            self._answer(START_LIMIT)
            self._send(CALL, pickle.dumps((archive, self.name, len(self.u), len(self.y)), -1))
            self._answer(time_limit)
        except BaseException as error:
            self._process.end("could not be instantiated")
            if isinstance(error, StepError):
                raise ExportError(f"{archive.path} cannot be instantiated: {error.reason}") from None
            raise

    # the other process

    def _usable(self) -> None:
        if why := self._process.unusable:
            raise WiringError(f"{self.name} {why} and cannot be used any more")

    def _send(self, kind: int, content: bytes) -> None:
        self._usable()
        try:
            self._process.send(kind, content)
        except Gone as gone:
            raise StepError(self.name, self.time, str(gone)) from None

    def _answer(self, limit: float | None) -> Any:
        """Return what the process answers, and take over the time it says."""
        try:
            kind, content = self._process.answer(limit)
        except Gone as gone:
            raise StepError(self.name, self.time, str(gone)) from None
        if kind == STEPPED:
            return STEPPED_FORMAT.unpack(content)[0]
        result, self.time = pickle.loads(content)
        if kind == DONE:
            return result
        self.log.entries.clear()  # the error says them
        if isinstance(result, StepError):
            raise StepError(self.name, result.time, result.reason, result.call)
        raise result

    def _ask(self, what: str, *arguments: Any) -> Any:
        """Have the process do something, after handing over the inputs if that is due."""
        if self._pushed:
            self._pushed = False
            self._ask("push")
        self._fresh = False
        self._send(CALL, pickle.dumps((what, self.name, *arguments), -1))
        return self._answer(self.time_limit)

    # values

    def push(self) -> None:
        """Hand the buffer ``u`` to the FMU: right before the next thing that is asked of it."""
        self._usable()
        self._memory.u[:] = self.u
        self._pushed, self._fresh = True, False

    def pull(self) -> None:
        """Fill the buffer ``y`` from the FMU."""
        self._usable()
        if self._pushed or not self._fresh:
            (self._event if self.can.event_mode else self._ask)("pull")
        self.y[:] = self._memory.y

    def set(self, name: str, value: Any) -> None:
        """Set one variable of any type; raises WiringError for a wrong shape, StepError if the FMU refuses."""
        shape = self.variable(name).shape
        self._ask("set", name, value)
        if name in self.u_at:
            self.u[self.u_at[name]] = np.ravel(np.broadcast_to(value, shape))

    def get(self, name: str) -> Any:
        """Return one variable of any type; arrays have their shape."""
        self.variable(name)
        return self._ask("get", name)

    def move(self, name: str, value: Any) -> None:
        """Set a state of an FMU of our own while it runs; raises WiringError for anybody else's."""
        self._ask("move", name, value)

    @property
    def warnings(self) -> list[str]:
        """Warnings the FMU has sent."""
        return list(self.log.warnings)

    # life

    def enter_initialization(self, start: int = 0, stop: int | None = None, tolerance: float | None = None) -> None:
        """Begin initialisation at tick *start*."""
        self.time = seconds(start)
        self._ask("enter_initialization", start, stop, tolerance)

    def exit_initialization(self) -> None:
        """End initialisation."""
        self._ask("exit_initialization")

    def step(self, start: int, end: int, *, early_return: bool = False) -> Advance:
        """Advance from tick *start* to *end*, or to an event if *early_return* and the FMU can."""
        self.time, pushed, self._pushed = seconds(start), self._pushed, False
        self._fresh = False
        self._send(STEP, STEP_FORMAT.pack(start, end, early_return, pushed))
        answer = self._answer(self.time_limit)
        if isinstance(answer, Advance):
            return answer
        self._fresh, self.time = answer, seconds(end)
        return Advance(end)

    def set_input_derivatives(self, values: list[np.ndarray]) -> None:
        """Let the inputs of the next step be polynomials; see ``Instance``."""
        if values:
            self._ask("set_input_derivatives", [np.array(v) for v in values])

    def next_event(self) -> int | None:
        """Return the tick by which the FMU must be in event mode again; None: it does not know of any."""
        return self._ask("next_event") if self.can.event_mode else None

    def enter_event_mode(self) -> None:
        """Begin to handle events; clocks of the FMU's own that are due tick."""
        self._event("enter_event_mode")

    def tick(self, clocks: Iterable[str]) -> None:
        """Let triggered input clocks tick at this instant."""
        self._event("tick", tuple(clocks))

    def update_discrete_states(self) -> Update:
        """Go on to the next instant of the same time."""
        return self._event("update_discrete_states")

    def enter_step_mode(self) -> None:
        """End the handling of events."""
        self._event("enter_step_mode")

    def _event(self, what: str, *arguments: Any) -> Any:
        result, self.active = self._ask("event", what, *arguments)
        return result

    @property
    def pid(self) -> int:
        """Number of the process."""
        return self._process.pid

    @property
    def alive(self) -> bool:
        """Whether it can still be used."""
        return not self._process.unusable

    def reset(self) -> None:
        """Set the FMU back to what it was when it was instantiated."""
        self._ask("reset")
        self.log.warnings.clear()
        self.u[:], self.y[:] = self._memory.u, self._memory.y

    def close(self) -> None:
        """Terminate and free the instance and end its process; a second time nothing happens."""
        limit = self.time_limit or CLOSE_LIMIT
        try:
            if self.alive:
                self._pushed = False
                self._send(CALL, pickle.dumps(("close", self.name), -1))
                self._answer(limit)
                self._process.finish(limit)
        except (StepError, Gone) as error:  # the run is over, and what it computed is not to be lost by this
            what = error if isinstance(error, StepError) else StepError(self.name, self.time, str(error))
            warnings.warn(f"while it was closed, {what}", RuntimeWarning, stacklevel=2)
        finally:
            self._process.end("was closed")

    def __del__(self) -> None:
        if hasattr(self, "_process") and not sys.is_finalizing():
            self.close()

    # rollback

    def snapshot(self) -> int:
        """Return the number under which the other process keeps the FMU's state; to be freed by ``forget``."""
        if self._pushed:
            self._pushed = False
            self._ask("push")
        self._usable()
        self._memory.u[:] = self.u  # it belongs to a snapshot, pushed or not
        forgotten, self._forgotten = self._forgotten, []
        return int(self._ask("snapshot", forgotten))

    def restore(self, snapshot: int) -> None:
        """Go back to a snapshot of this instance."""
        self._pushed = False
        self._ask("restore", snapshot)
        self.u[:] = self._memory.u

    def forget(self, snapshot: int) -> None:
        """Free a snapshot: together with the taking of the next."""
        self._forgotten.append(snapshot)

    def serialize(self, snapshot: int) -> bytes:
        """Return a snapshot as bytes."""
        return bytes(self._ask("serialize", snapshot))

    def deserialize(self, data: bytes) -> int:
        """Return the snapshot that *data* holds."""
        return int(self._ask("deserialize", data))

    def directional_derivative(self, unknowns: list[str], knowns: list[str], seed: np.ndarray) -> np.ndarray:
        """Return d(unknowns)/d(knowns) times *seed*, both flattened; the states are held."""
        for name in (*unknowns, *knowns):
            self.variable(name)
        return np.asarray(self._ask("directional_derivative", unknowns, knowns, seed))
