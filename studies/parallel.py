"""Several runs at once, each in a thread of its own: the compiled loop and the log's writer leave Python to the others.

Processes would have to import everything again, and hand whole records back.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import TypeVar

from cosim.errors import CosimError, ScenarioError
from cosim.scenario import Scenario

from .terminal import Bar

T = TypeVar("T")


class _Part(Bar):
    """The bar of one of several runs, which breaks its run off when all are to stop."""

    def __init__(self, bar: Bar, stop: list[BaseException]) -> None:
        super().__init__(bar.progress)
        self.stop = stop

    def __call__(self, label: str, share: float | None = None) -> None:
        if self.stop:
            raise self.stop[0]
        super().__call__(label, share)


@contextmanager
def _part(bar: Bar, stop: list[BaseException]) -> Iterator[Bar]:
    part = _Part(bar, stop)
    try:
        yield part
    finally:
        part.remove()


def usual_jobs(runs: int) -> int:
    """Return how many of *runs* to make at once: as many as there are processors for this process."""
    processors = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return max(1, min(processors, runs))


def together(
    scenarios: Sequence[Scenario], run: Callable[[Scenario, Bar], T], bar: Bar, jobs: int | None
) -> list[T | CosimError]:
    """Run *scenarios*, *jobs* at a time (None: as usual), and return for each what came of it, or why nothing did.

    What breaks this off, as Ctrl-C, or an error that is no CosimError, breaks all runs off: their logs say so.
    """
    if jobs is not None and jobs < 1:
        raise ScenarioError(f"{jobs} runs at once are not possible; give 1 or more")
    stop: list[BaseException] = []

    def one(scenario: Scenario) -> T | CosimError:
        if stop:
            raise stop[0]
        with _part(bar, stop) as part:
            try:
                return run(scenario, part)
            except CosimError as error:
                return error
            except BaseException as error:  # those before it in the order may go on for long
                stop.append(error)
                raise

    jobs = jobs or usual_jobs(len(scenarios))
    if jobs == 1:
        return [one(scenario) for scenario in scenarios]
    with ThreadPoolExecutor(jobs) as pool:
        try:
            return list(pool.map(one, scenarios))
        except BaseException as error:
            stop.append(error)
            raise
