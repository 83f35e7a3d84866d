"""``wmr-cosim figures`` as a user meets it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from commandline import Command

from studies.figures import register
from studies.figures.entry import Entry
from studies.figures.sheet import Sheet


def broken() -> Sheet:
    raise ZeroDivisionError("nothing there")


def test_the_list(wmr: Command) -> None:
    said = wmr("figures", "--list")
    assert (said.code, said.err) == (0, "")
    document = json.loads(wmr("figures", "--list", "--json").out)
    assert document == {e.key: e.title for e in register.chosen()}
    assert len(said.out.splitlines()) == 1 + len(document)
    assert next(iter(json.loads(wmr("figures", "chapter 5", "--list", "--json").out))) == "thesis table 5.1"


def test_the_table_writes_nothing(wmr: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    said = wmr("figures", "thesis 4.5", "thesis 5.2", "--table", "--jobs", 1)
    assert (said.code, said.err) == (0, "")
    assert "rear-wheel traction can be largest" in said.out
    assert said.out.splitlines()[-1].startswith("Of 4 claims about 2 figures and tables: 3 reproduced, 1 trend only")
    assert not list(tmp_path.iterdir())


def test_pictures_in_two_processes(wmr: Command, tmp_path: Path) -> None:
    said = wmr("figures", "thesis table 5.1", "thesis 5.2", "--out", tmp_path)
    assert (said.code, said.err) == (0, "")
    assert said.out.splitlines()[-1] == f"wrote {tmp_path / 'index.html'}"
    names = {f"thesis_{n}.{s}" for n in ("table_5_1", "5_2") for s in ("png", "csv")}
    assert {p.name for p in tmp_path.iterdir()} == names | {"index.html"}


def test_a_failure_is_said_and_the_rest_is_there(wmr: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fine = register.chosen(["thesis 5.2"])
    monkeypatch.setattr(register, "ENTRIES", (*fine, Entry("thesis 5.9", "broken", broken)))
    said = wmr("figures", "--out", tmp_path, "--jobs", 1)
    assert said.code == 1
    assert said.err.strip() == "error: thesis 5.9: ZeroDivisionError: nothing there"
    assert (tmp_path / "thesis_5_2.png").exists()
    assert "nothing there" in (tmp_path / "index.html").read_text()


def test_an_unknown_figure(wmr: Command) -> None:
    said = wmr("figures", "thesis 4.45", "--table")
    assert said.code == 1
    assert said.err.startswith("error: there is no figure 'thesis 4.45'; ")
    assert "thesis 4.4" in said.err
