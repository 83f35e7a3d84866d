"""How a log opens in the viewer: the scene, and the plots one decides by; readable at 1600 x 1000."""

from __future__ import annotations

from typing import Any

import rerun as rr
import rerun.blueprint as rrb

from .recorder import PALETTE

PLOTS = (
    ("normal force [N]", "plant/wheels/normal_force"),
    ("deformation [m], below 0 pressed", "plant/wheels/deformation"),
    ("traction [N] and friction limit", "plant/wheels/traction", "plant/wheels/friction_limit"),
    ("velocity of the body [m/s]", "plant/body/velocity"),
    ("pitch [rad], nose up", "plant/body/pitch"),
    ("jerk on board [m/s3]", "plant/body/jerk_body"),
)
CHASSIS = ("elastic acceleration at the stations [m/s2]", "plant/chassis/acceleration")
HEALTH = ("gap mismatch [m] and macro step [s]", "master/gap_mismatch", "master/step_size")


def _plot(name: str, *entities: str, **overrides: Any) -> rrb.TimeSeriesView:
    return rrb.TimeSeriesView(
        name=name, origin="/", contents=[f"/{e}" for e in entities], axis_x=rrb.TimeAxis(link="LinkToGlobal"),
        plot_legend=rrb.PlotLegend(visible=len(entities) < 3), **overrides,
    )  # fmt: skip


def _view3d(name: str, root: str, focus: tuple[float, float, float]) -> rrb.Spatial3DView:
    x, y, z = focus
    eye = rrb.EyeControls3D(kind=rrb.Eye3DKind.Orbital, position=[x - 0.9, y - 2.6, z + 1.1], look_target=[x, y, z])
    return rrb.Spatial3DView(name=name, origin=f"/{root}", eye_controls=eye)


def run_blueprint(*, has_chassis: bool = True, focus: tuple[float, float, float] = (0.4, 0.0, 0.3)) -> rrb.Blueprint:
    """Return the default arrangement for one run; *focus* is the world point the camera looks at, in m."""
    plots = [_plot(*p) for p in (*PLOTS, *((CHASSIS,) if has_chassis else ()), HEALTH)]
    return rrb.Blueprint(
        rrb.Horizontal(
            _view3d("scene", "world", focus),
            rrb.Grid(*plots, grid_columns=2),
            column_shares=[2, 3],
        ),
        rrb.TimePanel(timeline="sim_time", state="collapsed"),
        collapse_panels=True,
    )


def comparison_blueprint(
    variants: list[str], widths: dict[str, int], focus: tuple[float, float, float] = (0.4, 0.0, 0.3)
) -> rrb.Blueprint:
    """Return the arrangement for variants under their own roots: each variant one colour in every plot.

    *widths* gives the number of values of each entity (without its variant) that the runs have.
    """
    plots = []
    for title, *entities in (*PLOTS, CHASSIS):
        entity = entities[0]
        if entity not in widths:
            continue
        overrides = {}
        for i, variant in enumerate(variants):
            names = [f"{variant} {k + 1}" for k in range(widths[entity])]
            overrides[f"/{variant}/{entity}"] = rr.SeriesLines(
                names=names, colors=[PALETTE[i % len(PALETTE)]] * len(names)
            )
        contents = [f"/{v}/{entity}" for v in variants]
        plots.append(rrb.TimeSeriesView(name=title, origin="/", contents=contents, overrides=overrides,
                                        axis_x=rrb.TimeAxis(link="LinkToGlobal"),
                                        plot_legend=rrb.PlotLegend(visible=widths[entity] < 5)))  # fmt: skip
        if len(plots) % 2 and f"diff/{entity}" and title == PLOTS[0][0]:
            plots.append(_plot(f"difference to {variants[0]}: {title}", *(f"diff/{v}/{entity}" for v in variants[1:])))
    return rrb.Blueprint(
        rrb.Horizontal(
            rrb.Vertical(
                _view3d("scene", "world", focus),
                rrb.TextDocumentView(name="verdict", origin="/report"),
                row_shares=[3, 2],
            ),
            rrb.Grid(*plots, grid_columns=2),
            column_shares=[2, 3],
        ),
        rrb.TimePanel(timeline="sim_time", state="collapsed"),
        collapse_panels=True,
    )
