"""The verdict on a run: what a robot designer compares controllers by, computed from the recorded ports.

Every figure states its unit and which direction is better.  A scenario asks for more than the usual rows by their
group, ``verdict = ["jerk"]``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np

from cosim.errors import ScenarioError, nearest

from . import contact, control, jerk, motion, pitch, slip
from .metric import Metric, Signals
from .table import markdown, table

Group = Callable[[np.ndarray, Signals, "float | None"], list[Metric]]

USUAL: dict[str, Group] = {"contact": contact.figures, "motion": motion.figures, "control": control.figures}
ON_REQUEST: dict[str, Group] = {"jerk": jerk.figures, "pitch": pitch.figures, "slip": slip.figures}


def verdict(time: np.ndarray, read: Signals, obstacle: float | None = None, more: Iterable[str] = ()) -> list[Metric]:
    """Compute the metrics of a run.

    *time* (n,) in s; *read* returns a port's values (n, ...) by name, or None if the run has no such port; *obstacle*
    is the world x of a wheel centre where its path first leaves the level, in m: contacts count from the first touch
    there.  *more* are groups of rows beside the usual ones.  Raises ScenarioError for a group there is not.
    """
    check_groups(more)
    groups = [*USUAL.values(), *(ON_REQUEST[name] for name in more)]
    return [row for group in groups for row in group(time, read, obstacle)]


def check_groups(names: Iterable[str]) -> None:
    """Raise ScenarioError for a group of rows there is not."""
    for name in names:
        if name not in ON_REQUEST:
            raise ScenarioError(f"verdict names no group of figures {name!r}; {nearest(name, ON_REQUEST)}")


def as_mapping(rows: list[Metric]) -> dict[str, float | None]:
    """Return key to value, for JSON and for the properties of a log."""
    return {row.key: row.value for row in rows}


__all__ = ["Metric", "Signals", "as_mapping", "check_groups", "markdown", "table", "verdict"]
