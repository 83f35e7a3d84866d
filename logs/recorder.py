"""Every accepted macro step of every port into a Rerun file, while the run goes.

Layout: ``/plant/<component>/<port>`` outputs, ``/plant/<component>/in/<port>`` inputs, ``/master/...`` the master's
health, ``/events``, ``/log/master`` text, ``/world/...`` the scene, ``/report`` the verdict.  Two timelines:
``sim_time`` (ns) and ``step``.

The file is called ``NAME.<8 hex digits>.rrd.part`` until it is complete, so that two runs into one folder never share a
file.  It is flushed after every chunk and once a second, so a killed run keeps what was flushed; a run that fails keeps
everything up to the failure and is marked, one that never began leaves no file.
"""

from __future__ import annotations

import secrets
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import rerun as rr

from cosim.errors import ScenarioError
from cosim.observer import Observer, Point, RunInfo, Summary
from cosim.system import System

from .ports import Chunk, describe, index, scalars, style

APPLICATION = "wmr_cosim"
FLUSH_AFTER = 1.0  # s of wall clock

Health = Callable[[Point], Mapping[str, float]]
Closing = Callable[[], tuple[Mapping[str, Mapping[str, Any]], str]]


class RerunRecorder(Observer):
    """Writes a run to *path*.

    *properties* are tables by name (``run``, ``provenance``, ...) that describe the run; *signals* are patterns such as
    ``"wheels.*"`` (none: every port); *health* computes further series of the master per step, named with their unit,
    as in ``{"gap_mismatch [m]": 1e-9}``; *scene* draws in space; *closing* gives more properties and a report in
    Markdown when the run has ended; *chunk* is the number of steps between two flushes.  Raises ScenarioError if the
    file cannot be written.
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
        closing: Closing | None = None,
        signals: tuple[str, ...] = (),
        chunk: int = 1000,
    ) -> None:
        self.path, self.part = path, path.with_suffix(f".{secrets.token_hex(4)}{path.suffix}.part")
        self.scene, self.health, self.closing, self.signals, self.rows = scene, health, closing, signals, chunk
        self.name, self.properties, self.blueprint = name, properties or {}, blueprint
        rr.set_strict_mode(True)  # wrong data is an error, and not left out with a warning
        self.recording = rr.RecordingStream(APPLICATION, recording_id=recording_id)
        self._chunk: Chunk | None = None
        self._master: dict[str, np.ndarray] = {}
        self._wall = self._flushed = 0.0
        self._last: int | None = None  # ns, of the last accepted point
        self.file: Path | None = None  # where the log is now; a run that never began leaves none

    def set_property(self, title: str, table: Mapping[str, Any]) -> None:
        """Add or replace a table of properties: numbers, strings, booleans and lists of them; None is left out."""
        known = {k: _plain(v) for k, v in table.items() if v is not None and np.size(v)}
        if known:
            self.recording.send_property(title, rr.AnyValues(**known))

    # the run

    def started(self, system: System, info: RunInfo) -> None:
        self._open()
        self._chunk = Chunk(system, self.signals, self.rows)
        for held in self._chunk.logged:
            describe(self.recording, held.entity, held.variable, held.name)
        self._say(info.start_ns, f"started: {info.algorithm}, step {info.step_ns} ns", "INFO")
        if self.scene is not None:
            self.scene.started(self.recording)

    def accepted(self, point: Point) -> None:
        chunk = self._chunk
        assert chunk is not None
        own = {"step_size [s]": (point.end - point.start) * 1e-9, "wall [s]": point.wall - self._wall}
        for label, value in {**own, **(self.health(point) if self.health else {})}.items():
            if label not in self._master:
                self._master[label] = np.empty(self.rows)
                self._name_health(label)
            self._master[label][chunk.n] = value
        self._wall, self._last = point.wall, point.end
        chunk.append(point)
        if chunk.n == chunk.rows or point.wall - self._flushed >= FLUSH_AFTER:
            self.emit()
            self._flushed = point.wall

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
        if self._last is None:
            self._discard()
            return
        interrupted = isinstance(error, (KeyboardInterrupt, SystemExit))
        said = "stopped from outside" if interrupted else str(error) or type(error).__name__
        self._say(self._last, said, "ERROR")
        self._close({"status": "interrupted" if interrupted else "failed", "error": said})

    def emit(self) -> None:
        """Send what is buffered and flush it to the file; raises ScenarioError if the file takes no more."""
        chunk = self._chunk
        if chunk is None or not chunk.n:
            return
        at = index(chunk.ns[: chunk.n], chunk.step[: chunk.n])
        chunk.send(lambda path, columns: self.recording.send_columns(path, at, columns))
        for label, values in self._master.items():
            self.recording.send_columns(_health_entity(label), at, scalars(values[: chunk.n, None]))
        if self.scene is not None:
            self.scene.emit(self.recording, chunk.ns[: chunk.n], chunk.step[: chunk.n], chunk.read)
        chunk.clear()
        self._flush()

    def _open(self) -> None:
        try:
            self.recording.save(str(self.part), default_blueprint=self.blueprint)
        except (OSError, RuntimeError) as error:
            raise ScenarioError(
                f"cannot write the log {self.path}: {error}; choose another folder with --out"
            ) from None
        self.file = self.part
        rr.set_log_time_enabled(False, recording=self.recording)
        if self.name:
            self.recording.send_recording_name(self.name)
        for title, table in self.properties.items():
            self.set_property(title, table)

    def _name_health(self, label: str) -> None:
        name, _, unit = label.partition(" ")
        style(self.recording, _health_entity(label), [name], unit.strip("[]") or "1")
        about = rr.AnyValues(signal_name=[name], signal_unit=unit.strip("[]") or "1")
        self.recording.log(_health_entity(label), about, static=True)

    def _at(self, ns: int) -> None:
        self.recording.set_time("sim_time", duration=np.timedelta64(ns, "ns"))

    def _say(self, ns: int, text: str, level: str) -> None:
        self._at(ns)
        self.recording.log("log/master", rr.TextLog(text, level=level))

    def _flush(self) -> None:
        try:
            self.recording.flush()
        except RuntimeError as error:
            why = str(error).splitlines()[0]
            raise ScenarioError(
                f"the log {self.part} cannot be written any further ({why}): is the disk full?"
            ) from None

    def _close(self, outcome: dict[str, Any]) -> None:
        try:
            self.emit()
            self.set_property("outcome", outcome)
            tables, report = self.closing() if self.closing else ({}, "")
            for title, table in tables.items():
                self.set_property(title, table)
            if report:
                self.recording.log("report", rr.TextDocument(report, media_type="text/markdown"), static=True)
            self._flush()
        finally:
            self.recording.disconnect()
        self.part.replace(self.path)
        self.file = self.path

    def _discard(self) -> None:
        self.recording.disconnect()
        self.part.unlink(missing_ok=True)
        self.file = None


def _health_entity(label: str) -> str:
    return f"master/{label.split(' ')[0]}"


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    return value if isinstance(value, (int, float, str, bool, list)) else str(value)
