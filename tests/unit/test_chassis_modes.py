"""Modal data in files: what is written is read, and what is wrong is said with file and key."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cosim.errors import ScenarioError
from plants.chassis import chassis
from plants.chassis_modes import ModalData, load_modal_data

DATA = ModalData(
    np.array([24.0, 26.4, 54.5]),
    np.full(3, 5e-5),
    np.arange(12.0).reshape(4, 3) / 7,
    np.ones((2, 3)) / 3,
    ("nose", "tail"),
)


def test_round_trip_keeps_every_bit(tmp_path: Path) -> None:
    DATA.save(tmp_path / "modes.json")
    found = load_modal_data(tmp_path / "modes.json")
    for name in ("frequency", "damping", "wheel_shape", "station_shape"):
        np.testing.assert_array_equal(getattr(found, name), getattr(DATA, name))
    assert found.stations == DATA.stations


def test_component_from_a_file(tmp_path: Path) -> None:
    DATA.save(tmp_path / "modes.json")
    component = chassis(str(tmp_path / "modes.json"), modes=2, damping=0.01)
    np.testing.assert_array_equal(component.frequency, DATA.frequency[:2])
    np.testing.assert_array_equal(component.damping, [0.01, 0.01])
    assert component.stations == 2


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"frequency": None}, "frequency is missing"),
        ({"frequency": [24.0, "x", 54.5]}, "frequency must be a list of numbers"),
        ({"frequency": [54.5, 26.4, 24.0]}, "frequency must be positive and ascending"),
        ({"damping": [0.1]}, "damping has 1 numbers, but frequency has 3, one per mode"),
        ({"damping": [0.1, 0.1, 1.5]}, "damping must be ratios from 0 to below 1"),
        ({"wheels": {"fl": [1, 2, 3]}}, "wheels.fr is missing; give the shapes at fl, fr, rl and rr"),
        ({"stations": {}}, "stations must be a table of node names to shapes"),
        ({"stations": {"nose": [1.0]}}, "nose has 1 numbers, but frequency has 3"),
    ],
)
def test_what_is_wrong_is_named(tmp_path: Path, change: dict[str, Any], sentence: str) -> None:
    path = tmp_path / "modes.json"
    DATA.save(path)
    document = json.loads(path.read_text()) | change
    path.write_text(json.dumps({k: v for k, v in document.items() if v is not None}))
    with pytest.raises(ScenarioError) as caught:
        load_modal_data(path)
    assert sentence in str(caught.value)
    assert str(path) in str(caught.value)


def test_missing_and_broken_files(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match="cannot read the modal data"):
        load_modal_data(tmp_path / "none.json")
    (tmp_path / "broken.json").write_text("{")
    with pytest.raises(ScenarioError, match="are not JSON"):
        load_modal_data(tmp_path / "broken.json")


def test_more_modes_than_there_are() -> None:
    with pytest.raises(ScenarioError, match="hold 3 modes, so 4 cannot be kept"):
        DATA.component(4)
