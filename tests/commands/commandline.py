"""What the tests of the command line share: how a command is answered, and an FMU that fails on its way."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import casadi as ca

from cosim import Component, output, parameter, state


class Said(NamedTuple):
    """What a command answered."""

    code: int
    out: str
    err: str


Command = Callable[..., Said]


class Fading(Component):
    """x' = log(end - t): there is no such number after the end."""

    end = parameter(1.0, "s", "when it ends")
    x = state(1.0, "m", "position")
    y = output("m", "position")

    def derivatives(s):  # type: ignore[no-untyped-def]
        return dict(x=ca.log(s.end - s.time))

    def outputs(s):  # type: ignore[no-untyped-def]
        return dict(y=s.x)


class FadingSoon(Fading):
    """The same, ending at 0.105 s: in the step that begins at 0.1 s."""

    end = parameter(0.105, "s", "when it ends")
