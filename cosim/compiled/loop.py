"""A run's stretches in the compiled loop: whether it can make them, what it tells, and how it gives back."""

from __future__ import annotations

from collections.abc import Sequence
from ctypes import POINTER, byref, c_double, c_int, c_int64
from enum import IntEnum
from typing import Any, Protocol

import numpy as np

from cosim.algorithms import Algorithm, GaussSeidel, Jacobi
from cosim.clock import seconds
from cosim.errors import CouplingError
from cosim.observer import Block, Observer, RunInfo
from cosim.system import System
from cosim.variable import FLOAT

from .build import library
from .layout import CLoop, Layout
from .native import What

BUDGET = 0.1  # s of wall clock: nobody who watches waits longer, unless one macro step takes longer
BUFFER = 1 << 20  # bytes of rows in a block: what stays in the processor's cache until it is read
FEWEST, MOST = 16, 4096  # rows in a block
EXACT = 1 << 53  # ns; up to there a tick is a float


class _Why(IntEnum):
    """Why a call ended, as in ``loop.h``."""

    FULL = 0
    EARLY = 1
    MET = 2
    ENDED = 3
    STRAY = 4
    FAILED = 5


class Run(Protocol):
    """What is asked of the master's run."""

    now: int  # ns
    steps: int
    terminated: str

    def wall(self) -> float:
        """Return the seconds of wall clock since the run began."""

    def accept(self, end: int) -> None:
        """Accept a macro step to *end*, and tell of it."""

    def accept_many(self, n: int, end: int, block: Block | None) -> None:
        """Accept *n* macro steps, the last to *end*, and tell of them if somebody listens."""

    def event(self, time: int, component: str) -> None:
        """Tell of an event that everybody was brought to."""


def refusal(system: System, algorithm: Algorithm, info: RunInfo) -> str:
    """Return why the compiled loop cannot make a run, as a clause; empty if it can."""
    if type(algorithm) not in (Jacobi, GaussSeidel):
        return f"it knows Jacobi and GaussSeidel, not {type(algorithm).__name__}"
    if not system.numeric:
        return "a connection carries something else than Float64"
    if info.stop_ns > EXACT:
        return f"the run goes beyond {seconds(EXACT):.3g} s"
    for name, instance in system.instances.items():
        if instance.native() is None:
            return f"{name} is no FMU that is stepped by its C functions alone"
    found, why = library()
    return "" if found is not None else why


def listening(observers: Sequence[Observer]) -> tuple[bool, bool]:
    """Return whether anybody wants to hear of accepted points, and whether all of those take blocks.

    An observer that defines ``accepted`` only may look at the live system, wait, or break the run off: it has every
    point at once.
    """
    deaf = (Observer.accepted, Observer.accepted_block)
    interested = [o for o in observers if (type(o).accepted, type(o).accepted_block) != deaf]
    return bool(interested), all(type(o).accepted_block is not Observer.accepted_block for o in interested)


def compiled_loop(
    wanted: bool | None,
    system: System,
    algorithm: Algorithm,
    info: RunInfo,
    sequence: Sequence[str],
    rewound: Sequence[str],
    observers: Sequence[Observer],
) -> CompiledLoop | None:
    """Return the compiled loop of a run; None: the readable loop is *wanted* (False), or the only one that can make it.

    Raises CouplingError if the compiled one is wanted (True) and cannot.
    """
    if wanted is False:
        return None
    if why := refusal(system, algorithm, info):
        if wanted:
            raise CouplingError(f"the compiled loop cannot make this run: {why}; leave out compiled=True")
        return None
    return CompiledLoop(system, algorithm, info, sequence, rewound, observers)


class CompiledLoop:
    """The compiled loop of one run of *system*, whose instances keep their buffers from now on."""

    def __init__(
        self,
        system: System,
        algorithm: Algorithm,
        info: RunInfo,
        sequence: Sequence[str],
        rewound: Sequence[str],
        observers: Sequence[Observer],
    ) -> None:
        self.system = system
        self.natives = {name: native for name, i in system.instances.items() if (native := i.native()) is not None}
        self._layout = Layout(system, self.natives, info, sequence, rewound, jacobi=isinstance(algorithm, Jacobi))
        self._loop: Any = self._layout.loop
        self._advance = library()[0].advance
        self._advance.argtypes, self._advance.restype = (POINTER(CLoop), c_int64, c_double, c_double), c_int
        told, blocks = listening(observers)
        others = any(v.type != FLOAT and v.causality in ("input", "output")
                     for i in system.instances.values() for v in i.variables.values())  # fmt: skip
        self._one_by_one = told and (others or not blocks)  # ports of another type are not in a row: they are read live
        self._most = 1 if self._one_by_one else info.stop_ns
        self._walls: np.ndarray | None = None
        if told and not self._one_by_one:
            self._room()

    def _room(self) -> None:
        width = len(self.system.row)
        self._most = min(max(BUFFER // (8 * max(width, 1)), FEWEST), MOST)
        self._starts, self._ends = (np.empty(self._most, np.int64) for _ in range(2))
        self._walls, self._rows = np.empty(self._most), np.empty((self._most, width))
        self._layout.room(self._starts, self._ends, self._walls, self._rows)

    def advance(self, run: Run, k: int) -> int:
        """Make macro steps from the one after number *k* on, until one that the readable loop must make.

        Returns the number of the last one made.  Raises what the readable loop would raise.
        """
        loop = self._loop
        loop.k, loop.now = k, run.now
        for c, name in zip(self._layout.components, self.natives, strict=True):
            c.time = self.system.time[name]
        try:
            why = _Why.FULL
            while why in (_Why.FULL, _Why.MET) and run.now < loop.stop and not run.terminated:
                why = _Why(self._advance(byref(loop), self._most, run.wall(), BUDGET))
                self._given_back()
                self._accept(run, why)
        finally:
            self._forget()
        return int(loop.k)

    def _given_back(self) -> None:
        """Let the system and the instances know where they are."""
        for c, (name, native) in zip(self._layout.components, self.natives.items(), strict=True):
            self.system.time[name] = c.time
            native.arrived(seconds(c.time))

    def _accept(self, run: Run, why: _Why) -> None:
        """Tell of the macro steps made, and of what ended them."""
        loop, names = self._loop, self.system.names
        if loop.done and self._one_by_one:
            run.accept(loop.now)
        elif loop.done:
            run.accept_many(loop.done, loop.now, self._block(run, loop.done))
        if why in (_Why.MET, _Why.ENDED) and loop.terminated >= 0:
            run.terminated = names[loop.terminated]
        if why == _Why.MET:
            for i in self._layout.announced[: loop.n_announced]:
                run.event(loop.now, names[i])
        elif why == _Why.STRAY:
            raise self._strayed(names[loop.component])
        elif why == _Why.FAILED:
            self.natives[names[loop.component]].failed(What(loop.what), loop.status, loop.time)

    def _block(self, run: Run, n: int) -> Block | None:
        if self._walls is None:
            return None
        first = run.steps + 1
        return Block(first, self._starts[:n], self._ends[:n], self._walls[:n], self._rows[:n], self.system.places)

    def _strayed(self, name: str) -> CouplingError:
        loop = self._loop
        end = min(loop.start + (loop.k + 1) * loop.step, loop.stop)
        return CouplingError(
            f"{name} was asked to step from {seconds(self.system.time[name]):.9f} s to {seconds(end):.9f} s and "
            f"stopped at {seconds(loop.reached):.9f} s without having been allowed to"
        )

    def _forget(self) -> None:
        """Free the states that were kept to go back to."""
        for c, native in zip(self._layout.components, self.natives.values(), strict=True):
            if c.state:
                native.forget(c.state)
                c.state = None
