"""Nothing of an FMU in a process of its own is left when it, its importer or a call into it ends, however."""

from __future__ import annotations

import gc
import os
import re
import resource
import signal
import subprocess
import sys
import textwrap
import time
import zipfile
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from odd import ODDITIES

import fmus
from cosim import ExportError, StepError, WiringError
from cosim.clock import NS
from fmus import IsolatedFmu
from fmus.binding import Log
from fmus.process import Process

ROOT = Path(__file__).parents[2]


def gone(pid: int) -> bool:
    """Whether a process is gone, or is after five seconds."""
    for _ in range(100):
        try:
            status = Path(f"/proc/{pid}/stat").read_text().rsplit(") ", 1)[1]
        except OSError:
            return True
        if status.startswith("Z"):
            return True
        time.sleep(0.05)
    return False


def descriptors() -> int:
    return len(os.listdir("/dev/fd"))


def started(path: Path, oddity: str, **how: Any) -> IsolatedFmu:
    instance = fmus.load(path, "odd", isolated=True, **how)
    assert isinstance(instance, IsolatedFmu)
    instance.set("oddity", ODDITIES.index(oddity))
    instance.enter_initialization()
    instance.exit_initialization()
    return instance


IMPORTER = """
import sys
import fmus
instance = fmus.load(sys.argv[1], "odd", isolated=True)
instance.set("oddity", int(sys.argv[2]))
instance.enter_initialization()
instance.exit_initialization()
print(instance.pid, flush=True)
if int(sys.argv[2]):
    instance.step(0, 10**9)
sys.stdin.read()
"""


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="needs /proc to see other processes")
@pytest.mark.parametrize("oddity", ["none", "hang"])
def test_it_dies_with_its_importer(oddity: str, odd_fmus: dict[int, Path], tmp_path: Path) -> None:
    """Also in the midst of a call that does not return, and however the importer is killed."""
    script = tmp_path / "importer.py"
    script.write_text(textwrap.dedent(IMPORTER))
    arguments = [sys.executable, script, odd_fmus[3], str(ODDITIES.index(oddity))]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    with subprocess.Popen(arguments, stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=environment) as importer:
        assert importer.stdout is not None
        worker = int(importer.stdout.readline())
        assert Path(f"/proc/{worker}").exists()
        time.sleep(0.2)  # it is in the call by now
        importer.kill()
    assert gone(worker)


def test_an_interrupt_ends_a_call_that_does_not_return(odd_fmus: dict[int, Path]) -> None:
    instance = started(odd_fmus[3], "hang")
    old = signal.signal(signal.SIGALRM, signal.default_int_handler)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.3)
        with pytest.raises(KeyboardInterrupt):
            instance.step(0, NS)
    finally:
        signal.signal(signal.SIGALRM, old)
    with pytest.raises(WiringError, match="odd was interrupted in the midst of a call and cannot be used any more"):
        instance.step(0, NS)  # the answer to the first one would be taken for its
    pid, began = instance.pid, time.monotonic()
    instance.close()
    assert time.monotonic() - began < 2.0
    assert gone(pid)


def test_closing_leaves_nothing(odd_fmus: dict[int, Path]) -> None:
    before = descriptors()
    for oddity in ("none", "crash"):
        instance = started(odd_fmus[2], oddity)
        if oddity == "crash":
            with pytest.raises(StepError):
                instance.step(0, NS)
        instance.close()
        assert gone(instance.pid)
        assert descriptors() == before


def test_what_it_has_started_ends_with_it(fmi: int, odd_fmus: dict[int, Path]) -> None:
    """An FMU that starts its tool and hangs: both are gone after the time limit."""
    instance = started(odd_fmus[fmi], "start a tool", time_limit=0.5)
    with pytest.raises(StepError, match=r"tool \d+") as found:
        instance.step(0, NS)
    (tool,) = re.findall(r"tool (\d+)", str(found.value))
    assert gone(int(tool))
    instance.close()


# A fork has a copy of the instance and of its socket: whatever it does with them, the importer goes on.
FORK = """
import os, sys
import fmus
instance = fmus.load(sys.argv[1], "odd", isolated=True)
instance.enter_initialization()
instance.exit_initialization()
child = os.fork()
if not child:
    try:
        instance.step(0, 10**9)
    except Exception as error:
        print(type(error).__name__, error, flush=True)
    instance.close()
    del instance
    sys.exit()
assert os.waitpid(child, 0)[1] == 0
instance.push()
instance.step(0, 10**9)
instance.pull()
print(instance.y[0])
instance.close()
"""


def test_a_fork_does_not_disturb_its_importer(odd_fmus: dict[int, Path]) -> None:
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-c", FORK, str(odd_fmus[3])]
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
    assert done.stderr == ""
    assert done.stdout.splitlines() == [
        "WiringError odd belongs to the process that loaded it and cannot be used any more",
        "1.0",
    ]


@pytest.mark.skipif(not Path("/proc/self/fd").exists(), reason="needs /proc to see files of other processes")
def test_what_it_writes_to_its_standard_error_does_not_fill_the_disk(odd_fmus: dict[int, Path]) -> None:
    """6.4 MB per step; a second later most of it is gone, of which only the last line is ever looked at."""
    instance = started(odd_fmus[3], "write a lot")
    file = Path(f"/proc/{instance.pid}/fd/2")
    instance.step(0, NS)
    assert file.stat().st_blocks * 512 > 6_000_000
    until = time.monotonic() + 10
    while file.stat().st_blocks and time.monotonic() < until:
        time.sleep(0.05)
    assert file.stat().st_blocks == 0
    os.kill(instance.pid, signal.SIGKILL)
    with pytest.raises(StepError, match=r"it crashed: SIGKILL \(killed\); only its own process"):
        instance.step(NS, 2 * NS)


def test_one_that_cannot_be_started_leaves_nothing(
    odd_fmus: dict[int, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """There is no binary for this machine, or this process may open no more files."""
    unraisable: list[Any] = []
    monkeypatch.setattr(sys, "unraisablehook", unraisable.append)
    elsewhere = tmp_path / "elsewhere.fmu"
    with zipfile.ZipFile(odd_fmus[3]) as old, zipfile.ZipFile(elsewhere, "w") as new:
        new.writestr("modelDescription.xml", old.read("modelDescription.xml"))
    with pytest.raises(ExportError, match="has no binary for"):
        fmus.load(elsewhere, isolated=True)
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    for more in range(7):  # files of its own, a socket with two ends, memory, and two that starting a process takes
        before = descriptors()
        resource.setrlimit(resource.RLIMIT_NOFILE, (before + 50, hard))
        taken = []
        try:
            with suppress(OSError):
                while True:
                    taken.append(os.dup(0))
            for _ in range(more):
                os.close(taken.pop())
            with pytest.raises(ExportError, match=r"odd3.fmu cannot be given a process of its own: Too many"):
                Process("odd3.fmu", 1, 1, Log())
        finally:
            for descriptor in taken:
                os.close(descriptor)
            resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))
        assert descriptors() == before
    gc.collect()
    assert not unraisable
