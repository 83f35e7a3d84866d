"""Where the command line prints: tables on stdout, complaints and progress on stderr, JSON for programs."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

WIDE = 500  # columns where no terminal says how many there are: a row of a table stays a line of the file


def out() -> Console:
    """Return the console for results; as wide as the terminal, as COLUMNS says, or as wide as need be."""
    console = Console(highlight=False)
    if not console.is_terminal and not os.environ.get("COLUMNS"):
        console.width = WIDE
    return console


def err() -> Console:
    """Return the console for complaints and notes; lines are left to the terminal to break."""
    return Console(stderr=True, highlight=False, soft_wrap=True)


def complain(sentence: str) -> None:
    """Print one sentence about what went wrong."""
    err().print(f"[bold red]error:[/bold red] {plain(sentence)}")


def note(sentence: str) -> None:
    """Print one sentence about what is worth knowing."""
    err().print(f"[yellow]note:[/yellow] {plain(sentence)}")


def plain(text: str) -> str:
    """Return text in which brackets are no markup."""
    return text.replace("[", "\\[")


def listing(title: str, entries: Mapping[str, str]) -> Table:
    """Return a table of names and what they are."""
    shown = Table(title=title, title_justify="left", title_style="bold", show_header=False, box=None, padding=(0, 2))
    shown.add_column(no_wrap=True)
    shown.add_column()
    for name, line in entries.items():
        shown.add_row(plain(name), plain(line))
    return shown


def print_json(document: Any) -> None:
    """Print one JSON document; what is not a finite number is null, since JSON has no word for it."""
    print(json.dumps(_jsonable(document), allow_nan=False))


def _jsonable(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(k): _jsonable(v) for k, v in value.items()}
    if isinstance(value, np.ndarray):
        return _jsonable(value.tolist())
    if isinstance(value, Sequence) and not isinstance(value, str | bytes):
        return [_jsonable(v) for v in value]
    if isinstance(value, np.generic):
        return _jsonable(value.item())
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value if isinstance(value, str | int | bool | None) else str(value)


class Bar:
    """A progress bar where there is a terminal, silence where there is none."""

    def __init__(self, progress: Progress | None) -> None:
        self.progress = progress
        self.task = progress.add_task("", total=None) if progress else None

    def __call__(self, label: str, share: float | None = None) -> None:
        """Show *label* and how much of it is done; None: it is not known."""
        if self.progress is not None and self.task is not None:
            self.progress.update(self.task, description=plain(label), completed=share or 0.0,
                                 total=None if share is None else 1.0)  # fmt: skip

    def remove(self) -> None:
        """Take it off the screen."""
        if self.progress is not None and self.task is not None:
            self.progress.remove_task(self.task)


SILENT = Bar(None)


@contextmanager
def progress(quiet: bool = False) -> Iterator[Bar]:
    """Show a bar on stderr while something lasts."""
    console = Console(stderr=True)
    if quiet or not console.is_terminal:
        yield SILENT
        return
    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True) as shown:
        yield Bar(shown)
