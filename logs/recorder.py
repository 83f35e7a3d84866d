"""Every accepted macro step of every port into a Rerun file, while the run goes.

Layout: ``/plant/<component>/<port>`` outputs, ``/plant/<component>/in/<port>`` inputs, ``/master/...`` the master's
health, ``/events``, ``/log/master`` text, ``/world/...`` the scene.  Two timelines: ``sim_time`` (ns) and ``step``.

The file is called ``NAME.rrd.part`` until it is complete.  It is flushed after every chunk, so a killed run keeps what
was flushed; a run that fails keeps everything up to the failure and is marked.
"""

from __future__ import annotations

import fnmatch
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import rerun as rr

from cosim.errors import ScenarioError
from cosim.observer import Observer, Point, RunInfo, Summary
from cosim.system import System
from cosim.variable import Variable

APPLICATION = "wmr_cosim"
PALETTE = ((31, 120, 209), (240, 128, 32), (42, 157, 74), (168, 62, 196), (192, 57, 43), (127, 106, 85))
_MANY = 8  # values in a port beyond which series share the palette from light to dark


@dataclass(frozen=True)
class _Group:
    """One port: where it lies in its component's buffer and where it goes in the log."""

    entity: str
    variable: Variable
    at: slice


class _Buffer:
    """Rows of one component's flat buffer, of one chunk."""

    def __init__(self, width: int, chunk: int) -> None:
        self.rows = np.empty((chunk, width))


Health = Callable[[Point], Mapping[str, float]]


class RerunRecorder(Observer):
    """Writes a run to *path*.

    *properties* are tables by name (``run``, ``provenance``, ...) that describe the run; *signals* are patterns such as
    ``"wheels.*"`` (none: every port); *health* computes further series of the master per step, named with their unit,
    as in ``{"gap_mismatch [m]": 1e-9}``; *scene* draws in space; *closing* gives more properties when the run has
    ended.  Raises ScenarioError if the file cannot be written.
    """

    def __init__(
        self,
        path: Path,
        recording_id: str,
        *,
        name: str = "",
        properties: Mapping[str, Mapping[str, Any]] | None = None,
        blueprint: Any = None,
        scene: Any = None,
        health: Health | None = None,
        closing: Callable[[], Mapping[str, Mapping[str, Any]]] | None = None,
        signals: tuple[str, ...] = (),
        chunk: int = 1000,
    ) -> None:
        self.path, self.part = path, path.with_suffix(path.suffix + ".part")
        self.scene, self.health, self.closing, self.signals, self.chunk = scene, health, closing, signals, chunk
        rr.set_strict_mode(True)
        self.recording = rr.RecordingStream(APPLICATION, recording_id=recording_id)
        try:
            self.part.unlink(missing_ok=True)
            self.recording.save(str(self.part), default_blueprint=blueprint)
        except (OSError, RuntimeError) as error:
            raise ScenarioError(
                f"cannot write the log {self.part}: {error}; choose another folder with --out"
            ) from None
        rr.set_log_time_enabled(False, recording=self.recording)
        if name:
            self.recording.send_recording_name(name)
        for title, table in (properties or {}).items():
            self.set_property(title, table)
        self._n = 0
        self._ns = np.empty(chunk, np.int64)
        self._step = np.empty(chunk, np.int64)
        self._master = np.empty((chunk, 2))
        self._extra: list[Mapping[str, float]] = []
        self._groups: dict[tuple[str, str], list[_Group]] = {}
        self._buffers: dict[tuple[str, str], _Buffer] = {}
        self._last_wall = 0.0

    def set_property(self, title: str, table: Mapping[str, Any]) -> None:
        """Add or replace a table of properties: numbers, strings, booleans and lists of them; None is left out."""
        known = {k: _plain(v) for k, v in table.items() if v is not None}
        if known:
            self.recording.send_property(title, rr.AnyValues(**known))

    # the run

    def started(self, system: System, info: RunInfo) -> None:
        for name, instance in system.instances.items():
            for kind, variables, places in (
                ("in", instance.inputs, instance.u_at),
                ("out", instance.outputs, instance.y_at),
            ):
                groups = []
                for v in variables:
                    if self.signals and not any(fnmatch.fnmatch(f"{name}.{v.name}", p) for p in self.signals):
                        continue
                    entity = f"plant/{name}/in/{v.name}" if kind == "in" else f"plant/{name}/{v.name}"
                    groups.append(_Group(entity, v, places[v.name]))
                    self._describe(entity, v, f"{name}.{v.name}")
                if groups:
                    width = len(instance.u if kind == "in" else instance.y)
                    self._groups[name, kind] = groups
                    self._buffers[name, kind] = _Buffer(width, self.chunk)
        self._style("master/step_size", ["step [s]"])
        self._style("master/wall", ["wall time of the step [s]"])
        self.recording.set_time("sim_time", duration=np.timedelta64(info.start_ns, "ns"))
        self.recording.log("log/master", rr.TextLog(f"started: {info.algorithm}, step {info.step_ns} ns", level="INFO"))
        if self.scene is not None:
            self.scene.started(self.recording)

    def accepted(self, point: Point) -> None:
        n = self._n
        self._ns[n], self._step[n] = point.end, point.number
        self._master[n] = (point.end - point.start) * 1e-9, point.wall - self._last_wall
        self._last_wall = point.wall
        for (name, kind), buffer in self._buffers.items():
            buffer.rows[n] = (point.inputs if kind == "in" else point.outputs)[name]
        if self.health is not None:
            self._extra.append(dict(self.health(point)))
        self._n = n + 1
        if self._n == self.chunk:
            self.emit()

    def rejected(self, start: int, end: int, reached: int, component: str) -> None:
        self._say(start, f"step to {end} ns taken back: {component} returned early at {reached} ns", "DEBUG")

    def event(self, time: int, component: str) -> None:
        self._at(time)
        self.recording.log("events/located", rr.TextLog(f"{component}: event at {time} ns", level="INFO"))

    def finished(self, summary: Summary) -> None:
        self._close({
            "status": "complete", "steps": summary.steps, "rejected": summary.rejected, "events": summary.events,
            "wall_seconds": summary.wall, "simulated_seconds": summary.simulated,
        })  # fmt: skip

    def failed(self, error: BaseException) -> None:
        self._say(int(self._ns[self._n - 1]) if self._n else 0, str(error) or type(error).__name__, "ERROR")
        self._close({"status": "failed", "error": str(error) or type(error).__name__})

    def emit(self) -> None:
        """Send what is buffered and flush it to the file."""
        n, self._n = self._n, 0
        if not n:
            return
        index = self.index(self._ns[:n], self._step[:n])
        for key, groups in self._groups.items():
            rows = self._buffers[key].rows[:n]
            for group in groups:
                self._send(group.entity, index, rows[:, group.at])
        self._send("master/step_size", index, self._master[:n, :1])
        self._send("master/wall", index, self._master[:n, 1:])
        for label in self._extra[0] if self._extra else ():
            entity = f"master/{label.split(' ')[0]}"
            self._style(entity, [label])
            self._send(entity, index, np.array([[row[label]] for row in self._extra]))
        self._extra.clear()
        if self.scene is not None:
            self.scene.emit(self.recording, self._ns[:n], self._step[:n], self.values(n))
        self.recording.flush()

    def values(self, n: int) -> Callable[[str], np.ndarray | None]:
        """Return a reader of the buffered chunk: ``read("body.position")`` is (n, *shape), or None."""
        found = {
            g.entity.removeprefix("plant/").replace("/", ".", 1): (key, g)
            for key, groups in self._groups.items()
            for g in groups
        }

        def read(port: str) -> np.ndarray | None:
            if port not in found:
                return None
            key, group = found[port]
            return self._buffers[key].rows[:n, group.at].reshape(n, *group.variable.shape)

        return read

    @staticmethod
    def index(ns: np.ndarray, step: np.ndarray) -> list[Any]:
        """Return the two timelines as columns; integers, since a float duration would be truncated to ns."""
        return [rr.TimeColumn("sim_time", duration=ns.astype("timedelta64[ns]")), rr.TimeColumn("step", sequence=step)]

    def _send(self, entity: str, index: list[Any], values: np.ndarray) -> None:
        n, width = values.shape
        self.recording.send_columns(
            entity, index, rr.Scalars.columns(scalars=values.ravel()).partition(np.full(n, width))
        )

    def _describe(self, entity: str, v: Variable, port: str) -> None:
        unit = v.unit or "1"
        names = [f"{label} [{unit}]" if unit != "1" else label for label in v.labels()]
        self._style(entity, names)
        self.recording.log(
            entity,
            rr.AnyValues(
                signal_name=v.labels(),
                signal_unit=unit,
                signal_shape=list(v.shape) or [0],
                port=port,
                meaning=v.meaning,
            ),
            static=True,
        )

    def _style(self, entity: str, names: list[str]) -> None:
        colours = [PALETTE[i % len(PALETTE)] for i in range(len(names))]
        self.recording.log(entity, rr.SeriesLines(names=names, colors=colours, widths=[1.2] * len(names)), static=True)

    def _at(self, ns: int) -> None:
        self.recording.set_time("sim_time", duration=np.timedelta64(ns, "ns"))

    def _say(self, ns: int, text: str, level: str) -> None:
        self._at(ns)
        self.recording.log("log/master", rr.TextLog(text, level=level))

    def _close(self, outcome: dict[str, Any]) -> None:
        self.emit()
        self.set_property("outcome", outcome)
        for title, table in (self.closing() if self.closing else {}).items():
            self.set_property(title, table)
        try:
            self.recording.flush()
        except RuntimeError as error:
            raise ScenarioError(f"the log {self.part} could not be written to its end: {error}") from None
        self.recording.disconnect()
        self.part.replace(self.path)


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return value.tolist()
    return value if isinstance(value, (int, float, str, bool, list)) else str(value)
