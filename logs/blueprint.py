"""How a log opens in the viewer: the scene, and the plots one decides by; readable at 1600 x 1000."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import rerun as rr
import rerun.blueprint as rrb

from cosim.variable import Variable

from .panels import DECISIVE, MOTION, Panel
from .ports import entity
from .style import WHEEL_COLOURS, WHEELS, colour, pale

SLOWLY = 0.1  # of real time: an impact lasts some hundredths of a second
MOST_PLOTS = 8  # of a run that is no rover

_DEFORMED, _TRACTION = "deformation [m], above 0 off the ground", "traction [N]; pale: limits of friction"
_STATIONS, _MISMATCH = "elastic acceleration at the stations [m/s2]", "wheel and body disagree about the gap by [m]"


@dataclass(frozen=True)
class Camera:
    """Where the view of the scene looks: a world point in m, or the body that starts there, as far as it goes."""

    target: tuple[float, float, float]
    follow: bool = False


def run_blueprint(ports: Mapping[str, Variable], camera: Camera | None = None) -> rrb.Blueprint:
    """Return the default arrangement for one run with these output *ports*.

    Without a *camera* the run has no scene, and its plots are made from its ports.
    """
    if camera is None:
        return _arranged(rrb.Grid(*_plots_of(ports), grid_columns=2))
    plots = [
        _wheels("normal force [N]", ports, "wheels.normal_force", legend=True),
        _wheels(_DEFORMED, ports, "wheels.deformation"),
        _wheels(_TRACTION, ports, "wheels.traction", "wheels.friction_limit"),
        _named("velocity of the body [m/s]", ports, "body.velocity", ["x", "y", "z"]),
        _named("pitch [rad], nose up", ports, "body.pitch", ["pitch"]),
        _named("jerk on board, forces held [m/s3]", ports, "body.jerk_body", ["x", "y", "z"]),
        _named(_STATIONS, ports, "chassis.acceleration", []),
        _plot(_MISMATCH, ["master/gap_mismatch"]),
    ]
    left = rrb.Vertical(
        _scene(camera, [""], "normal force and traction as arrows"),
        rrb.Tabs(
            rrb.TextDocumentView(name="verdict", origin="/report"),
            rrb.TextLogView(name="what happened", origin="/", contents=["/events/**", "/log/**"]),
        ),
        row_shares=[3, 2],
    )
    shown = [p for p in plots if p is not None]
    return _arranged(rrb.Horizontal(left, rrb.Grid(*shown, grid_columns=2), column_shares=[2, 3]))


def comparison_blueprint(variants: list[str], ports: Iterable[str], camera: Camera | None = None) -> rrb.Blueprint:
    """Return the arrangement for *variants* whose first has these *ports*: overlaid, and as differences beside it.

    Each variant has one colour in every plot and in the scene.
    """
    known = set(ports)

    def rows(panels: Iterable[Panel]) -> list[Any]:
        found: list[Any] = []
        for panel in panels:
            if panel.port in known:
                title = f"{panel.title} [{panel.unit}]"
                found.append(_plot(title, [f"overlay/{panel.key}/**"], legend=not found))
                short = f"minus {variants[0]}: {panel.title.partition(' (')[0]} [{panel.unit}]"
                found.append(_plot(short, [f"overlay_diff/{panel.key}/**"]))
        return found

    tabs = [
        rrb.Grid(*views, grid_columns=2, name=name)
        for name, panels in (("what decides", DECISIVE), ("motion", MOTION))
        if (views := rows(panels))
    ]
    right: Any = rrb.Tabs(*tabs) if tabs else rrb.TimeSeriesView(name="all", origin="/")
    verdict = rrb.TextDocumentView(name="verdict", origin="/report")
    roots = [f"{rr.escape_entity_path_part(v)}/" for v in variants]
    left: Any = (
        verdict
        if camera is None
        else rrb.Vertical(
            _scene(camera, roots, f"{variants[0]} solid, the others as wires"), verdict, row_shares=[3, 2]
        )
    )
    return _arranged(rrb.Horizontal(left, right, column_shares=[2, 3]))


def _arranged(what: Any) -> rrb.Blueprint:
    time = rrb.TimePanel(timeline="sim_time", state="collapsed", playback_speed=SLOWLY, loop_mode="All")
    return rrb.Blueprint(what, time, collapse_panels=True)


def _scene(camera: Camera, roots: list[str], what: str) -> rrb.Spatial3DView:
    """Return the view of the scene of the robots at *roots*; marks of flights stay where they were made."""
    x, y, z = camera.target
    since = rrb.VisibleTimeRanges(
        timeline="sim_time", start=rrb.TimeRangeBoundary.infinite(), end=rrb.TimeRangeBoundary.cursor_relative()
    )
    eye = rrb.EyeControls3D(
        kind=rrb.Eye3DKind.Orbital, position=[x - 0.6, y - 2.2, z + 0.7], look_target=camera.target,
        tracking_entity=f"/world/{roots[0]}robot/body/hull" if camera.follow else None,
    )  # fmt: skip
    return rrb.Spatial3DView(
        name=f"scene: {what}, dots where a wheel flew",
        origin="/world",
        eye_controls=eye,
        line_grid=False,
        overrides={f"/world/{root}flights": since for root in roots},
    )


def _plot(name: str, entities: list[str], *, legend: bool = False, overrides: Any = None) -> rrb.TimeSeriesView:
    return rrb.TimeSeriesView(
        name=name, origin="/", contents=[f"/{e}" for e in entities], axis_x=rrb.TimeAxis(link="LinkToGlobal"),
        plot_legend=rrb.PlotLegend(corner=rrb.Corner2D.RightTop, visible=legend), overrides=overrides,
    )  # fmt: skip


def _wheels(
    name: str, ports: Mapping[str, Variable], port: str, limit: str = "", *, legend: bool = False
) -> rrb.TimeSeriesView | None:
    """Return the plot of a port with one value per wheel, its *limit* in pale colours behind it."""
    if port not in ports:
        return None
    overrides = {f"/{entity(port)}": rr.SeriesLines(names=list(WHEELS), colors=list(WHEEL_COLOURS), widths=[1.5] * 4)}
    if limit in ports:
        faint = [pale(c) for c in WHEEL_COLOURS]
        overrides[f"/{entity(limit)}"] = rr.SeriesLines(
            names=[f"limit {w}" for w in WHEELS], colors=faint, widths=[1] * 4
        )
    return _plot(name, [entity(p) for p in (limit, port) if p in ports], legend=legend, overrides=overrides)


def _named(name: str, ports: Mapping[str, Variable], port: str, names: list[str]) -> rrb.TimeSeriesView | None:
    if port not in ports:
        return None
    colours = [colour(i) for i in range(len(names))]
    overrides = {f"/{entity(port)}": rr.SeriesLines(names=names, colors=colours)} if names else None
    return _plot(name, [entity(port)], legend=len(names) > 1, overrides=overrides)


def _plots_of(ports: Mapping[str, Variable]) -> list[rrb.TimeSeriesView]:
    """Return plots for components that nobody made plots for: one for each unit of each component."""
    groups: dict[tuple[str, str], list[str]] = {}
    for port, v in ports.items():
        if v.type not in ("String", "Binary"):
            groups.setdefault((port.partition(".")[0], v.unit or "1"), []).append(port)
    plots = [
        _plot(f"{component} [{unit}]", [entity(p) for p in names], legend=True)
        for (component, unit), names in list(groups.items())[:MOST_PLOTS]
    ]
    return plots or [_plot("macro step [s]", ["master/step_size"])]
