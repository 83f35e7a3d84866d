"""The C source of the loop -> a shared library in the cache, compiled once per source, compiler and machine."""

from __future__ import annotations

import ctypes
import hashlib
import importlib.util
import os
import platform
import shutil
import subprocess
import sys
import tempfile
from functools import cache
from pathlib import Path
from typing import Any

from cosim.cache import cache_folder

SOURCE, HEADER = (Path(__file__).parent / name for name in ("loop.c", "loop.h"))
# no contraction to fused multiply-add: the same numbers as NumPy's
FLAGS = ("-std=c11", "-O2", "-ffp-contract=off", "-fvisibility=hidden", "-shared")


def compiler() -> list[str] | None:
    """Return the command of this machine's C compiler: ``CC``, cc, gcc, clang, or the ziglang wheel's; None without."""
    found = os.environ.get("CC") or next(filter(None, map(shutil.which, ("cc", "gcc", "clang"))), None)
    if found:
        return found.split()
    if importlib.util.find_spec("ziglang") is not None:
        return [sys.executable, "-m", "ziglang", "cc"]
    return None


@cache
def library() -> tuple[Any, str]:
    """Return the loaded library, or None and a clause that says why there is none."""
    windows = sys.platform == "win32"
    about = repr((SOURCE.read_bytes(), HEADER.read_bytes(), FLAGS, platform.machine(), sys.platform))
    key = hashlib.sha256(about.encode()).hexdigest()[:12]
    path = cache_folder() / f"loop-{key}{'.dll' if windows else '.so'}"
    try:
        if not path.exists():
            _compile(path, () if windows else ("-fPIC",))
        return ctypes.CDLL(str(path)), ""
    except (OSError, RuntimeError) as error:
        return None, str(error)


def _compile(path: Path, position: tuple[str, ...]) -> None:
    command = compiler()
    if command is None:
        raise RuntimeError("no C compiler was found: install one, or pip install 'wmr-cosim[portable]'")
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=".loop-") as work:
        built = Path(work, path.name)
        done = subprocess.run(
            [*command, *FLAGS, *position, str(SOURCE), "-o", str(built)],
            env={**os.environ, "ZIG_LOCAL_CACHE_DIR": work}, capture_output=True, text=True, check=False,
        )  # fmt: skip
        if done.returncode != 0 or not built.exists():
            said = (done.stderr or done.stdout).strip().splitlines()
            raise RuntimeError(f"the C compiler {command[0]} failed: {said[-1] if said else 'it said nothing'}")
        os.replace(built, path)  # atomic: who compiles at the same time gets either file
