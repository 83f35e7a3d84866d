"""Help that teaches, the version, the FMU commands, progress where there is a terminal, and the viewer."""

from __future__ import annotations

import io
import json
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path

import pytest
from commandline import Command
from rich.console import Console

from logs import live
from studies import session, terminal

COMMANDS = ("list", "run", "compare", "explain", "inspect", "logs", "fmu build", "fmu check", "fmu info")


@pytest.mark.parametrize("command", COMMANDS)
def test_help_has_an_example(wmr: Command, command: str) -> None:
    said = wmr(*command.split(), "--help")
    assert (said.code, said.err) == (0, "")
    text = " ".join(said.out.split())
    assert f"Example: wmr-cosim {command}" in text
    assert "--json" in text


def test_help_of_the_whole(wmr: Command) -> None:
    said = wmr("--help")
    assert said.code == 0
    assert "Start here: wmr-cosim compare" in said.out
    for command in ("list", "run", "compare", "explain", "inspect", "logs", "fmu"):
        assert f" {command} " in said.out


def test_version(wmr: Command) -> None:
    assert wmr("--version") == (0, f"wmr-cosim {version('wmr-cosim')}\n", "")


def test_fmus_are_built_checked_and_described(wmr: Command, tmp_path: Path) -> None:
    built = wmr("fmu", "build", "Uncontrolled", "--out", tmp_path)
    assert (built.code, built.err) == (0, "")
    files = [tmp_path / f"Uncontrolled.fmi{v}.fmu" for v in (3, 2)]
    assert [line.split()[-1] for line in built.out.splitlines()[1:]] == [str(f) for f in files]
    document = json.loads(wmr("fmu", "build", "Uncontrolled", "--fmi", 2, "--json").out)
    assert [(row["component"], row["fmi"]) for row in document] == [("Uncontrolled", 2)]
    assert Path(document[0]["path"]).stat().st_size == document[0]["bytes"]

    checked = wmr("fmu", "check", *files)
    assert (checked.code, checked.out.splitlines()) == (0, [f"{f}: no problems found" for f in files])
    assert json.loads(wmr("fmu", "check", *files, "--json").out) == {str(f): [] for f in files}

    info = wmr("fmu", "info", files[0])
    assert info.code == 0
    (row,) = (line for line in info.out.splitlines() if line.split()[:1] == ["traction_demand"])
    assert row.split()[1:5] == ["output", "Float64", "4", "N"]
    facts = json.loads(wmr("fmu", "info", files[0], "--json").out)
    assert facts["fmi"] == "3.0"
    assert "traction_demand" in {v["name"] for v in facts["variables"]}


def test_a_bar_is_shown_to_a_terminal_only(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: dict[bool, str] = {}
    for is_terminal in (True, False):
        stream = io.StringIO()
        monkeypatch.setattr(
            terminal, "Console", lambda stderr, s=stream, t=is_terminal: Console(file=s, force_terminal=t, width=80)
        )
        with terminal.progress() as bar:
            bar("building [x]")
            bar("building [x]", 0.5)
            if bar.progress is not None:
                bar.progress.refresh()
        seen[is_terminal] = stream.getvalue()
    assert "building [x]" in seen[True]
    assert seen[False] == ""


def test_a_run_tells_how_far_it_is(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    told: list[tuple[str, float | None]] = []

    class Told(terminal.Bar):
        def __init__(self) -> None:
            super().__init__(None)

        def __call__(self, label: str, share: float | None = None) -> None:
            told.append((label, share))

    from studies.catalog import find_scenario

    file = find_scenario("ramp-impact")
    session.run_scenario(file.load(None, file.overrides(["run.duration=0.1"])), None, Told())
    assert any(label.startswith("ramp-impact uncontrolled: FMU ") and share is None for label, share in told)
    shares = [share for _, share in told if share is not None]
    assert len(shares) >= 4
    assert shares == sorted(shares)
    assert shares[-1] == 1.0


class Opened:
    """Stands for a viewer: tells what it was asked to show, and takes nothing."""

    url = page = ""

    def __init__(self, log: Path | None, web: bool) -> None:
        self.log, self.web, self.ended = log, web, ""

    def wait(self, waiting: Callable[[], None]) -> None:
        waiting()
        self.ended = "waited for"

    def close(self) -> None:
        self.ended = "closed"


@pytest.fixture
def opened(monkeypatch: pytest.MonkeyPatch) -> list[Opened]:
    """Return the viewers that are started, none of which is one."""
    started: list[Opened] = []

    def start(log: Path | None = None, *, web: bool = False) -> Opened:
        started.append(Opened(log, web))
        return started[-1]

    monkeypatch.setattr(live, "start", start)
    return started


@pytest.mark.parametrize("how", ["--view", "--serve"])
def test_a_comparison_is_shown_when_it_is_done(wmr: Command, opened: list[Opened], tmp_path: Path, how: str) -> None:
    names = ("--variants", "uncontrolled,pd-friction")
    assert wmr("compare", "ramp-impact", *names, "--duration", "2e-3", "--out", tmp_path, how).code == 0
    (shown,) = opened
    assert shown.log == tmp_path / "ramp-impact-all.rrd"
    assert (shown.web, shown.ended) == ((False, "") if how == "--view" else (True, "waited for"))


def test_a_viewer_is_there_before_the_run_and_goes_if_there_is_none(
    wmr: Command, opened: list[Opened], tmp_path: Path
) -> None:
    said = wmr("run", "ramp-impact", "--set", "wheels.kw=1", "--out", tmp_path, "--view")
    assert said.code == 1
    (shown,) = opened
    assert (shown.log, shown.ended) == (None, "closed")
