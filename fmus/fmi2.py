"""FMI 2.0 co-simulation FMUs."""

from __future__ import annotations

from collections.abc import Callable
from ctypes import byref, c_char, c_char_p, c_double, c_int, c_size_t, c_uint32, c_void_p
from typing import Any

import numpy as np

from cosim import Advance, ExportError, Variable, WiringError
from cosim.clock import NS, seconds

from .binding import DISCARD, WARNING, callbacks2
from .declared import References
from .instance import FmuInstance, seconds_between

CO_SIMULATION = 1
LAST_SUCCESSFUL_TIME, TERMINATED = 2, 3  # fmi2StatusKind
_NUMBERS: dict[str, tuple[str, Any]] = {
    "Real": ("Real", c_double),
    "Integer": ("Integer", c_int),
    "Enumeration": ("Integer", c_int),
    "Boolean": ("Boolean", c_int),
}
_VALUES = (c_void_p, c_void_p, c_size_t, c_void_p)
_PROTOTYPES: dict[str, tuple[Any, ...]] = {
    "fmi2Instantiate": (c_char_p, c_int, c_char_p, c_char_p, c_void_p, c_int, c_int),
    "fmi2FreeInstance": (c_void_p,),
    "fmi2SetupExperiment": (c_void_p, c_int, c_double, c_double, c_int, c_double),
    "fmi2EnterInitializationMode": (c_void_p,),
    "fmi2ExitInitializationMode": (c_void_p,),
    "fmi2Terminate": (c_void_p,),
    "fmi2Reset": (c_void_p,),
    "fmi2DoStep": (c_void_p, c_double, c_double, c_int),
    "fmi2SetRealInputDerivatives": (c_void_p, c_void_p, c_size_t, c_void_p, c_void_p),
    "fmi2GetRealStatus": (c_void_p, c_int, c_void_p),
    "fmi2GetBooleanStatus": (c_void_p, c_int, c_void_p),
    "fmi2GetFMUstate": (c_void_p, c_void_p),
    "fmi2SetFMUstate": (c_void_p, c_void_p),
    "fmi2FreeFMUstate": (c_void_p, c_void_p),
    "fmi2SerializedFMUstateSize": (c_void_p, c_void_p, c_void_p),
    "fmi2SerializeFMUstate": (c_void_p, c_void_p, c_void_p, c_size_t),
    "fmi2DeSerializeFMUstate": (c_void_p, c_void_p, c_size_t, c_void_p),
    "fmi2GetDirectionalDerivative": (c_void_p, c_void_p, c_size_t, c_void_p, c_size_t, c_void_p, c_void_p),
    **{f"fmi2{verb}{kind}": _VALUES for verb in ("Get", "Set") for kind in ("Real", "Integer", "Boolean", "String")},
}


class Fmu2(FmuInstance):
    """An instance of an FMI 2.0 FMU."""

    _slopes: np.ndarray | None = None  # derivatives of the inputs that the FMU has, by order; None: it never had any

    @staticmethod
    def prototypes() -> dict[str, tuple[Any, ...]]:
        """Return the argument types of the C functions used."""
        return _PROTOTYPES

    def _instantiate(self) -> int:
        self._callbacks = callbacks2(self._environment)
        resources = (self.archive.folder.resolve() / "resources").as_uri()
        component = self._function("fmi2Instantiate", c_void_p)(
            self.name.encode(), CO_SIMULATION, self.archive.token.encode(), resources.encode(),
            byref(self._callbacks), False, False,
        )  # fmt: skip
        if not component:
            raise ExportError(f"{self.archive.path} cannot be instantiated: {self.log.said() or 'it said nothing'}")
        self._do_step = self._function("fmi2DoStep")
        return int(component)

    # values

    def _float_functions(self) -> tuple[Callable[..., int], Callable[..., int]]:
        return self._function("fmi2SetReal"), self._function("fmi2GetReal")

    def _transfer_arguments(self, references: Any, n: int, values: Any, n_values: int) -> tuple[Any, ...]:
        return (self._c, references, n, values)

    def _write(self, references: References, variable: Variable, value: Any) -> None:
        n = len(references.values)
        reference = (c_uint32 * n)(*references.values)
        if references.type == "String":
            if not isinstance(value, str):
                raise WiringError(f"{self.name}.{variable.name} takes a str, not {value!r}")
            self._call("fmi2SetString", reference, n, (c_char_p * n)(*[value.encode()] * n))
            return
        kind, ctype = _NUMBERS[references.type]
        numbers = (ctype * n)(*np.ravel(np.broadcast_to(value, variable.shape)).tolist())
        self._call(f"fmi2Set{kind}", reference, n, numbers)

    def _read(self, references: References, variable: Variable) -> Any:
        n = len(references.values)
        reference = (c_uint32 * n)(*references.values)
        if references.type == "String":
            strings = (c_char_p * n)()
            self._call("fmi2GetString", reference, n, strings)
            texts = [(s or b"").decode() for s in strings]
            return np.array(texts, dtype=object).reshape(variable.shape) if variable.shape else texts[0]
        kind, ctype = _NUMBERS[references.type]
        numbers = (ctype * n)()
        self._call(f"fmi2Get{kind}", reference, n, numbers)
        values = [bool(v) for v in numbers] if references.type == "Boolean" else numbers[:]
        return np.array(values).reshape(variable.shape) if variable.shape else values[0]

    # life

    def enter_initialization(self, start: int = 0, stop: int | None = None, tolerance: float | None = None) -> None:
        """Begin initialisation at tick *start*."""
        self.time = seconds(start)
        self._call(
            "fmi2SetupExperiment", tolerance is not None, tolerance or 0.0, self.time,
            stop is not None, seconds(stop or 0),
        )  # fmt: skip
        self._call("fmi2EnterInitializationMode")

    def exit_initialization(self) -> None:
        """End initialisation."""
        self._call("fmi2ExitInitializationMode")
        self._initialized = True

    def push(self) -> None:
        """Hand the buffer ``u`` to the FMU; derivatives hold for one step only."""
        super().push()
        if self._slopes is not None and self._slopes.any():
            self.set_input_derivatives([])

    def set_input_derivatives(self, values: list[np.ndarray]) -> None:
        """Let the inputs of the next step be polynomials; see ``Instance``."""
        if len(values) > self.can.input_derivatives:
            super().set_input_derivatives(values)
        if not self._push:
            return
        n, orders = self._push[2], self.can.input_derivatives
        if self._slopes is None:
            self._slopes = np.zeros((orders, n))
            self._derivatives = (
                (c_uint32 * (n * orders))(*list(self._push[1]) * orders), n * orders,
                (c_int * (n * orders))(*(k for k in range(1, orders + 1) for _ in range(n))), self._slopes.ctypes.data,
            )  # fmt: skip
        for order, slope in enumerate(self._slopes):
            slope[:] = values[order] if order < len(values) else 0.0
        self._call("fmi2SetRealInputDerivatives", *self._derivatives)

    def step(self, start: int, end: int, *, early_return: bool = False) -> Advance:
        """Advance from tick *start* to *end*; FMI 2.0 has no early return."""
        self.time, t = end / NS, start / NS
        status = self._do_step(self._c, t, seconds_between(start, end), False)
        if status <= WARNING:
            return Advance(end)
        self.time = t
        if status == DISCARD:
            reached, terminated = self._discarded_at()
            if terminated:
                return Advance(self._tick(reached, "fmi2DoStep", t), early=reached < end / NS, terminated=True)
            return self._discarded("fmi2DoStep", start, end, reached, early_return)
        self._fail("fmi2DoStep", status)

    def _discarded_at(self) -> tuple[float, bool]:
        """Return how far a discarded step came, and whether that ends the simulation: so does FMI 2.0 say it."""
        flag, reached = c_int(), c_double(self.time)
        if self._function("fmi2GetBooleanStatus")(self._c, TERMINATED, byref(flag)) > WARNING:
            flag.value = 0
        self._function("fmi2GetRealStatus")(self._c, LAST_SUCCESSFUL_TIME, byref(reached))
        return reached.value, bool(flag.value)

    def _end(self) -> None:
        if self._initialized:
            self._function("fmi2Terminate")(self._c)
        self._function("fmi2FreeInstance", None)(self._c)

    # rollback

    def snapshot(self) -> Any:
        """Return the FMU's state, exact to the bit; to be freed by ``forget``."""
        state = c_void_p()
        self._call("fmi2GetFMUstate", byref(state))
        return state, self.u.copy(), self.time

    def restore(self, snapshot: Any) -> None:
        """Go back to a snapshot of this instance."""
        state, u, self.time = snapshot
        self._call("fmi2SetFMUstate", state)
        self.u[:] = u
        if self._slopes is not None:
            self._slopes[:] = np.nan  # what it has now only the FMU knows

    def forget(self, snapshot: Any) -> None:
        """Free a snapshot."""
        if self._c is not None:
            self._call("fmi2FreeFMUstate", byref(snapshot[0]))

    def serialize(self, snapshot: Any) -> bytes:
        """Return a snapshot as bytes."""
        state, u, time = snapshot
        size = c_size_t()
        self._call("fmi2SerializedFMUstateSize", state, byref(size))
        data = (c_char * size.value)()
        self._call("fmi2SerializeFMUstate", state, data, size.value)
        return np.array([time, *u]).tobytes() + bytes(data)

    def deserialize(self, data: bytes) -> Any:
        """Return the snapshot that *data* holds."""
        n = 8 * (1 + self.u.size)
        head = np.frombuffer(data[:n])
        state, rest = c_void_p(), data[n:]
        buffer = (c_char * len(rest)).from_buffer_copy(rest)
        self._call("fmi2DeSerializeFMUstate", buffer, len(rest), byref(state))
        return state, head[1:].copy(), float(head[0])

    def _derive(self, u: Any, n_u: int, k: Any, n_k: int, seed: np.ndarray, result: np.ndarray) -> None:
        self._call("fmi2GetDirectionalDerivative", u, n_u, k, n_k, seed.ctypes.data, result.ctypes.data)
