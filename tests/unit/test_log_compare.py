"""The combined log holds A, B and B - A with the right values, and what it takes to look at it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rerun as rr
from rerun.chunk import RrdReader
from toys import Gain, Mass

from cosim import Jacobi, System, run
from cosim.errors import ScenarioError
from logs.blueprint import Camera
from logs.compare import ALL_DIFFERENCES, WIDEST, combine, difference
from logs.inspect import describe
from logs.panels import PANELS, Panel
from logs.read import properties, signals
from logs.recorder import RerunRecorder
from logs.style import colour
from studies.catalog import find_scenario
from studies.logged import log_observer
from studies.runner import execute

MS = 1_000_000


def falling(path: Path, v: float, step: int, stop: int) -> Path:
    """Log a mass that moves at v: position 1 + v t, exact at every step size."""
    system = System({"m": Mass().instance(), "g": Gain().instance()}, {})
    system.instances["m"].set("v", v)
    run(system, Jacobi(), step=step, stop=stop, observers=[RerunRecorder(path, path.stem)])
    return path


def test_differences_are_b_minus_a_at_the_times_of_either(tmp_path: Path) -> None:
    """B has another step and ends earlier: both are interpolated, and there is no difference where one was not."""
    a = falling(tmp_path / "a.rrd", 2.0, 3 * MS, 30 * MS)
    b = falling(tmp_path / "b.rrd", 5.0, 2 * MS, 20 * MS)
    out = combine({"A": a, "two words/odd": b}, tmp_path / "all.rrd")
    found = signals(out)
    difference = found["diff.two words/odd.plant.m.pos"]
    assert difference.ns.tolist() == [k * MS for k in range(21) if k % 3 == 0 or k % 2 == 0]
    # both positions are linear in time, so interpolation is exact but for rounding of numbers near 1
    np.testing.assert_allclose(difference.values[:, 0], 3.0 * difference.ns * 1e-9, atol=4 * np.finfo(float).eps)
    assert difference.unit == "m"
    assert found["A.plant.m.pos"].ns.tolist() == signals(a)["m.pos"].ns.tolist()
    assert not any(".in." in port for port in found)


def test_a_peak_of_the_finer_run_is_not_lost() -> None:
    """A tooth of B between two points of A: at the times of A alone there would be no difference."""
    coarse, fine = np.array([0, 10, 20]), np.arange(0, 21, 2)
    tooth = np.where(fine == 4, 7.0, 0.0)
    ns, values = difference(coarse, np.zeros((3, 1)), fine, tooth[:, None])
    assert dict(zip(ns.tolist(), values[:, 0].tolist(), strict=True)) == dict(zip(fine.tolist(), tooth, strict=True))


@pytest.mark.parametrize("baseline", [None, "A", "B"])
def test_the_baseline_is_what_differences_are_to(tmp_path: Path, baseline: str | None) -> None:
    """It comes first, so it has the first colour and is the solid one of the scene."""
    logs = {name: falling(tmp_path / f"{name}.rrd", v, MS, 10 * MS) for name, v in (("A", 2.0), ("B", 5.0))}
    out = combine(logs, tmp_path / "all.rrd", baseline=baseline)
    base, other = ("B", "A") if baseline == "B" else ("A", "B")
    assert properties(out)["compare"] == {"variants": [base, other], "title": "all", "base": base}
    found = signals(out)
    a, b = (found[f"{name}.plant.m.pos"].values for name in (base, other))
    np.testing.assert_array_equal(found[f"diff.{other}.plant.m.pos"].values, b - a)
    assert f"diff.{base}.plant.m.pos" not in found


def test_a_baseline_that_is_none(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match=r"there is no variant 'uncontroled' to be the baseline; did you mean"):
        combine({"uncontrolled": tmp_path / "a.rrd"}, tmp_path / "all.rrd", baseline="uncontroled")


@pytest.fixture(scope="module")
def impacts(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, Path], Path]:
    """Return the logs of 20 ms of two variants of the ramp impact, and the combined one."""
    folder = tmp_path_factory.mktemp("compare")
    file, logs = find_scenario("ramp-impact"), {}
    for variant in ("uncontrolled", "pd"):
        scenario = file.load(variant, file.overrides(["run.duration=0.02"]))
        path = logs[variant] = folder / f"{variant}.rrd"
        execute(scenario, lambda a, i, r, path=path: [log_observer(a, path, i, r)])  # type: ignore[misc]
    return logs, combine(logs, folder / "all.rrd", title="T", report="# verdict", camera=Camera((0.6, 0.0, 0.2)))


def test_both_runs_are_in_it_bit_by_bit(impacts: tuple[dict[str, Path], Path]) -> None:
    logs, out = impacts
    found = signals(out)
    for variant, path in logs.items():
        own = {p: s for p, s in signals(path, "/plant/**").items() if ".in." not in p and s.values.shape[1] <= WIDEST}
        assert len(own) > 30
        for port, alone in own.items():
            component, _, name = port.partition(".")
            together = found[f"{variant}.plant.{component}.{name}"]
            assert together.values.tobytes() == alone.values.tobytes(), port
            assert (together.unit, together.names) == (alone.unit, alone.names)


def test_the_difference_of_every_output(impacts: tuple[dict[str, Path], Path]) -> None:
    logs, out = impacts
    found, a, b = signals(out), signals(logs["uncontrolled"], "/plant/**"), signals(logs["pd"], "/plant/**")
    common = [p for p, s in a.items() if p in b and ".in." not in p and s.values.shape[1] <= WIDEST]
    assert "wheels.normal_force" in common
    for port in common:
        component, _, name = port.partition(".")
        difference = found[f"diff.pd.plant.{component}.{name}"]
        # both were stepped to the same instants, so nothing is interpolated and the difference is exact
        np.testing.assert_array_equal(a[port].ns, b[port].ns)
        np.testing.assert_array_equal(difference.values, b[port].values - a[port].values, err_msg=port)
        assert difference.unit == a[port].unit


def test_the_curves_one_decides_by(impacts: tuple[dict[str, Path], Path]) -> None:
    logs, out = impacts
    found = signals(out)
    force = {v: signals(p)["wheels.normal_force"].values for v, p in logs.items()}
    gap = signals(logs["pd"])["wheels.deformation"].values
    for variant in logs:
        front = found[f"overlay.front_normal_force.{variant}"].values[:, 0]
        np.testing.assert_array_equal(front, force[variant][:, 0] + force[variant][:, 1])
    np.testing.assert_array_equal(found["overlay.rear_deformation.pd"].values[:, 0], 1e3 * gap[:, 2])
    both = [force[v][:, :2].sum(axis=1) for v in ("uncontrolled", "pd")]
    np.testing.assert_array_equal(found["overlay_diff.front_normal_force.pd"].values[:, 0], both[1] - both[0])
    for panel in PANELS:
        for port in (f"overlay.{panel.key}.pd", f"overlay_diff.{panel.key}.pd"):
            assert (found[port].unit, found[port].meaning) == (panel.unit, panel.title)
    assert {p.split(".")[1] for p in found if p.startswith("overlay.")} == {panel.key for panel in PANELS}


def test_properties_report_and_blueprint_are_in_it(impacts: tuple[dict[str, Path], Path]) -> None:
    logs, out = impacts
    found = properties(out)
    assert found["compare"] == {"variants": ["uncontrolled", "pd"], "title": "T", "base": "uncontrolled"}
    for variant, path in logs.items():
        assert found[f"{variant} metrics"] == {k: v for k, v in properties(path)["metrics"].items() if v is not None}
        assert found[f"{variant} run"]["config_json"] == properties(path)["run"]["config_json"]
    assert describe(out, ["nothing"])["status"] == "comparison"
    (report,) = RrdReader(str(out)).stream().filter(content="/report")
    assert "# verdict" in str(report.to_record_batch().to_pylist())
    assert [b.application_id for b in RrdReader(str(out)).blueprints()] == ["wmr_compare"]


def test_one_ground_and_one_robot_for_each(impacts: tuple[dict[str, Path], Path]) -> None:
    _, out = impacts
    drawn = {c.entity_path for c in RrdReader(str(out)).stream().filter(content="/world/**")}
    assert {"/world/ground/left", "/world/ground/right"} <= drawn
    assert {"/world/pd/robot/body", "/world/uncontrolled/robot/body"} <= drawn
    assert not any("ground" in path for path in drawn if not path.startswith("/world/ground"))


def newest(path: Path, entity: str, component: str) -> Any:
    """Return what the viewer shows of a static component: the value with the latest row id."""
    rows = []
    for chunk in RrdReader(str(path)).stream().filter(content=entity, is_static=True):
        batch = chunk.to_record_batch()
        if component in batch.schema.names:
            (row_id,) = (c for c, f in zip(batch.columns, batch.schema, strict=True) if f.name.endswith("RowId"))
            rows += zip(row_id.to_pylist(), batch.column(component).to_pylist(), strict=True)
    return max(rows)[1]


def test_the_tyres_of_a_ghost_let_others_be_seen(impacts: tuple[dict[str, Path], Path]) -> None:
    ghost = list(impacts[0])[1]
    (shown,) = newest(impacts[1], f"/world/{ghost}/robot/wheel_fl/tyre", "Mesh3D:albedo_factor")
    assert shown & 255 == 0  # two discs in one place would flicker; a spoke shows where the wheel is
    r, g, b = colour(1)
    spoke = newest(impacts[1], f"/world/{ghost}/robot/wheel_fl/spoke", "Boxes3D:colors")
    assert spoke == [(r << 24) + (g << 16) + (b << 8) + 255]


@pytest.mark.parametrize("part", ["robot/body/hull", "forces/normal"])
def test_each_robot_has_its_colour(impacts: tuple[dict[str, Path], Path], part: str) -> None:
    """The first is solid, the others are wires, so that all can be seen where they are at the same place."""
    kind = {"robot/body/hull": "Boxes3D", "forces/normal": "Arrows3D"}[part]
    for number, variant in enumerate(impacts[0]):
        r, g, b = colour(number)
        shown = newest(impacts[1], f"/world/{variant}/{part}", f"{kind}:colors")
        assert shown == [(r << 24) + (g << 16) + (b << 8) + 255]
        if kind != "Arrows3D":
            mode = newest(impacts[1], f"/world/{variant}/{part}", f"{kind}:fill_mode")
            assert mode == [
                int((rr.components.FillMode.MajorWireframe if number else rr.components.FillMode.Solid).value)
            ]


def test_a_panel_reads_what_there_is() -> None:
    panel = Panel("k", "t", "mm", "w.z", (0, 2), 1e3)
    assert panel.read(lambda port: None) is None
    assert panel.read(lambda port: np.ones((4, 2))) is None  # too few wheels
    np.testing.assert_array_equal(panel.read(lambda port: np.arange(8.0).reshape(2, 4)), [2e3, 10e3])


def test_a_file_that_cannot_be_written(tmp_path: Path) -> None:
    a = falling(tmp_path / "a.rrd", 2.0, 3 * MS, 30 * MS)
    with pytest.raises(ScenarioError, match="cannot write the combined log "):
        combine({"A": a, "B": a}, tmp_path / "none" / "all.rrd")


def test_many_variants_keep_the_curves_one_decides_by(tmp_path: Path, impacts: tuple[dict[str, Path], Path]) -> None:
    logs = {f"{name}{i}": path for i in range(2) for name, path in impacts[0].items()}
    assert len(logs) > ALL_DIFFERENCES
    found = signals(combine(logs, tmp_path / "all.rrd"))
    assert not any(port.startswith("diff.") for port in found)
    assert {f"overlay_diff.pitch.{name}" for name in list(logs)[1:]} <= set(found)
    assert not np.any(found["overlay_diff.pitch.uncontrolled1"].values)  # the same run twice
    assert [p.name for p in tmp_path.iterdir()] == ["all.rrd"]
