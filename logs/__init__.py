"""Logs of runs: written while a run goes, compared, inspected, read back.

``logs.load(path)`` gives an xarray dataset.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .read import load

__all__ = ["load"]


def __getattr__(name: str) -> Any:
    """Import what is asked for when it is: Rerun and xarray take a while, and who wants a colour needs neither."""
    if name == "load":
        from .read import load

        return load
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
