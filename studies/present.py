"""What the command line prints about scenarios and runs: tables for people, one JSON document for programs."""

from __future__ import annotations

import inspect
import subprocess
import sys
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.table import Table

from .conclusion import conclusion
from .metrics import table
from .terminal import listing, note, out, plain, print_json

if TYPE_CHECKING:
    from .session import Comparison, Done

LABELS = 44  # columns that a table keeps for labels and units
ZERO = 1e-12  # what is smaller is rounding, whatever the unit


def number(value: float | None) -> str:
    """Return a number at a glance: three or four significant digits, thousands as they are."""
    if value is None:
        return "-"
    if abs(value) < ZERO:
        return "0"
    return f"{value:.0f}" if 1000 <= abs(value) < 1e7 else f"{value:.4g}" if abs(value) >= 1 else f"{value:.3g}"


def show_catalog(json: bool) -> None:
    """Print what can be named: scenarios, components, controllers, robots and grounds."""
    from plants.tables import ROBOTS

    from .catalog import CONTROLLERS, ELEMENTS, GROUNDS, PLANTS, find_scenario, scenario_files

    scenarios = {n: find_scenario(n) for n in scenario_files()}
    lists: dict[str, dict[str, str]] = {
        "scenarios": {
            n: f"{f.table['title']}  ({', '.join(f.variants) or 'no variants'})" for n, f in scenarios.items()
        },
        "components": {n: _first_line(c) for n, c in PLANTS.items()},
        "controllers": {n: _first_line(c) for n, c in CONTROLLERS.items()},
        "elements of connections": {n: _first_line(c) for n, c in ELEMENTS.items()},
        "robots": {n: f"{r.source}: {r.m:g} kg, wheelbase {r.L:g} m" for n, r in ROBOTS.items()},
        "grounds": {n: f"{_first_line(g)}  ({', '.join(f.name for f in fields(g))})" for n, g in GROUNDS.items()},
    }
    if json:
        print_json(lists)
        return
    console = out()
    for title, entries in lists.items():
        console.print(listing(title, entries))
        console.print()
    console.print("Run a scenario with: wmr-cosim run NAME, or all its variants with: wmr-cosim compare NAME")


def _first_line(cls: type) -> str:
    return (inspect.getdoc(cls) or "").split("\n")[0]


def show_run(done: Done, json: bool) -> None:
    """Print the verdict on one run and where its log is."""
    result = done.result
    if json:
        print_json(_run_facts(done))
        return
    console = out()
    _say_title(result.scenario, f"  variant {result.scenario.variant}" if result.scenario.variant else "")
    shown = Table(box=None, padding=(0, 1))
    shown.add_column("")
    shown.add_column("unit", no_wrap=True)
    shown.add_column("value", justify="right", no_wrap=True)
    for metric in result.metrics:
        if metric.value is not None:
            shown.add_row(plain(metric.label), _unit(metric.unit), number(metric.value))
    if shown.row_count:
        console.print(shown)
    _say_how(done)
    _say_files({"log": done.log})


def show_comparison(done: Comparison, json: bool) -> None:
    """Print the verdicts side by side, the best of each row marked, and where the files are."""
    columns = {r.result.scenario.variant: r.result.metrics for r in done.runs if r.result.metrics}
    rows, sentences = table(columns), conclusion(columns)
    if json:
        print_json({
            "scenario": done.runs[0].result.scenario.name, "rows": rows, "runs": [_run_facts(r) for r in done.runs],
            "in_words": sentences, "combined": done.combined, "picture": done.picture, "report": done.report,
        })  # fmt: skip
        return
    scenario = done.runs[0].result.scenario
    console = out()
    _say_title(scenario)
    console.print(f"Claim: {plain(scenario.claim)}", soft_wrap=True)
    say_table(rows, list(columns))
    for run in done.runs:
        _say_how(run)
    for sentence in sentences:
        console.print(plain(sentence), soft_wrap=True)
    _say_files({**{f"log {r.result.scenario.variant}": r.log for r in done.runs}, "all variants": done.combined,
                "picture": done.picture, "report": done.report})  # fmt: skip


def say_table(rows: list[dict[str, Any]], variants: list[str]) -> None:
    """Print one column per variant; where they are too wide, heads break at hyphens, then the columns go in blocks."""
    width = out().width - LABELS
    rows = [row for row in rows if any(v is not None for v in row["values"].values())]
    cells = {v: [number(r["values"][v]) + (" *" if v in r["best"] else "  ") for r in rows] for v in variants}
    heads = {v: v for v in variants}
    if sum(_needed(heads[v], cells[v]) for v in variants) > width:
        heads = {v: v.replace("-", "-\n") for v in variants}
    block: list[str] = []
    for v in variants:
        if block and sum(_needed(heads[w], cells[w]) for w in [*block, v]) > width:
            _say_block(rows, block, heads, cells)
            block = []
        block.append(v)
    _say_block(rows, block, heads, cells)
    if any(row["best"] for row in rows):
        out().print("* the best of its row")


def _needed(head: str, cells: list[str]) -> int:
    return 2 + max(*(len(line) + 2 for line in head.split("\n")), *map(len, cells))


def _say_block(
    rows: list[dict[str, Any]], variants: list[str], heads: dict[str, str], cells: dict[str, list[str]]
) -> None:
    shown = Table(box=None, padding=(0, 1), header_style="bold")
    shown.add_column("")
    shown.add_column("unit", no_wrap=True)
    for v in variants:
        shown.add_column("\n".join(f"{line}  " for line in heads[v].split("\n")), justify="right", no_wrap=True)
    for i, row in enumerate(rows):
        marked = [f"[bold green]{cells[v][i]}[/bold green]" if v in row["best"] else cells[v][i] for v in variants]
        shown.add_row(plain(row["label"]), _unit(row["unit"]), *marked)
    out().print(shown)


def _unit(unit: str) -> str:
    return "" if unit == "1" else unit


def _say_title(scenario: Any, more: str = "") -> None:
    out().print(f"[bold]{plain(scenario.title)}[/bold]{plain(more)}", soft_wrap=True)


def _say_how(done: Done) -> None:
    for text in done.result.assembly.notes:
        note(text)
    summary = done.result.summary
    if summary is not None:
        wall = done.result.seconds["running"]
        out().print(
            f"[dim]{done.result.scenario.variant or done.result.scenario.name}: {summary.steps} macro steps, "
            f"{summary.events} events located, {summary.rejected} steps taken back, {wall:.2f} s of computing[/dim]",
            soft_wrap=True,
        )


def _say_files(paths: dict[str, Path | None]) -> None:
    for what, path in paths.items():
        if path is not None:
            out().print(f"{what}: {plain(str(path))}", soft_wrap=True)


def _run_facts(done: Done) -> dict[str, Any]:
    result = done.result
    return {
        "scenario": result.scenario.name, "variant": result.scenario.variant, "log": done.log,
        "error": str(result.error) if result.error else None, "seconds": result.seconds,
        "metrics": {m.key: {"value": m.value, "unit": m.unit} for m in result.metrics},
    }  # fmt: skip


def open_viewer(path: Path) -> None:
    """Open the Rerun viewer on a log, detached."""
    import rerun_cli

    binary = Path(rerun_cli.__file__).parent / "rerun"
    subprocess.Popen([str(binary if binary.exists() else "rerun"), str(path)], stdout=subprocess.DEVNULL,
                     stderr=sys.stderr, start_new_session=True)  # fmt: skip
