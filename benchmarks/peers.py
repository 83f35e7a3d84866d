"""The other tools that pip can install: a virtual environment for each in the user's cache, and how a run is asked for.

``peer_runs.py`` runs in that environment and knows how each tool is called.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import platformdirs

INSTALLING, RUNNING = 280, 120  # s, at most
RUNS = Path(__file__).parent / "peer_runs.py"


class Peer(NamedTuple):
    """What pip is asked for, and how many macro steps a run makes, so that it takes a second or so."""

    packages: tuple[str, ...]
    steps: int


PEERS = {
    "FMPy": Peer(("fmpy",), 20_000),
    "libcosim": Peer(("libcosimpy",), 20_000),
    "Ecos": Peer(("ecospy", "tbb"), 100_000),
    "CoFMUPy": Peer(("cofmupy",), 5_000),
    "PathSim": Peer(("pathsim", "pathsim-fmi"), 2_000),
    "mosaik": Peer(("mosaik", "mosaik-fmi"), 2_000),
    "fmucontainer": Peer(("fmu-manipulation-toolbox", "fmpy"), 100_000),
    "PyFMI": Peer(("pyfmi",), 20_000),
    "OMSimulator": Peer(("OMSimulator",), 100_000),
}


def prepare(name: str) -> tuple[Path, str]:
    """Return the Python of a peer's environment, made if there is none, and why it cannot be used; empty if it can."""
    folder = platformdirs.user_cache_path("wmr-cosim") / "peers" / name.lower()
    python = folder / ("Scripts/python.exe" if sys.platform == "win32" else "bin/python")
    failed, ready = folder / "failed.txt", folder / "ready"
    if failed.exists():
        return python, failed.read_text()
    if not ready.exists():
        subprocess.run([sys.executable, "-m", "venv", folder], check=True)
        command = [python, "-m", "pip", "install", "-q", *PEERS[name].packages]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=INSTALLING, check=False)
            said = "" if done.returncode == 0 else _reason(done.stderr)
        except subprocess.TimeoutExpired:
            said = f"it did not install within {INSTALLING} s"
        if said:
            failed.write_text(f"pip install {' '.join(PEERS[name].packages)}: {said}")
            return python, failed.read_text()
        ready.touch()
    return python, ""


def measure(name: str, python: Path, files: Sequence[Path], step: float, steps: int, folder: Path) -> dict[str, Any]:
    """Have a peer step the FMUs in a ring; return ``seconds``, ``y`` and ``version``, or the ``reason`` why not."""
    asked = json.dumps({"files": [str(f) for f in files], "step": step, "steps": steps, "folder": str(folder)})
    libraries = {"LD_LIBRARY_PATH": str(python.parent.parent / "lib")}  # Ecos looks for libtbb there
    try:
        done = subprocess.run([python, RUNS, name, asked], capture_output=True, text=True, timeout=RUNNING, check=False,
                              env={**os.environ, **libraries}, cwd=folder)  # fmt: skip
    except subprocess.TimeoutExpired:
        return {"reason": f"{steps} macro steps took longer than {RUNNING} s"}
    answers = [line for line in done.stdout.splitlines() if line.startswith('{"seconds"')]
    if done.returncode != 0 or not answers:
        return {"reason": _reason(done.stderr or done.stdout) + f" (exit code {done.returncode})"}
    answer: dict[str, Any] = json.loads(answers[-1])
    return answer


def _reason(text: str) -> str:
    """Return the line of a tool's last words that says what is wrong."""
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    errors = [line for line in lines if "error" in line.lower() and not line.startswith("note:")]
    return (errors or lines or ["it said nothing"])[-1][:200]
