"""States of a running FMU of our own: FMI lets nobody set them, but a snapshot is bytes, and we know where they lie.

A snapshot ends with the first slots of the instance (``harness/snapshot.c``): time, parameters, inputs, states.  In a
slot's place from the end nothing depends on what a snapshot begins with.
"""

from __future__ import annotations

import numpy as np

from cosim import WiringError
from cosim.variable import FLOAT

from .importer import Archive

TOOL = "wmr-cosim"  # that wrote the FMU


def is_state(archive: Archive, name: str) -> bool:
    """Whether a variable is a state of an FMU of ours."""
    return archive.variables[name].causality == "local" and not name.startswith("der(")


def place(archive: Archive, name: str) -> int:
    """Return how many bytes before the end of a snapshot the state *name* begins; raises WiringError.

    No other tool's FMU has states that can be set, and no other variable of ours is one.
    """
    if archive.tool != TOOL:
        raise WiringError(f"the states of {archive.path.name} cannot be set once it runs: it is a foreign FMU")
    if not is_state(archive, name):
        raise WiringError(f"{name} of {archive.path.name} is no state, and only states can be moved")
    kept = [
        v for n, v in archive.variables.items()
        if v.type == FLOAT and (v.causality in ("parameter", "input") or is_state(archive, n))
    ]  # fmt: skip
    slots = 1 + sum(v.size for v in kept)
    return 8 * (slots - archive.references[name].values[0])


def patched(snapshot: bytes, before_end: int, value: np.ndarray) -> bytes:
    """Return the bytes of a snapshot with *value* written *before_end* bytes before their end."""
    at = len(snapshot) - before_end
    data = np.ascontiguousarray(value, dtype=float).tobytes()
    return snapshot[:at] + data + snapshot[at + len(data) :]
