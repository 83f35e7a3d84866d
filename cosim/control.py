"""How long macro steps are: fixed, or as an error estimate asks for."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from .clock import NS, seconds
from .errors import CouplingError

if TYPE_CHECKING:
    from .attempt import Attempt
    from .system import System

GROW, SHRINK = 5.0, 0.2  # at most, from one step to the next


@dataclass(frozen=True)
class Fixed:
    """Every macro step is as long as asked for."""


@dataclass(frozen=True)
class PI:
    """Steps as long as the estimate of an algorithm such as ``Richardson`` allows; too wrong ones are taken back.

    A step is accepted if no estimated error is above ``tolerance_abs * nominal + tolerance_rel * size`` of its output.
    The next one follows from the last two (Gustafsson 1991: proportional and integral part), within *min_step* and
    *max_step* (s; none: 1 ns, the run).  The step of the run is the first one.  The *order* is that of the algorithm.
    """

    tolerance_rel: float = 1e-4
    tolerance_abs: float = 1e-6
    min_step: float = 0.0
    max_step: float = float("inf")
    safety: float = 0.9
    order: int = 1

    def check(self, system: System, compiled: bool | None) -> None:
        """Raise CouplingError naming a component whose steps cannot vary or be taken back, or for the compiled loop."""
        if compiled:
            raise CouplingError(
                "the compiled loop makes steps of equal length; leave out compiled=True, or control the step by Fixed"
            )
        for name, instance in system.instances.items():
            if system.every[name] > 1:
                raise CouplingError(
                    f"{name} steps every {system.every[name]} macro steps, which has no meaning where their length "
                    f"varies; let it step every one, or control the step by Fixed"
                )
            if not instance.can.variable_step:
                raise CouplingError(f"{name} needs steps of equal length; control the step by Fixed")
            if not instance.can.rollback:
                raise CouplingError(
                    f"{name} cannot be taken back to an earlier state, which a rejected step asks for; "
                    f"control the step by Fixed"
                )


class Pace:
    """The steps of one run under ``PI``."""

    def __init__(self, control: PI, first: int) -> None:
        self.control, self.step = control, float(first)  # ns
        self.before = 1.0  # error of the last accepted step, as a share of the tolerance
        self.low = max(1.0, control.min_step * NS)
        self.high = control.max_step * NS
        self.worst = ""

    def next(self, now: int, limit: int) -> int:
        """Return where the next step is to end; the ones up to *limit* are of about equal length."""
        step = max(self.low, min(self.step, self.high))
        parts = max(1, -int(-(limit - now) // step))
        return min(limit, now + max(1, int((limit - now) / parts))) if parts > 1 else limit

    def accepts(self, attempt: Attempt) -> bool:
        """Judge an attempt and choose the step after it, which is no shorter for one that something else cut short."""
        if attempt.estimate is None:
            raise CouplingError("the algorithm estimates no error, so PI cannot choose the step; wrap it in Richardson")
        share, self.worst = attempt.estimate.worst(self.control.tolerance_rel, self.control.tolerance_abs)
        length, exponent = attempt.end - attempt.start, 1 / (self.control.order + 1)
        if not share <= 1:  # NaN, too, is no error to accept
            if length <= self.low:
                raise CouplingError(
                    f"the error of {self.worst} is {share:.3g} times its tolerance at "
                    f"t = {seconds(attempt.start):.9f} s even with the shortest step of {seconds(length):g} s; "
                    f"loosen the tolerance or allow shorter ones"
                )
            factor = self.control.safety * share**-exponent if share == share and share < float("inf") else SHRINK
            self.step = max(self.low, length * max(SHRINK, min(factor, 0.9)))
            return False
        share = max(share, 1e-10)
        factor = self.control.safety * share ** (-0.7 * exponent) * self.before ** (0.4 * exponent)
        chosen = length * max(SHRINK, min(GROW, factor))
        self.step = max(self.step, chosen) if 2 * length < self.step else chosen
        self.before = share
        return True

    def shorter(self, start: int) -> int:
        """Return where the next attempt ends after a rejected one from *start*."""
        return start + max(1, int(self.step))
