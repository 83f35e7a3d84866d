"""The report on the figures: complete, its links lead somewhere, and a figure that fails loses no other."""

from __future__ import annotations

import os
import struct
from dataclasses import replace
from functools import partial
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from cosim.errors import ScenarioError
from studies.errata import find
from studies.errata.pages import register_html
from studies.figures import register
from studies.figures.build import Outcome, _elsewhere, build
from studies.figures.claim import CONTRADICTED, REPRODUCED, Claim
from studies.figures.entry import Entry
from studies.figures.page import write_page
from studies.figures.parts import PARTS
from studies.figures.sheet import Sheet, panels
from studies.figures.summary import counts, sentence

# what the report must have, besides chapter 6 and the papers on jerk and impact
REQUIRED = {
    *(f"thesis {n}" for n in ("3.2", "4.4", "4.5", "4.7", "4.8 velocity", "4.8 dimensions")),
    *(f"thesis {n}" for n in ("5.2", "5.3", "5.4", "5.5")),
    *(f"thesis 6.{n}" for n in (5, 6, 7, 8, 9, 10, 11, 14, 15)), *(f"wheel impact paper {n}" for n in range(4, 11)),
    *(f"DYMAC paper {n}" for n in (3, 4, 5)), *(f"ASME paper {n}" for n in (3, 4, 6)), "TIMR paper 3",
    *(f"thesis {n}" for n in ("7.3", "8.2", "8.3-8.5", "8.6", "8.7-8.8", *(f"8.{k}" for k in range(9, 16)))),
    *(f"thesis table {n}" for n in ("4.1", "5.1", "6.1", "6.2", "8.1")),
    *(f"smooth manoeuvre paper {n}" for n in ("4", "5", "6", "7", "table 1")),
    *(f"shock paper {n}" for n in ("table 1", "3", "4", "5")),
    *(f"{paper} paper table" for paper in ("DYMAC", "ASME", "TIMR")), "wheel impact paper table 1",
}  # fmt: skip
CHEAP = ("thesis 4.5", "thesis table 4.1", "smooth manoeuvre paper 4", "shock paper 4")


class Links(HTMLParser):
    """What a page refers to, and the names it has."""

    def __init__(self) -> None:
        super().__init__()
        self.files: list[str] = []
        self.jumps: list[str] = []
        self.ids: list[str] = []
        self.text = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        self.ids += [given["id"] or ""] if "id" in given else []
        target = given.get("href") or given.get("src") or ""
        if target.startswith("#"):
            self.jumps.append(target[1:])
        elif target and not target.startswith("data:"):
            self.files.append(target)

    def handle_data(self, data: str) -> None:
        self.text += data


def parsed(page: Path) -> Links:
    links = Links()
    links.feed(page.read_text(encoding="utf-8"))
    return links


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("figures")


@pytest.fixture(scope="module")
def outcomes(folder: Path) -> list[Outcome]:
    return build(register.chosen(CHEAP), folder, jobs=1)


def test_every_figure_that_is_asked_for_is_there() -> None:
    entries = register.chosen()
    keys = [e.key for e in entries]
    assert set(keys) >= REQUIRED
    assert len(set(keys)) == len(keys) == len({e.stem for e in entries})
    assert [p for p in PARTS if p in {e.part for e in entries}] == list(dict.fromkeys(e.part for e in entries))


def test_the_page_is_complete(outcomes: list[Outcome], folder: Path) -> None:
    page = write_page(outcomes, folder, register_html(find("4.44 P_12")))
    links = parsed(page)
    assert all((folder / name).stat().st_size > 0 for name in links.files)
    assert set(links.jumps) <= set(links.ids)
    assert len(set(links.ids)) == len(links.ids)
    for o in outcomes:
        assert {o.picture, o.data} <= set(links.files)
        assert o.stem in links.ids
        assert all(c.found in links.text and c.text in links.text for c in o.claims)
    assert "rigid-ramp-plastic.rrd" in links.files
    assert sentence(outcomes) in links.text
    assert "errata" in links.ids
    assert "4.44 P_12" in links.text
    assert {p.stem for p in folder.glob("*.png")} == {o.stem for o in outcomes}


def test_pictures_and_data(outcomes: list[Outcome], folder: Path) -> None:
    for o in outcomes:
        head = (folder / o.picture).read_bytes()[:24]
        assert head[:8] == b"\x89PNG\r\n\x1a\n"
        assert min(struct.unpack(">II", head[16:])) > 300  # pixels
        columns = (folder / o.data).read_text().splitlines()
        assert len(columns) > 1
    table = next(o for o in outcomes if "table" in o.key).table
    assert table[0] == ("symbol", "meaning", "printed", "used", "why")


def test_counts_of_verdicts() -> None:
    claims = tuple(Claim("", "", "", v) for v in (REPRODUCED, REPRODUCED, CONTRADICTED))
    assert counts(claims) == (2, 0, 1, 0)
    one = Outcome("thesis 4.5", "", "chapter 4", "a", claims)
    assert sentence([one, replace(one, claims=(), error="Broken: x")]) == (
        "Of 3 claims about 2 figures and tables: 2 reproduced, 0 trend only, 1 contradicted, 0 not identifiable; "
        "1 of them failed."
    )


def broken() -> Sheet:
    raise ZeroDivisionError("nothing there")


def drawn() -> Sheet:
    figure, _ = panels("a")
    return Sheet("a", {"x [m]": np.arange(3.0)}, figure)


def test_a_figure_that_fails_loses_no_other(tmp_path: Path) -> None:
    entries = [Entry("thesis 4.1", "broken", broken), Entry("thesis 4.2", "fine", drawn)]
    bad, good = build(entries, tmp_path, jobs=1)
    assert (bad.error, bad.picture) == ("ZeroDivisionError: nothing there", "")
    assert (good.error, good.picture) == ("", "thesis_4_2.png")
    page = parsed(write_page([bad, good], tmp_path))
    assert "Failed: ZeroDivisionError: nothing there" in page.text
    assert all((tmp_path / name).exists() for name in page.files)
    # without a folder only the claims are asked for, so that nothing is drawn and nothing fails
    assert [o.error for o in build(entries, None, jobs=1)] == ["", ""]


def test_a_run_that_fails_is_said(tmp_path: Path) -> None:
    entry = Entry("thesis 4.2", "fine", drawn, run=("rigid-ramp", "no-such-variant"))
    (outcome,) = build([entry], tmp_path, jobs=1)
    assert outcome.error.startswith("ScenarioError: ")
    assert "no-such-variant" in outcome.error
    assert (outcome.picture, outcome.log) == ("thesis_4_2.png", "")


def test_a_process_that_dies_loses_no_other() -> None:
    """The death of one takes those along that wait: they are done again, each by itself."""
    tasks = {"dies": partial(os._exit, 3), **{str(k): partial(abs, -k) for k in range(4)}}
    found = dict(_elsewhere(tasks, 2))
    assert found.keys() == tasks.keys()
    assert [found[str(k)] for k in range(4)] == [0, 1, 2, 3]
    assert "terminated abruptly" in str(found["dies"])


@pytest.mark.parametrize(("key", "count"), [("chapter 5", 5), ("thesis 5", 4), ("Thesis 5.4", 1), ("shock paper", 5)])
def test_keys(key: str, count: int) -> None:
    assert len(register.chosen([key])) == count


def test_an_unknown_key_is_refused() -> None:
    with pytest.raises(ScenarioError, match=r"there is no figure 'thesis 9\.1'"):
        register.chosen(["thesis 4.4", "thesis 9.1"])
