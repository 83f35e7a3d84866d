"""A comparison as one HTML file that needs nothing else: verdict, plots to zoom into, sketches, how to run it again."""

from __future__ import annotations

import base64
import io
import json
from importlib.resources import files
from itertools import pairwise
from pathlib import Path
from typing import Any

import jinja2
import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from cosim.errors import ScenarioError
from logs.panels import PANELS
from logs.style import colour

from .conclusion import conclusion, heading, mixed
from .metrics import table
from .runner import Result
from .sketch import sketch
from .verdicts import number

_POINTS = 3000  # of a curve, at most: extremes are kept


def write_report(results: list[Result], path: Path, command: str = "") -> Path:
    """Write the report on several runs of one scenario; raises ScenarioError if the file cannot be written."""
    columns = {r.scenario.variant or r.scenario.name: r.metrics for r in results if r.metrics}
    rows = [row for row in table(columns) if any(v is not None for v in row["values"].values())]
    scenario = results[0].scenario
    text = _template().render(
        scenario=scenario,
        title=heading([r.scenario for r in results]),
        notes=mixed([r.scenario for r in results]),
        sentences=conclusion(columns),
        variants=list(columns),
        colours={name: _hex(i) for i, name in enumerate(columns)},
        rows=rows,
        number=number,
        plots=plots(results).to_html(full_html=False, include_plotlyjs="inline", config={"displaylogo": False}),
        sketch=_picture(sketch(results)),
        configurations={
            name: json.dumps(r.scenario.model_dump(mode="json"), indent=1)
            for name, r in zip(columns, results, strict=False)
        },
        provenance=results[0].provenance,
        command=command,
        failures=[f"{r.scenario.variant}: {r.error}" for r in results if r.error is not None],
    )
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise ScenarioError(f"cannot write the report {path}: {error.strerror}") from None
    return path


def _template() -> jinja2.Template:
    environment = jinja2.Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True)
    return environment.from_string(files("studies").joinpath("report.html.j2").read_text(encoding="utf-8"))


def plots(results: list[Result]) -> Any:
    """Return the decisive signals of all runs over time as one Plotly figure, panels linked, a colour per variant."""
    shown = [p for p in PANELS if any(p.read(r.signal) is not None for r in results)]
    figure = make_subplots(
        rows=-(-len(shown) // 2), cols=2, shared_xaxes="all", vertical_spacing=0.06, horizontal_spacing=0.08,
        subplot_titles=[p.title for p in shown],
    )  # fmt: skip
    for i, panel in enumerate(shown):
        row, column = i // 2 + 1, i % 2 + 1
        for k, result in enumerate(results):
            values = panel.read(result.signal)
            if values is None:
                continue
            keep = thinned(values, _POINTS)
            name = result.scenario.variant or result.scenario.name
            figure.add_trace(
                go.Scatter(x=result.record.time[keep], y=values[keep].astype(np.float32), name=name, legendgroup=name,
                           showlegend=i == 0, line={"color": _hex(k), "width": 1.4}, mode="lines"),
                row=row, col=column,
            )  # fmt: skip
        figure.update_yaxes(title_text=panel.unit, row=row, col=column)
    figure.update_xaxes(title_text="time / s", row=-(-len(shown) // 2))
    figure.update_layout(
        height=270 * (-(-len(shown) // 2)), margin={"l": 60, "r": 20, "t": 60, "b": 40}, template="plotly_white",
        legend={"orientation": "h", "y": 1.05}, hovermode="x unified",
    )  # fmt: skip
    return figure


def _hex(number: int) -> str:
    return "#{:02x}{:02x}{:02x}".format(*colour(number))


def thinned(values: np.ndarray, most: int) -> np.ndarray:
    """Return the indices of at most about *most* values that keep the least and the largest of every stretch."""
    n = len(values)
    if n <= most:
        return np.arange(n)
    edges = np.linspace(0, n, most // 2 + 1).astype(int)
    found = {0, n - 1}
    for a, b in pairwise(edges):
        found |= {int(a + np.argmin(values[a:b])), int(a + np.argmax(values[a:b]))}
    return np.array(sorted(found))


def _picture(figure: Any) -> str:
    """Return a figure as the text of an embedded PNG; empty for none."""
    if figure is None:
        return ""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=100)
    return base64.b64encode(buffer.getvalue()).decode()
