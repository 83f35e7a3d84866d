"""The plots that answer each question about a run of a rover."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import rerun as rr
import rerun.blueprint as rrb

from .energy import RESIDUAL
from .jerk import JERK
from .parts import Ports
from .ports import entity
from .states import TOTAL
from .style import WHEEL_COLOURS, WHEELS, Colour, colour, pale

QUESTIONS = ("impact", "smoothness", "shock", "health")


@dataclass(frozen=True)
class Camera:
    """Where the view of the scene looks: a world point in m, or the body that starts there, as far as it goes."""

    target: tuple[float, float, float]
    follow: bool = False


@dataclass(frozen=True)
class Look:
    """How a log opens: at which of QUESTIONS (*view*), with a *camera* if there is a scene, and captions of drawings.

    *captions* name the drawings that the log has: ``scene``, ``chassis``, ``modes``, ``spectrum``, ``contact``,
    ``energy``, ``jerk``, ``diagram``, each with what must be known to read it; ``unlimited``: friction has no limit.
    """

    view: str = "impact"
    camera: Camera | None = None
    captions: Mapping[str, str] = field(default_factory=dict)

    def table(self) -> dict[str, Any]:
        """Return this as properties of a log."""
        camera = {} if self.camera is None else {"target": list(self.camera.target), "follow": self.camera.follow}
        return {"view": self.view, "drawings": list(self.captions), "captions": list(self.captions.values()), **camera}

    @classmethod
    def of(cls, table: Mapping[str, Any]) -> Look:
        """Return what `table` gave."""
        names, captions, target = (table.get(key) for key in ("drawings", "captions", "target"))
        listed = [([x] if isinstance(x, str) else list(x or [])) for x in (names, captions)]
        camera = None if target is None else Camera((target[0], target[1], target[2]), bool(table.get("follow")))
        return cls(str(table.get("view", "impact")), camera, dict(zip(*listed, strict=True)))


def impact(ports: Ports, look: Look) -> Any:
    """What happens to the wheels: forces, deformation, who touches the ground, traction against its limit."""
    free = "unlimited" in look.captions
    limit = ("", ", friction unlimited") if free else ("wheels.friction_limit", "; pale: friction limit")
    plots = [
        wheels("normal force [N]", ports, "wheels.normal_force", legend=True),
        wheels("deformation [m], above 0 off the ground", ports, "wheels.deformation"),
        *(
            wheels(f"traction, {axle} [N]{limit[1]}", ports, "wheels.traction", limit[0], at)
            for axle, at in (("front", (0, 1)), ("rear", (2, 3)))
        ),
        named("velocity of the body [m/s]", ports, "body.velocity", ["x", "y", "z"]),
        named("pitch [rad], nose up", ports, "body.pitch", ["pitch"]),
    ]
    left = [scene(look.camera, [""], look.captions.get("scene", ""))] if look.camera is not None else []
    shares = [5.0] * len(left)
    if "contact" in look.captions:
        left.append(rrb.StateTimelineView(name="contact of each wheel", origin="/contact"))
        shares.append(2.2)
    return beside(rrb.Vertical(*left, report(), row_shares=[*shares, 2.5]), plots)


def smoothness(ports: Ports, look: Look) -> Any:
    """How smoothly the body moves: three jerks, slope, ideal and applied force."""
    ideal = "controller.ideal_force"
    shown = [entity(ideal)] if ideal in ports else []
    line = rr.SeriesLines(names=["ideal: without normal jerk"], colors=[(42, 157, 74)], widths=[1.5])
    overrides = {f"/{path}": line for path in shown}
    applied = [TOTAL] if "wheels.traction" in ports else []
    force = plot("ideal and applied force, all wheels [N]", [*shown, *applied], legend=True, overrides=overrides)
    plots = [
        named("jerk of the body's components [m/s3]", ports, "body.jerk_body", ["x", "y", "z"]),
        plot(look.captions["jerk"], [JERK], legend=True) if "jerk" in look.captions else None,
        named("jerk vector, in body axes [m/s3]", ports, "body.jerk_inertial", ["x", "y", "z"]),
        named("vertical jerk of the thesis, 4.54 [m/s3]", ports, "body.jerk_thesis", ["jerk_thesis"]),
        force if shown or applied else None,
        wheels("slope under the wheels [rad]", ports, "body.slope", legend=True),
        named("slope the law counts on [rad]", ports, "controller.axle_slope", ["rear", "front"])
        or named("speed [m/s]", ports, "body.velocity_body", ["x", "y", "z"]),
    ]
    left = [scene(look.camera, [""], look.captions.get("scene", ""))] if look.camera is not None else []
    return beside(rrb.Vertical(*left, report(), row_shares=[3.0] * len(left) + [2.0]), plots)


def shock(ports: Ports, look: Look) -> Any:
    """What equipment on the chassis feels: station map, modes, spectra."""
    above = []
    if "chassis" in look.captions:
        above.append(plate("/chassis", look.captions["chassis"], (-1.0, 0.4, 0.8), (-0.05, 0.0, 0.0)))
        above.append(plate("/modes", look.captions["modes"], (-3.2, 0.0, 2.9), (-0.95, 0.0, 0.0)))
    below = [
        stations(ports, look),
        rrb.BarChartView(name=look.captions["spectrum"], origin="/spectrum") if "spectrum" in look.captions else None,
        wheels("force of each wheel on the chassis [N]", ports, "body.wheel_force", legend=True),
        energies(ports),
    ]
    rows = [rrb.Horizontal(*above)] if above else []
    grid = rrb.Grid(*[p for p in below if p is not None], grid_columns=2)
    return rrb.Vertical(*rows, grid, row_shares=[1.0] * len(rows) + [1.25])


def health(ports: Ports, look: Look) -> Any:
    """Whether the co-simulation can be trusted: gap mismatch, energy, step size, wall time, and how it is coupled."""
    twice = {"body.gap", "wheels.deformation"} <= ports.names
    added = look.captions.get("energy") or "what the splitting adds"
    plots = [
        plot("wheel and body disagree about the gap by [m]", ["master/gap_mismatch"]) if twice else None,
        plot(f"energy residual [J]: {added}", [RESIDUAL]) if "energy" in look.captions else None,
        plot("macro step [s], shorter before an event", ["master/step_size"]),
        plot("wall time of a step [s]", ["master/wall"]),
    ]
    events = rrb.TextLogView(name="what happened", origin="/", contents=["/events/**", "/log/**"])
    if "diagram" in look.captions:
        graph = rrb.GraphView(name=look.captions["diagram"], origin="/diagram")
        wires = rrb.TextDocumentView(name="wires: unit and delay of each", origin="/wires")
        left: Any = rrb.Vertical(graph, rrb.Horizontal(wires, events, column_shares=[3, 2]), row_shares=[5, 2])
    else:
        left = events
    return beside(left, plots, shares=(3, 2), columns=1)


def stations(ports: Ports, look: Look) -> Any:
    """Return the plot of the acceleration at the stations above the wheels; of all, where it is not known which."""
    port = "chassis.acceleration"
    if port not in ports or "chassis" not in look.captions:
        return named("acceleration at the stations [m/s2]", ports, port, [])
    above = dict(zip((0, 3, 16, 19), zip(WHEELS, WHEEL_COLOURS, strict=True), strict=True))
    wheel = [above.get(k, ("", (130, 130, 130))) for k in range(20)]
    names = [f"{k + 1} ({w})" for k, (w, _) in enumerate(wheel)]
    lines = _lines(names, [c for _, c in wheel], 1.0, [k in above for k in range(20)])
    title = "acceleration at the stations above the wheels, in their colours [m/s2]"
    return plot(title, [place(ports, port)], overrides={f"/{place(ports, port)}": lines})


def energies(ports: Ports) -> Any:
    """Return the plot of the elastic energy of the chassis, or None."""
    both = {"chassis.strain_energy": "stored", "chassis.elastic_kinetic_energy": "moving"}
    if not all(port in ports for port in both):
        return None
    overrides = {
        f"/{place(ports, port)}": rr.SeriesLines(names=[name], colors=[colour(i)], widths=[1.2])
        for i, (port, name) in enumerate(both.items())
    }
    return plot("elastic energy of the chassis [J]", [place(ports, p) for p in both], legend=True, overrides=overrides)


def beside(left: Any, plots: list[Any], shares: tuple[float, float] = (2, 3), columns: int = 2) -> Any:
    """Return *left* with the *plots* that there are to its right."""
    grid = rrb.Grid(*[p for p in plots if p is not None], grid_columns=columns)
    return rrb.Horizontal(left, grid, column_shares=list(shares))


def report() -> Any:
    """Return the view of the verdict."""
    return rrb.TextDocumentView(name="verdict", origin="/report")


def plate(origin: str, name: str, eye: tuple[float, float, float], at: tuple[float, float, float]) -> Any:
    """Return a view of a plate, the front away from the reader."""
    looks = rrb.EyeControls3D(kind=rrb.Eye3DKind.Orbital, position=eye, look_target=at)
    return rrb.Spatial3DView(name=name, origin=origin, eye_controls=looks, line_grid=False)


def scene(camera: Camera, roots: list[str], what: str) -> rrb.Spatial3DView:
    """Return the view of the scene of the robots at *roots*; marks of flights stay where they were made."""
    x, y, z = camera.target
    since = rrb.VisibleTimeRanges(
        timeline="sim_time", start=rrb.TimeRangeBoundary.infinite(), end=rrb.TimeRangeBoundary.cursor_relative()
    )
    eye = rrb.EyeControls3D(
        kind=rrb.Eye3DKind.Orbital, position=[x - 0.5, y - 1.95, z + 0.55], look_target=camera.target,
        tracking_entity=f"/world/{roots[0]}robot/body/hull" if camera.follow else None,
    )  # fmt: skip
    return rrb.Spatial3DView(
        name=f"scene: {what}",
        origin="/world",
        eye_controls=eye,
        line_grid=False,
        overrides={f"/world/{root}flights": since for root in roots},
    )


def place(ports: Ports, port: str) -> str:
    """Return the entity of a port."""
    return entity(ports.at(port))


def plot(name: str, entities: list[str], *, legend: bool = False, overrides: Any = None) -> rrb.TimeSeriesView:
    """Return a plot of *entities* over the time that all plots share."""
    return rrb.TimeSeriesView(
        name=name, origin="/", contents=[f"/{e}" for e in entities], axis_x=rrb.TimeAxis(link="LinkToGlobal"),
        plot_legend=rrb.PlotLegend(corner=rrb.Corner2D.RightTop, visible=legend), overrides=overrides,
    )  # fmt: skip


def wheels(
    name: str, ports: Ports, port: str, limit: str = "", at: tuple[int, ...] = (0, 1, 2, 3), *, legend: bool = False
) -> rrb.TimeSeriesView | None:
    """Return the plot of the wheels *at* of a port with one value per wheel, its *limit* in pale colours behind it."""
    if port not in ports:
        return None
    seen = [k in at for k in range(len(WHEELS))]
    strong: list[Colour] = list(WHEEL_COLOURS)
    overrides = {f"/{place(ports, port)}": _lines(list(WHEELS), strong, 1.5, seen)}
    if limit in ports:
        faint = [pale(c) for c in WHEEL_COLOURS]
        overrides[f"/{place(ports, limit)}"] = _lines([f"limit {w}" for w in WHEELS], faint, 1.0, seen)
    return plot(name, [place(ports, p) for p in (limit, port) if p in ports], legend=legend, overrides=overrides)


def _lines(names: list[str], colours: list[Colour], width: float, seen: list[bool]) -> rr.SeriesLines:
    return rr.SeriesLines(names=names, colors=colours, widths=[width] * len(names), visible_series=seen)


def named(name: str, ports: Ports, port: str, names: list[str]) -> rrb.TimeSeriesView | None:
    """Return the plot of a port whose values have *names*, or None without the port."""
    if port not in ports:
        return None
    colours = [colour(i) for i in range(len(names))]
    overrides = {f"/{place(ports, port)}": rr.SeriesLines(names=names, colors=colours)} if names else None
    return plot(name, [place(ports, port)], legend=len(names) > 1, overrides=overrides)
