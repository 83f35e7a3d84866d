"""Odd FMUs of both versions, built once."""

from __future__ import annotations

from pathlib import Path

import pytest
from odd import odd, state_flag


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Run a test that takes ``fmi`` for both versions."""
    if "fmi" in metafunc.fixturenames:
        metafunc.parametrize("fmi", [2, 3], ids=["fmi2", "fmi3"])


@pytest.fixture(scope="session")
def odd_fmus(tmp_path_factory: pytest.TempPathFactory) -> dict[int, Path]:
    """Return the odd FMUs by version; they can be taken back."""
    folder = tmp_path_factory.mktemp("odd")
    return {fmi: odd(folder / str(fmi), fmi, state_flag(fmi)) for fmi in (2, 3)}
