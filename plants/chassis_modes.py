"""Modal data of a chassis: frequencies, damping, and shapes at named nodes; from a file, or for a component."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from cosim.errors import ScenarioError

from .chassis_files import read_document, write_document
from .chassis_modal import ChassisModal

WHEELS = ("fl", "fr", "rl", "rr")


@dataclass(frozen=True)
class ModalData:
    """Elastic modes of a chassis, ascending in frequency; shapes are vertical and mass-normalised (kg^-1/2)."""

    frequency: np.ndarray  # (n,) Hz
    damping: np.ndarray  # (n,) ratios
    wheel_shape: np.ndarray  # (4, n), wheels front-left, front-right, rear-left, rear-right
    station_shape: np.ndarray  # (stations, n)
    stations: tuple[str, ...]

    def component(self, modes: int | None = None) -> ChassisModal:
        """Return the chassis as a component with the first *modes* modes (all, if none are given)."""
        n = len(self.frequency) if modes is None else modes
        if not 1 <= n <= len(self.frequency):
            raise ScenarioError(
                f"the modal data hold {len(self.frequency)} modes, so {n} cannot be kept; ask for fewer"
            )
        return ChassisModal(
            modes=n,
            stations=len(self.stations),
            frequency=self.frequency[:n],
            damping=self.damping[:n],
            wheel_shape=self.wheel_shape[:, :n],
            station_shape=self.station_shape[:, :n],
        )

    def first(self, modes: int) -> ModalData:
        """Return the data of the first *modes* modes only."""
        return ModalData(
            self.frequency[:modes], self.damping[:modes], self.wheel_shape[:, :modes], self.station_shape[:, :modes],
            self.stations,
        )  # fmt: skip

    def damped(self, ratio: float) -> ModalData:
        """Return the data with one damping *ratio* for all modes."""
        return replace(self, damping=np.full(len(self.frequency), float(ratio)))

    def save(self, path: Path) -> None:
        """Write the data, every bit kept: as CSV or NPZ if the suffix says so, else as JSON."""
        document = {
            "frequency": self.frequency.tolist(),
            "damping": self.damping.tolist(),
            "wheels": dict(zip(WHEELS, self.wheel_shape.tolist(), strict=True)),
            "stations": dict(zip(self.stations, self.station_shape.tolist(), strict=True)),
        }
        write_document(path, document)


def load_modal_data(path: Path) -> ModalData:
    """Read modal data from a JSON, CSV or NPZ file; raises ScenarioError naming file and key for what is wrong."""
    document = read_document(path, WHEELS)
    frequency = _numbers(path, document, "frequency")
    n = len(frequency)
    damping = _numbers(path, document, "damping", n)
    wheels, stations = (_nodes(path, document, key, n) for key in ("wheels", "stations"))
    for wheel in WHEELS:
        if wheel not in wheels:
            raise ScenarioError(f"{path}: wheels.{wheel} is missing; give the shapes at fl, fr, rl and rr")
    if np.any(frequency <= 0) or np.any(np.diff(frequency) < 0):
        raise ScenarioError(f"{path}: frequency must be positive and ascending, in Hz, without rigid-body modes")
    if np.any((damping < 0) | (damping >= 1)):
        raise ScenarioError(f"{path}: damping must be ratios from 0 to below 1")
    shapes = np.array([wheels[w] for w in WHEELS])
    return ModalData(frequency, damping, shapes, np.array(list(stations.values())), tuple(stations))


def _numbers(path: Path, table: dict[str, Any], key: str, n: int | None = None) -> np.ndarray:
    if key not in table:
        raise ScenarioError(f"{path}: {key} is missing")
    try:
        values = np.array(table[key], dtype=float)
    except (TypeError, ValueError):
        raise ScenarioError(f"{path}: {key} must be a list of numbers") from None
    if values.ndim != 1 or not len(values) or not np.all(np.isfinite(values)):
        raise ScenarioError(f"{path}: {key} must be a list of finite numbers")
    if n is not None and len(values) != n:
        raise ScenarioError(f"{path}: {key} has {len(values)} numbers, but frequency has {n}, one per mode")
    return values


def _nodes(path: Path, document: dict[str, Any], key: str, n: int) -> dict[str, np.ndarray]:
    nodes = document.get(key)
    if not isinstance(nodes, dict) or not nodes:
        raise ScenarioError(f"{path}: {key} must be a table of node names to shapes")
    return {name: _numbers(path, nodes, name, n) for name in nodes}
