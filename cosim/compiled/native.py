"""What the compiled loop must know of an instance: where its C functions are, and how to go back to Python."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum
from typing import Any, NoReturn


class What(IntEnum):
    """Which call failed, or what was wrong with a step; as in ``loop.h``."""

    SETTING = 0
    GETTING = 1
    STEPPING = 2
    SAVING = 3
    RESTORING = 4
    CREEPING = 5  # it returns early again and again
    NOWHERE = 6  # it says that it reached what is no time


@dataclass(frozen=True)
class Native:
    """The C side of an instance; addresses are integers, 0 where there is nothing.

    They hold until the instance is bound to other buffers or closed.
    """

    fmi: int  # 2 or 3: which arguments the functions take
    instance: int
    u_references: Any  # a ctypes array of value references, for the buffer u; None: no inputs
    y_references: Any
    failed: Callable[[What, int, float], NoReturn]  # raises as the instance would: what, status, time in s
    arrived: Callable[[float], None]  # the instance is at a time in s
    forget: Callable[[int], None]  # frees what ``save`` has returned
    set: int
    get: int
    step: int
    save: int = 0
    restore: int = 0
    boolean_status: int = 0  # FMI 2.0 only
    real_status: int = 0
