"""Where the C functions of an FMU instance are: what the master's compiled loop calls without Python."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from ctypes import c_void_p
from typing import TYPE_CHECKING, Any, NamedTuple, NoReturn

from cosim import ExportError, StepError
from cosim.compiled import Native, What

if TYPE_CHECKING:
    from .instance import FmuInstance

NO_TIME = 1e9  # s; who says that it reached more, or NaN, does not know where it is


class Names(NamedTuple):
    """What the functions of a version of the standard are called."""

    set: str
    get: str
    step: str
    save: str
    restore: str


NAMES = {
    2: Names("fmi2SetReal", "fmi2GetReal", "fmi2DoStep", "fmi2GetFMUstate", "fmi2SetFMUstate"),
    3: Names("fmi3SetFloat64", "fmi3GetFloat64", "fmi3DoStep", "fmi3GetFMUState", "fmi3SetFMUState"),
}
_CALLS = ("push", "pull", "step", "snapshot", "restore")


def native(
    instance: FmuInstance,
    handle: int | None,
    function: Callable[[str], Any],
    push: tuple[Any, ...],
    pull: tuple[Any, ...],
    fail: Callable[[str, int], NoReturn],
) -> Native | None:
    """Return the C side of *instance*; None where stepping it is more than calling C, or somebody watches the calls.

    *push* and *pull* are the arguments of the functions that set its inputs and get its outputs.
    """
    special = instance.can.event_mode or instance.archive.retry
    if handle is None or special or any(name in vars(instance) for name in _CALLS):
        return None
    fmi = instance.archive.fmi
    names = NAMES[fmi]._asdict() if instance.can.rollback else dict(zip(Names._fields[:3], NAMES[fmi], strict=False))
    names |= {"boolean_status": "fmi2GetBooleanStatus", "real_status": "fmi2GetRealStatus"} if fmi == 2 else {}
    try:
        addresses = {entry: ctypes.cast(function(name), c_void_p).value or 0 for entry, name in names.items()}
    except ExportError:  # what is missing shows when it is needed, if ever
        return None
    return Native(
        fmi=fmi,
        instance=handle,
        u_references=push[1] if push else None,
        y_references=pull[1] if pull else None,
        failed=lambda what, status, time: _failed(instance, fail, what, status, time),
        arrived=lambda time: setattr(instance, "time", time),
        forget=lambda state: instance.forget((c_void_p(state),)),
        **addresses,
    )


def no_time(what: str) -> str:
    """Return the complaint about a function that says it came to no time."""
    return f"{what} returned a last successful time that is no time"


def _failed(
    instance: FmuInstance, fail: Callable[[str, int], NoReturn], what: What, status: int, time: float
) -> NoReturn:
    """Raise what the instance raises where the same call fails."""
    instance.time = time
    if what == What.CREEPING:
        raise StepError(
            instance.name, time, "fmi3DoStep returns early again and again without reaching the end of the step"
        )
    names = NAMES[instance.archive.fmi]
    if what == What.NOWHERE:
        raise StepError(instance.name, time, no_time(names.step))
    fail(names[what], status)
