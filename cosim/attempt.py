"""One attempt to bring a system from one communication point to the next: what an algorithm works with."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from .clock import seconds
from .errors import CosimError, CouplingError, StepError
from .estimate import Estimate
from .system import System

Feeder = Callable[["Attempt", str], None]


@dataclass
class Attempt:
    """The interval [start, end] in ns, those who step to its end (*due*), and how far they got."""

    system: System
    start: int
    end: int
    due: tuple[str, ...]
    early_return: bool
    stepped: list[str] = field(default_factory=list)
    announced: list[str] = field(default_factory=list)  # whose event lies at the end
    stopped: str = ""  # who stopped before the end, at ``reached``
    reached: int = 0
    discarded: bool = False  # not for an event, but since the step was too long
    terminated: str = ""  # who asked to end the run
    estimate: Estimate | None = None  # of the error made, by algorithms that make one
    since: int = 0  # ns, the last event at or before the start: what was before it says nothing of what comes
    ahead: frozenset[str] = frozenset()  # components that show a guess of what they show at the end
    feeders: tuple[Feeder, ...] = ()  # what changes the inputs of a component after it was fed

    @property
    def beginning(self) -> list[str]:
        """Components whose own step begins at the start: all, but those in the midst of a step over several."""
        return [name for name, time in self.system.time.items() if time == self.start]

    def feed(self, name: str) -> None:
        """Set the inputs of a component for its next step."""
        self.system.feed(name)
        for feeder in self.feeders:
            feeder(self, name)

    def step(self, name: str) -> bool:
        """Step a component from where it is to the end; False if it stopped before, which ends the attempt."""
        system, start, end = self.system, self.system.time[name], self.end
        self.stepped.append(name)
        try:
            advance = system.instances[name].step(start, end, early_return=self.early_return)
        except CosimError:
            raise
        except Exception as error:  # whatever a component raises, the run's log must say who and when
            raise StepError(name, seconds(start), f"{type(error).__name__}: {error}") from error
        if advance.terminated:
            self.terminated = name
        if advance.reached == end:
            system.time[name] = end
            if advance.early and not advance.terminated:
                self.announced.append(name)
            return True
        allowed = advance.terminated or (advance.early and self.early_return)
        if not allowed or not start <= advance.reached < end:
            raise CouplingError(
                f"{name} was asked to step from {seconds(start):.9f} s to {seconds(end):.9f} s and stopped at "
                f"{seconds(advance.reached):.9f} s without having been allowed to"
            )
        self.stopped, self.reached, self.discarded = name, advance.reached, advance.discarded
        return False
