"""FMI 3.0 co-simulation FMUs."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Callable
from ctypes import POINTER, byref, c_bool, c_char_p, c_double, c_size_t, c_uint8, c_uint32, c_void_p
from typing import Any

import numpy as np

from cosim import Advance, ExportError, StepError, Variable, WiringError
from cosim.clock import NS, seconds

from . import intermediate
from .binding import DISCARD, WARNING, receive3
from .declared import References
from .instance import FmuInstance, seconds_between
from .intermediate import Polynomials

_NUMBERS: dict[str, Any] = {
    "Float32": ctypes.c_float,
    "Float64": c_double,
    "Int8": ctypes.c_int8,
    "UInt8": ctypes.c_uint8,
    "Int16": ctypes.c_int16,
    "UInt16": ctypes.c_uint16,
    "Int32": ctypes.c_int32,
    "UInt32": ctypes.c_uint32,
    "Int64": ctypes.c_int64,
    "UInt64": ctypes.c_uint64,
    "Boolean": c_bool,
    "Enumeration": ctypes.c_int64,  # an enumeration travels as Int64
}
_VALUES = (c_void_p, c_void_p, c_size_t, c_void_p, c_size_t)
_BINARY = (c_void_p, c_void_p, c_size_t, c_void_p, c_void_p, c_size_t)
_PROTOTYPES: dict[str, tuple[Any, ...]] = {
    "fmi3InstantiateCoSimulation": (
        c_char_p, c_char_p, c_char_p, c_bool, c_bool, c_bool, c_bool, c_void_p, c_size_t, c_void_p, c_void_p, c_void_p,
    ),
    "fmi3FreeInstance": (c_void_p,),
    "fmi3EnterInitializationMode": (c_void_p, c_bool, c_double, c_double, c_bool, c_double),
    "fmi3ExitInitializationMode": (c_void_p,),
    "fmi3Terminate": (c_void_p,),
    "fmi3Reset": (c_void_p,),
    "fmi3DoStep": (c_void_p, c_double, c_double, c_bool, c_void_p, c_void_p, c_void_p, c_void_p),
    "fmi3GetFMUState": (c_void_p, c_void_p),
    "fmi3SetFMUState": (c_void_p, c_void_p),
    "fmi3FreeFMUState": (c_void_p, c_void_p),
    "fmi3SerializedFMUStateSize": (c_void_p, c_void_p, c_void_p),
    "fmi3SerializeFMUState": (c_void_p, c_void_p, c_void_p, c_size_t),
    "fmi3DeserializeFMUState": (c_void_p, c_void_p, c_size_t, c_void_p),
    "fmi3GetDirectionalDerivative": (
        c_void_p, c_void_p, c_size_t, c_void_p, c_size_t, c_void_p, c_size_t, c_void_p, c_size_t,
    ),
    **{f"fmi3{verb}{kind}": _VALUES for verb in ("Get", "Set") for kind in (*_NUMBERS, "String")},
    **{f"fmi3{verb}Binary": _BINARY for verb in ("Get", "Set")},
}  # fmt: skip


class Fmu3(FmuInstance):
    """An instance of an FMI 3.0 FMU, used without event mode; ``event_mode.EventFmu3`` uses it."""

    _polynomials: Polynomials | None = None

    @staticmethod
    def prototypes() -> dict[str, tuple[Any, ...]]:
        """Return the argument types of the C functions used."""
        return _PROTOTYPES

    def _instantiate(self) -> int:
        resources = os.path.join(self.archive.folder, "resources", "")
        if self.can.input_derivatives:
            self._polynomials = self._intermediate()
        asked = self._polynomials.references if self._polynomials else (c_uint32 * 0)()
        component = self._function("fmi3InstantiateCoSimulation", c_void_p)(
            self.name.encode(), self.archive.token.encode(), resources.encode(), False, False,
            self.can.event_mode, self.can.early_return, asked or None, len(asked), self._environment, receive3,
            intermediate.update if asked else None,
        )  # fmt: skip
        if not component:
            raise ExportError(f"{self.archive.path} cannot be instantiated: {self.log.said() or 'it said nothing'}")
        self._flags = (c_bool * 3)()  # event handling needed, terminate, early return
        self._reached = c_double()
        start = ctypes.addressof(self._flags)
        self._ending = (start, start + 1, start + 2, ctypes.addressof(self._reached))
        self._do_step = self._function("fmi3DoStep")
        if self._polynomials:
            self._polynomials.attach(int(component), self._function("fmi3SetFloat64"))
        return int(component)

    def _intermediate(self) -> Polynomials:
        names = [n for n in self.u_at if n in self.archive.intermediate]
        places = [np.arange(self.u_at[n].start, self.u_at[n].stop) for n in names]
        references = [r for n in names for r in self.archive.references[n].values]
        return Polynomials(self._environment, references, np.concatenate([np.zeros(0, int), *places]))

    def _end_of_use(self, why: str) -> None:
        super()._end_of_use(why)
        intermediate.forget(self._environment)

    def push(self) -> None:
        """Hand the buffer ``u`` to the FMU; derivatives hold for one step only."""
        super().push()
        if self._polynomials:
            self._polynomials.coefficients = []

    def set_input_derivatives(self, values: list[np.ndarray]) -> None:
        """Let the inputs of the next step be polynomials, as far as the FMU asks for them; see ``Instance``."""
        if not self._polynomials or len(values) > self.can.input_derivatives:
            super().set_input_derivatives(values)
        elif values:
            self._polynomials.take(self.u, values)

    # values

    def _float_functions(self) -> tuple[Callable[..., int], Callable[..., int]]:
        return self._function("fmi3SetFloat64"), self._function("fmi3GetFloat64")

    def _transfer_arguments(self, references: Any, n: int, values: Any, n_values: int) -> tuple[Any, ...]:
        return (self._c, references, n, values, n_values)

    def _write(self, references: References, variable: Variable, value: Any) -> None:
        reference = (c_uint32 * 1)(*references.values)
        if references.type == "String":
            texts = _listed(variable, value, str)
            strings = (c_char_p * len(texts))(*(t.encode() for t in texts))
            self._call("fmi3SetString", reference, 1, strings, len(texts))
        elif references.type == "Binary":
            pieces = _listed(variable, value, bytes)
            buffers = [(c_uint8 * max(len(p), 1)).from_buffer_copy(p or b"\0") for p in pieces]
            pointers = (POINTER(c_uint8) * len(pieces))(*(ctypes.cast(b, POINTER(c_uint8)) for b in buffers))
            sizes = (c_size_t * len(pieces))(*map(len, pieces))
            self._call("fmi3SetBinary", reference, 1, sizes, pointers, len(pieces))
        else:
            kind = self._number(references, variable)
            numbers = (kind * variable.size)(*np.ravel(np.broadcast_to(value, variable.shape)).tolist())
            self._call(_accessor("Set", references.type), reference, 1, numbers, variable.size)

    def _read(self, references: References, variable: Variable) -> Any:
        reference, n = (c_uint32 * 1)(*references.values), variable.size
        if references.type == "String":
            strings = (c_char_p * n)()
            self._call("fmi3GetString", reference, 1, strings, n)
            return _shaped([(s or b"").decode() for s in strings], variable)
        if references.type == "Binary":
            sizes, pointers = (c_size_t * n)(), (POINTER(c_uint8) * n)()
            self._call("fmi3GetBinary", reference, 1, sizes, pointers, n)
            return _shaped([ctypes.string_at(p, s) for p, s in zip(pointers, sizes, strict=True)], variable)
        numbers = (self._number(references, variable) * n)()
        self._call(_accessor("Get", references.type), reference, 1, numbers, n)
        return np.array(numbers[:]).reshape(variable.shape) if variable.shape else numbers[0]

    def _number(self, references: References, variable: Variable) -> Any:
        if references.type not in _NUMBERS:
            raise WiringError(f"{self.name}.{variable.name} is a {references.type}, which cannot be set or read")
        return _NUMBERS[references.type]

    # life

    def enter_initialization(self, start: int = 0, stop: int | None = None, tolerance: float | None = None) -> None:
        """Begin initialisation at tick *start*."""
        self.time = seconds(start)
        self._call(
            "fmi3EnterInitializationMode", tolerance is not None, tolerance or 0.0, self.time,
            stop is not None, seconds(stop or 0),
        )  # fmt: skip

    def exit_initialization(self) -> None:
        """End initialisation."""
        self._call("fmi3ExitInitializationMode")
        self._initialized = True

    def step(self, start: int, end: int, *, early_return: bool = False) -> Advance:
        """Advance from tick *start* to *end*, or to an event if *early_return* and the FMU can."""
        self.time, t = end / NS, start / NS
        if self._polynomials:
            self._polynomials.began = t
        status = self._do_step(self._c, t, seconds_between(start, end), False, *self._ending)
        if self._polynomials and self._polynomials.failed:
            self._fail("fmi3SetFloat64 within a step", self._polynomials.status)
        if status == 0 and not (self._flags[1] or self._flags[2]):
            return Advance(end)
        return self._unusual(status, start, end, early_return)

    def _unusual(self, status: int, start: int, end: int, early_return: bool) -> Advance:
        """Handle the end of a step with a warning, an error, before its time, or of the simulation."""
        t = start / NS
        for _ in range(10_000):  # early returns in one step: more are no progress
            if status > WARNING:
                self.time = t
                if status == DISCARD:
                    return self._discarded("fmi3DoStep", start, end, self._reached.value, early_return)
                self._fail("fmi3DoStep", status)
            reached = self._reached.value
            if self._flags[1]:
                return Advance(self._tick(reached, "fmi3DoStep", t), early=reached < end / NS, terminated=True)
            if not self._flags[2]:
                return Advance(end)
            if early_return:
                tick, self.time = self._tick(reached, "fmi3DoStep", t), reached
                return Advance(min(max(tick, start + 1), end), early=True)
            if reached >= end / NS:
                return Advance(end)
            t = reached  # nobody wants to stop here: the rest of the same step
            status = self._do_step(self._c, t, end / NS - t, False, *self._ending)
        raise StepError(self.name, t, "fmi3DoStep returns early again and again without reaching the end of the step")

    def _end(self) -> None:
        if self._initialized:
            self._function("fmi3Terminate")(self._c)
        self._function("fmi3FreeInstance", None)(self._c)

    # rollback

    def snapshot(self) -> Any:
        """Return the FMU's state, exact to the bit; to be freed by ``forget``."""
        state = c_void_p()
        self._call("fmi3GetFMUState", byref(state))
        return state, self.u.copy(), self.time

    def restore(self, snapshot: Any) -> None:
        """Go back to a snapshot of this instance."""
        state, u, self.time = snapshot
        self._call("fmi3SetFMUState", state)
        self.u[:] = u

    def forget(self, snapshot: Any) -> None:
        """Free a snapshot."""
        if self._c is not None:
            self._call("fmi3FreeFMUState", byref(snapshot[0]))

    def serialize(self, snapshot: Any) -> bytes:
        """Return a snapshot as bytes."""
        state, u, time = snapshot
        size = c_size_t()
        self._call("fmi3SerializedFMUStateSize", state, byref(size))
        data = (c_uint8 * size.value)()
        self._call("fmi3SerializeFMUState", state, data, size.value)
        return np.array([time, *u]).tobytes() + bytes(data)

    def deserialize(self, data: bytes) -> Any:
        """Return the snapshot that *data* holds."""
        n = 8 * (1 + self.u.size)
        head = np.frombuffer(data[:n])
        state, rest = c_void_p(), data[n:]
        buffer = (c_uint8 * len(rest)).from_buffer_copy(rest)
        self._call("fmi3DeserializeFMUState", buffer, len(rest), byref(state))
        return state, head[1:].copy(), float(head[0])

    def _derive(self, u: Any, n_u: int, k: Any, n_k: int, seed: np.ndarray, result: np.ndarray) -> None:
        self._call(
            "fmi3GetDirectionalDerivative", u, n_u, k, n_k, seed.ctypes.data, seed.size, result.ctypes.data, result.size
        )


def _accessor(verb: str, type: str) -> str:
    return f"fmi3{verb}{'Int64' if type == 'Enumeration' else type}"


def _listed(variable: Variable, value: Any, kind: type) -> list[Any]:
    values = [value] * variable.size if isinstance(value, kind) else list(np.ravel(np.asarray(value, dtype=object)))
    if len(values) != variable.size or not all(isinstance(v, kind) for v in values):
        raise WiringError(f"{variable.name} takes {variable.size} of {kind.__name__}, not {value!r}")
    return values


def _shaped(values: list[Any], variable: Variable) -> Any:
    return np.array(values, dtype=object).reshape(variable.shape) if variable.shape else values[0]
