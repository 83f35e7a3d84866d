"""The ports of wheels, drive and chassis under one name each, wherever a robot has them.

Whoever draws, compares or judges asks for ``wheels.normal_force`` and ``chassis.acceleration``.  A robot whose wheels
and chassis are part of its body has these ports itself, as ``body.normal_force`` and ``body.station_acceleration``.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator

import numpy as np

Read = Callable[[str], "np.ndarray | None"]

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
