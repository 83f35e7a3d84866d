"""Chassis from outside: CSV and NPZ, finite-element results by meshio, and the plate with other dimensions."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest

from cosim.errors import ScenarioError
from plants.chassis import chassis
from plants.chassis_fe import PlateChassis
from plants.chassis_modes import ModalData, load_modal_data
from plants.chassis_results import modes_of_result
from studies.assembly import assemble
from studies.catalog import find_scenario

DATA = ModalData(np.array([24.0, 26.4, 54.5]), np.full(3, 5e-5), np.arange(12.0).reshape(4, 3) / 7,
                 np.ones((2, 3)) / 3, ("nose", "tail"))  # fmt: skip
WHEELS = [[1.0, 0.5, 0.0], [1.0, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.0]]
FREQUENCIES = (0.001, 24.5, 31.25)


@pytest.mark.parametrize("suffix", [".json", ".csv", ".npz"])
def test_every_format_keeps_every_bit(tmp_path: Path, suffix: str) -> None:
    DATA.save(tmp_path / f"modes{suffix}")
    found = load_modal_data(tmp_path / f"modes{suffix}")
    for name in ("frequency", "damping", "wheel_shape", "station_shape"):
        np.testing.assert_array_equal(getattr(found, name), getattr(DATA, name))
    assert found.stations == DATA.stations


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("frequency\n", "need a header and one row per mode"),
        ("frequency,damping\n1,2,3\n", "mode 1 has 3 values, but the header has 2"),
        ("frequency,dampng\n1,2\n", "the column 'dampng' is not known"),
        ("frequency,damping,wheels.fl,stations.a\nfast,0,1,1\n", "frequency must be a list of numbers"),
        ("frequency,damping,wheels.fl,stations.a\n9,0,1,1\n", "wheels.fr is missing"),
    ],
)
def test_what_is_wrong_with_csv(tmp_path: Path, text: str, sentence: str) -> None:
    (tmp_path / "modes.csv").write_text(text)
    with pytest.raises(ScenarioError, match=sentence):
        load_modal_data(tmp_path / "modes.csv")


def test_what_is_wrong_with_npz(tmp_path: Path) -> None:
    np.savez(tmp_path / "modes.npz", frequency=[1.0], damping=[0.0], wheels=np.ones((3, 1)), stations=np.ones((2, 1)))
    with pytest.raises(ScenarioError, match="wheels has the shape"):
        load_modal_data(tmp_path / "modes.npz")
    (tmp_path / "broken.npz").write_text("no archive")
    with pytest.raises(ScenarioError, match="are not NPZ"):
        load_modal_data(tmp_path / "broken.npz")


def result_mesh() -> tuple[np.ndarray, list[tuple[str, np.ndarray]], list[np.ndarray]]:
    """Return points, cells and three fields (nodes, 3) on a plate of 5 x 4 nodes; the third goes down in front."""
    x, y = np.meshgrid(np.linspace(0, 1, 5), np.linspace(0, 0.5, 4), indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel(), 0 * x.ravel()])
    quads = [[4 * i + j, 4 * i + j + 1, 4 * i + j + 5, 4 * i + j + 4] for i in range(4) for j in range(3)]
    heights = (np.ones(20), np.cos(np.pi * x.ravel()) ** 2, -x.ravel() * (1 + y.ravel()))
    return points, [("quad", np.array(quads))], [np.column_stack([0 * h, 7 + 0 * h, h]) for h in heights]


def vtu(path: Path) -> None:
    points, cells, fields = result_mesh()
    named = {f"mode {k}, {f!r} Hz": v for k, (f, v) in enumerate(zip(FREQUENCIES, fields, strict=True))}
    meshio.Mesh(points, cells, point_data=named).write(path)


def xdmf(path: Path) -> None:
    points, cells, fields = result_mesh()
    with meshio.xdmf.TimeSeriesWriter(path) as writer:
        writer.write_points_cells(points, cells)
        for f, v in zip(FREQUENCIES, fields, strict=True):
            writer.write_data(f, point_data={"displacement": v})


def med(path: Path) -> None:
    """Write one field with a step per mode, its time the frequency, as Code_Aster does."""
    import h5py

    points, cells, fields = result_mesh()
    meshio.Mesh(points, cells, point_data={"DEPL": fields[0]}).write(path)
    with h5py.File(path, "a") as file:
        field = file["CHA/DEPL"]
        first = next(iter(field))
        for k, (f, v) in enumerate(zip(FREQUENCIES, fields, strict=True), 1):
            name = f"{k:020d}{1:020d}"
            if name != first:
                field.copy(field[first], name)
            field[name].attrs["PDT"] = f
            data = field[name]["NOE"][field[name]["NOE"].attrs["PFL"]]["CO"]
            data[...] = v.ravel(order="F")


@pytest.mark.parametrize(("suffix", "write"), [(".vtu", vtu), (".xdmf", xdmf), (".med", med)])
def test_modes_of_a_result_file(tmp_path: Path, suffix: str, write: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)  # a series in XDMF keeps its arrays in a file beside it
    path = Path(f"modes{suffix}")
    write(path)
    found = modes_of_result(path, WHEELS, modal_mass=[4.0, 1.0])
    points, _, fields = result_mesh()
    np.testing.assert_allclose(found.frequency, FREQUENCIES[1:])  # without the rigid mode
    order = [int(np.argmin(np.linalg.norm(points - w, axis=1))) for w in WHEELS]
    np.testing.assert_allclose(found.wheel_shape[:, 0], fields[1][order, 2] / 2)
    np.testing.assert_allclose(found.wheel_shape[:, 1], -fields[2][order, 2])  # station 1 moves up
    # 5 x 4 stations, row by row from the front, left to right: exactly the nodes
    rows = [(1 - i / 4, 0.5 * (1 - j / 3)) for i in range(5) for j in range(4)]
    np.testing.assert_allclose(found.station_shape[:, 1], [x * (1 + y) for x, y in rows])


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"wheels": WHEELS[:3]}, "wheels must be 4 positions"),
        ({"wheels": [[9, 9, 9], *WHEELS[1:]]}, "wheels: no node of .* lies within 0.01 m"),
        ({"wheels": WHEELS, "up": "w"}, "up cannot be 'w'"),
        ({"wheels": WHEELS, "modal_mass": [1.0]}, "one for each of the 2 modes"),
        ({}, "say where its wheels are"),
        ({"wheels": WHEELS, "thickness": 0.01}, "thickness cannot stand beside modal_data"),
    ],
)
def test_what_a_result_file_lacks(tmp_path: Path, given: dict[str, Any], sentence: str) -> None:
    vtu(tmp_path / "modes.vtu")
    with pytest.raises(ScenarioError, match=sentence):
        chassis(str(tmp_path / "modes.vtu"), **given)


def test_result_files_that_cannot_be_read(tmp_path: Path) -> None:
    points, cells, _ = result_mesh()
    meshio.Mesh(points, cells).write(tmp_path / "bare.vtu")
    (tmp_path / "broken.vtu").write_text("<")
    for name, sentence in (("bare.vtu", "no field with a frequency"), ("none.vtu", "no such file"),
                           ("broken.vtu", "meshio cannot read"), ("modes.xyz", "no such file")):  # fmt: skip
        with pytest.raises(ScenarioError, match=sentence):
            modes_of_result(tmp_path / name, WHEELS)


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"thicknes": 0.01}, "no parameter 'thicknes'; did you mean 'thickness'"),
        ({"thickness": -0.01}, "thickness of the chassis is -0.01; it must be positive"),
        ({"thickness": "thick"}, "thickness of the chassis must be a number"),
        ({"nu": 0.5}, "Poisson's ratio lies between"),
        ({"box_size": [0.1, 0.1]}, "box_size of the chassis must be 3 positive lengths"),
        ({"box_size": [0.5, 0.06, 0.1]}, "overlap at a box_pitch"),
        ({"width": 0.5}, "the width of the plate is 0.5 m"),
        ({"refinement": 9}, "refinement of the chassis is 9"),
        ({"modes": 0}, "modes must be a whole number from 1"),
        ({"wheels": WHEELS}, "wheels belongs to a finite-element result"),
    ],
)
def test_plates_that_are_none(given: dict[str, Any], sentence: str) -> None:
    with pytest.raises(ScenarioError, match=sentence):
        chassis(**given)


def test_a_scenario_can_ask_for_another_plate() -> None:
    """Twice as thick under the same mass without boxes: stiffness 8 times, frequencies less than root 8, for shear."""
    changes = {"components": {"chassis": {"box_mass": 0.0, "thickness": 0.012, "modes": 6}}}
    thick = {"components": {"chassis": {"box_mass": 0.0, "thickness": 0.024, "modes": 6}}}
    file = find_scenario("shock-collision")
    thin, double = (assemble(file.load("one-wheel", [c])).components["chassis"] for c in (changes, thick))
    ratio = double.values["frequency"] / thin.values["frequency"]  # type: ignore[union-attr]
    assert np.all((ratio > 0.98 * np.sqrt(8)) & (ratio < np.sqrt(8)))


def test_mass_of_the_plate() -> None:
    """Uniform vertical motion: the mass matrix holds all of it."""
    for plate in (PlateChassis(), PlateChassis(box_mass=0.0), PlateChassis(plate_mass=120.0, box_mass=150.0)):
        _, M, _, _ = plate.matrices()
        assert M.sum() / 3 == pytest.approx(plate.mass, rel=1e-9)
