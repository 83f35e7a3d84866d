"""What is kept in files is what would be made anew, and nothing stale or broken is ever taken."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from toys import Mass

from cosim import kept
from cosim.component import Component
from cosim.equations import build
from plants.rigid_body import RigidBody
from plants.wheel_deformation import WheelDeformation


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("WMR_COSIM_CACHE", str(tmp_path))
    return tmp_path / "kept"


def test_equations_that_were_kept_give_the_same_bits(folder: Path) -> None:
    """Those derived here against those read back, at the start values."""
    part = WheelDeformation()
    key = kept.fingerprint(part)
    made = [kept.kept("equations", key, lambda: build(part)) for _ in range(2)]
    assert len(list(folder.iterdir())) == 1
    assert made[0].feedthrough == made[1].feedthrough
    for name, function in made[0].functions().items():
        arguments = [np.full(function.size_in(i), 0.3 + i) for i in range(function.n_in())]
        again = made[1].functions()[name]
        np.testing.assert_array_equal(np.asarray(function(*arguments)), np.asarray(again(*arguments)))


def test_the_second_does_not_make_it_again(folder: Path) -> None:
    made = []

    def make() -> str:
        made.append(1)
        return "made"

    assert [kept.kept("x", "key", make) for _ in range(2)] == ["made"] * 2
    assert len(made) == 1
    (path,) = folder.iterdir()
    path.write_bytes(path.read_bytes()[:-3])  # cut off
    assert kept.kept("x", "key", make) == "made"
    assert len(made) == 2


def test_what_cannot_be_written_is_made(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").touch()
    monkeypatch.setenv("WMR_COSIM_CACHE", str(tmp_path / "file"))
    assert kept.kept("x", "key", lambda: 7) == 7


def test_the_fingerprint_is_of_all_that_matters(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    one = kept.fingerprint(RigidBody())
    assert one == kept.fingerprint(RigidBody(m=100.0))  # a parameter is no part of the equations
    assert one != kept.fingerprint(RigidBody(traction_arm="centre"))
    assert one != kept.fingerprint(WheelDeformation())
    values = [kept.fingerprint(RigidBody(m=m), values=True) for m in (100.0, 100.0, 101.0)]
    assert values[0] == values[1] != values[2]
    package = tmp_path / "plants"
    package.mkdir()
    (package / "__init__.py").touch()
    monkeypatch.setattr(sys.modules["plants"], "__file__", str(package / "__init__.py"))
    assert one != kept.fingerprint(RigidBody())  # other sources
    (package / "more.py").write_text("x = 1")
    kept.digest.cache_clear()
    assert kept.fingerprint(RigidBody()) is not None


@pytest.mark.parametrize("kind", [Mass, type("Local", (RigidBody,), {"__module__": __name__})])
def test_nothing_is_kept_of_classes_with_unknown_sources(kind: type[Component]) -> None:
    assert kept.fingerprint(kind()) is None
    assert kept.kept("x", None, lambda: 1) == 1
