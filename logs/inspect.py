"""What a log holds, in numbers; and its signals as CSV, Parquet or MCAP."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet

from cosim.errors import ScenarioError

from . import mcap_file
from .parts import like, read_as
from .read import Signal, properties, signals, texts

_UNITS = "metric_units"


def describe(path: Path, patterns: list[str] | None = None) -> dict[str, Any]:
    """Return properties, events and statistics of the signals that match any of *patterns* (all, if none are given).

    Keys: ``status`` (complete, failed, interrupted; unfinished if it was killed or is still written; comparison);
    ``properties``; ``units`` of the verdict; ``events`` as (s, text); ``ports``: all names; ``signals``: by port unit,
    width, rows, min, max, mean and rms over all values; ``read_as``: the patterns that are for ports of the body here.
    """
    tables = properties(path)
    units = {
        title.replace(_UNITS, "metrics"): dict(zip(table["metric"], table["unit"], strict=True))
        for title, table in tables.items()
        if title.endswith(_UNITS)
    }
    found = signals(path)
    patterns = patterns or []
    return {
        "path": str(path),
        "status": _status(tables),
        "properties": {t: table for t, table in tables.items() if not t.endswith(_UNITS)},
        "units": units,
        "events": [(ns * 1e-9, text) for ns, text in texts(path, "/events/**")],
        "ports": list(found),
        "signals": {port: _statistics(found[port]) for port in like(found, patterns)},
        "read_as": {asked: known for asked, known in read_as(patterns, found).items() if asked != known},
    }


def _status(tables: dict[str, dict[str, Any]]) -> str:
    outcome = tables.get("outcome", {})
    if "compare" in tables:
        return "comparison"
    return str(outcome["status"]) if outcome else "unfinished (killed, or still being written)"


def _statistics(signal: Signal) -> dict[str, Any]:
    v = signal.values
    return {
        "unit": signal.unit, "width": v.shape[1], "rows": len(v), "min": float(np.min(v)), "max": float(np.max(v)),
        "mean": float(np.mean(v)), "rms": float(np.sqrt(np.mean(v**2))),
    }  # fmt: skip


def export(path: Path, out: Path, ports: list[str]) -> Path:
    """Write signals to ``.csv`` or ``.parquet``: a column ``time [s]``, then one per value, named with its unit.

    Or to ``.mcap``: a topic per port, see ``mcap_file``.
    """
    found = signals(path)
    chosen = [found[p] for p in ports]
    try:
        if out.suffix == ".mcap":
            mcap_file.write(chosen, out)
        elif out.suffix == ".parquet":
            pyarrow.parquet.write_table(_table(chosen), out)
        elif out.suffix == ".csv":
            pyarrow.csv.write_csv(_table(chosen), out)
        else:
            raise ScenarioError(f"cannot write {out}: the name must end in .csv, .parquet or .mcap")
    except OSError as error:
        raise ScenarioError(f"cannot write {out}: {error}") from None
    return out


def _table(chosen: list[Signal]) -> pa.Table:
    base = max(chosen, key=lambda s: len(s.ns)).ns
    columns: dict[str, Any] = {"time [s]": base * 1e-9}
    for signal in chosen:
        same = np.array_equal(signal.ns, base)
        for k in range(signal.values.shape[1]):
            label = signal.port + (f"[{k + 1}]" if signal.values.shape[1] > 1 else "")
            column = signal.values[:, k] if same else _on(base, signal, k)
            columns[f"{label} [{signal.unit}]"] = column
    return pa.table(columns)


def _on(base: np.ndarray, signal: Signal, k: int) -> np.ndarray:
    """Return a column at other times: its value there, not a number where it has none."""
    column = np.full(len(base), np.nan)
    _, mine, theirs = np.intersect1d(base, signal.ns, return_indices=True)
    column[mine] = signal.values[theirs, k]
    return column
