"""Modes from the result file of a finite-element program, by meshio: MED, VTU, VTK, XDMF and what else it reads.

A mode is a field of displacements at the nodes whose frequency in Hz stands

- in the time of the field: MED as Code_Aster writes modes, and time series in XDMF;
- or in its name, before ``Hz``: ``mode 1, 24.77 Hz`` in VTU, VTK or any other file.

What such a file does not say is given beside it: where the wheels and stations are, which axis points up, and the modal
masses unless the shapes are mass-normalised.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from contextlib import redirect_stdout
from dataclasses import dataclass
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np

from cosim.errors import ScenarioError

from .chassis_modes import ModalData

ROWS, COLUMNS = 5, 4  # of stations between the wheels, unless they are given
RIGID = 0.5  # Hz, below which a mode is a rigid one of the free body
_IN_NAME = re.compile(r"(\d[\d.]*(?:[eE][+-]?\d+)?)\s*Hz")
_IN_TIME = re.compile(r"\[\d+\] - ([\d.eE+-]+)$")  # how meshio names the steps of a MED field


@dataclass(frozen=True)
class Fields:
    """Frequencies (n,) in Hz, displacements (n, nodes, 3) and the nodes (nodes, 3) in m of a result file."""

    frequency: np.ndarray
    shape: np.ndarray
    nodes: np.ndarray


def modes_of_result(
    path: Path,
    wheels: Sequence[Sequence[float]],
    stations: Sequence[Sequence[float]] | None = None,
    *,
    up: str = "z",
    modal_mass: float | Sequence[float] = 1.0,
    damping: float = 5e-5,
    tolerance: float = 0.01,
) -> ModalData:
    """Return the elastic modes of a result file at the nodes nearest to *wheels* (4, 3) and *stations* (m, 3) in m.

    Wheels in the order front-left, front-right, rear-left, rear-right.  Without *stations* there are 5 x 4 between the
    wheels, row by row from the front, left to right.  *up* is the file's axis that points upwards, shapes are divided
    by the root of *modal_mass* (kg, one or one per elastic mode), and a node must lie within *tolerance* m of its
    place.  The first station moves up in every mode.  Raises ScenarioError for a file or a place that does not fit.
    """
    fields = read_fields(path)
    if up not in ("x", "y", "z"):
        raise ScenarioError(f"up cannot be {up!r}; it is the axis of {path} that points upwards: 'x', 'y' or 'z'")
    corners = _places("wheels", wheels, 4)
    places = _between(corners) if stations is None else _places("stations", stations, None)
    at_wheels = [_node(path, fields.nodes, place, "wheels", tolerance) for place in corners]
    at_stations = [_node(path, fields.nodes, place, "stations", tolerance) for place in places]
    kept = np.flatnonzero(fields.frequency > RIGID)
    kept = kept[np.argsort(fields.frequency[kept], kind="stable")]
    if not len(kept):
        raise ScenarioError(f"{path} has no mode above {RIGID:g} Hz: rigid modes only")
    mass = np.asarray(modal_mass, float)
    if mass.ndim > 1 or (mass.ndim == 1 and len(mass) != len(kept)) or np.any(mass <= 0):
        raise ScenarioError(f"modal_mass must be positive, in kg: one for all or one for each of the {len(kept)} modes")
    vertical = (fields.shape[kept, :, "xyz".index(up)].T / np.sqrt(mass)).T
    vertical = vertical * np.where(vertical[:, at_stations[:1]] < 0, -1.0, 1.0)
    names = tuple(str(k + 1) for k in range(len(places)))
    ratios = np.full(len(kept), float(damping))
    return ModalData(fields.frequency[kept], ratios, vertical[:, at_wheels].T, vertical[:, at_stations].T, names)


def read_fields(path: Path) -> Fields:
    """Read all modes of a result file; raises ScenarioError if meshio cannot, or if no field has a frequency."""
    nodes, fields = _read(path)
    found = []
    for name, frequency, values in fields:
        if values.ndim != 2 or values.shape[1] < 3:
            raise ScenarioError(f"{path}: the field {name!r} must have three displacements per node")
        found.append((frequency, values[:, :3]))
    if not found:
        raise ScenarioError(
            f"{path} has no field with a frequency; name the fields of a VTU or VTK file like 'mode 1, 24.77 Hz', "
            f"or write a MED file or an XDMF series with the frequency in Hz as time"
        )
    return Fields(np.array([f for f, _ in found]), np.array([v for _, v in found]), nodes)


def _read(path: Path) -> tuple[np.ndarray, list[tuple[str, float, np.ndarray]]]:
    try:
        import meshio
    except ImportError:
        raise ScenarioError(f"reading {path} needs meshio: pip install 'wmr-cosim[fe]'") from None
    if not path.is_file():
        raise ScenarioError(f"cannot read the modal data {path}: there is no such file")
    said = StringIO()
    try:
        with redirect_stdout(said):  # meshio prints what is wrong and exits
            if path.suffix == ".xdmf" and "Temporal" in path.read_text(encoding="utf-8", errors="replace"):
                return _series(meshio, path)
            mesh = meshio.read(path)
    except (SystemExit, Exception) as error:
        reason = said.getvalue().strip().splitlines()[-1:] or [str(error)]
        raise ScenarioError(f"meshio cannot read {path}: {reason[0]}") from None
    fields = []
    for name, values in mesh.point_data.items():
        match = _IN_NAME.search(name) or _IN_TIME.search(name)
        if match:
            fields.append((name, float(match[1]), np.asarray(values, float)))
    return np.asarray(mesh.points, float), fields


def _series(meshio: Any, path: Path) -> tuple[np.ndarray, list[tuple[str, float, np.ndarray]]]:
    with meshio.xdmf.TimeSeriesReader(path) as reader:
        points, _ = reader.read_points_cells()
        steps = [reader.read_data(k) for k in range(reader.num_steps)]
    fields = [(n, float(t), np.asarray(v, float)) for t, data, _ in steps for n, v in data.items() if np.ndim(v) == 2]
    return np.asarray(points, float), fields


def _places(name: str, places: Any, count: int | None) -> np.ndarray:
    try:
        found = np.array(places, dtype=float)
    except (TypeError, ValueError):
        found = np.zeros(0)
    if found.ndim != 2 or found.shape[1] != 3 or (count is not None and len(found) != count):
        many = f"{count} positions" if count else "positions"
        raise ScenarioError(f"{name} must be {many} [x, y, z] in m in the axes of the result file, not {places!r}")
    return found


def _between(wheels: np.ndarray) -> np.ndarray:
    """Return the 5 x 4 stations (20, 3) of the quadrangle that the wheels span."""
    fl, fr, rl, rr = wheels
    rows = [((1 - k) * fl + k * rl, (1 - k) * fr + k * rr) for k in np.linspace(0, 1, ROWS)]
    return np.array([(1 - k) * left + k * right for left, right in rows for k in np.linspace(0, 1, COLUMNS)])


def _node(path: Path, nodes: np.ndarray, place: np.ndarray, name: str, tolerance: float) -> int:
    distance = np.linalg.norm(nodes - place, axis=1)
    nearest = int(np.argmin(distance))
    if distance[nearest] > tolerance:
        raise ScenarioError(
            f"{name}: no node of {path} lies within {tolerance:g} m of {place.tolist()}; the nearest, "
            f"{nodes[nearest].tolist()}, is {distance[nearest]:.3g} m away"
        )
    return nearest
