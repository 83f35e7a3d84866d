"""The thesis' cases: 1000 N on every excited wheel, pulses of 0.05 and 0.08 s, 25 modes, 20 stations, one second."""

from __future__ import annotations

from functools import cache

import numpy as np

from plants.chassis_fe import PlateChassis
from plants.chassis_modes import ModalData
from plants.pulses import Pulse
from plants.shock import Method, pulse_response, station_response
from plants.shock_loads import wheel_load

FORCE, SHORT, LONG = 1000.0, 0.05, 0.08  # N, s, s: section 8.3
RATE, SECONDS = 10_000.0, 1.0  # samples per s and length of what peaks are taken from
MODES = 25
CASES = ("single", "diagonal", "four")
STATIONS = np.arange(1, 21)
CORNERS, INNER = (1, 4, 17, 20), (6, 7, 10, 11, 14, 15)
EDGES = tuple(k for k in range(1, 21) if k not in CORNERS + INNER)


@cache
def platform(modes: int = MODES) -> ModalData:
    """Return the default chassis with its lowest *modes* modes."""
    return PlateChassis().cached_modes(modes)


def times(seconds: float = SECONDS) -> np.ndarray:
    """Return the sampling times in s, 0 and the end included."""
    return np.arange(round(seconds * RATE) + 1) / RATE


def acceleration(
    data: ModalData,
    case: str = "single",
    duration: float = SHORT,
    *,
    total: float | None = None,
    shape: str = "rectangular",
    t: np.ndarray | None = None,
    method: Method = pulse_response,
) -> np.ndarray:
    """Return accelerations (n, stations) in m/s2 of a case: 1000 N on each excited wheel, or *total* N in all."""
    load = FORCE * wheel_load(case) if total is None else wheel_load(case, total=total)
    return station_response(data, load, Pulse(shape, duration), times() if t is None else t, method)


def at(values: np.ndarray, stations: tuple[int, ...]) -> np.ndarray:
    """Return the entries of *values* (20,) at *stations*, which count from 1."""
    return values[np.array(stations) - 1]
