"""A picture of a log as the viewer shows it, without a screen: ``python -m logs.screenshot LOG.rrd OUT.png --at 0.14``.

Needs a Vulkan adapter; one in software does (Debian's package ``mesa-vulkan-drivers``).
"""

from __future__ import annotations

import argparse
import io
import os
import socket
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import rerun_cli
from PIL import Image
from rerun.experimental import ViewerClient

from cosim.errors import CosimError, ScenarioError

BINARY = Path(rerun_cli.__file__).parent / "rerun"
PATIENCE = 20.0  # s until a log is loaded
SETTLE = 2.0  # s in which axes and legends find their places


@contextmanager
def viewer() -> Iterator[Any]:
    """Start a viewer without a window and end it afterwards; raises ScenarioError where it cannot start."""
    os.environ.setdefault("RERUN_ANALYTICS", "0")
    client = None
    try:
        client = ViewerClient.spawn(
            headless=True, port=_free_port(), hide_welcome_screen=True, memory_limit="2GB", executable_path=str(BINARY)
        )
        client.take_screenshot(max_size=64)
    except Exception as error:
        raise ScenarioError(
            f"the Rerun viewer does not start without a screen ({error}): is there a Vulkan adapter? "
            "On Debian, apt-get install mesa-vulkan-drivers brings one in software"
        ) from None
    try:
        yield client
    finally:
        client.quit()


def _free_port() -> int:
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return int(s.getsockname()[1])


def show(client: Any, log: Path, at: float) -> Any:
    """Open *log* at the time *at* in s and wait until it is drawn; returns the state of the viewer with its views."""
    client.open(str(log.resolve()))
    client.set_time("sim_time", duration=at, play_state="paused")
    deadline = time.monotonic() + PATIENCE
    while client.get_state().loading or not client.get_state().views:
        if time.monotonic() > deadline:
            raise ScenarioError(f"the viewer has not shown {log} within {PATIENCE:g} s")
        time.sleep(0.2)
    time.sleep(SETTLE)
    return client.get_state()


def screenshot(log: Path, out: Path, at: float, width: int = 1600) -> Path:
    """Write the picture of *log* at the time *at* in s to the PNG *out*, in 256 colours to keep it small."""
    with viewer() as client:
        show(client, log, at)
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
    chosen = parser.parse_args()
    try:
        screenshot(chosen.log, chosen.out, chosen.at)
    except CosimError as error:
        parser.exit(1, f"error: {error}\n")


if __name__ == "__main__":
    main()
