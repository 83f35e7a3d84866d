"""What `run` and `compare` do: run variants with logs and progress, then combine and draw."""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass
from datetime import UTC, datetime
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

from cosim.errors import ScenarioError
from cosim.instance import Instance
from cosim.observer import Observer, Point, RunInfo, Summary
from cosim.record import Record
from cosim.scenario import Scenario
from logs.blueprint import Camera, run_blueprint
from logs.compare import combine
from logs.ports import chosen
from logs.recorder import RerunRecorder
from logs.scene import Scene
from plants.tables import G

from .assembly import Assembly
from .catalog import find_scenario
from .metrics import as_mapping, markdown, table
from .picture import draw, drawable
from .places import run_folder
from .runner import Result, execute, judge, obstacle_start, provenance
from .terminal import SILENT, Bar, progress

FAR = 3.0  # m of way, beyond which a camera that stands still sees the robot leave
FRAMES = 500  # of the scene, at most
FORCE_ARROW = 3.0  # radii of a wheel: how long the arrow of a quarter of the weight is


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
    report: Path | None = None


def run_one(
    name: str, variant: str | None, changes: list[str], out: Path | None, *, log: bool = True, quiet: bool = False
) -> Done:
    """Run one variant of a scenario; *changes* are ``--set`` texts."""
    file = find_scenario(name)
    scenario = file.load(variant, file.overrides(changes))
    folder = run_folder(out) if log else None
    with progress(quiet) as bar:
        return run_scenario(scenario, folder, bar)


def compare(
    name: str,
    variants: tuple[str, ...] | None,
    changes: list[str],
    out: Path | None,
    *,
    log: bool = True,
    report: Path | None = None,
    quiet: bool = False,
) -> Comparison:
    """Run several variants of a scenario (all, if none are named), combine their logs and draw the picture.

    *report* is where the HTML report goes, if there is to be one.
    """
    file = find_scenario(name)
    names = tuple(dict.fromkeys(variants or file.variants))
    if not names:
        raise ScenarioError(f"{file.path} has no variants to compare; add [variants.NAME] tables, or use run")
    overrides = file.overrides(changes)
    scenarios = [file.load(v, overrides) for v in names]  # all are read before the first is run
    folder = run_folder(out)
    with progress(quiet) as bar:
        runs = [run_scenario(s, folder if log else None, bar) for s in scenarios]
        kept = [r for r in runs if r.result.metrics]
        combined = None
        logs = {r.result.scenario.variant: r.log for r in kept if r.log is not None}
        if len(logs) > 1:
            bar("combining the logs")
            combined = folder / f"{_stem(scenarios[0], '')}-all.rrd"
            text = markdown(scenarios[0], table({r.result.scenario.variant: r.result.metrics for r in kept}))
            camera = _camera(kept[0].result.assembly)
            combine(logs, combined, title=scenarios[0].title, report=text, camera=camera)
        picture = None
        if drawable(results := [r.result for r in kept]):
            bar("drawing the picture")
            picture = draw(results, folder / f"{scenarios[0].name}.png")
        if report is not None and results:
            from .report import write_report  # Plotly takes a while to import

            bar("writing the report")
            write_report(results, report, " ".join(["wmr-cosim", *sys.argv[1:]]))
    return Comparison(runs, combined, picture, report if results else None)


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


def run_scenario(scenario: Scenario, folder: Path | None, bar: Bar = SILENT) -> Done:
    """Run a scenario as it is, with its log in *folder*; None: without a log."""
    label = f"{scenario.name} {scenario.variant}".strip()
    path = folder / f"{_stem(scenario, scenario.variant)}.rrd" if folder else None

    loggers: list[RerunRecorder] = []

    def observers(assembly: Assembly, instances: dict[str, Instance], record: Record) -> list[Observer]:
        if path is not None:
            loggers.append(log_observer(assembly, path, instances, record))
        return [_Watcher(bar, label), *loggers]

    result = execute(scenario, observers, lambda text: bar(f"{label}: {text}"))
    return Done(result, loggers[0].file if loggers else None)


def log_observer(assembly: Assembly, path: Path, instances: dict[str, Instance], record: Record) -> RerunRecorder:
    """Return the observer that logs a run of *assembly* to *path*, with scene, blueprint, properties and verdict."""
    scenario = assembly.scenario
    config = json.dumps(scenario.model_dump(mode="json"), sort_keys=True)
    stamp = datetime.now(UTC).strftime("%Y%m%dT%H%M%S.%f")[:-3]
    label = f"{scenario.name} {scenario.variant}".strip()

    def closing() -> tuple[dict[str, dict[str, Any]], str]:
        rows = judge(assembly, record)
        report = markdown(scenario, table({scenario.variant or "value": rows})) if rows else ""
        units = {"metric": [m.key for m in rows], "unit": [m.unit for m in rows]}
        return {"metrics": as_mapping(rows), "metric_units": units}, report

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
        blueprint=run_blueprint(chosen(instances, scenario.run.signals), _camera(assembly)),
        scene=_scene(assembly),
        health=_gap_mismatch(instances),
        closing=closing,
        signals=scenario.run.signals,
    )


def _stem(scenario: Scenario, variant: str) -> str:
    return (f"{scenario.name}-{variant}" if variant else scenario.name).replace("/", "-")


def _camera(assembly: Assembly) -> Camera | None:
    """Return who looks at the foot of the obstacle, or goes along where the way is long; None: there is no scene."""
    if assembly.robot is None or assembly.ground is None:
        return None
    bot, obstacle = assembly.robot, obstacle_start(assembly)
    start, speed = _departure(assembly)
    follow = abs(speed) * assembly.scenario.run.duration > FAR
    x = start + bot.L_f if obstacle is None else obstacle
    return Camera((start if follow else x, 0.0, 0.6 * bot.h), follow)


def _departure(assembly: Assembly) -> tuple[float, float]:
    """Return where the body starts, in m, and how fast, in m/s."""
    r, v = (assembly.starts.get(f"body.{name}") for name in ("r", "v"))
    return float(r[0]) if r is not None else 0.0, float(v[0]) if v is not None else 0.0


def _scene(assembly: Assembly) -> Scene | None:
    if assembly.robot is None or assembly.ground is None:
        return None
    bot, run = assembly.robot, assembly.scenario.run
    start, speed = _departure(assembly)
    reach = abs(speed) * run.duration + bot.L_f + 0.8
    x = np.arange(start - bot.L_r - 0.8, start + reach, 0.01)
    left, right = (np.column_stack([x, track.elevation(x)]) for track in (assembly.ground.left, assembly.ground.right))
    scale = FORCE_ARROW * bot.R / (bot.m * G / 4)
    return Scene(bot.R, bot.half_track, bot.L_f, bot.L_r, bot.h, left, right, scale, max(2e-3, run.duration / FRAMES))


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
