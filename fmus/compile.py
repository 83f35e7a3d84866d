"""C sources -> shared library: with the system's C compiler, or with the ziglang wheel, which also cross-compiles."""

from __future__ import annotations

import importlib.util
import os
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import fmpy

from cosim import ExportError

from .describe import SOURCE

# no contraction to fused multiply-add: the same numbers on every platform and in the Python instance
# nobody looks at errno or at the exceptions' flags, which do not change a number
MATHS = ("-ffp-contract=off", "-fno-math-errno", "-fno-trapping-math")
FLAGS = ("-std=c11", "-O2", *MATHS, "-fvisibility=hidden", "-DLIBM_IS_LINKED", "-shared")
HERE = fmpy.platform_tuple  # this machine, in FMI 3.0's spelling


@dataclass(frozen=True)
class Platform:
    """A platform an FMU can carry a binary for; *fmi2* is None where FMI 2.0 has no folder for it."""

    target: str  # zig's name, glibc version included
    extension: str
    fmi2: str | None


PLATFORMS = {
    "x86_64-linux": Platform("x86_64-linux-gnu.2.17", ".so", "linux64"),
    "aarch64-linux": Platform("aarch64-linux-gnu.2.17", ".so", None),
    "x86_64-windows": Platform("x86_64-windows-gnu", ".dll", "win64"),
    "x86_64-darwin": Platform("x86_64-macos", ".dylib", "darwin64"),
    "aarch64-darwin": Platform("aarch64-macos", ".dylib", None),
}


def binary_folder(platform: str, fmi: int) -> str:
    """Return the name of a platform's folder under ``binaries``; raises ExportError where FMI 2.0 has none."""
    if platform not in PLATFORMS:
        raise ExportError(f"cannot build for platform {platform!r}; the platforms are {', '.join(PLATFORMS)}")
    if fmi != 2:
        return platform
    if platform == HERE:
        return str(fmpy.platform)  # where FMPy and other importers look on this machine
    folder = PLATFORMS[platform].fmi2
    if folder is None:
        raise ExportError(f"cannot build an FMI 2.0 FMU for {platform}: the standard has no folder for it; use FMI 3.0")
    return folder


def compile_library(sources: Path, output: Path, platform: str) -> None:
    """Compile the sources in a folder to the shared library *output*; raises ExportError."""
    command, environment = _compiler(platform, output.parent)
    position = () if "windows" in platform else ("-fPIC",)
    # a relative source name and no debug information: nothing of this machine's paths gets into the binary
    done = subprocess.run(
        [*command, *FLAGS, *position, "-I.", SOURCE, "-o", str(output.resolve()), "-lm"],
        cwd=sources, env=environment, capture_output=True, text=True, check=False,
    )  # fmt: skip
    if done.returncode != 0 or not output.exists():
        lines = (done.stderr or done.stdout).strip().splitlines()
        lines = [line for line in lines if "error" in line][-8:] or lines[-8:]
        raise ExportError(f"the C compiler {command[0]} failed for {platform} ({output.name}):\n" + "\n".join(lines))


def _compiler(platform: str, folder: Path) -> tuple[list[str], dict[str, str]]:
    environment = dict(os.environ)
    if platform == HERE:
        found = os.environ.get("CC") or next(filter(None, map(shutil.which, ("cc", "gcc", "clang"))), None)
        if found:
            return found.split(), environment
    if importlib.util.find_spec("ziglang") is None:
        purpose = "no C compiler was found" if platform == HERE else f"building for {platform} on {HERE} needs zig"
        raise ExportError(f"{purpose}: install a C compiler or pip install 'wmr-cosim[portable]'"
                          if platform == HERE else f"{purpose}: pip install 'wmr-cosim[portable]'")  # fmt: skip
    environment["ZIG_LOCAL_CACHE_DIR"] = str(folder / "zig-cache")
    return [sys.executable, "-m", "ziglang", "cc", "-target", PLATFORMS[platform].target, "-s"], environment
