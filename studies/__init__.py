"""Scenarios of the robot, their runs and comparisons.  For scripts and notebooks::

    import studies

    result = studies.run("ramp-impact", "pd", wheels={"c_w": 0.0}, run={"duration": 0.1})
    studies.compare("ramp-impact", "pd", "lqr")

Changes are the tables of a scenario file; ``components`` may be left out before a slot, as on the command line.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:  # importing what runs a scenario takes a second
    from cosim import Component
    from cosim.scenario import Scenario
    from fmus import Pool

    from .runner import Result
    from .session import Comparison


def scenario(name: str, variant: str | None = None, **changes: Any) -> Scenario:
    """Return a variant (the first, if none is named) of a scenario, given by its name or the path of its file.

    Raises ScenarioError for a name or a change that does not exist, naming the nearest one.
    """
    from .catalog import find_scenario

    file = find_scenario(name)
    return file.load(variant, file.overrides([changes]))


def run(
    name: str,
    variant: str | None = None,
    *,
    parts: Mapping[str, Component] = MappingProxyType({}),
    pool: Pool | None = None,
    **changes: Any,
) -> Result:
    """Run a variant of a scenario without a log; *parts* are components that stand in the slots they are named by.

    Of thousands of runs each is quicker, and nothing piles up in the process, if they share a *pool* of FMU instances::

        with fmus.Pool() as pool:
            ends = [studies.run("ramp-impact", wheels={"c_w": c}, pool=pool).signal("body.pitch")[-1] for c in dampings]

    Raises CosimError for what is wrong before the first step; a run that fails later has its ``error`` set.
    """
    from .runner import execute

    return execute(scenario(name, variant, **changes), parts=parts, pool=pool)


def compare(name: str, *variants: str, out: Path | str = "runs", jobs: int | None = None, **changes: Any) -> Comparison:
    """Run variants of a scenario (all, if none are named) side by side, with logs and a picture in the folder *out*.

    *jobs* is how many run at once; None: as many as there are processors.
    """
    from . import session

    return session.compare(name, variants or None, [changes], Path(out), quiet=True, jobs=jobs)


__all__ = ["compare", "run", "scenario"]
