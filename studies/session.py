"""What `run` and `compare` do: run variants with logs and progress, then combine and draw."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from cosim.errors import ScenarioError
from cosim.instance import Instance
from cosim.observer import Observer, Point, RunInfo, Summary
from cosim.record import Record
from cosim.scenario import Scenario
from logs.blueprint import run_blueprint
from logs.compare import combine
from logs.recorder import RerunRecorder
from logs.scene import Scene

from .assembly import Assembly
from .catalog import find_scenario
from .metrics import as_mapping, markdown, table
from .picture import draw
from .places import run_folder
from .runner import Result, execute, judge, provenance


@dataclass
class Done:
    """One run and its log."""

    result: Result
    log: Path | None


@dataclass
class Comparison:
    """All variants of a scenario, side by side."""

    runs: list[Done]
    combined: Path | None
    picture: Path | None


def run_one(
    name: str, variant: str | None, changes: list[str], out: Path | None, *, log: bool = True, quiet: bool = False
) -> Done:
    """Run one variant of a scenario; *changes* are ``--set`` texts."""
    file = find_scenario(name)
    scenario = file.load(variant, file.overrides(changes))
    folder = run_folder(out) if log else None
    with _progress(quiet) as bar:
        return _run(scenario, folder, bar)


def compare(
    name: str,
    variants: tuple[str, ...] | None,
    changes: list[str],
    out: Path | None,
    *,
    log: bool = True,
    quiet: bool = False,
) -> Comparison:
    """Run several variants of a scenario (all, if none are named), combine their logs and draw the picture."""
    file = find_scenario(name)
    names = variants or tuple(file.variants)
    if not names:
        raise ScenarioError(f"{file.path} has no variants to compare; add [variants.NAME] tables, or use run")
    overrides = file.overrides(changes)
    scenarios = [file.load(v, overrides) for v in names]  # all are read before the first is run
    folder = run_folder(out)
    with _progress(quiet) as bar:
        runs = [_run(s, folder if log else None, bar) for s in scenarios]
        kept = [r for r in runs if r.result.metrics]
        combined = None
        logs = {r.result.scenario.variant: r.log for r in kept if r.log is not None}
        if len(logs) > 1:
            bar("combining the logs")
            combined = folder / f"{_stem(scenarios[0], '')}-all.rrd"
            text = markdown(scenarios[0], table({r.result.scenario.variant: r.result.metrics for r in kept}))
            combine(logs, combined, title=scenarios[0].title, report=text)
        picture = draw([r.result for r in kept], folder / f"{scenarios[0].name}.png") if kept else None
    return Comparison(runs, combined, picture)


class _Watcher(Observer):
    """Shows how far a run has come."""

    def __init__(self, bar: Bar, label: str) -> None:
        self.bar, self.label = bar, label

    def started(self, system: Any, info: RunInfo) -> None:
        self.start, self.span = info.start_ns, info.stop_ns - info.start_ns

    def accepted(self, point: Point) -> None:
        if point.number % 256 == 0:
            self.bar(self.label, (point.end - self.start) / self.span)

    def finished(self, summary: Summary) -> None:
        self.bar(self.label, 1.0)


class Bar:
    """A progress bar where there is a terminal, silence where there is none."""

    def __init__(self, progress: Progress | None) -> None:
        self.progress = progress
        self.task = progress.add_task("", total=1.0) if progress else None

    def __call__(self, label: str, share: float | None = None) -> None:
        if self.progress is not None and self.task is not None:
            self.progress.update(self.task, description=label, completed=share or 0.0)


@contextmanager
def _progress(quiet: bool) -> Iterator[Bar]:
    console = Console(stderr=True)
    if quiet or not console.is_terminal:
        yield Bar(None)
        return
    columns = (TextColumn("{task.description}"), BarColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True) as progress:
        yield Bar(progress)


def _run(scenario: Scenario, folder: Path | None, bar: Bar) -> Done:
    label = f"{scenario.name} {scenario.variant}".strip()
    path = folder / f"{_stem(scenario, scenario.variant)}.rrd" if folder else None

    def observers(assembly: Assembly, instances: dict[str, Instance], record: Record) -> list[Observer]:
        return [_Watcher(bar, label), *([log_observer(assembly, path, instances, record)] if path else [])]

    return Done(execute(scenario, observers, lambda text: bar(f"{label}: {text}")), path)


def log_observer(assembly: Assembly, path: Path, instances: dict[str, Instance], record: Record) -> RerunRecorder:
    """Return the observer that logs a run of *assembly* to *path*, with scene, blueprint, properties and verdict."""
    scenario = assembly.scenario
    config = json.dumps(scenario.model_dump(mode="json"), sort_keys=True)
    stamp = datetime.now(UTC).strftime("%Y%m%dT%H%M%S.%f")[:-3]
    label = f"{scenario.name} {scenario.variant}".strip()
    properties: dict[str, dict[str, Any]] = {
        "run": {
            "scenario": scenario.name, "variant": scenario.variant, "title": scenario.title, "claim": scenario.claim,
            "step_s": scenario.run.step, "duration_s": scenario.run.duration, "algorithm": scenario.run.algorithm,
            "config_json": config, "config_hash": sha256(config.encode()).hexdigest()[:16],
            "command": " ".join(["wmr-cosim", *sys.argv[1:]]), "started_utc": stamp,
        },
        "provenance": provenance(instances),
    }  # fmt: skip
    return RerunRecorder(
        path,
        f"{stamp}-{scenario.name}-{scenario.variant or 'run'}-{properties['run']['config_hash'][:8]}",
        name=label,
        properties=properties,
        blueprint=run_blueprint(has_chassis="chassis" in assembly.components),
        scene=_scene(assembly),
        health=_gap_mismatch(instances),
        closing=lambda: {"metrics": as_mapping(judge(assembly, record))},
        signals=scenario.run.signals,
    )


def _stem(scenario: Scenario, variant: str) -> str:
    return f"{scenario.name}-{variant}" if variant else scenario.name


def _scene(assembly: Assembly) -> Scene | None:
    if assembly.robot is None or assembly.ground is None:
        return None
    bot, run = assembly.robot, assembly.scenario.run
    start = float(assembly.starts["body.r"][0]) if "body.r" in assembly.starts else 0.0
    speed = float(assembly.starts["body.v"][0]) if "body.v" in assembly.starts else 0.0
    reach = abs(speed) * run.duration + bot.L_f + 0.8
    x = np.arange(start - bot.L_r - 0.8, start + reach, 0.01)
    left, right = (np.column_stack([x, track.elevation(x)]) for track in (assembly.ground.left, assembly.ground.right))
    return Scene(bot.R, bot.half_track, bot.L_f, bot.L_r, bot.h, left, right, interval=max(2e-3, run.duration / 500))


def _gap_mismatch(instances: dict[str, Instance]) -> Any:
    """Compare the deformation that the wheels ended with to the gap of the body: one quantity, computed twice."""
    wheels, body = instances.get("wheels"), instances.get("body")
    if wheels is None or body is None or "deformation" not in wheels.y_at or "gap" not in body.y_at:
        return None
    mine, its = wheels.y_at["deformation"], body.y_at["gap"]

    def health(point: Point) -> dict[str, float]:
        off = point.outputs["wheels"][mine] - point.outputs["body"][its]
        return {"gap_mismatch [m]": float(np.max(np.abs(off)))}

    return health
