"""What the tests of the command line share: how a command is answered, and an FMU that fails on its way."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from toys import Fading

from cosim import parameter


class Said(NamedTuple):
    """What a command answered."""

    code: int
    out: str
    err: str


Command = Callable[..., Said]


class FadingSoon(Fading):
    """The same, ending at 0.105 s: in the step that begins at 0.1 s."""

    end = parameter(0.105, "s", "when it ends")
