"""What a log holds when the process or the disk ends before the run does."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import studies
from logs.inspect import describe
from logs.read import signals

PORTS = {"a.in.u", "a.y", "a.since", "a.saw", "g.in.u", "g.y", "master.step_size", "master.wall"}
ROOT = Path(__file__).parents[2]

# A run in a process of its own: two components, steps of 1 ms, chunks of 50; what happens at point 180 is filled in.
RUN = """
import os, resource, signal, sys, time
from pathlib import Path
sys.path[:0] = [{root!r}, {tests!r}]
from toys import Gain, Watch
from cosim import Jacobi, Observer, System, run
from logs.recorder import RerunRecorder

class At(Observer):
    def accepted(self, point):
        if point.number == 180:
            {act}

system = System({{"a": Watch().instance(), "g": Gain().instance()}}, {{"a.u": "a.y"}})
run(system, Jacobi(), step=1_000_000, stop={steps} * 1_000_000,
    observers=[RerunRecorder(Path({path!r}), "killed", chunk=50), At()])
"""


def in_a_process(path: Path, act: str, steps: int = 1000) -> subprocess.CompletedProcess[str]:
    text = RUN.format(root=str(ROOT), tests=str(ROOT / "tests"), act=act, path=str(path), steps=steps)
    return subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, timeout=60, check=False)


# Runs without end, each in a fork of one process that has imported everything, killed at a random moment.  What the
# runs had accepted is told by memory shared with them.
KILLED = """
import json, mmap, os, random, signal, struct, sys, time
from pathlib import Path
import scipy.integrate  # a run does so at its first step
sys.path[:0] = [{root!r}, {tests!r}]
from toys import Gain, Watch
from cosim import Jacobi, Observer, System, run
from logs.recorder import RerunRecorder

class Tell(Observer):
    def accepted(self, point):
        shared[:8] = struct.pack("q", point.number)

shared, draw, told = mmap.mmap(-1, 8), random.Random(7), []
for k in range({times}):
    shared[:8] = struct.pack("q", -1)
    child = os.fork()
    if not child:
        folder = Path({folder!r}) / str(k)
        folder.mkdir()
        system = System({{"a": Watch().instance(), "g": Gain().instance()}}, {{"a.u": "a.y"}})
        run(system, Jacobi(), step=1_000_000, stop=10**9 * 1_000_000,
            observers=[RerunRecorder(folder / "run.rrd", "killed", chunk=50), Tell()])
    while struct.unpack("q", shared[:8])[0] < 0:
        time.sleep(0.001)
    time.sleep(draw.uniform(0.0, 0.3))
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    told.append(struct.unpack("q", shared[:8])[0])
print(json.dumps(told))
"""


def test_a_log_survives_a_kill_at_any_moment(tmp_path: Path) -> None:
    """Twenty times: it opens, is marked, and of no signal a chunk is missing that was written.

    With n + 1 points accepted, (n + 1) // 50 chunks were full; before the last of them is sent, the last but two is in
    the file, and the one between them may be on its way.
    """
    times = 20
    text = KILLED.format(root=str(ROOT), tests=str(ROOT / "tests"), folder=str(tmp_path), times=times)
    done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, timeout=60, check=True)
    accepted = json.loads(done.stdout)
    assert len(set(accepted)) > times // 2  # they were killed at different moments
    for k, n in enumerate(accepted):
        (part,) = (tmp_path / str(k)).iterdir()
        assert part.name.endswith(".rrd.part")
        assert describe(part)["status"] == "unfinished (killed, or still being written)"
        sure = ((n + 1) // 50 - 2) * 50
        found = signals(part) if sure > 0 else {}
        assert sure <= 0 or set(found) == PORTS
        for port, signal_ in found.items():
            assert len(signal_.ns) >= sure, (k, port)
            np.testing.assert_array_equal(signal_.ns, np.arange(len(signal_.ns)) * 1_000_000, err_msg=port)
        if found:
            y = found["a.y"]
            np.testing.assert_array_equal(y.values[:, 0], np.arange(len(y.ns)) / 1000)
    assert max(accepted) > 200  # some were killed long after their first chunk


def test_a_log_that_is_cut_anywhere_opens(tmp_path: Path) -> None:
    """A write that was not finished leaves a part of a message: what is whole before it is read, the file is left."""
    path = tmp_path / "killed.rrd"
    in_a_process(path, "time.sleep(0.5); os._exit(3)")
    (part,) = tmp_path.iterdir()
    data = part.read_bytes()
    last = 0
    for size in (*range(len(data) // 2, len(data), 1009), len(data)):
        cut = tmp_path / "cut.rrd.part"
        cut.write_bytes(data[:size])
        assert describe(cut)["status"] == "unfinished (killed, or still being written)"
        rows = min(len(s.ns) for s in signals(cut).values())
        assert last <= rows <= 150
        assert cut.stat().st_size == size
        last = rows
    assert last == 150


@pytest.mark.parametrize("act", ["os.kill(os.getpid(), signal.SIGKILL)", "os._exit(3)"])
def test_everything_up_to_the_last_written_chunk_survives(tmp_path: Path, act: str) -> None:
    """However the process ends; half a second after a chunk it is in the file."""
    path = tmp_path / "killed.rrd"
    done = in_a_process(path, f"time.sleep(0.5); {act}")
    assert done.returncode in (-signal.SIGKILL, 3), done.stderr
    (part,) = tmp_path.iterdir()
    assert part.name.endswith(".rrd.part")
    found = signals(part)
    # points 0 to 180 were accepted; chunks of 50 were full at 49, 99, 149: 150 points, of every signal
    for port, signal_ in found.items():
        np.testing.assert_array_equal(signal_.ns, np.arange(150) * 1_000_000, err_msg=port)
    np.testing.assert_array_equal(found["a.y"].values[:, 0], np.arange(150) / 1000)
    assert describe(part)["status"] == "unfinished (killed, or still being written)"


def test_a_full_disk_ends_the_run_with_a_sentence(tmp_path: Path) -> None:
    """The file may not grow beyond what it is at point 180: the next chunk cannot be written."""
    path = tmp_path / "full.rrd"
    size = f"max(p.stat().st_size for p in Path({str(tmp_path)!r}).iterdir())"
    done = in_a_process(path, f"resource.setrlimit(resource.RLIMIT_FSIZE, ({size},) * 2)", steps=5000)
    assert done.returncode == 1
    assert "ScenarioError: the log " in done.stderr
    assert "cannot be written any further" in done.stderr
    assert "is the disk full?" in done.stderr
    assert not path.exists()  # never called complete
    (part,) = tmp_path.iterdir()
    # three chunks of 50 were sent by then; the file's size was taken while the last of them might be under way
    assert len(signals(part)["a.y"].ns) >= 100


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_the_command_can_be_told_to_end(tmp_path: Path, number: signal.Signals) -> None:
    """The log is closed and says so, and so does the command."""
    studies.run("ramp-impact", run={"duration": 1e-3})  # builds the FMUs, for which nobody waits below
    scenario = ROOT / "studies" / "ramp-impact.toml"
    command = [sys.executable, "-m", "studies.cli", "run", str(scenario), "--duration", "50", "--out", str(tmp_path)]
    process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        wait_for_rows(tmp_path, process)
        process.send_signal(number)
        _, stderr = process.communicate(timeout=60)
    finally:
        process.kill()
    assert process.returncode == 128 + number, stderr
    assert stderr.strip() == "error: stopped; a log that was begun holds what was computed up to here, and says so"
    (log,) = tmp_path.iterdir()
    facts = describe(log, ["body.pitch"])
    assert facts["status"] == "interrupted"
    assert log.suffix == ".rrd"
    assert facts["signals"]["body.pitch"]["rows"] > 1000


def wait_for_rows(folder: Path, process: subprocess.Popen[str]) -> None:
    """Return when a part has grown beyond its first chunk."""
    for _ in range(2400):
        assert process.poll() is None, process.communicate()
        if any(os.stat(p).st_size > 5_000_000 for p in folder.glob("*.part")):
            return
        time.sleep(0.05)
    raise AssertionError("the run wrote nothing within 120 s")
