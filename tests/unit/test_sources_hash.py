"""The hash of the sources: what is built meanwhile is none of its business."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import pytest

from studies.inputs import sources


def test_it_never_looks_into_a_folder_where_others_build(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two processes may start at once on an empty cache: a folder of the other's build is gone before it is read."""
    visited: list[Path] = []
    scandir = os.scandir

    def watched(path: Any = ".") -> Any:
        visited.append(Path(path))
        return scandir(path)

    monkeypatch.setattr(os, "scandir", watched)
    sources.cache_clear()
    assert len(sources()) == 16
    assert any(path.name == "harness" for path in visited)
    assert not any("build" in path.parts for path in visited)
