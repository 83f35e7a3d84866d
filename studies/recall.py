"""Runs read back from their logs, as if they had just ended: for tables, pictures and reports on old runs.

The verdict is computed afresh from the logged signals, so that logs of different versions are judged alike; a figure
whose signals were not logged is the one that the log states.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from cosim.errors import CosimError, ScenarioError, WiringError, nearest
from cosim.observer import Summary
from cosim.record import Record
from cosim.scenario import Scenario
from logs.compare import baseline_first
from logs.read import Signal, properties, signals

from .assembly import Assembly, assemble
from .inputs import digest, placed, recorded
from .metrics import Metric
from .places import run_folder
from .reproduce import scenario_of
from .runner import Result, judge
from .session import Comparison, Done, put_together
from .terminal import progress


class LoggedRecord(Record):
    """The outputs of a run as its log has them."""

    def __init__(self, found: dict[str, Signal]) -> None:
        super().__init__()
        self._found = found
        longest = max(found.values(), key=lambda s: len(s.ns)).ns if found else np.empty(0, np.int64)
        self._keep(np.empty((len(longest), 0)), np.concatenate((longest[:1], longest[:-1])), longest)

    def __contains__(self, port: object) -> bool:
        return port in self._found and len(self._found[str(port)].ns) == len(self)

    def ports(self) -> tuple[str, ...]:
        return tuple(port for port in self._found if port in self)

    def __getitem__(self, port: str) -> np.ndarray:
        if port not in self:
            raise WiringError(f"nothing called {port!r} was logged; {nearest(port, self.ports())}")
        signal = self._found[port]
        return signal.values.reshape(len(signal.ns), *signal.shape)

    def get(self, port: str) -> np.ndarray | None:
        if port not in self:
            return None
        return self[port]


def recall(log: Path, label: str) -> Done:
    """Return the run of a log, its variant called *label*.

    Raises ScenarioError for a file that is not the log of a run.  Where the scenario cannot be put together any more,
    because a file of it is gone, there is no ground to draw, which the assembly notes.
    """
    tables = properties(log)
    scenario = scenario_of(log).model_copy(update={"variant": label})
    record = LoggedRecord({port: s for port, s in signals(log, "/plant/**").items() if ".in." not in port})
    if len(record) < 2:
        raise ScenarioError(f"the log {log} holds no step of its run, so there is nothing to compare")
    assembly = _assembly(scenario, recorded(tables))
    outcome = tables.get("outcome", {})
    summary = None
    if outcome.get("status") == "complete":
        steps, rejected, events = (int(outcome[key]) for key in ("steps", "rejected", "events"))
        summary = Summary(steps, rejected, events, outcome["wall_seconds"], outcome["simulated_seconds"])
    metrics = _completed(judge(assembly, record), tables.get("metrics", {}))
    seconds = {"running": float(outcome.get("wall_seconds") or 0.0)}
    broken = None if summary else CosimError(str(outcome.get("error", "the log breaks off: the run was killed")))
    return Done(Result(assembly, record, metrics, summary, broken, seconds, dict(tables.get("provenance", {}))), log)


def compare_logs(
    logs: Sequence[Path],
    out: Path | None,
    *,
    baseline: str | None = None,
    report: Path | None = None,
    quiet: bool = False,
) -> Comparison:
    """Set the runs of old *logs* side by side: verdicts, the combined log, the picture and, if asked for, the *report*.

    Differences are to the run called *baseline*, or to the first.  Raises ScenarioError for what cannot be compared.
    """
    if len(logs) < 2:
        more = f"; to look at one: wmr-cosim inspect {logs[0]}" if logs else ""
        raise ScenarioError(f"compare --logs needs two logs or more{more}")
    with progress(quiet) as bar:
        bar("reading the logs")
        runs = list(baseline_first({r.result.scenario.variant: r for r in recall_all(logs)}, baseline).values())
        names = list(dict.fromkeys(r.result.scenario.name for r in runs))
        done = put_together(runs, run_folder(out), f"{names[0]}-logs" if len(names) == 1 else "logs", report, bar)
    broken = [f"{r.scenario.variant} did not reach its end: {r.error}" for r in (d.result for d in runs) if r.error]
    return replace(done, notes=(*done.notes, *broken))


def recall_all(logs: Sequence[Path]) -> list[Done]:
    """Return the runs of several logs, each under a name of its own.

    Raises ScenarioError for a log that is named twice or is none.
    """
    for path, count in Counter(p.resolve() for p in logs).items():
        if count > 1:
            raise ScenarioError(f"the log {path} is named twice; a run cannot be compared with itself")
    return [recall(path, label) for path, label in zip(logs, labels(logs), strict=True)]


def labels(logs: Sequence[Path]) -> list[str]:
    """Return what tells the runs of *logs* apart: variants, else names of files, else paths."""
    scenarios = [scenario_of(log) for log in logs]
    attempts = (
        [s.variant or s.name for s in scenarios],
        [f"{s.name} {s.variant}".strip() for s in scenarios],
        [log.stem for log in logs],
        [f"{log.resolve().parent.name}/{log.stem}" for log in logs],
        [str(log) for log in logs],
    )
    return next(names for names in attempts if len(set(names)) == len(names) or names is attempts[-1])


def _assembly(scenario: Scenario, files: dict[str, tuple[str, str]]) -> Assembly:
    try:
        for path, sha in files.values():
            if Path(path).is_file() and digest(Path(path)) != sha:
                raise ScenarioError(f"the file {path} has changed")
        assembly = assemble(placed(scenario, files))
    except CosimError as error:
        name = scenario.variant or scenario.name
        note = f"the scenario of {name} cannot be put together any more, so there is no ground to draw: {error}"
        return Assembly(scenario, {}, {}, order=(), every={}, notes=(note,))
    return replace(assembly, scenario=scenario, notes=())


def _completed(rows: list[Metric], told: dict[str, Any]) -> list[Metric]:
    """Return the *rows* with what the log states where a value cannot be computed from its signals."""
    return [Metric(m.key, m.label, m.unit, m.better, told.get(m.key) if m.value is None else m.value) for m in rows]
