"""The structures of ``loop.h``, and a system written into them."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from ctypes import c_bool, c_double, c_int64, c_void_p
from typing import Any

import numpy as np

from cosim.observer import RunInfo
from cosim.system import Inlet, System

from .native import Native


class CComponent(ctypes.Structure):
    """``Component`` of ``loop.h``."""

    _fields_ = (
        *((name, c_void_p) for name in ("instance", "set", "get", "step", "save", "restore")),
        *((name, c_void_p) for name in ("boolean_status", "real_status", "u_references", "y_references", "u", "y")),
        *((name, c_void_p) for name in ("targets", "sources", "factor", "offset")),
        *((name, c_int64) for name in ("n_u_references", "n_y_references", "n_u", "n_y", "n_wires")),
        *((name, c_int64) for name in ("fmi", "every", "rewound", "time", "kept_time")),
        ("state", c_void_p),
        ("reached", c_double),
        *((name, c_bool) for name in ("event", "terminate", "early")),
    )


class CLoop(ctypes.Structure):
    """``Loop`` of ``loop.h``."""

    _fields_ = (
        ("components", c_void_p),
        *((name, c_void_p) for name in ("order", "row", "values", "kept", "announced", "starts", "ends")),
        *((name, c_void_p) for name in ("walls", "rows")),
        *((name, c_int64) for name in ("n", "n_row", "jacobi", "locating", "start", "stop", "step", "k", "now")),
        *((name, c_int64) for name in ("done", "n_announced", "terminated", "component", "what", "status")),
        ("reached", c_int64),
        *((name, c_double) for name in ("time", "from", "to")),
    )


class Layout:
    """The memory that ``loop.c`` works on; it lives as long as this object."""

    def __init__(
        self,
        system: System,
        natives: Mapping[str, Native],
        info: RunInfo,
        sequence: Sequence[str],
        rewound: Sequence[str],
        *,
        jacobi: bool,
    ) -> None:
        self._held: list[Any] = []
        self.components = (CComponent * len(natives))()
        for i, (name, native) in enumerate(natives.items()):
            self._fill(self.components[i], system, name, native, rewound=name in rewound)
        self.announced = np.zeros(len(natives), np.int64)
        self.loop = CLoop(
            components=ctypes.addressof(self.components), n=len(natives), n_row=len(system.row),
            order=self._array([system.names.index(name) for name in sequence], np.int64),
            row=system.row.ctypes.data, values=system.values.ctypes.data,
            kept=self._array(system.row, float) if rewound else None, announced=self.announced.ctypes.data,
            jacobi=jacobi, locating=bool(rewound), start=info.start_ns, stop=info.stop_ns, step=info.step_ns,
        )  # fmt: skip

    def _fill(self, c: CComponent, system: System, name: str, native: Native, *, rewound: bool) -> None:
        for entry in ("instance", "set", "get", "step", "save", "restore", "boolean_status", "real_status", "fmi"):
            setattr(c, entry, getattr(native, entry))
        instance = system.instances[name]
        for side, references, buffer in (
            ("u", native.u_references, instance.u),
            ("y", native.y_references, instance.y),
        ):
            setattr(c, side, buffer.ctypes.data)
            setattr(c, f"n_{side}", buffer.size)
            if references is not None:
                setattr(c, f"{side}_references", ctypes.addressof(references))
                setattr(c, f"n_{side}_references", len(references))
        self._held.append(native)
        self._wires(c, system.inlet(name))
        c.every, c.rewound = system.every[name], rewound

    def _wires(self, c: CComponent, inlet: Inlet) -> None:
        c.n_wires = len(inlet.targets)
        c.targets, c.sources = self._array(inlet.targets, np.int64), self._array(inlet.sources, np.int64)
        if inlet.factor is not None:
            c.factor, c.offset = self._array(inlet.factor, float), self._array(inlet.offset, float)

    def _array(self, values: Any, kind: Any) -> int:
        """Keep a copy of *values*; return its address."""
        self._held.append(np.array(values, kind))
        return int(self._held[-1].ctypes.data)

    def room(self, starts: np.ndarray, ends: np.ndarray, walls: np.ndarray, rows: np.ndarray) -> None:
        """Have the macro steps told in these arrays, one row each."""
        self._held += [starts, ends, walls, rows]
        self.loop.starts, self.loop.ends = starts.ctypes.data, ends.ctypes.data
        self.loop.walls, self.loop.rows = walls.ctypes.data, rows.ctypes.data
