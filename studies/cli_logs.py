"""``wmr-cosim logs``: all runs of a folder in one table."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from .places import run_folder
from .terminal import out, plain, print_json
from .verdicts import number

_COLUMNS = ("scenario", "variant", "status", "started_utc")
_METRICS = ("front_off", "rear_off", "front_normal_peak", "demand_peak", "station_peak")


def logs(
    folder: Annotated[Path | None, typer.Argument(help="Where to look, subfolders included; default: as run.")] = None,
    where: Annotated[
        list[str] | None, typer.Option(help="Keep runs with e.g. scenario=ramp-impact or 'front_off<10'. Repeatable.")
    ] = None,
    sort: Annotated[str | None, typer.Option(help="Sort by a property or metric, -KEY for the largest first.")] = None,
    show: Annotated[
        str | None, typer.Option(help=f"Properties or metrics to show, comma-separated; default: {','.join(_METRICS)}.")
    ] = None,
    json: Annotated[
        bool, typer.Option("--json", help="Print one JSON document (SI units) instead of a table.")
    ] = False,
) -> None:
    """List the runs of a folder with their verdicts, filtered and sorted by any property or metric.

    Example: wmr-cosim logs --where scenario=ramp-impact --where 'front_off<10' --sort demand_peak
    """
    from logs.runs import runs, select

    rows = select(runs(folder or run_folder()), where or (), sort)
    if json:
        print_json(rows)
        return
    metrics = tuple(s.strip() for s in show.split(",")) if show else _METRICS
    shown = Table(*_COLUMNS, *metrics, "file", box=None, padding=(0, 1))
    for row in rows:
        cells = [_cell(row.get(key)) for key in (*_COLUMNS, *metrics)]
        shown.add_row(*cells, plain(Path(row["path"]).name))
    out().print(shown)


def _cell(value: object) -> str:
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return number(float(value))
    return plain("" if value is None else str(value))
