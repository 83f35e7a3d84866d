"""The verdicts on several runs side by side: as rows, and as Markdown."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .metric import Metric


def table(columns: Mapping[str, list[Metric]]) -> list[dict[str, Any]]:
    """Return the comparison as rows: key, label, unit, one value per variant, and which variants are best."""
    rows = []
    for i, first in enumerate(next(iter(columns.values()))):
        values = {variant: metrics[i].value for variant, metrics in columns.items()}
        known = [v for v in values.values() if v is not None]
        best: list[str] = []
        if first.better and len(known) > 1 and max(known) - min(known) > 1e-9 * max(abs(v) for v in known) + 1e-12:
            target = min(known) if first.better == "lower" else max(known)
            best = [name for name, v in values.items() if v == target]
        rows.append({"key": first.key, "label": first.label, "unit": first.unit, "values": values, "best": best})
    return rows


def markdown(scenario: Any, rows: list[dict[str, Any]]) -> str:
    """Return the comparison as a Markdown document, for the log."""
    variants = list(rows[0]["values"])
    lines = [f"### {scenario.title}", "", scenario.claim, "", "| | unit | " + " | ".join(variants) + " |"]
    lines.append("| --- | --- |" + " ---: |" * len(variants))
    for row in rows:
        if any(v is not None for v in row["values"].values()):
            cells = [
                "-"
                if row["values"][v] is None
                else f"**{row['values'][v]:.4g}**"
                if v in row["best"]
                else f"{row['values'][v]:.4g}"
                for v in variants
            ]
            lines.append(f"| {row['label']} | {row['unit']} | " + " | ".join(cells) + " |")
    return "\n".join([*lines, "", "Bold: the best of its row."])
