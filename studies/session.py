"""What `run` and `compare` do: run variants with logs and progress, then combine and draw."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cosim.errors import CosimError, ScenarioError
from cosim.instance import Instance
from cosim.observer import Block, Observer, Point, RunInfo, Summary
from cosim.record import Record
from cosim.scenario import Scenario

from .assembly import Assembly
from .catalog import find_scenario
from .conclusion import conclusion, heading, mixed
from .metrics import markdown, table
from .parallel import together
from .picture import draw, drawable
from .places import run_folder
from .runner import Result, execute
from .terminal import SILENT, Bar, progress

if TYPE_CHECKING:
    from logs.recorder import RerunRecorder

Observers = Callable[[Assembly, dict[str, Instance], Record], list[Observer]]


@dataclass(repr=False)
class Done:
    """One run and its log."""

    result: Result
    log: Path | None

    def __repr__(self) -> str:
        return f"{self.result!r}"[:-1] + (f", log {self.log}>" if self.log else ", no log>")

    def _repr_html_(self) -> str:
        from .show import result_html

        return result_html(self.result, self.log)


@dataclass(repr=False)
class Comparison:
    """All variants of a scenario, side by side."""

    runs: list[Done]
    combined: Path | None
    picture: Path | None
    report: Path | None = None
    notes: tuple[str, ...] = ()  # what is worth knowing before the numbers are read
    failed: dict[str, CosimError] = field(default_factory=dict)  # variants of which nothing came, and why

    def __repr__(self) -> str:
        names = ", ".join(r.result.scenario.variant or r.result.scenario.name for r in self.runs)
        return f"<Comparison of {names}" + (f", logs {self.combined}>" if self.combined else ">")

    def _repr_html_(self) -> str:
        from .show import comparison_html

        return comparison_html(self)


def run_one(
    name: str,
    variant: str | None,
    changes: list[str],
    out: Path | None,
    *,
    log: bool = True,
    quiet: bool = False,
    viewer: str = "",
    pace: float | None = None,
) -> Done:
    """Run one variant of a scenario; *changes* are ``--set`` texts.

    *viewer* is the address of one that shows the run while it goes; *pace* is how many times real time it may be fast.
    """
    file = find_scenario(name)
    scenario = file.load(variant, file.overrides(changes))
    folder = run_folder(out) if log else None

    def watching(assembly: Assembly, instances: dict[str, Instance], record: Record) -> list[Observer]:
        found: list[Observer] = []
        if viewer or pace is not None:
            from logs.live import LiveRecorder, Pacer

            from .logged import log_observer

            if viewer:
                shown = partial(LiveRecorder, url=viewer)
                found.append(log_observer(assembly, Path(assembly.scenario.name), instances, record, shown))
            if pace is not None:
                found.append(Pacer(pace))
        return found

    with progress(quiet) as bar:
        return run_scenario(scenario, folder, bar, watching)


def compare(
    name: str,
    variants: tuple[str, ...] | None,
    changes: Sequence[str | Mapping[str, Any]],
    out: Path | None,
    *,
    log: bool = True,
    report: Path | None = None,
    quiet: bool = False,
    baseline: str | None = None,
    jobs: int | None = None,
) -> Comparison:
    """Run several variants of a scenario (all, if none are named), combine their logs and draw the picture.

    *changes* are ``--set`` texts, or tables of the scenario file; *report* is where the HTML report goes, if there is
    to be one; *baseline* is what the others are compared to, the first if it is not named; *jobs* is how many run at
    once, as many as there are processors if it is None.  Variants that fail before their first step are told in
    ``failed``; raises the first's CosimError if all do.
    """
    from logs.compare import baseline_first

    file = find_scenario(name)
    names = tuple(dict.fromkeys(variants or file.variants))
    if not names:
        raise ScenarioError(f"{file.path} has no variants to compare; add [variants.NAME] tables, or use run")
    overrides = file.overrides(changes)
    # all are read before the first is run
    scenarios = list(baseline_first({v: file.load(v, overrides) for v in names}, baseline).values())
    folder = run_folder(out)
    with progress(quiet) as bar:
        found = together(scenarios, lambda s, part: run_scenario(s, folder if log else None, part), bar, jobs)
        failed = {s.variant: f for s, f in zip(scenarios, found, strict=True) if isinstance(f, CosimError)}
        if len(failed) == len(found):
            raise next(iter(failed.values()))
        done = put_together([f for f in found if isinstance(f, Done)], folder, scenarios[0].name, report, bar)
        return replace(done, failed=failed)


def put_together(runs: list[Done], folder: Path, stem: str, report: Path | None, bar: Bar) -> Comparison:
    """Combine the logs of *runs* into STEM-all.rrd, the first the baseline; draw STEM.png and write the *report*."""
    kept = [r for r in runs if r.result.metrics]
    results = [r.result for r in kept]
    combined, picture = None, None
    logs = {r.result.scenario.variant: r.log for r in kept if r.log is not None}
    if len(logs) > 1:
        from logs.compare import combine

        from .drawn import camera

        bar("combining the logs")
        combined = folder / f"{stem.replace('/', '-')}-all.rrd"
        title = heading([r.scenario for r in results])
        combine(logs, combined, title=title, report=_document(results), camera=camera(results[0].assembly))
    if drawable(results):
        bar("drawing the picture")
        picture = draw(results, folder / f"{stem}.png")
    if report is not None and results:
        from .report import write_report  # Plotly takes a while to import

        bar("writing the report")
        write_report(results, report, " ".join(["wmr-cosim", *sys.argv[1:]]))
    notes = mixed([r.result.scenario for r in runs])
    return Comparison(runs, combined, picture, report if results else None, notes)


def _document(results: list[Result]) -> str:
    """Return the verdict as Markdown: who kept the ground in words, then all figures side by side."""
    columns = {r.scenario.variant: r.metrics for r in results}
    sentences = [f"- {sentence}" for sentence in conclusion(columns)]
    scenarios = [r.scenario for r in results]
    about = scenarios[0].model_copy(update={"title": heading(scenarios)})
    if notes := mixed(scenarios):
        about = about.model_copy(update={"claim": f"Note: {notes[0]}."})
    return "\n".join([*sentences, "", markdown(about, table(columns))])


class _Watcher(Observer):
    """Shows how far a run has come."""

    def __init__(self, bar: Bar, label: str) -> None:
        self.bar, self.label = bar, label

    def started(self, system: Any, info: RunInfo) -> None:
        self.start, self.span = info.start_ns, info.stop_ns - info.start_ns

    def accepted(self, point: Point) -> None:
        if point.number % 256 == 0:
            self.bar(self.label, (point.end - self.start) / self.span)

    def accepted_block(self, block: Block) -> None:
        self.bar(self.label, (int(block.ends[-1]) - self.start) / self.span)

    def finished(self, summary: Summary) -> None:
        self.bar(self.label, 1.0)


def run_scenario(scenario: Scenario, folder: Path | None, bar: Bar = SILENT, more: Observers = lambda *run: []) -> Done:
    """Run a scenario as it is, with its log in *folder*; None: without a log.  *more* observers come last."""
    label = f"{scenario.name} {scenario.variant}".strip()
    path = folder / f"{_stem(scenario, scenario.variant)}.rrd" if folder else None

    loggers: list[RerunRecorder] = []

    def observers(assembly: Assembly, instances: dict[str, Instance], record: Record) -> list[Observer]:
        if path is not None:
            from .logged import log_observer  # Rerun takes a second to import

            loggers.append(log_observer(assembly, path, instances, record))
        return [_Watcher(bar, label), *loggers, *more(assembly, instances, record)]

    result = execute(scenario, observers, lambda text: bar(f"{label}: {text}"))
    return Done(result, loggers[0].file if loggers else None)


def _stem(scenario: Scenario, variant: str) -> str:
    return (f"{scenario.name}-{variant}" if variant else scenario.name).replace("/", "-")
