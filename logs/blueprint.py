"""How a log opens in the viewer: a tab for each question, the one that the scenario asks in front.

Each is readable at 1600 x 1000 without touching anything.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import rerun as rr
import rerun.blueprint as rrb
from rerun.chunk import RrdReader

from cosim.errors import ScenarioError, nearest
from cosim.variable import Variable

from .panels import DECISIVE, MOTION, Panel
from .parts import Ports
from .ports import entity
from .questions import QUESTIONS, Camera, Look, health, impact, plot, scene, shock, smoothness
from .read import properties

SLOWLY = 0.1  # of real time: an impact lasts some hundredths of a second
MOST_PLOTS = 8  # of a run that is no rover
_ARRANGED = {"impact": impact, "smoothness": smoothness, "shock": shock, "health": health}


def run_blueprint(ports: Mapping[str, Variable], look: Look | None = None) -> rrb.Blueprint:
    """Return the default arrangement for one run with these output *ports*: a tab for each question it can answer.

    Without a camera in *look* the run has no scene, and plots made from its ports stand in front.
    """
    look = look or Look()
    names = answered(ports, look)
    tabs = [_ARRANGED[name](Ports(ports), look) for name in names]
    if look.camera is None:
        names, tabs = ["all ports", *names], [rrb.Grid(*_plots_of(ports), grid_columns=2), *tabs]
    for name, tab in zip(names, tabs, strict=True):
        tab.name = name
    front = names.index(look.view) if look.camera is not None and look.view in names else 0
    return _arranged(rrb.Tabs(*tabs, active_tab=front))


def answered(ports: Iterable[str], look: Look | None = None) -> list[str]:
    """Return the QUESTIONS that a run with these output *ports*, and the drawings of *look*, can answer."""
    needed = {"impact": "wheels.normal_force", "smoothness": "body.jerk_body", "shock": "chassis.acceleration"}
    known = Ports(ports)
    drawn = {"smoothness"} if look is not None and "jerk" in look.captions else set()
    return [name for name in QUESTIONS if name in drawn or name not in needed or needed[name] in known]


def question(name: str, ports: Iterable[str], look: Look | None = None) -> rrb.Blueprint:
    """Return the arrangement for one of QUESTIONS alone, to be saved as .rbl or sent to a viewer.

    Raises ScenarioError for a question that there is none of, or that the *ports* do not answer.
    """
    known = Ports(ports)
    if name not in (possible := answered(known, look)):
        raise ScenarioError(f"this log has no view {name!r}; {nearest(name, possible)}")
    return _arranged(_ARRANGED[name](known, look or Look()))


def question_of(name: str, log: Path) -> rrb.Blueprint:
    """Return `question` for the run in a *log*, by what it says of itself."""
    look = Look.of(properties(log).get("look", {}))
    found = set()
    for chunk in RrdReader(str(log)).stream().filter(content="/plant/**", is_static=True):
        parts = chunk.entity_path.removeprefix("/plant/").split("/")
        if len(parts) == 2:  # an output; inputs lie one deeper
            found.add(".".join(part.replace("\\", "") for part in parts))
    return question(name, found, look)


def comparison_blueprint(variants: list[str], ports: Iterable[str], camera: Camera | None = None) -> rrb.Blueprint:
    """Return the arrangement for *variants* whose first has these *ports*: overlaid, and as differences beside it.

    Each variant has one colour in every plot and in the scene.
    """
    known = Ports(ports)

    def rows(panels: Iterable[Panel]) -> list[Any]:
        found: list[Any] = []
        for panel in panels:
            if panel.port in known:
                title = f"{panel.title} [{panel.unit}]"
                found.append(plot(title, [f"overlay/{panel.key}/**"], legend=not found))
                short = f"minus {variants[0]}: {panel.title.partition(' (')[0]} [{panel.unit}]"
                found.append(plot(short, [f"overlay_diff/{panel.key}/**"]))
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
            scene(camera, roots, f"{variants[0]} solid, the others as wires; dots: where a wheel flew"),
            verdict,
            row_shares=[3, 2],
        )
    )
    return _arranged(rrb.Horizontal(left, right, column_shares=[2, 3]))


def _arranged(what: Any) -> rrb.Blueprint:
    time = rrb.TimePanel(timeline="sim_time", state="collapsed", playback_speed=SLOWLY, loop_mode="All")
    return rrb.Blueprint(what, time, collapse_panels=True)


def _plots_of(ports: Mapping[str, Variable]) -> list[rrb.TimeSeriesView]:
    """Return plots for components that nobody made plots for: one for each unit of each component."""
    groups: dict[tuple[str, str], list[str]] = {}
    for port, v in ports.items():
        if v.type not in ("String", "Binary"):
            groups.setdefault((port.partition(".")[0], v.unit or "1"), []).append(port)
    plots = [
        plot(f"{component} [{unit}]", [entity(p) for p in names], legend=True)
        for (component, unit), names in list(groups.items())[:MOST_PLOTS]
    ]
    return plots or [plot("macro step [s]", ["master/step_size"])]
