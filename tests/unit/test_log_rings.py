"""The scene of rubber rings: every node where it is, its distance from round exaggerated, the forces that act on it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import rerun as rr
from rerun.chunk import RrdReader

import studies
from cosim.system import System
from logs.rings import RingScene
from logs.style import WHEELS
from studies.assembly import assemble
from studies.drawn import scene

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
