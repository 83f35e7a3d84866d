"""The log of a robot on rubber rings: every node where it is, and all that the log of a robot of parts shows."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
import rerun as rr
from rerun.chunk import RrdReader

import studies
from cosim import Component, Record, run
from cosim.clock import ticks
from cosim.system import System
from logs.blueprint import question_of
from logs.compare import combine
from logs.inspect import describe
from logs.jerk import WINDOW, jerk
from logs.panels import PANELS
from logs.questions import QUESTIONS
from logs.read import properties, signals
from logs.rings import RingScene
from logs.states import FLIES, TOUCHES
from logs.style import WHEELS
from plants import rover
from studies.assembly import Assembly, assemble
from studies.drawn import scene
from studies.logged import log_observer
from studies.runner import algorithm_of, connect

NODES, R, FACTOR, SCALE = 16, 0.1, 5.0, 1e-3
GROUND = np.column_stack([np.linspace(-1, 9, 11), np.zeros(11)])
ANGLE = 2 * np.pi * np.arange(NODES) / NODES
HUBS = np.array([[0.6, 0.29, 0.098], [0.6, -0.29, 0.098], [-0.46, 0.29, 0.098], [-0.46, -0.29, 0.098]])


def ports(n: int) -> dict[str, np.ndarray]:
    """Return a robot that stands: rings round but for the lowest node, which is 2 mm further in and pressed."""
    radius = np.where(np.arange(NODES) == NODES // 2, R - 2e-3, R)
    nodes = [hub + np.column_stack([radius * np.sin(ANGLE), 0 * ANGLE, radius * np.cos(ANGLE)]) for hub in HUBS]
    normal, friction = np.zeros((NODES, 12)), np.zeros((NODES, 12))
    normal[NODES // 2, 2::3], friction[NODES // 2, 0::3] = [100, 200, 300, 1e6], [-20, 0, 0, 40]
    stands = {
        "position": [0, 0, 0.498], "orientation": [1, 0, 0, 0], "wheel_centre": HUBS, "contact_normal": [[0, 0, 1]] * 4,
        "contact_velocity": np.zeros((4, 2)), "traction_direction": [[1, 0, 0]] * 4, "ring_nodes": np.hstack(nodes),
        "ring_normal": normal, "ring_friction": friction,
    }  # fmt: skip
    return {f"body.{name}": np.tile(value, (n, *[1] * np.ndim(value))).astype(float) for name, value in stands.items()}


def test_rings_and_forces_are_those_of_the_ports(tmp_path: Path) -> None:
    path, values = tmp_path / "rings.rrd", ports(3)
    drawing = RingScene(R, 0.29, 0.6, 0.46, 0.4, GROUND, GROUND, SCALE, flattening=FACTOR)
    recording = rr.RecordingStream("rings", recording_id="x")
    recording.save(str(path))
    drawing.started(recording, System({}, {}))
    drawing.emit(recording, np.arange(3) * 10**7, np.arange(3), values.get)
    recording.flush()
    recording.disconnect()
    found: dict[str, list[dict[str, Any]]] = {}
    for part in RrdReader(str(path)).stream().filter(content="/world/**", is_static=False):
        batch = part.to_record_batch()
        assert batch.column("sim_time").cast(pa.int64()).to_pylist() == [0, 10**7, 2 * 10**7]
        found.setdefault(part.entity_path.removeprefix("/world/"), []).extend(batch.to_pylist())
    assert not any("tyre" in entity for entity in found)

    def column(entity: str, name: str) -> Any:
        return np.array(next(v for k, v in found[entity][-1].items() if k.endswith(name)))

    for k, wheel in enumerate(WHEELS):
        left, right = column(f"robot/ring_{wheel}", ":strips")
        np.testing.assert_array_equal(left[0], left[-1])  # closed
        middle = (left + right)[:-1] / 2 - HUBS[k]
        distance = np.hypot(middle[:, 0], middle[:, 2])
        expected = np.where(np.arange(NODES) == NODES // 2, R - FACTOR * 2e-3, R)
        np.testing.assert_allclose(distance, expected, atol=1e-7)  # single precision
    arrows = column("forces/normal", ":vectors")
    # in m; the last one is as long as any may be
    np.testing.assert_allclose(arrows, [[0, 0, z] for z in (0.1, 0.2, 0.3, 0.8)], atol=1e-6)
    np.testing.assert_allclose(column("forces/friction", ":vectors"), [[-0.02, 0, 0], [0.04, 0, 0]], atol=1e-6)
    at = HUBS[[0, 3]] - [0, 0, R - FACTOR * 2e-3]
    np.testing.assert_allclose(column("forces/friction", ":origins"), at, atol=1e-6)


def test_a_scenario_that_shows_its_rings_is_drawn_with_them() -> None:
    """Rings of 2.8e6 N/m sink in by 0.15 mm under the weight: 6 % of a radius are 40 times that."""
    hidden = scene(assemble(studies.scenario("full-order-ramp")))
    shown = scene(assemble(studies.scenario("full-order-ramp", body={"seen": 32})))
    assert not isinstance(hidden, RingScene)
    assert isinstance(shown, RingScene)
    assert shown.flattening == 50
    assert "x50" in shown.caption


# a run: everything that the log of a robot of parts shows

STEP = 1e-4  # s


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> tuple[Assembly, Path]:
    """Return a robot of coarse rings and the log of its first 30 ms: gravity rises in 10 ms, and it meets the ramp.

    As Python objects: an FMU of that many nodes would have to be built for this alone.
    """
    coarse = {"gravity_time": 0.01, "nodes": NODES, "points": 2 * NODES, "seen": NODES, "chassis": {"modes": 5}}
    asked = studies.scenario("full-order-ramp", "realistic", ground={"start": 0.64}, body=coarse)
    made, path, record = assemble(asked), tmp_path_factory.mktemp("whole") / "whole.rrd", Record()
    instances = {name: part.instance(name) for name, part in made.components.items() if isinstance(part, Component)}
    rover.apply(made.starts, instances)
    with connect(made, instances) as system:
        observers = [record, log_observer(made, path, instances, record)]
        step = ticks(STEP, "step")
        run(system, algorithm_of(made), step=step, stop=300 * step, observers=observers)
    return made, path


def asked_for(view: Any) -> list[str]:
    """Return the entities that a view, or the views in a container, show; of a scene where it begins."""
    if hasattr(view, "root_container"):
        return asked_for(view.root_container)
    if not hasattr(view, "origin"):
        return [entity for part in view.contents for entity in asked_for(part)]
    listed = [str(c) for c in view.contents] if isinstance(view.contents, list) else []
    return [c for c in listed if "*" not in c] if view.origin == "/" else [view.origin]


@pytest.mark.parametrize("name", QUESTIONS)
def test_the_log_has_what_every_question_shows(name: str, whole: tuple[Assembly, Path]) -> None:
    log = whole[1]
    there = {chunk.entity_path for chunk in RrdReader(str(log)).stream()}
    wanted = asked_for(question_of(name, log))
    assert len(wanted) >= 5
    missing = [w for w in wanted if not any(t == w or t.startswith(f"{w}/") for t in there)]
    assert not missing


def test_wheels_first_hang_and_then_touch(whole: tuple[Assembly, Path]) -> None:
    found = RrdReader(str(whole[1])).stream().filter(content="/contact/fl", is_static=False)
    states = [v[0] for c in found for row in c.to_record_batch().to_pylist() for k, v in row.items() if "tate" in k]
    assert states == [FLIES, TOUCHES]


def test_the_energy_of_the_whole_robot_is_accounted_for(whole: tuple[Assembly, Path]) -> None:
    """Less than 1e-3 of what moves is left over, as in the balances; contacts alone hold a hundred times as much."""
    found = signals(whole[1])
    moving = np.ptp(found["body.kinetic_energy"].values)
    assert np.max(np.abs(found["master.energy_residual"].values)) < 1e-3 * moving
    assert np.max(found["body.contact_energy"].values) > 0.1 * moving
    assert np.max(found["body.dissipated_energy"].values) > 0.1 * moving


def test_stations_feel_the_modal_equation(whole: tuple[Assembly, Path]) -> None:
    """7.10 with means over each step; by the trapezoidal rule that of q is off by up to q'' dt^2 / 8."""
    found, values = signals(whole[1]), whole[0].components["body"].values  # type: ignore[union-attr]
    w, q = 2 * np.pi * values["frequency"], found["body.modal_displacement"].values
    rate, mean = np.diff(q, axis=0) / STEP, (q[1:] + q[:-1]) / 2
    force = found["body.wheel_force"].values[1:] @ values["wheel_shape"]
    modal = force - 2 * values["damping"] * w * rate - w**2 * mean
    bound = np.max(np.abs(modal), axis=0) * (w * STEP) ** 2 / 8 @ np.abs(values["station_shape"].T)
    given = found["body.station_acceleration"].values
    assert np.max(np.abs(given)) > 1e3 * np.max(bound)
    assert np.all(np.abs(given[1:] - modal @ values["station_shape"].T) < bound)
    elastic = found["body.strain_energy"].values[:, 0]
    np.testing.assert_allclose(elastic, np.sum((w * q) ** 2, axis=1) / 2, rtol=1e-12)
    metrics = properties(whole[1])["metrics"]
    assert metrics["station_peak"] == pytest.approx(np.max(np.abs(given)) / 9.81, rel=1e-3)


def test_signals_of_its_wheels_are_found_by_their_usual_name(whole: tuple[Assembly, Path]) -> None:
    facts = describe(whole[1], ["wheels.normal_*", "chassis.acceleration"])
    assert set(facts["signals"]) == {"body.normal_force", "body.normal_force_end", "body.station_acceleration"}
    assert facts["read_as"]["wheels.normal_*"] == "body.normal_*"
    assert describe(whole[1], ["body.pitch"])["read_as"] == {}


def test_it_is_compared_by_the_same_curves(whole: tuple[Assembly, Path], tmp_path: Path) -> None:
    path = combine({"one": whole[1], "other": whole[1]}, tmp_path / "all.rrd")
    found = signals(path, "/overlay/**") | signals(path, "/overlay_diff/**")
    both = {f"overlay.{p.key}.{v}" for p in PANELS for v in ("one", "other")}
    assert set(found) == both | {f"overlay_diff.{p.key}.other" for p in PANELS}
    painted = RrdReader(str(path)).stream().filter(content="/world/other/robot/ring_fl", is_static=True)
    assert any("LineStrips3D:colors" in c.to_record_batch().schema.names for c in painted)


def test_jerk_over_a_window_is_exact_for_a_cubic_velocity() -> None:
    time = np.arange(101) * 1e-3
    velocity = np.column_stack([time**3, 2 * time**2, time])
    means = np.vstack([np.zeros(3), np.diff(velocity, axis=0) / 1e-3])
    at, found = jerk(time, means)
    assert (time[at[0]], time[at[-1]]) == pytest.approx((WINDOW, 0.1 - WINDOW))
    expected = np.column_stack([6 * time[at], np.full(len(at), 4.0), np.zeros(len(at))])
    np.testing.assert_allclose(found, expected, atol=1e-10)


def test_laid_on_traction_has_no_limit_worth_drawing() -> None:
    assert scene(assemble(studies.scenario("full-order-ramp", "uncontrolled"))).limited
    assert not scene(assemble(studies.scenario("full-order-ramp", "pd"))).limited
