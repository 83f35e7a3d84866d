"""``wmr-cosim inspect --diff`` and ``--rerun``: whether two runs are the same to the bit."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import typer
from rich.table import Table

from cosim.errors import ScenarioError

from .terminal import out, plain, print_json, progress
from .verdicts import number

if TYPE_CHECKING:
    from logs.difference import Difference

_ONLY = {
    "one": "only in the first", "other": "only in the second", "shape": "of another shape", "times": "at other times",
}  # fmt: skip


def show_diff(log: Path, other: Path, patterns: list[str], json: bool) -> None:
    """Print the signals, those like any of *patterns*, of two logs that are not the same; exits with 1 if any are not.

    Raises ScenarioError if no signal is like the patterns.
    """
    from logs.difference import differences  # Rerun takes a while to import
    from logs.parts import like

    with progress(json) as bar:
        bar(f"comparing {log} and {other}")
        found = differences(log, other)
    kept = set(like([d.port for d in found], patterns))
    chosen = [d for d in found if d.port in kept]
    if not chosen:
        raise ScenarioError(f"neither {log} nor {other} has a signal like {', '.join(patterns) or 'any'}")
    off = [d for d in chosen if not d.identical]
    if json:
        print_json({"one": log, "other": other, "identical": not off, "signals": _rows(chosen)})
    else:
        same = f"{len(chosen) - len(off)} of {len(chosen)} signals are the same to the bit"
        out().print(f"{plain(str(log))} and {plain(str(other))}: {same}", soft_wrap=True)
        if off:
            _show(off)
    if off:
        raise typer.Exit(1)


def show_rerun(log: Path, json: bool) -> None:
    """Run a log again and say whether it is reproduced; exits with 1 if it is not."""
    from .reproduce import reproduce

    with progress(json) as bar:
        bar(f"reading {log}")
        done = reproduce(log, bar)
    if json:
        print_json({
            "log": log, "status": done.status, "identical": done.exact, "reasons": done.reasons,
            "in_words": done.sentence(), "signals": _rows(done.differences),
        })  # fmt: skip
    else:
        out().print(f"{plain(str(log))}: {plain(done.sentence())}", soft_wrap=True)
        if not done.exact:
            _show([d for d in done.differences if not d.identical])
    if not done.exact:
        raise typer.Exit(1)


def _rows(found: list[Difference]) -> list[dict[str, object]]:
    return [{**asdict(d), "identical": d.identical} for d in found]


def _show(off: list[Difference]) -> None:
    shown = Table(box=None, padding=(0, 1), header_style="bold")
    for name in ("signal", "unit"):
        shown.add_column(name, no_wrap=True)
    for name in ("largest difference", "rms", "since / s"):
        shown.add_column(name, justify="right", no_wrap=True)
    shown.add_column("")
    for d in off:
        since = "" if d.since is None else f"{d.since:.9g}"
        known = d.largest == d.largest  # a number
        sizes = (number(d.largest), number(d.rms)) if known else ("", "")
        shown.add_row(plain(d.port), d.unit, *sizes, since, _ONLY.get(d.only, ""))
    out().print(shown)
