"""``wmr-cosim inspect``: what a log is, how the run went, and its numbers."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.table import Table

from cosim.errors import ScenarioError, nearest

from . import cli_same
from .terminal import listing, out, plain, print_json, progress
from .verdicts import number, say_table

LONGEST = 60  # characters of a value in a table


def inspect(
    log: Annotated[Path, typer.Argument(help="A .rrd file written by run or compare (also an unfinished .rrd.part).")],
    signals: Annotated[
        str | None, typer.Option(help="Only these ports, comma-separated patterns such as wheels.*,body.pitch.")
    ] = None,
    metrics: Annotated[bool, typer.Option("--metrics", help="Only the verdict of the run.")] = False,
    csv: Annotated[Path | None, typer.Option(help="Write the signals to a CSV file, one column per value.")] = None,
    parquet: Annotated[Path | None, typer.Option(help="Write the signals to a Parquet file.")] = None,
    mcap: Annotated[Path | None, typer.Option(help="Write the signals to an MCAP file.")] = None,
    diff: Annotated[
        Path | None,
        typer.Option(help="Compare every bit with another log; for runs on other steps use compare --logs."),
    ] = None,
    rerun: Annotated[
        bool, typer.Option("--rerun", help="Run it again from what it says about itself and compare every bit.")
    ] = False,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON document (SI units) instead of tables.")
    ] = False,
) -> None:
    """Say what a log is: configuration, outcome, verdict, health, events, and statistics of every signal with its unit.

    With --diff or --rerun it says instead whether two runs are the same to the bit, and exits with 1 if they are not.

    Example: wmr-cosim inspect logs/runs/ramp-impact-pd.rrd --signals 'wheels.*' --csv wheels.csv
    """
    from logs.inspect import describe, export

    if rerun:
        cli_same.show_rerun(log, as_json)
        return
    patterns = [p.strip() for p in signals.split(",")] if signals else []
    if diff is not None:
        cli_same.show_diff(log, diff, patterns, as_json)
        return
    files = [file for file in (csv, parquet, mcap) if file is not None]
    with progress(as_json) as bar:
        bar(f"reading {log}")
        facts = describe(log, patterns)
        if signals and not facts["signals"]:
            raise ScenarioError(f"the log {log} has no signal like {signals!r}; {nearest(signals, facts['ports'])}")
        facts["health"] = describe(log, ["master.*"])["signals"]
        for file in files:
            bar(f"writing {file}")
            export(log, file, list(facts["signals"]))
    if as_json:
        print_json(facts)
        return
    _show_facts(facts, only_verdict=metrics)
    if not metrics:
        _show_signals(facts["signals"], facts["read_as"])
    for file in files:
        out().print(f"wrote {plain(str(file))}", soft_wrap=True)


def _show_facts(facts: dict[str, Any], *, only_verdict: bool) -> None:
    console, tables = out(), facts["properties"]
    console.print(f"{plain(facts['path'])}: [bold]{facts['status']}[/bold]", soft_wrap=True)
    if "compare" in tables:  # what the runs are is in their own logs, and in --json
        console.print(listing("compare", {k: str(v) for k, v in tables["compare"].items()}))
        _show_verdicts(facts, list(tables["compare"]["variants"]))
        return
    if not only_verdict:
        for title, table in tables.items():
            if title != "metrics":
                console.print(listing(title, {k: str(v) for k, v in table.items() if k != "config_json"}))
        if "config_json" in tables.get("run", {}):
            console.print(listing("configuration", configuration(json.loads(tables["run"]["config_json"]))))
        console.print(listing("health of the master", _health(facts["health"])))
    units = _spelt(facts["units"].get("metrics", {}))
    verdict = {k: f"{number(v)} {units.get(k, '')}".strip() for k, v in tables.get("metrics", {}).items()}
    if verdict:
        console.print(listing("verdict", verdict))
    for time, text in facts["events"] if not only_verdict else ():
        console.print(f"{time:.9f} s  {plain(text)}", soft_wrap=True)


def configuration(table: dict[str, Any]) -> dict[str, str]:
    """Return a scenario's values by their keys as --set takes them, long lists cut; what is empty is left out."""
    found: dict[str, str] = {}
    for key, value in table.items():
        if key in ("title", "claim", "name", "variant"):  # said by the table of the run
            continue
        if isinstance(value, dict):
            found |= {f"{key}.{inner}": text for inner, text in configuration(value).items()}
        elif value not in (None, [], ""):
            text = json.dumps(value)
            found[key] = text if len(text) <= LONGEST else f"{text[:LONGEST]} ... ({len(value)} values)"
    return found


def _health(statistics: dict[str, dict[str, Any]]) -> dict[str, str]:
    """Return how the master fared: its series by name, in words."""
    found = {}
    for port, s in statistics.items():
        name, unit = port.removeprefix("master."), s["unit"]
        found[name] = f"{number(s['min'])} to {number(s['max'])} {unit}, mean {number(s['mean'])} {unit}"
    if wall := statistics.get("master.wall"):
        steps = wall["rows"]
        found["wall"] = (
            f"{wall['mean'] * steps:.3g} s for {steps - 1} steps, {1e6 * wall['mean']:.3g} us each, "
            f"the slowest {1e3 * wall['max']:.3g} ms"
        )
    return found


def _show_verdicts(facts: dict[str, Any], variants: list[str]) -> None:
    columns = {v: facts["properties"].get(f"{v} metrics", {}) for v in variants}
    units = _spelt(facts["units"].get(f"{variants[0]} metrics", {}))
    keys = dict.fromkeys(key for column in columns.values() for key in column)
    rows = [(key, {v: column.get(key) for v, column in columns.items()}) for key in keys]
    say_table([{"label": k, "unit": units.get(k, ""), "best": [], "values": v} for k, v in rows], variants)


def _spelt(units: dict[str, str]) -> dict[str, str]:
    return {key: "" if unit == "1" else unit for key, unit in units.items()}


def _show_signals(statistics: dict[str, dict[str, Any]], read_as: dict[str, str]) -> None:
    for asked, known in read_as.items():
        part = asked.partition(".")[0]
        out().print(f"{plain(asked)} is read as {plain(known)}: the body of this robot has the ports of its {part}")
    shown = Table(box=None, padding=(0, 1), header_style="bold")
    for name in ("signal", "unit"):
        shown.add_column(name, no_wrap=True)
    for name in ("values", "rows", "min", "max", "mean", "rms"):
        shown.add_column(name, justify="right", no_wrap=True)
    for port, s in statistics.items():
        shown.add_row(plain(port), s["unit"], str(s["width"]), str(s["rows"]),
                      *(f"{s[k]:.4g}" for k in ("min", "max", "mean", "rms")))  # fmt: skip
    out().print(shown)
