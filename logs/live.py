"""Looking at a run while it goes: a viewer of its own on this machine alone, fed beside the log, at a pace of choice.

The viewer gets what the log gets through a recording of its own: who closes it, or whose network is slow, does no harm
to the run and its file.  Nobody else can look: everything listens to the loopback address only.
"""

from __future__ import annotations

import os
import re
import socket
import subprocess
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import quote

import rerun_cli

from cosim.errors import ScenarioError
from cosim.observer import Block, Observer, Point, RunInfo
from cosim.system import System

from .recorder import RerunRecorder

HERE = "127.0.0.1"
BINARY = Path(rerun_cli.__file__).parent / "rerun"
PATIENCE = 30.0  # s until a viewer listens
PROMPT = 0.1  # s of wall clock between two looks
HANG = 2.0  # s that a viewer may take for what it is sent, before it counts as gone
LONGEST = 300  # characters of what a viewer complains about
REST = 1e-3  # s that a sleep is worth


@dataclass(frozen=True)
class Viewer:
    """A viewer that is a process of its own: where it takes data, and the page for a browser (empty for a window)."""

    process: subprocess.Popen[bytes]
    url: str
    page: str

    def wait(self, waiting: Callable[[], None] = lambda: None) -> None:
        """Wait until it is closed or this program is interrupted, and end it then; *waiting* is called before."""
        try:
            waiting()  # whoever is told to interrupt may do so at once
            self.process.wait()
        except (KeyboardInterrupt, SystemExit):
            pass
        finally:
            self.close()

    def close(self) -> None:
        """End it."""
        self.process.terminate()
        self.process.wait()


def start(log: Path | None = None, *, web: bool = False) -> Viewer:
    """Start a viewer on *log*, or an empty one that waits for a run; as a window, or a web page with *web*.

    Raises ScenarioError if it does not start, as where there is no screen.
    """
    port = _free_port()
    arguments = [str(BINARY), "--bind", HERE, "--port", str(port)]
    url, page = f"rerun+http://{HERE}:{port}/proxy", ""
    if web:
        place = _free_port()
        arguments += ["--serve-web", "--web-viewer-port", str(place)]
        page = f"http://{HERE}:{place}/?url={quote(url, safe='')}"
    arguments += [str(log.resolve())] if log is not None else []
    with tempfile.TemporaryFile() as said:
        process = subprocess.Popen(
            arguments, stdin=subprocess.DEVNULL, stdout=said, stderr=said, start_new_session=True,
            env={**os.environ, "RERUN_ANALYTICS": "0"},
        )  # fmt: skip
        if not _listens(process, place if web else port):
            process.kill()
            process.wait()
            said.seek(0)
            why = _reason(said.read().decode(errors="replace"))
            hint = "" if web else "; without a screen, --serve shows it in a browser"
            raise ScenarioError(f"the Rerun viewer does not start ({why}){hint}")
    return Viewer(process, url, page)


def _free_port() -> int:
    with socket.socket() as s:
        s.bind((HERE, 0))
        return int(s.getsockname()[1])


def _listens(process: subprocess.Popen[bytes], port: int) -> bool:
    """Wait until somebody listens at *port*; return whether that is so and the process, its owner, lives."""
    deadline = time.monotonic() + PATIENCE
    while time.monotonic() < deadline and process.poll() is None:
        with socket.socket() as s:
            if s.connect_ex((HERE, port)) == 0:
                break
        time.sleep(0.05)
    try:
        process.wait(0.5)  # without a screen it listens first and fails then
    except subprocess.TimeoutExpired:
        return time.monotonic() < deadline
    return False


def _reason(said: str) -> str:
    lines = [line.strip() for line in said.splitlines() if line.strip()]
    errors = [line for line in lines if "rror" in line]
    return re.sub(r" os error at \S+:", "", (errors or lines or ["it said nothing"])[0])[:LONGEST]


class LiveRecorder(RerunRecorder):
    """Sends a run to the viewer at *url* as it goes; takes what a `RerunRecorder` takes, but writes no file."""

    def __init__(self, path: Path, recording_id: str, *, url: str, **rest: Any) -> None:
        super().__init__(path, recording_id, **rest)
        self.url, self.gone = url, False
        if self.blueprint is not None:
            self.blueprint.time_panel.play_state = "following"  # the newest is what one looks for
            self.blueprint.time_panel.loop_mode = "Off"

    def accepted(self, point: Point) -> None:
        if self.gone:
            return
        super().accepted(point)
        self._prompt(point.wall)

    def accepted_block(self, block: Block) -> None:
        if self.gone:
            return
        super().accepted_block(block)
        self._prompt(float(block.walls[-1]))

    def _prompt(self, wall: float) -> None:
        if wall - self._flushed >= PROMPT:
            self.emit(wait=False)
            self._flushed = wall

    def _open(self) -> None:
        place, _, port = self.url.partition("//")[2].partition("/")[0].rpartition(":")
        with socket.socket() as s:
            self.gone = s.connect_ex((place, int(port))) != 0  # Rerun would wait for it
        if self.gone:
            return
        self.recording.connect_grpc(self.url, default_blueprint=self.blueprint)
        self._introduce()

    def _flush(self, wait: bool = True) -> None:
        try:
            self.recording.flush(timeout_sec=HANG)
        except RuntimeError:
            self.gone = True

    def _finish(self) -> None:
        """Have nothing to read back: there is no file."""


class Pacer(Observer):
    """Lets a run go no faster than *speed* times real time: it sleeps where the computing is ahead."""

    def __init__(self, speed: float) -> None:
        self.speed = speed

    def started(self, system: System, info: RunInfo) -> None:
        self._begin, self._clock = info.start_ns, time.monotonic()

    def accepted(self, point: Point) -> None:
        if point.number == 0:
            self._clock = time.monotonic()  # building up takes a while
        self._wait(point.end)

    def accepted_block(self, block: Block) -> None:
        if block.first == 0:
            self._clock = time.monotonic()
        self._wait(int(block.ends[-1]))

    def _wait(self, end: int) -> None:
        due = self._clock + (end - self._begin) * 1e-9 / self.speed
        ahead = due - time.monotonic()
        if ahead > REST:
            time.sleep(ahead)
