"""``wmr-cosim inspect``: what a log is, how the run went, and its numbers."""

from __future__ import annotations

import json as jsonlib
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.table import Table

from cosim.errors import ScenarioError, nearest

console = Console(highlight=False)


def inspect(
    log: Annotated[Path, typer.Argument(help="A .rrd file written by run or compare (also an unfinished .rrd.part).")],
    signals: Annotated[
        str | None, typer.Option(help="Only these ports, comma-separated patterns such as wheels.*,body.pitch.")
    ] = None,
    metrics: Annotated[bool, typer.Option("--metrics", help="Only the verdict of the run.")] = False,
    csv: Annotated[Path | None, typer.Option(help="Write the signals to a CSV file, one column per value.")] = None,
    parquet: Annotated[Path | None, typer.Option(help="Write the signals to a Parquet file.")] = None,
    json: Annotated[bool, typer.Option("--json", help="Print one JSON document (SI units) instead of tables.")] = False,
) -> None:
    """Say what a log is: configuration, outcome, verdict, events, and statistics of every signal with its unit.

    Example: wmr-cosim inspect logs/runs/ramp-impact-pd.rrd --signals 'wheels.*' --csv wheels.csv
    """
    from logs.inspect import describe, export

    facts = describe(log, _patterns(signals))
    if signals and not facts["signals"]:
        raise ScenarioError(f"the log {log} has no signal like {signals!r}; {nearest(signals, facts['ports'])}")
    for out in (csv, parquet):
        if out is not None:
            export(log, out, list(facts["signals"]))
    if json:
        print(jsonlib.dumps(facts, default=float))
        return
    _show_facts(facts)
    if not metrics:
        _show_signals(facts["signals"])
    for out in (csv, parquet):
        if out is not None:
            console.print(f"wrote {out}", soft_wrap=True)


def _patterns(signals: str | None) -> list[str]:
    return [p.strip() for p in signals.split(",")] if signals else []


def _show_facts(facts: dict[str, Any]) -> None:
    for title in ("run", "outcome", "provenance"):
        table = facts["properties"].get(title, {})
        shown = Table(title=title, title_justify="left", show_header=False, box=None, padding=(0, 2))
        for key, value in table.items():
            if key != "config_json":
                shown.add_row(key, str(value).replace("[", "\\["))
        if table:
            console.print(shown)
    verdict = facts["properties"].get("metrics", {})
    if verdict:
        shown = Table(
            title="verdict (SI units as in compare)", title_justify="left", show_header=False, box=None, padding=(0, 2)
        )
        for key, value in verdict.items():
            shown.add_row(key, f"{value:.5g}")
        console.print(shown)
    for time, text in facts["events"]:
        console.print(f"{time:.9f} s  {text}")


def _show_signals(statistics: dict[str, dict[str, Any]]) -> None:
    shown = Table("signal", "unit", "values", "min", "max", "mean", "rms", box=None, padding=(0, 1))
    for port, s in statistics.items():
        shown.add_row(port, s["unit"], str(s["width"]), *(f"{s[k]:.4g}" for k in ("min", "max", "mean", "rms")))
    console.print(shown)
