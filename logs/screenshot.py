"""A picture of a log as the viewer shows it, without a screen: ``python -m logs.screenshot LOG.rrd OUT.png --at 0.14``.

Needs a Vulkan adapter; one in software does (Debian's package ``mesa-vulkan-drivers``).
"""

from __future__ import annotations

import argparse
import io
import os
import socket
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import rerun_cli
from PIL import Image
from rerun.chunk import RrdReader
from rerun.experimental import ViewerClient

from cosim.errors import CosimError, ScenarioError

from .blueprint import question_of
from .questions import QUESTIONS
from .recorder import APPLICATION

BINARY = Path(rerun_cli.__file__).parent / "rerun"
HERE = "127.0.0.1"  # nobody but this machine can connect
SIZE = (1600, 1000)  # px of the window
PATIENCE = 20.0  # s until a log is loaded
SETTLE = 2.0  # s in which axes and legends find their places


@contextmanager
def viewer() -> Iterator[Any]:
    """Start a viewer without a window and end it afterwards; raises ScenarioError where it cannot start."""
    port = _free_port()
    size = "x".join(str(n) for n in SIZE)
    asked = [str(BINARY), "--headless", "--bind", HERE, "--port", str(port), "--window-size", size,
             "--hide-welcome-screen", "--memory-limit", "2GB"]  # fmt: skip
    process = subprocess.Popen(asked, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                               env={**os.environ, "RERUN_ANALYTICS": "0"})  # fmt: skip
    try:
        yield _connected(process, f"rerun+http://{HERE}:{port}/proxy")
    finally:
        process.kill()
        process.wait()


def _connected(process: subprocess.Popen[bytes], url: str) -> Any:
    """Return the client of a viewer as soon as it draws; raises ScenarioError if it never does."""
    deadline, why = time.monotonic() + PATIENCE, ""
    while process.poll() is None and time.monotonic() < deadline:
        try:
            client = ViewerClient.connect(url)
            client.take_screenshot(max_size=64)
            return client
        except Exception as error:
            why = str(error)
            time.sleep(0.2)
    why = why if process.poll() is None else f"exit code {process.returncode}"
    raise ScenarioError(
        f"the Rerun viewer does not start without a screen ({why}): is there a Vulkan adapter? "
        "On Debian, apt-get install mesa-vulkan-drivers brings one in software"
    )


def _free_port() -> int:
    with socket.socket() as s:
        s.bind((HERE, 0))
        return int(s.getsockname()[1])


def show(client: Any, log: Path, at: float, question: str = "") -> Any:
    """Open *log* at the time *at* in s and wait until it is drawn; returns the state of the viewer with its views.

    A *question* shows that one alone, whatever the log opens with: a view in a tab behind another has no picture.
    """
    with TemporaryDirectory() as scratch:
        client.open(str(_asked(log, question, Path(scratch)).resolve()))
        return _settled(client, log, at)


def _asked(log: Path, question: str, scratch: Path) -> Path:
    """Return a log that opens with *question* alone."""
    if not question:
        return log
    blueprint = question_of(question, log)
    view, data, out = scratch / "view.rbl", scratch / "data.rrd", scratch / "asked.rrd"
    application = f"{APPLICATION}_{question}"  # a viewer keeps one blueprint for each application
    blueprint.save(application, str(view))
    reader = RrdReader(str(log))  # its stream leaves out the blueprint of the log, which would be the one that is used
    name = f"{reader.recordings()[0].recording_id}-{question}"
    reader.stream().write_rrd(str(data), application_id=application, recording_id=name)
    merge = [str(BINARY), "rrd", "merge", str(view), str(data), "-o", str(out)]
    merged = subprocess.run(merge, capture_output=True, text=True, check=False)
    if merged.returncode:
        raise ScenarioError(f"cannot show {log} as {question}: {merged.stderr.strip()[:300]}")
    return out


def _settled(client: Any, log: Path, at: float) -> Any:
    client.set_time("sim_time", duration=at, play_state="paused")
    deadline = time.monotonic() + PATIENCE
    while client.get_state().loading or not client.get_state().views:
        if time.monotonic() > deadline:
            raise ScenarioError(f"the viewer has not shown {log} within {PATIENCE:g} s")
        time.sleep(0.2)
    time.sleep(SETTLE)
    return client.get_state()


def screenshot(log: Path, out: Path, at: float, width: int = 1600, question: str = "") -> Path:
    """Write the picture of *log* at the time *at* in s to the PNG *out*, in 256 colours to keep it small."""
    with viewer() as client:
        show(client, log, at, question)
        data = client.take_screenshot(max_size=width)
    image = Image.open(io.BytesIO(data)).convert("RGB")
    image.quantize(256, dither=Image.Dither.NONE).save(out, optimize=True)
    return out


def main() -> None:
    """Take the picture that the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("log", type=Path, help="a .rrd file written by run or compare")
    parser.add_argument("out", type=Path, help="the PNG file to write")
    parser.add_argument("--at", type=float, default=0.0, help="simulated time in s")
    parser.add_argument("--question", default="", help=f"show one view alone: {', '.join(QUESTIONS)}")
    chosen = parser.parse_args()
    try:
        screenshot(chosen.log, chosen.out, chosen.at, question=chosen.question)
    except CosimError as error:
        parser.exit(1, f"error: {error}\n")


if __name__ == "__main__":
    main()
