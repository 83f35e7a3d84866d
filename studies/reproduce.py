"""Run a log again from its own properties and compare every bit: a log is reproducible, or it says why not."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from pydantic import ValidationError

from cosim.errors import CosimError, ScenarioError
from cosim.scenario import Scenario
from logs.difference import Difference, differences
from logs.read import properties

from .inputs import Tables, digest, placed, recorded
from .session import run_scenario
from .terminal import SILENT, Bar

_IRRELEVANT = ("rerun_sdk", "cpus")  # of provenance and host, what does not compute
_SPELT = {"sources": "the hash of the sources"}


@dataclass(frozen=True)
class Reproduction:
    """A log against a fresh run of the same configuration."""

    status: str  # of the log: what is after the end of one that is not complete cannot be compared
    differences: list[Difference]  # of every signal
    reasons: list[str]  # what is not as it was: versions, FMUs, files, machine

    @property
    def exact(self) -> bool:
        """Whether every signal has the same bits at the same times."""
        return all(d.identical for d in self.differences)

    def sentence(self) -> str:
        """Return the answer in one sentence."""
        count, off = len(self.differences), [d for d in self.differences if not d.identical]
        upto = "" if self.status in ("complete", "failed") else f", as far as the log goes ({self.status})"
        if not off:
            changed = f", though {' and '.join(self.reasons)}" if self.reasons else ""
            return f"reproduced: the same bits in all {count} signals at the same times{upto}{changed}"
        timed = [d for d in off if d.since is not None]
        first = min(timed, key=lambda d: (d.since, d.port)) if timed else off[0]
        where = f"first {first.port}" + (f" at {first.since:.9g} s" if first.since is not None else " (not in both)")
        why = " and ".join(self.reasons) or "nothing that the log names has changed, so it is not deterministic here"
        return f"not reproduced: {len(off)} of {count} signals differ, {where}: {why}"


def scenario_of(log: Path) -> Scenario:
    """Return the scenario that a log was made from; raises ScenarioError if the log does not hold it."""
    tables = properties(log)
    if "compare" in tables:
        made_of = tables["compare"].get("variants", [])
        raise ScenarioError(
            f"{log} is a comparison, not the log of a run; name one of its runs' ({', '.join(made_of)})"
        )
    if "config_json" not in tables.get("run", {}):
        raise ScenarioError(f"the log {log} does not hold the configuration of its run, so it cannot be run again")
    try:
        return Scenario.model_validate(json.loads(tables["run"]["config_json"]))
    except (ValidationError, json.JSONDecodeError) as error:
        why = str(error).splitlines()[0]
        raise ScenarioError(f"this version does not understand the configuration in {log}: {why}") from None


def reproduce(log: Path, bar: Bar = SILENT) -> Reproduction:
    """Run the configuration of *log* again and compare.

    Raises ScenarioError if it cannot be run again: the log does not hold its configuration, or something that the run
    was made of is gone.
    """
    before = properties(log)
    files = recorded(before)
    for name, (path, _) in files.items():
        if not Path(path).is_file():
            called = f" (called {name} there)" if name != path else ""
            raise ScenarioError(f"the log {log} cannot be run again: the file {path}{called} that it read is gone")
    scenario = placed(scenario_of(log), files)
    reasons = [f"the file {path} has changed" for path, sha in files.values() if digest(Path(path)) != sha]
    status = str(before.get("outcome", {}).get("status", "unfinished"))
    with TemporaryDirectory() as folder:
        try:
            again = run_scenario(scenario, Path(folder), bar)
        except CosimError as error:
            known = f" ({' and '.join(reasons)})" if reasons else ""
            raise ScenarioError(f"the log {log} cannot be run again{known}: {error}") from None
        assert again.log is not None  # a run that began has one
        bar("comparing every bit")
        found = differences(log, again.log, unfinished=status not in ("complete", "failed"))
        return Reproduction(status, found, [*reasons, *_changes(before, properties(again.log))])


def _changes(before: Tables, now: Tables) -> list[str]:
    """Return what of the provenance is not as it was, as parts of a sentence."""
    found = []
    told, current = ({**t.get("host", {}), **t.get("provenance", {})} for t in (before, now))
    for key, value in current.items():
        old = told.get(key)  # None: an older version did not record it
        if key not in _IRRELEVANT and old is not None and old != value:
            fmu = f"the token of the FMU of {key.removeprefix('token_')}" if key.startswith("token_") else ""
            found.append(f"{fmu or _SPELT.get(key, key)} was {old} and is {value}")
    return found
