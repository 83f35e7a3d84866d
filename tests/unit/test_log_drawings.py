"""What is drawn beside the scene: tyres, contact states, energy, the chassis, the block diagram, views of questions."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rerun.chunk import RrdReader

from cosim.errors import ScenarioError
from logs import tyre
from logs.blueprint import answered, question
from logs.chassis_map import DOWN, LEVEL, UP, ChassisMap, coloured, scales, spectrum
from logs.diagram import LATE, NOW, graph
from logs.drawing import Frames, nice
from logs.parts import by_parts
from logs.questions import QUESTIONS, Camera, Look
from logs.read import properties, signals
from logs.states import CHANGES, FLIES, LIMIT, TOTAL, TOUCHES, ContactStates
from studies import session
from studies.assembly import assemble
from studies.catalog import find_scenario
from studies.drawn import chassis

R, WIDTH = 0.1, 0.06


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the log of 0.1 s of the step under one wheel, which starts right before it."""
    changes = ["run.duration=0.1", "start.x=0.07"]
    path = session.run_one("one-wheel-step", "soft", changes, tmp_path_factory.mktemp("drawn"), quiet=True).log
    assert path is not None
    return path


def rows(log: Path, entity: str, *, static: bool = False) -> list[dict[str, Any]]:
    found = RrdReader(str(log)).stream().filter(content=f"/{entity}", is_static=static)
    return [row for chunk in found for row in chunk.to_record_batch().to_pylist()]


def value(row: dict[str, Any], name: str) -> Any:
    return next(v for key, v in row.items() if key.endswith(name))


# tyres


def test_a_pressed_tyre_stands_on_the_ground() -> None:
    """Whatever the factor, its lowest point lies R - d below the centre; its flat is as long as factor d makes it."""
    pressed = np.array([0.0, 1e-3, 4e-3])
    for factor in (1.0, 10.0):
        vertices = tyre.shape(R, WIDTH, pressed, factor)
        np.testing.assert_allclose(vertices[:, :, 2].min(axis=1)[1:], -(R - pressed[1:]), rtol=1e-12)
        flat = np.abs(vertices[2, :, 2] + R - pressed[2]) < 1e-12
        length = np.ptp(vertices[2, flat, 0])
        assert length == pytest.approx(2 * np.sqrt(R**2 - (R - factor * pressed[2]) ** 2), rel=1e-9)
    np.testing.assert_allclose(np.linalg.norm(tyre.shape(R, WIDTH, pressed[:1], 10.0)[0, :-2, ::2], axis=1), R)


def test_the_triangles_of_a_tyre_face_outwards() -> None:
    vertices, triangles = tyre.shape(R, WIDTH, np.zeros(1), 1.0)[0], tyre.triangles()
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    assert np.all(np.sum(np.cross(b - a, c - a) * (a + b + c), axis=1) > 0)
    assert len(tyre.normals()) == len(vertices)
    assert len(vertices) % 3 == 0  # or the viewer complains while it has vertices and not yet triangles


# contact states


class Sent:
    """A recording that keeps what it is sent."""

    def __init__(self) -> None:
        self.states: dict[str, list[tuple[int, str]]] = {}

    def send_columns(self, path: str, index: Any, columns: Any) -> None:
        if path.startswith("contact"):
            (column,) = columns
            times = [int(t) for t in index[1].as_arrow_array().to_pylist()]
            texts = [t for row in column.as_arrow_array().to_pylist() for t in row]
            self.states.setdefault(path, []).extend(zip(times, texts, strict=True))


def test_states_are_sent_at_changes_only_whatever_the_chunks_are() -> None:
    contact = np.ones((100, 4))
    contact[20:40, 0] = 0
    limit = np.where(contact > 0, 50.0, 0.0)
    traction = np.zeros((100, 4))
    traction[60:70, 1] = -50.0
    ports = {"wheels.contact": contact, "wheels.traction": traction, "wheels.friction_limit": limit}
    for chunk in (7, 20, 100):
        sent, states = Sent(), ContactStates()
        for first in range(0, 100, chunk):
            part = slice(first, first + chunk)
            number = np.arange(100)[part]
            states.emit(sent, number, number, {port: values[part] for port, values in ports.items()}.get)
        assert sent.states["contact/fl"] == [(0, TOUCHES), (20, FLIES), (40, TOUCHES)]
        assert sent.states["contact/fr"] == [(0, TOUCHES), (60, LIMIT), (70, TOUCHES)]
        assert sent.states["contact/rl"] == [(0, TOUCHES)]


def test_a_wheel_that_slides_on_less_than_static_friction_is_shown_as_sliding() -> None:
    """Rubber rings hold 0.3 of their load while they slide, 0.8 at rest: their force never is at the limit."""
    number, share = np.arange(30), np.zeros((30, 4))
    share[10:20, 2], share[10:20, 3] = 1.0, 0.5  # the ends of a patch that rolls under traction slide, too
    ports = {
        "body.contact": np.ones((30, 4)), "body.traction": np.full((30, 4), 30.0),
        "body.friction_limit": np.full((30, 4), 80.0), "body.sliding": share,
    }  # fmt: skip
    for limited, shown in ((True, [(0, TOUCHES), (10, LIMIT), (20, TOUCHES)]), (False, [(0, TOUCHES)])):
        sent = Sent()
        ContactStates(limited=limited).emit(sent, number, number, by_parts(ports.get))
        assert sent.states["contact/rl"] == shown
        assert sent.states["contact/rr"] == [(0, TOUCHES)]


def test_a_chattering_contact_does_not_fill_the_log() -> None:
    sent, number = Sent(), np.arange(3 * CHANGES)
    contact = np.tile((number % 2)[:, None].astype(float), (1, 4))
    ContactStates().emit(sent, number, number, {"wheels.contact": contact}.get)
    assert CHANGES / 2 < len(sent.states["contact/rr"]) <= CHANGES


def test_the_traction_of_all_wheels_is_their_sum(log: Path) -> None:
    each = signals(log, "/plant/wheels/traction")["wheels.traction"]
    total = [value(row, ":scalars")[0] for row in rows(log, TOTAL)]
    assert sorted(total) == sorted(each.values.sum(axis=1))


# energy


def test_the_energy_residual_is_what_the_splitting_leaves(tmp_path: Path) -> None:
    """PD traction works on the body: 100 J and more.  What is left is a part in 1e5 of it and falls with the step."""
    left = []
    for step in ("2e-4", "1e-4"):
        changes = ["run.duration=0.2", f"run.step={step}"]
        run = session.run_one("ramp-impact-realistic", "pd", changes, tmp_path / step, quiet=True)
        assert run.log is not None
        left.append(max(abs(value(row, ":scalars")[0]) for row in rows(run.log, "master/energy_residual")))
        energy = run.result.signal("body.kinetic_energy")
        assert energy is not None
        assert np.ptp(energy) > 50
    assert left[1] < 1e-5 * 50
    assert left[1] < left[0] / 2  # second order would be 4


def test_the_energy_residual_knows_where_traction_acts(tmp_path: Path) -> None:
    """At the centres of the wheels: taken as if it acted at the ground, more than 1 J would be left over."""
    changes = ["run.duration=0.2", 'body.type="RigidBody"', 'body.traction_arm="centre"']
    path = session.run_one("ramp-impact-realistic", "pd", changes, tmp_path, quiet=True).log
    assert path is not None
    assert max(abs(value(row, ":scalars")[0]) for row in rows(path, "master/energy_residual")) < 1e-5 * 50


# the chassis


def test_the_plate_is_bent_and_coloured_as_the_ports_say(log: Path) -> None:
    scenario = find_scenario("one-wheel-step").load("soft")
    plate = chassis(assemble(scenario))
    assert plate is not None
    q = signals(log, "/plant/chassis/modal_displacement")["chassis.modal_displacement"]
    acceleration = signals(log, "/plant/chassis/acceleration")["chassis.acceleration"]
    drawn = rows(log, "chassis/plate")
    assert 30 <= len(drawn) <= 51  # every 2 ms at most
    for row in (drawn[0], drawn[-1]):
        ns = (
            row["sim_time"].value if hasattr(row["sim_time"], "value") else round(row["sim_time"].total_seconds() * 1e9)
        )
        at = int(np.argmin(np.abs(q.ns - ns)))
        vertices = np.array(value(row, ":vertex_positions"))[:20]
        np.testing.assert_allclose(vertices[:, 2], plate.factor * plate.shape @ q.values[at], atol=1e-6)
        expected = coloured(acceleration.values[at] / plate.limit)
        packed = np.array(value(row, ":vertex_colors"), dtype=np.uint32)[:20]
        np.testing.assert_array_equal(np.stack([packed >> 24, packed >> 16 & 255, packed >> 8 & 255], axis=1), expected)


def test_stations_lie_row_by_row_from_the_front_left() -> None:
    plate = ChassisMap(5, 4, 1.0, 0.6, np.ones(1), np.zeros((20, 1)), 1.0, 1.0)._plate()
    np.testing.assert_allclose(plate[[0, 3, 16, 19], :2], [[0.5, 0.3], [0.5, -0.3], [-0.5, 0.3], [-0.5, -0.3]])


def test_colours_end_at_the_limit() -> None:
    np.testing.assert_array_equal(coloured(np.array([-5.0, -1.0, 0.0, 1.0, 5.0])), [DOWN, DOWN, LEVEL, UP, UP])


def test_scales_come_from_the_load_at_rest() -> None:
    """One mode, one station: k = (2 pi f)^2 per unit of mass, so 100 N bend it by 100 / k and would start it at 100."""
    limit, factor = scales(np.array([5.0]), np.ones((1, 1)), np.array([[1.0], [0], [0], [0]]), np.full(4, 100.0))
    assert limit == 50.0
    assert factor == nice(0.02 * (10 * np.pi) ** 2 / 100)


def test_a_spectrum_shows_a_sine_at_its_frequency() -> None:
    time = np.linspace(0, 1, 4001)
    frequency, amplitude = spectrum(time, 3 * np.sin(2 * np.pi * 60 * time), 150.0)
    assert frequency[np.argmax(amplitude)] == pytest.approx(60, abs=0.5)
    assert amplitude.max() == pytest.approx(3, rel=1e-3)


# the diagram


def test_every_wire_is_in_the_table_with_its_unit_and_delay(log: Path) -> None:
    """Gauss-Seidel, controller, wheels, body, chassis: what goes back is one step late, what goes on is new."""
    (row,) = rows(log, "wires", static=True)
    table = value(row, ":text")[0]
    assert "| body.gap | wheels.gap | m | 1 |" in table
    assert "| wheels.normal_force | body.normal_force | N | 0 |" in table
    assert "| body.wheel_force | chassis.wheel_force | N | 0 |" in table


def test_bundles_lie_between_their_blocks_and_late_ones_to_the_left() -> None:
    nodes, edges = graph(("a", "b"), {("a", "b", 0): ["x [m]"], ("b", "a", 1): ["y [N]", "z [s]"]})
    assert nodes.positions is not None
    places = np.array(nodes.positions.as_arrow_array().to_pylist())
    assert nodes.labels is not None
    labels = nodes.labels.as_arrow_array().to_pylist()
    assert labels[2:] == ["no delay:\nx [m]", "1 step late:\ny [N]\nz [s]"]
    assert places[2, 0] > 0 > places[3, 0]
    assert edges.edges is not None
    assert len(edges.edges.as_arrow_array()) == 4
    assert NOW != LATE


# views


def test_a_log_says_how_it_opens(log: Path) -> None:
    look = Look.of(properties(log)["look"])
    assert look.view == "shock"  # of the scenario
    assert look.camera is not None
    assert "bent" in look.captions["chassis"]
    assert Look.of({}) == Look()
    kept = Look("health", Camera((1.0, 2.0, 3.0), True), {"scene": "s"})
    assert Look.of(kept.table()) == kept


def test_only_questions_with_an_answer_are_asked() -> None:
    assert answered(["wheels.normal_force", "body.jerk_body", "chassis.acceleration"]) == list(QUESTIONS)
    assert answered(["motor.angle"]) == ["health"]
    with pytest.raises(ScenarioError, match=r"no view 'shock'"):
        question("shock", ["motor.angle"])


# helpers


def test_frames_are_as_rare_as_asked_for_whatever_the_chunks_are() -> None:
    ns = np.arange(1000) * 1000
    whole = list(ns[Frames(10e-6).of(ns)])
    frames = Frames(10e-6)
    parts = [int(part[i]) for part in np.array_split(ns, 37) for i in frames.of(part)]
    assert parts == whole == list(range(0, 1_000_000, 10_000))


def test_nice_numbers() -> None:
    assert [nice(x) for x in (0.7, 1.0, 1.1, 3.0, 5.1, 120.0)] == [1.0, 1.0, 2.0, 5.0, 10.0, 200.0]
