"""The chassis as a plate that bends: acceleration at its stations as colours, its modes beside each other, spectra.

A plate has its stations as corners of its triangles.  Each is raised by its elastic displacement, Phi q, times a
factor; the plate stands still otherwise.  In the view of the modes each plate is one mode: height and colour are its
share of the elastic force per mass, w^2 phi q in m/s2, at one scale for all, so that the modes that matter stand out.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import rerun as rr

from cosim.system import System

from .drawing import Drawing, Frames, Read, nice
from .parts import by_parts
from .ports import index

SHOWN = 8  # modes
ACROSS = 4  # of them beside each other
RAISED = 0.12  # of the length of the plate: how high the colours' limit raises a mode
DOWN, LEVEL, UP = (31, 90, 200), (238, 238, 238), (214, 40, 30)
MARK, EDGE = (235, 235, 235), (120, 124, 130)


@dataclass
class ChassisMap(Drawing):
    """A plate of *rows* x *columns* stations, row by row from the front, left to right.

    *length*, *width* are those of the plate in m; *frequency* (modes,) in Hz and *shape* (stations, modes),
    mass-normalised; *limit* is the acceleration in m/s2 with the full colour, *factor* exaggerates displacements.
    """

    rows: int
    columns: int
    length: float
    width: float
    frequency: np.ndarray
    shape: np.ndarray
    limit: float
    factor: float
    interval: float = 2e-3  # s between frames
    _frames: Frames = field(init=False, repr=False)

    @property
    def captions(self) -> dict[str, str]:
        """What the views of this are called: scales and limits, without which they cannot be read."""
        colours = f"red {self.limit:g} m/s2 up or more, blue down"
        return {
            "chassis": f"stations 1-{self.rows * self.columns}: {colours}; bent {self.factor:g} x",
            "modes": f"first {self._shown} modes, w2 phi q: {colours}, same scale",
        }

    @property
    def _shown(self) -> int:
        return min(SHOWN, len(self.frequency))

    def started(self, recording: Any, system: System) -> None:
        """Draw the outlines and the labels, which do not move."""
        self._frames = Frames(self.interval)
        flat, mesh = self._plate(), rr.Mesh3D.from_fields(triangle_indices=self._triangles())
        corners = [0, self.columns - 1, (self.rows - 1) * self.columns, self.rows * self.columns - 1]
        for root in ("chassis", "modes"):
            recording.log(root, rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
        recording.log("chassis/plate", mesh, static=True)
        recording.log("chassis/frame", self._outline(flat, [0, 0, 0]), static=True)
        words = [f"{k + 1}, wheel {w}" for k, w in zip(corners, ("fl", "fr", "rl", "rr"), strict=True)]
        recording.log("chassis/stations", rr.Points3D(flat, radii=0.005, colors=[EDGE]), static=True)
        outside = flat[corners] * [1.12, 1.12, 1]
        recording.log("chassis/wheels", rr.Points3D(outside, labels=words, radii=0.004, colors=[MARK]), static=True)
        for k in range(self._shown):
            place = self._place(k)
            recording.log(f"modes/{k + 1}", mesh, static=True)
            recording.log(f"modes/{k + 1}/frame", self._outline(flat, place), static=True)
            label = rr.Points3D([place - [0.62 * self.length, 0, 0]], labels=[f"{k + 1}: {self.frequency[k]:.0f} Hz"],
                                radii=0.001, colors=[MARK], show_labels=True)  # fmt: skip
            recording.log(f"modes/{k + 1}/label", label, static=True)

    def emit(self, recording: Any, ns: np.ndarray, step: np.ndarray, read: Read) -> None:
        """Draw the frames of one chunk."""
        q, acceleration = read("chassis.modal_displacement"), read("chassis.acceleration")
        frames = self._frames.of(ns)
        if q is None or acceleration is None or not len(frames):
            return
        q, at, flat = q[frames], index(ns[frames], step[frames]), self._plate()

        def send(path: str, height: np.ndarray, values: np.ndarray, place: Any) -> None:
            vertices = np.repeat((flat + place)[None], len(height), axis=0)
            vertices[:, :, 2] += height
            corners = _by_threes(vertices)
            columns = rr.Mesh3D.columns(
                vertex_positions=corners.reshape(-1, 3),
                vertex_colors=_by_threes(coloured(values / self.limit)).reshape(-1, 3),
            )
            recording.send_columns(path, at, columns.partition(np.full(len(height), corners.shape[1])))

        send("chassis/plate", self.factor * q @ self.shape.T, acceleration[frames], np.zeros(3))
        share = (2 * np.pi * self.frequency) ** 2 * q
        for k in range(self._shown):
            values = share[:, k, None] * self.shape[None, :, k]
            height = RAISED * self.length / self.limit * values
            send(f"modes/{k + 1}", height, values, self._place(k))

    def _plate(self) -> np.ndarray:
        x = self.length * (0.5 - np.arange(self.rows) / (self.rows - 1))
        y = self.width * (0.5 - np.arange(self.columns) / (self.columns - 1))
        return np.stack([np.repeat(x, self.columns), np.tile(y, self.rows), np.zeros(self.rows * self.columns)], axis=1)

    def _place(self, mode: int) -> np.ndarray:
        row, column = divmod(mode, ACROSS)
        return np.array([-row * 1.6 * self.length, (1.5 - column) * 1.7 * self.width, 0.0])

    def _triangles(self) -> np.ndarray:
        first = (np.arange(self.rows - 1)[:, None] * self.columns + np.arange(self.columns - 1)).ravel()
        right, behind = first + 1, first + self.columns
        return np.concatenate([np.column_stack([first, behind, right]), np.column_stack([right, behind, behind + 1])])

    def _outline(self, flat: np.ndarray, place: Any) -> rr.LineStrips3D:
        """Return the plate at rest, as wires."""
        grid = (flat + place).reshape(self.rows, self.columns, 3)
        return rr.LineStrips3D([*grid, *grid.transpose(1, 0, 2)], colors=[EDGE], radii=0.0015)


def _by_threes(values: np.ndarray) -> np.ndarray:
    """Repeat the last of (n, vertices, 3) until their number is a multiple of 3.

    While the viewer has the vertices of a mesh but not yet its triangles, it complains about any other number.
    """
    return np.concatenate([values, np.repeat(values[:, -1:], -values.shape[1] % 3, axis=1)], axis=1)


def coloured(share: np.ndarray) -> np.ndarray:
    """Return colours (..., 3) of shares of the limit: blue at -1 and below, grey at 0, red at 1 and above."""
    channels = [np.interp(share, [-1, 0, 1], ends) for ends in zip(DOWN, LEVEL, UP, strict=True)]
    return np.stack(channels, axis=-1).astype(np.uint8)


def scales(frequency: np.ndarray, shape: np.ndarray, wheel_shape: np.ndarray, load: np.ndarray) -> tuple[float, float]:
    """Return a limit of accelerations in m/s2 and a factor of displacements from the static *load* (4,) of the wheels.

    The limit is half of what that load would give if it came at once; the factor makes its deflection 2 cm.
    """
    force = wheel_shape.T @ load
    deflection = np.max(np.abs(shape @ (force / (2 * np.pi * frequency) ** 2)))
    return nice(0.5 * float(np.max(np.abs(shape @ force)))), nice(0.02 / deflection)


BARS = 160


class Spectra(Drawing):
    """The amplitude spectrum of the acceleration at the worst and the quietest station, when the run has ended.

    *time* and *signal* give the whole run: times (n,) in s and ports (n, ...).  Resampled linearly to even steps;
    each bar is the largest amplitude in its band, so that no line is lost.
    """

    def __init__(self, time: Callable[[], np.ndarray], signal: Callable[[str], np.ndarray | None], top: float) -> None:
        self.time, self.signal, self.top = time, by_parts(signal), top

    def finished(self, recording: Any) -> None:
        values = self.signal("chassis.acceleration")
        if values is None or len(values) < 16:
            return
        peaks = np.max(np.abs(values), axis=0)
        for what, station, paint in (("worst", np.argmax(peaks), UP), ("quietest", np.argmin(peaks), (90, 170, 250))):
            frequency, amplitude = spectrum(self.time(), values[:, station], self.top)
            if len(frequency) < 2:
                return  # the run is too short for a frequency below the top
            width = np.full(len(frequency), 0.9 * (frequency[1] - frequency[0]), np.float32)
            chart = rr.BarChart(amplitude, abscissa=frequency, widths=width, color=paint)
            recording.log(f"spectrum/{what}_station_{station + 1}", chart, static=True)


def spectrum(time: np.ndarray, values: np.ndarray, top: float) -> tuple[np.ndarray, np.ndarray]:
    """Return frequencies in Hz up to *top* and the amplitudes there of *values* (n,) at *time* (n,) in s.

    A steady sine of amplitude 1 that fits the run has amplitude 1.
    """
    even = np.linspace(time[0], time[-1], len(time), endpoint=False)
    resampled = np.interp(even, time, values)
    frequency = np.fft.rfftfreq(len(even), even[1] - even[0])
    amplitude = 2 / len(even) * np.abs(np.fft.rfft(resampled - resampled.mean()))
    kept = (frequency > 0) & (frequency <= top)
    frequency, amplitude = frequency[kept], amplitude[kept]
    group = -(-len(frequency) // BARS)
    if group > 1:
        count = len(frequency) // group * group
        frequency = frequency[:count].reshape(-1, group).mean(axis=1)
        amplitude = amplitude[:count].reshape(-1, group).max(axis=1)
    return frequency, amplitude
