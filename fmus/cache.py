"""Where FMUs are built and unpacked: beside the source in a checkout, in the user's cache directory otherwise."""

from __future__ import annotations

import os
from pathlib import Path

import platformdirs


def cache_folder() -> Path:
    """Return the folder: ``WMR_COSIM_CACHE`` if that is set, ``fmus/build`` in a checkout, else the user's cache."""
    if given := os.environ.get("WMR_COSIM_CACHE"):
        return Path(given)
    here = Path(__file__).parent
    if (here.parent / "pyproject.toml").exists():
        return here / "build"
    return platformdirs.user_cache_path("wmr-cosim") / "fmus"
