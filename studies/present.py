"""What the command line prints: tables for people, one JSON document for programs, one sentence for a mistake."""

from __future__ import annotations

import inspect
import json as jsonlib
import subprocess
import sys
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.table import Table

from .metrics import Metric, table

if TYPE_CHECKING:
    from .session import Comparison, Done

console = Console(highlight=False)
errors = Console(stderr=True, highlight=False, soft_wrap=True)


def complain(sentence: str) -> None:
    """Print one sentence about what went wrong to stderr."""
    errors.print(f"[bold red]error:[/bold red] {_plain(sentence)}")


def _plain(text: str) -> str:
    return text.replace("[", "\\[")


def number(value: float | None) -> str:
    """Return a number at a glance: three or four significant digits, thousands as they are."""
    if value is None:
        return "-"
    if value == 0:
        return "0"
    return f"{value:.0f}" if 1000 <= abs(value) < 1e7 else f"{value:.4g}" if abs(value) >= 1 else f"{value:.3g}"


def show_catalog(json: bool) -> None:
    """Print what can be named: scenarios, components, controllers, robots and grounds."""
    from plants.tables import ROBOTS

    from .catalog import CONTROLLERS, GROUNDS, PLANTS, find_scenario, scenario_files

    scenarios = {n: find_scenario(n) for n in scenario_files()}
    lists: dict[str, dict[str, str]] = {
        "scenarios": {
            n: f"{f.table['title']}  ({', '.join(f.variants) or 'no variants'})" for n, f in scenarios.items()
        },
        "components": {n: _first_line(c) for n, c in PLANTS.items()},
        "controllers": {n: _first_line(c) for n, c in CONTROLLERS.items()},
        "robots": {n: f"{r.source}: {r.m:g} kg, wheelbase {r.L:g} m" for n, r in ROBOTS.items()},
        "grounds": {n: f"{_first_line(g)}  ({', '.join(f.name for f in fields(g))})" for n, g in GROUNDS.items()},
    }
    if json:
        print(jsonlib.dumps(lists))
        return
    for title, entries in lists.items():
        shown = Table(title=title, title_justify="left", show_header=False, box=None, padding=(0, 2))
        for name, line in entries.items():
            shown.add_row(f"[bold]{name}[/bold]", _plain(line))
        console.print(shown)
        console.print()


def _first_line(cls: type) -> str:
    return (inspect.getdoc(cls) or "").split("\n")[0]


def show_run(done: Done, json: bool) -> None:
    """Print the verdict on one run and where its log is."""
    result = done.result
    if json:
        print(jsonlib.dumps(_run_facts(done)))
        return
    console.print(
        f"[bold]{result.scenario.title}[/bold]"
        + (f"  variant {result.scenario.variant}" if result.scenario.variant else "")
    )
    shown = Table("", "unit", "value", box=None, padding=(0, 2))
    for metric in result.metrics:
        if metric.value is not None:
            shown.add_row(_plain(metric.label), _unit(metric), number(metric.value))
    console.print(shown)
    _say_notes(done)
    _say_files({"log": done.log})


def show_comparison(done: Comparison, json: bool) -> None:
    """Print the verdicts side by side, the best of each row marked, and where the files are."""
    rows = table({r.result.scenario.variant: r.result.metrics for r in done.runs if r.result.metrics})
    if json:
        document = {
            "scenario": done.runs[0].result.scenario.name, "rows": rows, "runs": [_run_facts(r) for r in done.runs],
            "combined": _path(done.combined), "picture": _path(done.picture),
        }  # fmt: skip
        print(jsonlib.dumps(document))
        return
    scenario = done.runs[0].result.scenario
    console.print(f"[bold]{scenario.title}[/bold]")
    console.print(f"Claim: {_plain(scenario.claim)}", soft_wrap=True)
    variants = [r.result.scenario.variant for r in done.runs if r.result.metrics]
    shown = Table("", "unit", *variants, box=None, padding=(0, 2))
    for row in rows:
        if any(v is not None for v in row["values"].values()):
            cells = [
                f"[bold green]{number(row['values'][v])} *[/bold green]"
                if v in row["best"]
                else f"{number(row['values'][v])}  "
                for v in variants
            ]
            shown.add_row(_plain(row["label"]), row["unit"], *cells)
    console.print(shown)
    console.print("* the best of its row")
    for run in done.runs:
        _say_notes(run)
    _say_files({**{f"log {r.result.scenario.variant}": r.log for r in done.runs}, "all variants": done.combined,
                "picture": done.picture})  # fmt: skip


def _unit(metric: Metric) -> str:
    return "" if metric.unit == "1" else metric.unit


def _say_notes(done: Done) -> None:
    for note in done.result.assembly.notes:
        errors.print(f"[yellow]note:[/yellow] {_plain(note)}")
    summary = done.result.summary
    if summary is not None:
        wall = done.result.seconds["running"]
        console.print(
            f"[dim]{done.result.scenario.variant or done.result.scenario.name}: {summary.steps} macro steps, "
            f"{summary.events} events located, {summary.rejected} steps taken back, {wall:.2f} s of computing[/dim]"
        )


def _say_files(paths: dict[str, Path | None]) -> None:
    for what, path in paths.items():
        if path is not None:
            console.print(f"{what}: {path}", soft_wrap=True)


def _path(path: Path | None) -> str | None:
    return str(path) if path else None


def _run_facts(done: Done) -> dict[str, Any]:
    result = done.result
    return {
        "scenario": result.scenario.name, "variant": result.scenario.variant, "log": _path(done.log),
        "error": str(result.error) if result.error else None, "seconds": result.seconds,
        "metrics": {m.key: {"value": m.value, "unit": m.unit} for m in result.metrics},
    }  # fmt: skip


def open_viewer(path: Path) -> None:
    """Open the Rerun viewer on a log, detached."""
    import rerun_cli

    binary = Path(rerun_cli.__file__).parent / "rerun"
    subprocess.Popen([str(binary if binary.exists() else "rerun"), str(path)], stdout=subprocess.DEVNULL,
                     stderr=sys.stderr, start_new_session=True)  # fmt: skip
