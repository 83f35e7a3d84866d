"""An FMU's shared library and its log: C functions with their argument types, messages sorted by instance."""

from __future__ import annotations

import contextlib
import ctypes
import itertools
import os
from collections import deque
from collections.abc import Callable, Mapping
from ctypes import CFUNCTYPE, Structure, c_char_p, c_int, c_size_t, c_void_p
from pathlib import Path
from typing import Any, ClassVar

import fmpy

from cosim import ExportError

STATUS = ("OK", "warning", "discard", "error", "fatal", "pending")
OK, WARNING, DISCARD, ERROR, FATAL = range(5)


class Log:
    """The last messages of one instance, oldest first."""

    told: ClassVar[Callable[[int, bytes | None], None] | None] = None  # in a process of its own: passes them on

    def __init__(self) -> None:
        self.entries: deque[tuple[int, str]] = deque(maxlen=20)
        self.warnings: deque[str] = deque(maxlen=100)

    def add(self, status: int, message: bytes | None) -> None:
        """Keep a message that the FMU sent."""
        text = (message or b"").decode(errors="replace").strip()
        self.entries.append((status, text))
        if status == WARNING:
            self.warnings.append(text)
        if Log.told is not None:
            Log.told(status, message)

    def said(self) -> str:
        """Return what the FMU said about a call that failed, its last serious messages, and forget it."""
        serious = [text for kind, text in self.entries if kind >= DISCARD and text] or [t for _, t in self.entries if t]
        self.entries.clear()
        return "; ".join(dict.fromkeys(serious[-3:]))


class Library:
    """A loaded shared library; unloaded by ``close``."""

    # in a process of its own: what puts around a function that its name is known while it is called
    around: ClassVar[Callable[[str, Callable[..., Any]], Callable[..., Any]] | None] = None

    def __init__(self, path: Path, prototypes: Mapping[str, tuple[Any, ...]]) -> None:
        self._prototypes = prototypes
        extra = getattr(os, "add_dll_directory", None)  # Windows: libraries that lie beside it
        try:
            with extra(str(path.parent)) if extra else contextlib.nullcontext():
                self._dll: Any = ctypes.CDLL(str(path))
        except OSError as error:
            raise ExportError(f"the FMU's library {path} cannot be loaded: {error}") from None
        self.path = path

    def function(self, name: str, result: Any = c_int) -> Callable[..., Any]:
        """Return a C function; raises ExportError if the library has none of that name."""
        try:
            found = self._dll[name]
        except AttributeError:
            raise ExportError(f"the FMU's library {self.path} does not export {name}") from None
        found.argtypes, found.restype = self._prototypes[name], result
        return found if Library.around is None else Library.around(name, found)

    def close(self) -> None:
        """Unload the library, unless others have it open too."""
        if self._dll is not None:
            fmpy.freeLibrary(self._dll._handle)
            self._dll = None


LOGGER3 = CFUNCTYPE(None, c_void_p, c_int, c_char_p, c_char_p)
LOGGER2 = CFUNCTYPE(None, c_void_p, c_char_p, c_int, c_char_p, c_char_p)

_logs: dict[int, Log] = {}  # by the environment pointer an instance was created with
_tokens = itertools.count(1)


def register(log: Log) -> int:
    """Return a token for a log: what the FMU is given as its environment pointer."""
    token = next(_tokens)
    _logs[token] = log
    return token


def unregister(token: int) -> None:
    """Forget a log."""
    _logs.pop(token, None)


def _receive3(environment: int | None, status: int, category: bytes, message: bytes) -> None:
    if log := _logs.get(environment or 0):
        log.add(status, message)


def _receive2(environment: int | None, name: bytes, status: int, category: bytes, message: bytes) -> None:
    if log := _logs.get(environment or 0):
        log.add(status, message)


# One callback for all instances: FMPy's proxy, which formats the variable arguments of FMI 2.0's logger in C, holds
# only one.  Where FMPy has no proxy for the platform, the format itself is the message.
receive3 = LOGGER3(_receive3)


class CallbackFunctions(Structure):
    """FMI 2.0's fmi2CallbackFunctions."""

    _fields_ = (
        ("logger", LOGGER2),
        ("allocate", CFUNCTYPE(c_void_p, c_size_t, c_size_t)),
        ("free", CFUNCTYPE(None, c_void_p)),
        ("step_finished", c_void_p),
        ("environment", c_void_p),
    )


_allocate = CFUNCTYPE(c_void_p, c_size_t, c_size_t)(fmpy.calloc)
_free = CFUNCTYPE(None, c_void_p)(fmpy.free)
_receive2_pointer = LOGGER2(_receive2)


def callbacks2(environment: int) -> CallbackFunctions:
    """Return FMI 2.0's callbacks for the instance with this environment."""
    functions = CallbackFunctions(_receive2_pointer, _allocate, _free, None, environment)
    with contextlib.suppress(ImportError, OSError, AttributeError):
        from fmpy.logging import addLoggerProxy

        addLoggerProxy(ctypes.byref(functions))
    return functions
