"""A loaded FMU as an instance the master can step.

Moving all Float64 inputs and outputs is one call into the FMU each, with pointers prepared once.
"""

from __future__ import annotations

import ctypes
import math
import sys
from abc import abstractmethod
from collections.abc import Callable
from ctypes import c_uint32, c_void_p
from typing import Any, NoReturn

import numpy as np

from cosim import Advance, Instance, StepError, Variable, WiringError
from cosim.clock import NS, tick_at_or_after
from cosim.compiled import Native

from .addresses import NAMES, NO_TIME, native, no_time
from .binding import DISCARD, FATAL, STATUS, WARNING, Library, Log, register, unregister
from .declared import References
from .importer import Archive, library
from .states import patched, place


class FmuInstance(Instance):
    """One instance of an FMU; ``fmi2.Fmu2`` and ``fmi3.Fmu3`` speak the two versions of the standard."""

    def __init__(self, archive: Archive, name: str) -> None:
        super().__init__(name or archive.model, archive.variables)
        self.archive, self.can, self._u_at_start = archive, archive.can, self.u.copy()
        self.log = Log()
        self.time = 0.0
        self._initialized = self._started = False
        self._library: Library | None = Library(library(archive), self.prototypes())
        self._environment = register(self.log)
        self._functions: dict[str, Callable[..., Any]] = {}
        self._do_step: Callable[..., int]
        self._c: int | None = None
        try:
            self._c = self._instantiate()
        finally:
            if self._c is None:
                self._release()
        self._prepare()
        self._set_float, self._get_float = self._float_functions()

    # what the two versions differ in

    @staticmethod
    @abstractmethod
    def prototypes() -> dict[str, tuple[Any, ...]]:
        """Return the argument types of the C functions used."""

    @abstractmethod
    def _instantiate(self) -> int: ...

    @abstractmethod
    def _float_functions(self) -> tuple[Callable[..., int], Callable[..., int]]: ...

    @abstractmethod
    def _transfer_arguments(self, references: Any, n: int, values: Any, n_values: int) -> tuple[Any, ...]: ...

    @abstractmethod
    def _write(self, references: References, variable: Variable, value: Any) -> None: ...

    @abstractmethod
    def _read(self, references: References, variable: Variable) -> Any: ...

    # calling C

    def _function(self, name: str, result: Any = ctypes.c_int) -> Callable[..., Any]:
        if self._library is None:
            self._closed()
        if name not in self._functions:
            self._functions[name] = self._library.function(name, result)
        return self._functions[name]

    def _call(self, name: str, *arguments: Any) -> None:
        status = self._function(name)(self._c, *arguments)
        if status > WARNING:
            self._fail(name, status)

    def _fail(self, what: str, status: int, cure: str = "") -> NoReturn:
        returned = f"{what} returned {STATUS[status] if 0 <= status < len(STATUS) else status}"
        said = self.log.said() or "it said nothing"
        if status == FATAL:  # the standard forbids every further call, even to free it, and the library stays
            self._c = self._library = None
            self._end_of_use("failed fatally")
        if status == DISCARD and not cure:
            cure = "use a shorter macro step"
            if self.can.rollback:
                cure = "with retry such steps are repeated in shorter ones, as it can be taken back; else " + cure
        raise StepError(self.name, self.time, f"{said}; {cure}" if cure else said, returned)

    def _discarded(self, what: str, start: int, end: int, reached: float, early_return: bool) -> Advance:
        """Return where everybody is to be taken after a step that the FMU made only until *reached* (s), or raise."""
        cure = ""
        if self.archive.retry and not early_return:
            cure = "to repeat it in shorter ones takes a run that locates events: locate_events = true"
        elif self.archive.retry:
            if end - start > 1:
                tick = int(reached * NS + 1e-3) if math.isfinite(reached) else start
                middle = start + (end - start) // 2
                return Advance(tick if start < tick < end else middle, early=True, discarded=True)
            cure = "it does so however short the step is"
        self._fail(what, DISCARD, cure)

    def _tick(self, reached: float, what: str, start: float) -> int:
        """Return the first tick at or after what the FMU says it reached from *start*; raises StepError for no time."""
        if not abs(reached) < NO_TIME:
            raise StepError(self.name, start, no_time(what))
        return tick_at_or_after(reached)

    def _transfer(self, variables: tuple[Variable, ...], values: np.ndarray) -> tuple[Any, ...]:
        references = [r for v in variables for r in self.archive.references[v.name].values]
        if not references:
            return ()
        array = (c_uint32 * len(references))(*references)
        return self._transfer_arguments(array, len(references), c_void_p(values.ctypes.data), values.size)

    def _prepare(self) -> None:
        self._push = self._transfer(self.inputs, self.u)
        self._pull = self._transfer(self.outputs, self.y)

    @property
    def warnings(self) -> list[str]:
        """Warnings the FMU has sent."""
        return list(self.log.warnings)

    # values

    def set(self, name: str, value: Any) -> None:
        """Set one variable of any type; raises WiringError for a wrong shape, StepError if the FMU refuses."""
        variable = self.variable(name)
        if variable.type not in ("String", "Binary") and np.shape(value) not in (variable.shape, ()):
            raise WiringError(
                f"{self.name}.{name} has shape {list(variable.shape)}, but was given {list(np.shape(value))}"
            )
        self._write(self.archive.references[name], variable, value)
        if name in self.u_at:
            self.u[self.u_at[name]] = np.ravel(np.broadcast_to(value, variable.shape))

    def get(self, name: str) -> Any:
        """Return one variable of any type; arrays have their shape."""
        variable = self.variable(name)
        return self._read(self.archive.references[name], variable)

    def move(self, name: str, value: Any) -> None:
        """Set a state of an FMU of our own while it runs; raises WiringError for anybody else's."""
        where, shape = place(self.archive, name), self.variable(name).shape
        saved = self.snapshot()
        try:
            data = patched(self.serialize(saved), where, np.broadcast_to(value, shape))
        finally:
            self.forget(saved)
        moved = self.deserialize(data)
        try:
            self.restore(moved)
        finally:
            self.forget(moved)

    def bind(self, u: np.ndarray, y: np.ndarray) -> None:
        """Keep the buffers ``u`` and ``y`` in these contiguous arrays from now on; raises WiringError when closed."""
        if self._library is None:
            self._closed()
        super().bind(u, y)
        self._prepare()  # the FMU is handed addresses

    def push(self) -> None:
        """Hand the buffer ``u`` to the FMU."""
        if self._push:
            status = self._set_float(*self._push)
            if status > WARNING:
                self._fail(NAMES[self.archive.fmi].set, status)

    def pull(self) -> None:
        """Fill the buffer ``y`` from the FMU."""
        if self._pull:
            status = self._get_float(*self._pull)
            if status > WARNING:
                self._fail(NAMES[self.archive.fmi].get, status)

    def native(self) -> Native | None:
        """Return where the C functions are, for the compiled loop."""
        return native(self, self._c, self._function, self._push, self._pull, self._fail)

    # derivatives

    def directional_derivative(self, unknowns: list[str], knowns: list[str], seed: np.ndarray) -> np.ndarray:
        """Return d(unknowns)/d(knowns) times *seed*, both flattened; the states are held."""
        if not self.can.directional_derivatives:
            raise WiringError(f"{self.name} does not provide directional derivatives")
        u, k = ([r for n in names for r in self._references_of(n)] for names in (unknowns, knowns))
        result = np.zeros(sum(self.variable(n).size for n in unknowns))
        flat = np.ascontiguousarray(seed, dtype=float).ravel()
        if flat.size != sum(self.variable(n).size for n in knowns):
            raise WiringError(f"{self.name} was given a seed of {flat.size} numbers for {', '.join(knowns)}")
        self._derive((c_uint32 * len(u))(*u), len(u), (c_uint32 * len(k))(*k), len(k), flat, result)
        return result

    def _references_of(self, name: str) -> tuple[int, ...]:
        self.variable(name)
        return self.archive.references[name].values

    @abstractmethod
    def _derive(self, u: Any, n_u: int, k: Any, n_k: int, seed: np.ndarray, result: np.ndarray) -> None: ...

    # life

    @property
    def alive(self) -> bool:
        """Whether it can still be used: not closed, and no fatal error met."""
        return self._c is not None

    def reset(self) -> None:
        """Set the FMU back to what it was when it was instantiated, as far as it keeps to the standard."""
        if self._initialized:
            self._call(f"fmi{self.archive.fmi}Terminate")
            self._initialized = False
        self._call(f"fmi{self.archive.fmi}Reset")
        self.u[:], self.y[:], self.time = self._u_at_start, 0.0, 0.0
        self.log.entries.clear()
        self.log.warnings.clear()

    def close(self) -> None:
        """Terminate and free the instance and unload its library; a second time nothing happens."""
        if self._c is not None and self._library is not None:
            self._end()
        self._c = None
        self._release()

    @abstractmethod
    def _end(self) -> None: ...

    def _release(self) -> None:
        self._end_of_use("was closed")
        if self._library is not None:
            self._library.close()
            self._library = None

    def _end_of_use(self, why: str) -> None:
        unregister(self._environment)
        self._why = why
        self._functions = {}
        self._push = self._pull = (None,)
        self._set_float = self._get_float = self._do_step = self._closed

    def _closed(self, *_: Any) -> NoReturn:
        raise WiringError(f"{self.name} {self._why} and cannot be used any more")

    def __del__(self) -> None:
        if getattr(self, "_library", None) is not None and not sys.is_finalizing():
            self.close()


def seconds_between(start: int, end: int) -> float:
    """Length of a step in seconds, from ticks."""
    return end / NS - start / NS
