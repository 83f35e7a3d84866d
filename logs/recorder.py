"""Every accepted macro step of every port into a Rerun file, while the run goes.

Layout: ``/plant/<component>/<port>`` outputs, ``/plant/<component>/in/<port>`` inputs, ``/master/...`` the master's
health, ``/events``, ``/log/master`` text, ``/world/...`` the scene, ``/report`` the verdict.  Two timelines:
``sim_time`` (ns) and ``step``.

The file is called ``NAME.<8 hex digits>.rrd.part`` until it is complete and was read back, so that two runs into one
folder never share a file.  A chunk goes to the file when it is full, and once a second, of a run of many minutes less
often; a thread sends it and one of Rerun packs and writes it while the run fills another, one chunk at most is under
way.  So a killed run keeps every chunk written, one that fails keeps everything up to the failure and is marked, one
that never began leaves no file.

With the index of its chunks at the end of the file a viewer loads only what it shows.  Rerun keeps it in memory until
then; the file of a run with so many steps that this would count has none, and is loaded as a whole.
"""

from __future__ import annotations

import secrets
from collections.abc import Callable, Mapping
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
import rerun as rr
from rerun.chunk import RrdReader

from cosim.errors import ScenarioError
from cosim.observer import Block, Observer, Point, RunInfo, Summary
from cosim.quiet import without
from cosim.system import System

from .ports import Chunk, describe, index, scalars, style
from .sender import Sender

APPLICATION = "wmr_cosim"
FLUSH_AFTER = 1.0  # s of wall clock
AT_MOST = 0.05  # of a run's wall clock is lost with its process, where that is more: chunks cost memory, see INDEX
INDEX = 20_000_000  # bytes of memory for the index of the file
OF_CHUNK = 3500  # bytes of it for each chunk of an entity, measured with rerun-sdk 0.41
TRY, PATIENCE = 1.0, 60  # s to wait for the file at a time, and how often

Read = Callable[[str], "np.ndarray | None"]
Health = Callable[[Read], Mapping[str, np.ndarray]]
Closing = Callable[[], tuple[Mapping[str, Mapping[str, Any]], str]]


class RerunRecorder(Observer):
    """Writes a run to *path*.

    *properties* are tables by name (``run``, ``provenance``, ...) that describe the run; *signals* are patterns such as
    ``"wheels.*"`` (none: every port); *health* computes further series of the master over a chunk of n steps from the
    ports it reads, (n, ...), named with their unit, as in ``{"gap_mismatch [m]": array}``; *scene* draws in space;
    *closing* gives more properties and a report in Markdown when the run has ended; *chunk* is the number of steps that
    go to the file at once.  Raises ScenarioError if the file cannot be written, or does not read back.
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
        chunk: int = 4096,
    ) -> None:
        self.path, self.part = path, path.with_suffix(f".{secrets.token_hex(4)}{path.suffix}.part")
        self.scene, self.health, self.closing, self.signals, self.rows = scene, health, closing, signals, chunk
        self.name, self.properties, self.blueprint = name, properties or {}, blueprint
        rr.set_strict_mode(True)  # wrong data is an error, and not left out with a warning
        self.recording = rr.RecordingStream(APPLICATION, recording_id=recording_id)
        self._named: set[str] = set()  # the series of the master that have their names
        self._points, self._last_sent = 0, ""
        self._flushed = 0.0  # s of wall clock
        self._indexed = True  # the file ends with an index of its chunks
        self._broken = False  # the file takes no more
        self._sender = Sender(self._send)
        self._last: int | None = None  # ns, of the last accepted point
        self.file: Path | None = None  # where the log is now; a run that never began leaves none

    def set_property(self, title: str, table: Mapping[str, Any]) -> None:
        """Add or replace a table of properties: numbers, strings, booleans and lists of them; None is left out."""
        known = {k: _plain(v) for k, v in table.items() if v is not None and np.size(v)}
        if known:
            self.recording.send_property(title, rr.AnyValues(**known))

    # the run

    def started(self, system: System, info: RunInfo) -> None:
        chunk = Chunk(system, self.signals, self.rows)
        chunks = (info.stop_ns - info.start_ns) / info.step_ns / self.rows * len(chunk.logged)
        self._indexed = chunks * OF_CHUNK <= INDEX
        self._open()
        self._sender.begin(chunk)
        for held in chunk.logged:
            describe(self.recording, held.entity, held.variable, held.name)
        self._say(info.start_ns, f"started: {info.algorithm}, step {info.step_ns} ns", "INFO")
        if self.scene is not None:
            self.scene.started(self.recording, system)

    def accepted(self, point: Point) -> None:
        chunk = self._sender.chunk
        assert chunk is not None
        chunk.append(point)
        self._last = point.end
        if chunk.full or self._due(point.wall):
            self._emit_at(point.wall)

    def accepted_block(self, block: Block) -> None:
        done = 0
        while done < len(block.rows):
            chunk = self._sender.chunk
            assert chunk is not None
            if not chunk.numeric:
                super().accepted_block(block)
                return
            done += chunk.extend(block, done)
            self._last, wall = int(block.ends[done - 1]), float(block.walls[done - 1])
            if chunk.full or self._due(wall):
                self._emit_at(wall)

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
        if self._broken:
            self._sender.close()
            self.recording.disconnect()
            return
        interrupted = isinstance(error, (KeyboardInterrupt, SystemExit))
        said = "stopped from outside" if interrupted else str(error) or type(error).__name__
        self._say(self._last, said, "ERROR")
        self._close({"status": "interrupted" if interrupted else "failed", "error": said})

    def _due(self, wall: float) -> bool:
        return wall - self._flushed >= FLUSH_AFTER * max(1.0, AT_MOST * wall)

    def _emit_at(self, wall: float) -> None:
        self.emit(wait=self._due(wall))
        self._flushed = wall

    def emit(self, *, wait: bool = True) -> None:
        """Send what is buffered to the file, and *wait* until it is there; raises ScenarioError if it takes no more."""
        if self._sender.chunk is None or not self._sender.chunk.n:
            return
        self._settle()  # the chunk before is in the file by now, or never will be
        self._sender.turn()
        if wait:
            self._settle()

    def _settle(self) -> None:
        self._sender.drain()
        self._flush()

    def _send(self, chunk: Chunk) -> None:
        """Send a chunk, in the sender's thread."""
        at = index(chunk.ns, chunk.step)
        chunk.send(lambda path, columns: self.recording.send_columns(path, at, columns))
        for label, values in {**chunk.durations(), **(self.health(chunk.read) if self.health else {})}.items():
            self._name_health(label)
            self._last_sent = _health_entity(label)
            self.recording.send_columns(self._last_sent, at, scalars(values[:, None]))
        self._points += chunk.n
        if self.scene is not None:
            self.scene.emit(self.recording, chunk.ns, chunk.step, chunk.read)

    def _open(self) -> None:
        try:
            self.recording.save(str(self.part), default_blueprint=self.blueprint, write_footer=self._indexed)
        except (OSError, RuntimeError) as error:
            raise ScenarioError(
                f"cannot write the log {self.path}: {error}; choose another folder with --out"
            ) from None
        self.file = self.part
        self._introduce()

    def _introduce(self) -> None:
        """Say what does not change: the name and the properties of the run."""
        rr.set_log_time_enabled(False, recording=self.recording)
        if self.name:
            self.recording.send_recording_name(self.name)
        for title, table in self.properties.items():
            self.set_property(title, table)

    def _name_health(self, label: str) -> None:
        if label in self._named:
            return
        self._named.add(label)
        name, _, unit = label.partition(" ")
        unit = unit.strip("[]") or "1"
        about = rr.AnyValues(signal_name=[name], signal_unit=unit)
        self.recording.log(_health_entity(label), style([name], unit), about, static=True)

    def _at(self, ns: int) -> None:
        self.recording.set_time("sim_time", duration=np.timedelta64(ns, "ns"))

    def _say(self, ns: int, text: str, level: str) -> None:
        self._at(ns)
        self.recording.log("log/master", rr.TextLog(text, level=level))

    def _flush(self) -> None:
        """Wait until all is in the file; asked not to wait (a timeout of 0), Rerun can hang when the disk is full."""
        for _ in range(PATIENCE):
            began = perf_counter()
            try:
                self.recording.flush(timeout_sec=TRY)
                return
            except RuntimeError as error:
                why = str(error).splitlines()[0]
                if perf_counter() - began < TRY:  # else it is only slow
                    break
        self._broken = True
        raise ScenarioError(f"the log {self.part} cannot be written any further ({why}): is the disk full?")

    def _close(self, outcome: dict[str, Any]) -> None:
        try:
            self.emit(wait=False)
            self._sender.drain()
            if self.scene is not None:
                self.scene.finished(self.recording)
            self.set_property("outcome", outcome)
            tables, report = self.closing() if self.closing else ({}, "")
            for title, table in tables.items():
                self.set_property(title, table)
            if report:
                self.recording.log("report", rr.TextDocument(report, media_type="text/markdown"), static=True)
            self._flush()
        finally:
            self._sender.close()
            self.recording.disconnect()
        self._finish()

    def _finish(self) -> None:
        verify(self.part, self._last_sent, self._points, indexed=self._indexed)
        self.part.replace(self.path)
        self.file = self.path

    def _discard(self) -> None:
        self._sender.close()
        self.recording.disconnect()
        self.part.unlink(missing_ok=True)
        self.file = None


def verify(path: Path, entity: str, points: int, *, indexed: bool = True) -> None:
    """Read *entity*, the last of every chunk, back from a log that is finished.

    Through its index, if it has one: reading everything would cost a tenth of a short run.  Raises ScenarioError unless
    the file is whole and all *points* are there.
    """
    try:
        with without(rr.error_utils.RerunWarning):  # no index: that is as it should be, or an error follows
            reader = RrdReader(str(path))
            stored = (reader.store().stream() if indexed else reader.stream()).filter(
                content=f"/{entity}", is_static=False
            )
        found = sum(chunk.num_rows for chunk in stored)
    except Exception as error:
        raise ScenarioError(f"the log {path} does not read back: {error}") from None
    if found != points:
        raise ScenarioError(f"the log {path} does not read back: it holds {found} of {points} steps")


def _health_entity(label: str) -> str:
    return f"master/{label.split(' ')[0]}"


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    return value if isinstance(value, (int, float, str, bool, list)) else str(value)
