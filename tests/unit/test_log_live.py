"""A run while it is looked at: the viewer gets the same bits, its end harms nobody, and nobody else can connect."""

from __future__ import annotations

import socket
import subprocess
import time
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from urllib.request import urlopen

import pytest
from toys import Mass

from cosim import Jacobi, System, run
from cosim.errors import ScenarioError
from cosim.observer import Observer, Point
from logs import live
from logs.difference import differences
from logs.read import properties, signals
from studies import session

MS = 1_000_000
SHORT = ["run.duration=0.02"]


@pytest.fixture
def receiver(tmp_path: Path) -> Iterator[tuple[subprocess.Popen[bytes], str, Path]]:
    """Start what takes a run as a viewer does and keeps it in a file: the process, its address and the file."""
    port, kept = live._free_port(), tmp_path / "received.rrd"
    process = subprocess.Popen(
        [str(live.BINARY), "--bind", live.HERE, "--port", str(port), "--save", str(kept)],
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    assert live._listens(process, port)
    yield process, f"rerun+http://{live.HERE}:{port}/proxy", kept
    process.terminate()
    process.wait()


def arrived(log: Path, title: str) -> bool:
    """Wait, half a minute at most, until a file that is still written holds a table of properties."""
    deadline = time.monotonic() + 30
    while time.monotonic() < deadline:
        try:
            if title in properties(log):
                return True
        except ScenarioError:
            pass  # nothing that can be read yet
        time.sleep(0.1)
    return False


def test_the_viewer_gets_what_the_log_gets(receiver: tuple[subprocess.Popen[bytes], str, Path], tmp_path: Path) -> None:
    process, url, kept = receiver
    log = session.run_one("ramp-impact", "pd", SHORT, tmp_path, viewer=url, quiet=True).log
    assert log is not None
    assert arrived(kept, "metrics")  # sent last, so everything else is there
    process.terminate()
    process.wait()
    assert all(d.identical for d in differences(log, kept, ignore=("master.wall",)))
    assert properties(kept)["metrics"] == properties(log)["metrics"]


class Closes(Observer):
    """Ends a process in the middle of a run, or before it."""

    def __init__(self, process: subprocess.Popen[bytes], at: int) -> None:
        self.process, self.at = process, at

    def accepted(self, point: Point) -> None:
        if point.number == self.at:
            self.process.kill()
            self.process.wait()


@pytest.mark.parametrize("at", [-1, 100])
def test_a_viewer_that_goes_takes_nothing_with_it(
    receiver: tuple[subprocess.Popen[bytes], str, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, at: int
) -> None:
    """Killed before the run begins (-1) or in its middle: the log is complete all the same."""
    process, url, _ = receiver
    if at < 0:
        process.kill()
        process.wait()
    monkeypatch.setattr(live, "Pacer", lambda pace: Closes(process, at))
    log = session.run_one("ramp-impact", "pd", SHORT, tmp_path, viewer=url, pace=1.0, quiet=True).log
    assert log is not None
    assert properties(log)["outcome"]["status"] == "complete"
    assert len(signals(log)["body.pitch"].ns) == properties(log)["outcome"]["steps"] + 1
    assert process.poll() is not None


def test_a_page_is_served_to_this_machine_only() -> None:
    shown = live.start(web=True)
    try:
        page, _, query = shown.page.partition("?")
        assert page.startswith("http://127.0.0.1:")
        assert query == "url=rerun%2Bhttp%3A%2F%2F127.0.0.1%3A" + shown.url.split(":")[-1].replace("/", "%2F")
        assert b"<html" in urlopen(page, timeout=10).read(2000)
        for port in (int(page.split(":")[-1].strip("/")), int(shown.url.split(":")[-1].split("/")[0])):
            for other in {a[4][0] for a in socket.getaddrinfo(socket.gethostname(), None, socket.AF_INET)} - {
                live.HERE
            }:
                with closing(socket.socket()) as s:
                    assert s.connect_ex((other, port)) != 0
    finally:
        shown.close()
    assert shown.process.poll() is not None


def test_without_a_screen_there_is_no_window(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"):
        monkeypatch.delenv(name, raising=False)
    with pytest.raises(ScenarioError, match=r"the Rerun viewer does not start \(.+\); without a screen, --serve shows"):
        live.start()


def test_a_paced_run_takes_its_time() -> None:
    """50 ms at half of real time are 0.1 s; unpaced they are a fraction of it, and a fast pace holds nobody up."""

    def lasted(*observers: live.Pacer) -> float:
        system = System({"m": Mass().instance()}, {})
        begun = time.monotonic()
        run(system, Jacobi(), step=MS, stop=50 * MS, observers=list(observers))
        return time.monotonic() - begun

    assert lasted(live.Pacer(0.5)) >= 0.1 - live.REST
    assert lasted(live.Pacer(1e9)) < 0.1
    assert lasted() < 0.1
