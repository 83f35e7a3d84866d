"""How results and comparisons show themselves in a notebook: sentences, the verdict, a small picture."""

from __future__ import annotations

import base64
import io
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cosim.show import Grid, html
from logs.panels import DECISIVE
from logs.style import colour

from .conclusion import conclusion, heading
from .metrics import table
from .verdicts import number, unit

if TYPE_CHECKING:
    from .runner import Result
    from .session import Comparison

DPI = 60  # of a picture on the page


def result_html(result: Result, log: Path | None = None) -> str:
    """Return what came of a run: its failure if it failed, the verdict in words and numbers, the decisive instants."""
    from .sketch import sketch  # draws; who only runs does without

    name = result.scenario.variant or result.scenario.name
    return html(
        _title(result),
        [*_failures([result]), *conclusion({name: result.metrics}), *_how(result), *_files({"log": log})],
        [_grid({name: result})],
        _png(sketch([result])),
    )


def comparison_html(done: Comparison) -> str:
    """Return several runs side by side: who kept the ground in words, the best of each row, the decisive signals."""
    results = [run.result for run in done.runs]
    judged = {r.scenario.variant or r.scenario.name: r for r in results if r.metrics}
    sentences = conclusion({name: r.metrics for name, r in judged.items()})
    files = {"all variants": done.combined, "picture": done.picture, "report": done.report}
    return html(
        heading([r.scenario for r in results]),
        [*_failures(results), *done.notes, *sentences, *_files(files)],
        [_grid(judged)],
        _png(curves(list(judged.values()))),
    )


def curves(results: list[Result]) -> Any:
    """Return a figure of the decisive signals of all runs, one colour each; None if no run has any of them."""
    from matplotlib.figure import Figure

    shown = [p for p in DECISIVE if any(p.read(r.signal) is not None for r in results)]
    if not shown:
        return None
    figure = Figure(figsize=(14, 2.4 * (-(-len(shown) // 2))), layout="constrained")
    axes = figure.subplots(-(-len(shown) // 2), 2, sharex=True, squeeze=False)
    for axis, panel in zip(axes.flat, shown, strict=False):
        for i, result in enumerate(results):
            values = panel.read(result.signal)
            if values is not None:
                name, tint = result.scenario.variant or result.scenario.name, [c / 255 for c in colour(i)]
                axis.plot(result.record.time, values, color=tint, linewidth=1.2, label=name)
        axis.set_title(f"{panel.title} / {panel.unit}", loc="left")
        axis.grid(alpha=0.3)
    for axis in axes[-1]:
        axis.set_xlabel("time / s")
    axes[0, 0].legend()
    return figure


def _title(result: Result) -> str:
    variant = result.scenario.variant
    return result.scenario.title + (f": {variant}" if variant else "")


def _failures(results: list[Result]) -> list[str]:
    return [f"{r.scenario.variant or r.scenario.name} failed: {r.error}" for r in results if r.error is not None]


def _how(result: Result) -> list[str]:
    if result.summary is None:
        return []
    steps, events = result.summary.steps, result.summary.events
    return [f"{steps} macro steps, {events} events located, {result.seconds['running']:.2f} s of computing."]


def _files(paths: dict[str, Path | None]) -> list[str]:
    return [f"{what}: {path}" for what, path in paths.items() if path is not None]


def _grid(results: dict[str, Result]) -> Grid:
    """Return the verdict table, a column per run, what no run has left out."""
    columns = {name: r.metrics for name, r in results.items() if r.metrics}
    if not columns:
        return Grid((), ())
    rows = [row for row in table(columns) if any(v is not None for v in row["values"].values())]
    names = list(columns)
    bold = {(i, 2 + names.index(best)) for i, row in enumerate(rows) for best in row["best"]}
    cells = [(row["label"], unit(row["unit"]), *(number(row["values"][n]) for n in names)) for row in rows]
    head = ("", "unit", *(names if len(names) > 1 else ["value"]))
    caption = "bold: the best of its row" if bold else ""
    return Grid(head, cells, caption, frozenset(range(2, len(head))), frozenset(bold))


def _png(figure: Any) -> str:
    """Return a figure as a PNG in base 64; empty for none."""
    if figure is None:
        return ""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=DPI)
    return base64.b64encode(buffer.getvalue()).decode()
