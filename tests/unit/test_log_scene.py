"""The scene shows where things were: poses and forces are those of the ports, and long runs stay small."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
import rerun as rr
from rerun.chunk import RrdReader
from scipy.spatial.transform import Rotation

import studies
from cosim.system import System
from logs.scene import LONGEST, MARK_EVERY, Scene, _axles, _upright
from studies.assembly import assemble
from studies.drawn import scene

MS = 1_000_000
FLAT = np.column_stack([np.linspace(-1, 9, 11), np.zeros(11)])
Drawn = dict[str, list[tuple[int, dict[str, Any]]]]
N = 400  # steps of 1 ms at 2 m/s


def ports(gap: np.ndarray) -> dict[str, np.ndarray]:
    """Return a robot that rolls along x at 2 m/s, turned by 0.3 rad nose up, its wheels *gap* (n, 4) above ground."""
    n = len(gap)
    x = 2e-3 * np.arange(n)
    half = -0.15  # nose up is a turn about -y
    offset = np.array([[0.6, 0.29, 0], [0.6, -0.29, 0], [-0.46, 0.29, 0], [-0.46, -0.29, 0]])
    centre = offset[None] + np.stack([x[:, None] + np.zeros(4), np.zeros((n, 4)), 0.1 + gap], axis=2)
    up = np.tile([0.0, 0.0, 1.0], (n, 4, 1))
    return {
        "body.position": np.column_stack([x, np.zeros(n), np.full(n, 0.4)]),
        "body.orientation": np.tile([np.cos(half), 0, np.sin(half), 0], (n, 1)),
        "body.wheel_centre": centre,
        "body.contact_velocity": np.tile([2.0, 0.0], (n, 4, 1)),
        "body.contact_normal": up,
        "body.traction_direction": np.tile([1.0, 0.0, 0.0], (n, 4, 1)),
        "body.gap": gap,
        "wheels.normal_force": np.tile([100.0, 200.0, 300.0, 400.0], (n, 1)),
        "wheels.traction": np.tile([10.0, -20.0, 0.0, 5.0], (n, 1)),
    }


def drawn(tmp_path: Path, gap: np.ndarray, chunk: int = 50, **settings: Any) -> Drawn:
    """Draw a run in chunks and return its entities: rows of (ns, components)."""
    path = tmp_path / "scene.rrd"
    scene = Scene(0.1, 0.29, 0.6, 0.46, 0.4, FLAT, FLAT, force_scale=1e-3, **settings)
    recording = rr.RecordingStream("scene", recording_id="x")
    recording.save(str(path))
    rr.set_log_time_enabled(False, recording=recording)
    scene.started(recording, System({}, {}))
    values = ports(gap)
    for first in range(0, len(gap), chunk):
        rows = slice(first, first + chunk)
        numbers = np.arange(len(gap))[rows]

        def read(port: str, rows: slice = rows) -> np.ndarray | None:
            return values[port][rows] if port in values else None

        scene.emit(recording, numbers * MS, numbers, read)
    recording.flush()
    recording.disconnect()
    found: Drawn = {}
    for part in RrdReader(str(path)).stream().filter(content="/world/**", is_static=False):
        batch = part.to_record_batch()
        times = batch.column("sim_time").cast(pa.int64()).to_pylist()
        rows = list(zip(times, batch.to_pylist(), strict=True))
        found.setdefault(part.entity_path.removeprefix("/world/"), []).extend(rows)
    return found


def column(rows: list[tuple[int, dict]], name: str) -> np.ndarray:
    return np.array(
        [next(v for k, v in row.items() if k.endswith(name)) for _, row in sorted(rows, key=lambda r: r[0])]
    )


def test_poses_are_those_of_the_ports(tmp_path: Path) -> None:
    found, values = drawn(tmp_path, np.zeros((N, 4)), interval=4e-3), ports(np.zeros((N, 4)))
    frames = slice(0, N, 4)
    np.testing.assert_array_equal(
        column(found["robot/body"], ":translation")[:, 0], values["body.position"][frames].astype(np.float32)
    )
    wheel = column(found["robot/wheel_rr"], ":translation")[:, 0]
    np.testing.assert_array_equal(wheel, values["body.wheel_centre"][frames, 3].astype(np.float32))
    xyzw = column(found["robot/body"], ":quaternion")[:, 0]
    np.testing.assert_allclose(xyzw[0], [0, np.sin(-0.15), 0, np.cos(-0.15)], atol=1e-7)  # single precision


def test_wheels_roll_as_far_as_they_drive(tmp_path: Path) -> None:
    """At 2 m/s a wheel of 0.1 m turns by 20 rad/s, whatever the chunks are."""
    whole = column(drawn(tmp_path, np.zeros((N, 4)), chunk=N)["robot/wheel_fl/spoke"], ":quaternion")
    parts = column(drawn(tmp_path, np.zeros((N, 4)), chunk=7)["robot/wheel_fl/spoke"], ":quaternion")
    np.testing.assert_allclose(whole, parts, atol=1e-6)  # single precision
    first, later = (Rotation.from_quat(q[0]) for q in (whole[0], whole[25]))  # 50 ms later: 1 rad, about the axle
    np.testing.assert_allclose((later * first.inv()).as_rotvec(), [0, 1, 0], atol=1e-6)


def test_arrows_are_the_forces(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    found = drawn(tmp_path, np.zeros((N, 4)))
    normal = column(found["forces/normal"], ":vectors")
    np.testing.assert_allclose(normal[3], 1e-3 * np.array([[0, 0, f] for f in (100, 200, 300, 400)]), rtol=1e-6)
    traction = column(found["forces/traction"], ":vectors")
    np.testing.assert_allclose(traction[3], 1e-3 * np.array([[f, 0, 0] for f in (10, -20, 0, 5)]), rtol=1e-6)
    strong = {**ports(np.zeros((N, 4))), "wheels.normal_force": np.full((N, 4), 1e6)}
    monkeypatch.setattr(sys.modules[__name__], "ports", lambda gap: strong)
    longest = column(drawn(tmp_path, np.zeros((N, 4)))["forces/normal"], ":vectors")[0]
    np.testing.assert_allclose(longest[:, 2], LONGEST * 0.1, rtol=1e-6)
    origin = column(found["forces/normal"], ":origins")[0]
    np.testing.assert_allclose(origin[:, 2], 0, atol=1e-7)  # at the ground
    assert np.all(np.abs(origin[:, 1]) > 0.29)  # beside the tyre, outside


def test_frames_are_as_rare_as_asked_for(tmp_path: Path) -> None:
    found = drawn(tmp_path, np.zeros((N, 4)), interval=10e-3)
    assert [ns for ns, _ in sorted(found["robot/body"], key=lambda r: r[0])] == [k * 10 * MS for k in range(N // 10)]


def test_every_flight_is_marked_and_long_ones_by_their_length(tmp_path: Path) -> None:
    gap = np.zeros((N, 4))
    gap[101, 2] = 1e-6  # one step only, between two frames
    gap[200:300, 0] = 5e-3  # 0.2 m
    marks = drawn(tmp_path, gap, interval=10e-3)["flights"]
    points = column(marks, ":positions")[:, 0]
    assert np.count_nonzero(np.abs(points[:, 0] - (2e-3 * 101 - 0.46)) < 1e-6) == 1
    # a mark is at least MARK_EVERY behind the last; steps are 2 mm, so it is at most 2 mm more
    assert 0.2 / (MARK_EVERY + 2e-3) <= np.count_nonzero(points[:, 1] > 0) - 1 <= 0.2 / MARK_EVERY + 1
    np.testing.assert_allclose(points[:, 2], 0, atol=1e-7)  # on the ground below


def test_a_robot_that_stands_in_the_air_is_marked_once(tmp_path: Path) -> None:
    """Marks are bounded by the way, not by the time."""
    scene = Scene(0.1, 0.29, 0.6, 0.46, 0.4, FLAT, FLAT)
    sent: list[int] = []

    class Recording:
        def send_columns(self, path: str, index: Any, columns: Any) -> None:
            sent.append(len(index[0].as_arrow_array()))

    centres = np.tile([[[0.6, 0.3, 0.2]] * 4], (1000, 1, 1))
    for k in range(5):
        ns = np.arange(1000) + 1000 * k
        scene._flights(Recording(), ns, ns, centres, np.full((1000, 4), 0.1))
    assert sent == [4]


def test_wheels_steer_about_the_body_and_stand_on_the_ground() -> None:
    """Steered by 90 degrees to the left on a body that is turned by as much, the axle of a wheel points backwards."""
    yaw = np.array([[np.sqrt(0.5), 0, 0, np.sqrt(0.5)]])
    axles = _axles(yaw, np.array([[np.pi / 2, 0, 0, -np.pi / 2]]))
    np.testing.assert_allclose(axles[0, [0, 1, 3]], [[0, -1, 0], [-1, 0, 0], [0, 1, 0]], atol=1e-15)
    normals = np.tile(np.array([np.sin(0.3), 0, np.cos(0.3)]), (1, 4, 1))
    upright = _upright(axles, normals)
    np.testing.assert_allclose(np.linalg.det(upright), 1, rtol=1e-12)
    np.testing.assert_allclose(upright[0, 0, :, 2], normals[0, 0], atol=1e-15)  # the axle lies across the slope
    np.testing.assert_allclose(upright[0, 1, :, 2], [0, 0, 1], atol=1e-15)  # here it points along it


def test_the_axles_lean_with_the_body() -> None:
    roll = np.array([[np.cos(0.1), np.sin(0.1), 0, 0]])  # by 0.2 rad to the right: the left side goes up
    np.testing.assert_allclose(_axles(roll, None)[0, 2], [0, np.cos(0.2), np.sin(0.2)], rtol=1e-12)


def test_limits_are_drawn_along_the_force_or_ahead(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Traction and lateral force make one arrow; its limit points the same way, or ahead without a force."""
    known = {
        **ports(np.zeros((N, 4))),
        "wheels.lateral": np.tile([10.0, 0.0, 0.0, 0.0], (N, 1)),
        "wheels.friction_limit": np.tile([100.0, 200.0, 300.0, 400.0], (N, 1)),
    }
    monkeypatch.setattr(sys.modules[__name__], "ports", lambda gap: known)
    found = drawn(tmp_path, np.zeros((N, 4)))
    along, limit = (column(found[f"forces/{what}"], ":vectors")[0] for what in ("traction", "limit"))
    np.testing.assert_allclose(along[0], [0.01, 0.01, 0], atol=1e-9)
    diagonal = 0.1 * np.sqrt(0.5)
    np.testing.assert_allclose(limit, [[diagonal, diagonal, 0], [-0.2, 0, 0], [0.3, 0, 0], [0.4, 0, 0]], atol=1e-7)
    assert "forces/limit" not in drawn(tmp_path, np.zeros((N, 4)), limited=False)


def test_tyres_are_flattened_by_their_deformation(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    known = {**ports(np.zeros((N, 4))), "wheels.deformation": np.tile([-5e-3, 0.0, 5e-3, -1e-3], (N, 1))}
    monkeypatch.setattr(sys.modules[__name__], "ports", lambda gap: known)
    found = drawn(tmp_path, np.zeros((N, 4)), flattening=3.0)
    lowest = [column(found[f"robot/wheel_{w}/tyre"], ":vertex_positions")[0, :, 2].min() for w in ("fl", "fr", "rl")]
    np.testing.assert_allclose(lowest, [-0.095, -0.1, -0.1], atol=1e-7)


def test_the_caption_says_how_much_is_exaggerated() -> None:
    """It names the longest arrow, too: 8 radii of 0.1 m are 1.6 kN at 5e-4 m/N."""
    assert "to 1.6 kN" in (caption := Scene(0.1, 0.29, 0.6, 0.46, 0.4, FLAT, FLAT, flattening=20.0).caption)
    assert "flats x20" in caption
    assert "flats" not in Scene(0.1, 0.29, 0.6, 0.46, 0.4, FLAT, FLAT).caption


def test_traction_at_the_centres_is_drawn_there(tmp_path: Path) -> None:
    """The choice is a structural parameter of the body; normal forces act at the ground all the same."""
    found = drawn(tmp_path, np.zeros((N, 4)), at_centre=True)
    heights = {what: column(found[f"forces/{what}"], ":origins")[0][:, 2] for what in ("normal", "traction")}
    np.testing.assert_allclose(heights["traction"] - heights["normal"], 0.1, atol=1e-6)
    asked = studies.scenario("ramp-impact", body={"type": "RigidBody", "traction_arm": "centre"})
    assert scene(assemble(asked)).at_centre
    assert not scene(assemble(studies.scenario("ramp-impact"))).at_centre
