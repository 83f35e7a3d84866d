"""The ports of wheels, drive and chassis under one name each, wherever a robot has them.

Whoever draws, compares or judges asks for ``wheels.normal_force`` and ``chassis.acceleration``.  A robot whose wheels
and chassis are part of its body has these ports itself, as ``body.normal_force`` and ``body.station_acceleration``.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator
from fnmatch import fnmatch

import numpy as np

Read = Callable[[str], "np.ndarray | None"]

_SHARE = 1 - 1e-6  # of the friction limit, from which a wheel counts as being at it
_SLIDING = 0.9  # of the load of a wheel on what slides, from which it counts as sliding: the ends of a patch always do
_PARTS, _WHOLE = ("wheels", "chassis", "drive"), "body"
_OTHERWISE = {
    "chassis.acceleration": f"{_WHOLE}.station_acceleration",  # the body has an acceleration of its own
    "drive.spin": f"{_WHOLE}.wheel_spin",
}


def at_body(port: str) -> str:
    """Return the name that a port has at a robot whose wheels, drive and chassis are part of its body."""
    part, _, name = port.partition(".")
    return _OTHERWISE.get(port, f"{_WHOLE}.{name}" if part in _PARTS else port)


def by_parts(read: Read) -> Read:
    """Return *read* that gives the body's ports for those of parts where there are no such parts."""

    def found(port: str) -> np.ndarray | None:
        values = read(port)
        own = at_body(port)
        return read(own) if values is None and own != port else values

    return found


def read_as(patterns: Iterable[str], ports: Iterable[str]) -> dict[str, str]:
    """Return what each of the *patterns* is for these ports: one for a part that there is not is for the body's."""
    slots = {port.partition(".")[0] for port in ports}
    return {p: p if p.partition(".")[0] in slots or _WHOLE not in slots else at_body(p) for p in patterns}


def like(ports: Collection[str], patterns: Iterable[str]) -> list[str]:
    """Return those of the *ports* that are like any of *patterns*, see `read_as`; all, if there are none."""
    wanted = read_as(patterns, ports).values()
    return [port for port in ports if not wanted or any(fnmatch(port, p) for p in wanted)]


class Ports(Collection[str]):
    """The ports of a run, asked for by part: ``in`` tells whether there is one, `at` its name in the log."""

    def __init__(self, names: Iterable[str]) -> None:
        self.names = frozenset(names)

    def at(self, port: str) -> str:
        """Return the name in the log of a port, whether it is there or not."""
        return port if port in self.names else at_body(port)

    def __contains__(self, port: object) -> bool:
        return isinstance(port, str) and self.at(port) in self.names

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)

    def __len__(self) -> int:
        return len(self.names)


def sliding(read: Read) -> np.ndarray | None:
    """Return (n, 4): which wheels have all the traction there is; None where the run does not tell.

    They are at their friction limit, or slide on friction that is less than that, as on rubber rings.
    """
    traction, limit, share = (read(f"wheels.{port}") for port in ("traction", "friction_limit", "sliding"))
    if traction is None or limit is None:
        return None
    full: np.ndarray = (limit > 0) & (np.abs(traction) >= _SHARE * limit)
    return full if share is None else full | (share >= _SLIDING)
