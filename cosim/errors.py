"""The errors a user can meet: each is one sentence that says what was asked, why not, and what would work."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from typing import Any


class CosimError(Exception):
    """Base of every error this package raises on purpose; the command line prints it without a traceback."""


class DeclarationError(CosimError):
    """A component's declaration or equations contradict themselves, or were given values they cannot take."""


class WiringError(CosimError):
    """A connection cannot be made: a name, causality, type, shape or unit does not fit."""


class CouplingError(CosimError):
    """Components that are wired correctly cannot be advanced together."""


class StepError(CosimError):
    """A component failed while it was initialised or stepped; carries the component, the time and its own message.

    *call* is the C function of an FMU with what it returned, *step* the number of the accepted point that the step
    would have led to, which the master knows; an error before the first step has none.
    """

    def __init__(self, component: str, time: float, reason: str, call: str = "", step: int | None = None) -> None:
        super().__init__(component, time, reason)
        self.component, self.time, self.reason, self.call, self.step = component, time, reason, call, step

    def __str__(self) -> str:
        where = ", ".join(filter(None, (self.call, f"step {self.step}" if self.step is not None else "")))
        return f"{self.component} failed at t = {self.time:.9g} s: {self.reason}" + (f" ({where})" if where else "")

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.component, self.time, self.reason, self.call, self.step)  # between processes


class ExportError(CosimError):
    """A component could not be turned into an FMU, or a file is not an FMU that runs here."""


class ScenarioError(CosimError):
    """A scenario file, or an override given for it, does not describe a run."""


def nearest(name: str, known: Iterable[str]) -> str:
    """Return the part of a sentence that helps after an unknown name: the nearest known one, or all of them."""
    known = list(known)
    close = difflib.get_close_matches(name, known, n=1, cutoff=0.6)
    if close:
        return f"did you mean {close[0]!r}?"
    return f"known: {', '.join(known)}" if known else "there are none"
