"""Where things go: logs in ``logs/runs`` of a source checkout, in ``./runs`` of an installed package."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryFile

from cosim.errors import ScenarioError


def source_checkout() -> Path | None:
    """Return the root of the source checkout this package runs from, or None if it is installed."""
    root = Path(__file__).resolve().parent.parent
    return root if (root / "pyproject.toml").is_file() and (root / "fmus" / "harness").is_dir() else None


def run_folder(chosen: Path | None = None) -> Path:
    """Return the folder for logs and pictures, made if needed; raises ScenarioError if it cannot be written."""
    root = source_checkout()
    folder = chosen or (root / "logs" / "runs" if root else Path("runs"))
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with TemporaryFile(dir=folder):  # of nobody's name: another run may try the same at the same time
            pass
    except OSError as error:
        raise ScenarioError(
            f"cannot write to the folder {folder}: {error.strerror}; choose another with --out"
        ) from None
    return folder
