"""Where FMUs and the compiled loop are built and FMUs unpacked: in a checkout, or in the user's cache directory."""

from __future__ import annotations

import os
from pathlib import Path

import platformdirs


def cache_folder() -> Path:
    """Return the folder: ``WMR_COSIM_CACHE`` if that is set, ``fmus/build`` in a checkout, else the user's cache."""
    if given := os.environ.get("WMR_COSIM_CACHE"):
        return Path(given)
    checkout = Path(__file__).parents[1]
    if (checkout / "pyproject.toml").exists():
        return checkout / "fmus" / "build"
    return platformdirs.user_cache_path("wmr-cosim") / "fmus"
