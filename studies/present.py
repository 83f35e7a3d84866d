"""What the command line prints about scenarios and runs: tables for people, one JSON document for programs."""

from __future__ import annotations

import inspect
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.table import Table

from . import verdicts
from .conclusion import conclusion, heading, mixed
from .metrics import table
from .terminal import listing, note, out, plain, print_json
from .verdicts import number

if TYPE_CHECKING:
    from .session import Comparison, Done


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
    variant = f"  variant {result.scenario.variant}" if result.scenario.variant else ""
    console.print(f"[bold]{plain(result.scenario.title)}[/bold]{plain(variant)}", soft_wrap=True)
    shown = Table(box=None, padding=(0, 1))
    shown.add_column("")
    shown.add_column("unit", no_wrap=True)
    shown.add_column("value", justify="right", no_wrap=True)
    for metric in result.metrics:
        if metric.value is not None:
            shown.add_row(plain(metric.label), verdicts.unit(metric.unit), number(metric.value))
    if shown.row_count:
        console.print(shown)
    for text in result.assembly.notes:
        note(text)
    _say_how([done])
    _say_files({"log": done.log})


def show_comparison(done: Comparison, json: bool, full: bool = False) -> None:
    """Print the verdicts side by side and in words, the best of each figure marked, and where the files are.

    What decides comes as a short row per variant, so that table and words are on one screen; *full* shows all figures.
    """
    columns = {r.result.scenario.variant: r.result.metrics for r in done.runs if r.result.metrics}
    rows, sentences = table(columns) if columns else [], conclusion(columns)
    scenarios = [r.result.scenario for r in done.runs]
    if json:
        print_json({
            "scenario": scenarios[0].name, "baseline": scenarios[0].variant, "rows": rows, "notes": done.notes,
            "runs": [_run_facts(r) for r in done.runs], "in_words": sentences, "combined": done.combined,
            "picture": done.picture, "report": done.report, "failed": {v: str(e) for v, e in done.failed.items()},
        })  # fmt: skip
        return
    out().print(f"[bold]{plain(heading(scenarios))}[/bold]", soft_wrap=True)
    if not mixed(scenarios):
        out().print(f"Claim: {plain(scenarios[0].claim)}", soft_wrap=True)
    for text in dict.fromkeys([*done.notes, *(n for r in done.runs for n in r.result.assembly.notes)]):
        note(text)
    verdicts.show(rows, list(columns), full=full or any(s.verdict for s in scenarios))
    _say_how(done.runs)
    for sentence in sentences:
        out().print(plain(sentence), soft_wrap=True)
    logs = [r.log for r in done.runs if r.log is not None]
    if logs:
        out().print(f"logs: {plain(braced(logs))}", soft_wrap=True)
    _say_files({"all variants": done.combined, "picture": done.picture, "report": done.report})


def braced(paths: list[Path]) -> str:
    """Return paths as a shell would take them: ``runs/ramp-{pd,lqr}.rrd``."""
    texts = [str(p) for p in paths]
    ends = {p.suffix for p in paths}
    if len(texts) < 2 or len(ends) > 1 or any(set(t) & set(" ,{}") for t in texts):
        return " ".join(texts)
    least, most = min(texts), max(texts)  # what these share, all share
    same = next((i for i, (a, b) in enumerate(zip(least, most, strict=False)) if a != b), min(len(least), len(most)))
    shared = least[: max(least.rfind(c, 0, same) for c in "-/") + 1]
    end = ends.pop()
    return f"{shared}{{{','.join(t.removeprefix(shared).removesuffix(end) for t in texts)}}}{end}"


def _say_how(runs: list[Done]) -> None:
    ended = [r.result for r in runs if r.result.summary is not None]
    if not ended:
        return
    steps, events, rejected = (sum(getattr(r.summary, key) for r in ended) for key in ("steps", "events", "rejected"))
    wall = sum(r.seconds["running"] for r in ended)
    out().print(
        f"[dim]{len(ended)} {'runs' if len(ended) > 1 else 'run'}: {steps} macro steps, {events} events located, "
        f"{rejected} steps taken back, {wall:.2f} s of computing[/dim]",
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
