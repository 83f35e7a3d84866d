"""FMUs with event mode, compiled once per session."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from hybrid import Make, hybrid

import fmus
from cosim import Instance


@pytest.fixture(scope="session")
def make(tmp_path_factory: pytest.TempPathFactory) -> Make:
    """Return a function that gives an instance of a model of ``hybrid_fmi3.c`` with parameters set."""
    folder = tmp_path_factory.mktemp("hybrid")
    made: dict[Any, Path] = {}

    def instance(
        model: str,
        build: dict[str, Any] | None = None,
        isolated: bool = False,
        retry: bool = False,
        **parameters: float,
    ) -> Instance:
        key = (model, *sorted((build or {}).items()))
        if key not in made:
            made[key] = hybrid(folder / str(len(made)), model, **(build or {}))
        found = fmus.load(made[key], isolated=isolated, retry=retry)
        for name, value in parameters.items():
            found.set(name, value)
        return found

    return instance
