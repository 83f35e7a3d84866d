"""Where a run was made: known for a checkout with history, left out elsewhere."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

from controllers.sensor import Sensor
from studies import origin
from studies.catalog import find_scenario


def git(root: Path, *arguments: str) -> str:
    who = ["-c", "user.name=a", "-c", "user.email=a@b.c"]
    done = subprocess.run(["git", "-C", str(root), *who, *arguments], capture_output=True, text=True, check=True)
    return done.stdout.strip()


def test_commit_and_whether_it_is_what_runs(tmp_path: Path) -> None:
    file = tmp_path / "a.py"
    file.write_text("x = 1\n")
    git(tmp_path, "init", "-q")
    git(tmp_path, "add", "a.py")
    git(tmp_path, "commit", "-qm", "first")
    (tmp_path / "untracked.txt").write_text("a log, say")
    commit = git(tmp_path, "rev-parse", "HEAD")
    assert origin.checkout.__wrapped__(tmp_path) == {"git_commit": commit, "git_dirty": False}
    file.write_text("x = 2\n")
    assert origin.checkout.__wrapped__(tmp_path) == {"git_commit": commit, "git_dirty": True}


def test_nothing_is_known_without_history_or_git(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert origin.checkout.__wrapped__(None) == {}  # an installed package
    assert origin.checkout.__wrapped__(tmp_path) == {}
    (tmp_path / ".git").mkdir()  # no repository
    assert origin.checkout.__wrapped__(tmp_path) == {}
    monkeypatch.setenv("PATH", "")
    assert origin.checkout.__wrapped__(tmp_path) == {}


def test_the_host_has_processors() -> None:
    found = origin.host()
    assert found["cpus"] == os.cpu_count()
    assert found["machine"] == os.uname().machine
    assert found["cpu"]


def test_seeds_of_components_and_ground() -> None:
    """A sensor's seed is in no scenario as long as it is the one of its class."""
    scenario = find_scenario("rigid-rough").load()
    assert origin.seeds(scenario, {"eye": Sensor().instance()}) == {
        "name": ["eye.seed", "ground.seed"],
        "value": [0, 1],
    }
    assert origin.seeds(find_scenario("ramp-impact").load(), {}) == {"name": [], "value": []}
