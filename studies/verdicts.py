"""Verdicts in a terminal: all figures with a column per variant, or what decides with a row per variant."""

from __future__ import annotations

from typing import Any

from rich.table import Table

from .terminal import out, plain

# what decides, by key: how it is called over a narrow column
DECISIVE = {
    "front_off": "front off ground, ms",
    "front_rebounds": "front rebounds",
    "rear_off": "rear off ground, ms",
    "front_normal_peak": "peak front force, N",
    "demand_peak": "most asked of a wheel, N",
    "actuator_energy": "actuator work, J",
    "saturated": "at friction limit, %",
    "speed_min": "lowest speed, m/s",
}
LABELS = 44  # columns that a table keeps for labels and units
ZERO = 1e-12  # what is smaller is rounding, whatever the unit


def number(value: float | None) -> str:
    """Return a number at a glance: three or four significant digits, thousands as they are."""
    if value is None:
        return "-"
    if abs(value) < ZERO:
        return "0"
    return f"{value:.0f}" if 1000 <= abs(value) < 1e7 else f"{value:.4g}" if abs(value) >= 1 else f"{value:.3g}"


def show(rows: list[dict[str, Any]], variants: list[str], *, full: bool = False) -> None:
    """Print the verdicts: what decides, if there is such a thing and not *full*, all figures else."""
    known = [row for row in rows if any(v is not None for v in row["values"].values())]
    decisive = {row["key"]: row for row in known if row["key"] in DECISIVE}
    if full or "front_off" not in decisive:
        say_table(rows, variants)
        return
    say_decisive({key: decisive[key] for key in DECISIVE if key in decisive}, variants)
    out().print(
        f"* the best of its column; all {len(known)} figures: --full, or the verdict in the log of all variants"
    )


def say_decisive(rows: dict[str, dict[str, Any]], variants: list[str]) -> None:
    """Print one row per variant, and of the figures *rows* by key as many as the terminal is wide."""
    cells = {
        k: [number(r["values"][v]) + (" *" if v in r["best"] else "  ") for v in variants] for k, r in rows.items()
    }
    shown = Table(box=None, padding=(0, 1), header_style="bold")
    shown.add_column("", no_wrap=True)
    room, kept = out().width - max(map(len, variants)) - 2, []
    for key, column in cells.items():
        wide = max(*(len(word) for word in DECISIVE[key].split()), *map(len, column)) + 2
        room -= wide
        if room < 0:
            break
        kept.append(key)
        shown.add_column(DECISIVE[key], justify="right", width=wide - 2)
    for i, v in enumerate(variants):
        marked = [f"[bold green]{cells[k][i]}[/bold green]" if v in rows[k]["best"] else cells[k][i] for k in kept]
        shown.add_row(plain(v), *marked)
    out().print(shown)


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
        shown.add_row(plain(row["label"]), unit(row["unit"]), *marked)
    out().print(shown)


def unit(text: str) -> str:
    """Return a unit as a table shows it: none for a plain number."""
    return "" if text == "1" else text
