"""Run a log again from its own properties and compare every bit: a log is reproducible, or it says why not."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from cosim.errors import ScenarioError
from cosim.scenario import Scenario
from logs.difference import Difference, differences
from logs.read import properties

from .session import run_scenario

# of the provenance, what does not change the numbers
_IRRELEVANT = ("platform", "rerun_sdk")


@dataclass(frozen=True)
class Reproduction:
    """A log against a fresh run of the same configuration."""

    differences: list[Difference]  # of every signal
    reasons: list[str]  # what is not as it was: versions, FMU tokens

    @property
    def exact(self) -> bool:
        """Whether every signal has the same bits at the same times."""
        return all(d.identical for d in self.differences)


def scenario_of(log: Path) -> Scenario:
    """Return the scenario that a log was made from; raises ScenarioError if the log does not hold it."""
    run = properties(log).get("run", {})
    if "config_json" not in run:
        raise ScenarioError(f"the log {log} does not hold the configuration of its run, so it cannot be run again")
    return Scenario.model_validate(json.loads(run["config_json"]))


def reproduce(log: Path) -> Reproduction:
    """Run the configuration of *log* again and compare; raises ScenarioError if the log does not hold it."""
    scenario = scenario_of(log)
    with TemporaryDirectory() as folder:
        again = run_scenario(scenario, Path(folder))
        assert again.log is not None
        return Reproduction(differences(log, again.log), _changes(properties(log), properties(again.log)))


def _changes(before: dict[str, dict[str, Any]], now: dict[str, dict[str, Any]]) -> list[str]:
    found = []
    for key, value in now.get("provenance", {}).items():
        old = before.get("provenance", {}).get(key)
        if key not in _IRRELEVANT and old != value:
            what = f"the FMU of {key.removeprefix('token_')}" if key.startswith("token_") else key
            found.append(f"{what} was {old} and is {value}")
    status = before.get("outcome", {}).get("status", "incomplete")
    if status != "complete":
        found.append(f"the log is {status}")
    return found
