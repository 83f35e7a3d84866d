"""What a plot of single ports does not show: which wheels touch the ground, and the traction of all wheels together."""

from __future__ import annotations

from typing import Any

import numpy as np
import rerun as rr

from cosim.system import System

from .drawing import Drawing, Read
from .parts import sliding
from .ports import index, scalars
from .style import WHEELS

TOUCHES, FLIES, LIMIT = "on the ground", "in the air", "sliding: at the friction limit"
CHANGES = 2000  # per wheel and chunk, beyond which a chattering contact is thinned out
TOTAL = "derived/total_traction"


class ContactStates(Drawing):
    """The state of each wheel at its changes only, and the sum of the tractions at every step.

    *limited* tells whether friction has a limit that a wheel could be at.
    """

    def __init__(self, *, limited: bool = True) -> None:
        self.limited = limited
        self._last = [""] * len(WHEELS)

    def started(self, recording: Any, system: System) -> None:
        known = rr.StateConfiguration(values=[TOUCHES, LIMIT, FLIES], labels=["ground", "friction limit", "air"],
                                      colors=[(60, 150, 80), (240, 160, 40), (225, 50, 50)])  # fmt: skip
        for wheel in WHEELS:
            recording.log(f"contact/{wheel}", known, static=True)
        named = rr.SeriesLines(names=["applied: all wheels [N]"], colors=[(240, 128, 32)], widths=[1.5])
        recording.log(TOTAL, named, rr.AnyValues(signal_name=["total_traction"], signal_unit="N"), static=True)

    def emit(self, recording: Any, ns: np.ndarray, step: np.ndarray, read: Read) -> None:
        contact, traction = read("wheels.contact"), read("wheels.traction")
        if traction is not None and traction.shape[1:] == (len(WHEELS),):
            recording.send_columns(TOTAL, index(ns, step), scalars(traction.sum(axis=1)[:, None]))
        if contact is None:
            return
        state = np.where(contact > 0.5, 1, 0)
        if self.limited and (slides := sliding(read)) is not None:
            state[(state == 1) & slides] = 2
        names = np.array([FLIES, TOUCHES, LIMIT])
        for k, wheel in enumerate(WHEELS):
            changed = np.flatnonzero(np.diff(state[:, k], prepend=-1))
            if changed.size and names[state[0, k]] == self._last[k]:
                changed = changed[1:]
            self._last[k] = str(names[state[-1, k]])
            if changed.size > CHANGES:
                changed = changed[:: -(-changed.size // CHANGES)]
            if changed.size:
                columns = rr.StateChange.columns(state=list(names[state[changed, k]]))
                recording.send_columns(f"contact/{wheel}", index(ns[changed], step[changed]), columns)
