"""What objects show of themselves in a notebook: everything they declare, as safe HTML."""

from __future__ import annotations

import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from toys import Mass, Spring

from cosim import Component, GaussSeidel, Jacobi, Link, StepError, System, input, parameter, structural, table
from cosim.show import brief, component_html, html, system_html
from studies.catalog import COMPONENTS, find_scenario
from studies.conclusion import conclusion
from studies.runner import Result, execute
from studies.session import Comparison, Done


class Page(HTMLParser):
    """The rows of all tables of a page, the texts in bold, and everything that it asks for."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.rows: list[list[str]] = []
        self.bold: list[tuple[str, str]] = []  # with the first text of its row
        self.open: list[str] = []
        self.fetched: list[str] = []
        self.text = ""
        self.feed(text)
        self.rows = [[" ".join(cell.split()) for cell in row] for row in self.rows]

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        if tag not in ("br", "img"):
            self.open.append(tag)
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")
        self.fetched += [value or "" for name, value in attributes if name in ("src", "href")]

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.text += data
        if {"td", "th"} & set(self.open):
            self.rows[-1][-1] += data
            if "b" in self.open:
                self.bold.append((self.rows[-1][0].strip(), data))

    def row(self, *first: str) -> list[str]:
        """Return the only row that begins so."""
        (found,) = (row for row in self.rows if tuple(row[: len(first)]) == first)
        return found


class Odd(Component):
    """Has <everything> & more."""

    period = parameter(1e-3, "s", "sample period")
    n = structural(2, "how many")
    kind = structural("a", "which", choices=("a", "b"))
    gains = parameter([1.0, 2.0], "N/m", "a <gain> each", shape="n")
    many = parameter(np.arange(9.0).reshape(3, 3), "1", "a matrix")
    rows = table(3, "a profile")
    u = input("degC", "a temperature", start=20.0)


def test_a_component_shows_what_it_declares() -> None:
    page = Page(Odd(gains=[1.0, 3.5], kind="b")._repr_html_())
    assert page.open == []
    assert "Has <everything> & more." in page.text
    assert "Sampled every 0.001 s." in page.text
    assert page.rows[0] == ["role", "name", "shape", "unit", "start", "meaning"]
    assert page.row("parameter", "gains") == ["parameter", "gains", "2", "N/m", "[1, 3.5]", "a <gain> each"]
    assert page.row("structural", "kind") == ["structural", "kind", "", "", "b", "which (one of a, b)"]
    assert page.row("parameter", "many")[2:5] == ["3 × 3", "1", "9 from 0 to 8"]
    assert page.row("table", "rows")[2:5] == ["1 × 3", "", "0"]
    assert page.row("input", "u") == ["input", "u", "", "degC", "20", "a temperature"]
    assert page.bold == [("structural", "b"), ("parameter", "[1, 3.5]")]
    assert "<gain>" not in Odd()._repr_html_()


@pytest.mark.parametrize("name", COMPONENTS)
def test_every_component_shows_every_declaration(name: str) -> None:
    part = COMPONENTS[name]()
    page = Page(component_html(part))
    shown = {row[1]: row[0] for row in page.rows[1:]}
    assert shown == {n: d.role for n, d in part.declarations.items()}
    assert page.bold == []  # it is as its class says
    assert (type(part).__doc__ or "").split("\n")[0] in page.text


@pytest.mark.parametrize(
    ("value", "text"),
    [(2.8e6, "2.8e+06"), ([0.0] * 9, "0"), ([1, 2], "[1, 2]"), (np.linspace(-1, 1, 7), "7 from -1 to 1"), ([], "none")],
)
def test_values_are_brief(value: Any, text: str) -> None:
    assert brief(value) == text


def oscillator() -> System:
    class Millimetres(Spring):
        """The same with another unit at its input."""

        x = input("mm", "elongation")

    parts = {"spring": Millimetres().instance(), "mass": Mass().instance()}
    return System(parts, {"mass.F": "spring.F", "spring.x": Link("mass.pos", convert=True)}, every={"mass": 2})


def test_a_system_shows_who_is_late_and_who_is_idle() -> None:
    page = Page(system_html(oscillator()))
    assert "GaussSeidel steps them in the order spring, mass." in page.text
    assert "Unconnected inputs, at their start values: spring.v." in page.text
    assert page.row("mass")[:3] == ["mass", "PythonInstance", "2"]
    assert page.row("spring.F") == ["spring.F", "mass.F", "N", "0", ""]
    assert page.row("mass.pos") == ["mass.pos", "spring.x", "m", "1", "× 1000"]


@pytest.mark.parametrize(
    ("algorithm", "late"), [(Jacobi(), ["1", "1"]), (GaussSeidel(("mass", "spring")), ["1", "0"])], ids=repr
)
def test_delays_are_those_of_the_algorithm(algorithm: Any, late: list[str]) -> None:
    page = Page(system_html(oscillator(), algorithm))
    assert [page.row(source)[3] for source in ("spring.F", "mass.pos")] == late
    assert f"{type(algorithm).__name__} steps them" in page.text


def test_a_page_needs_nothing_else_and_empty_tables_are_left_out() -> None:
    page = Page(html("<b>", ["a & b"], [], "AAAA"))
    assert page.fetched == ["data:image/png;base64,AAAA"]
    assert page.rows == []
    assert "<b>" in page.text


@pytest.fixture(scope="module")
def results() -> list[Result]:
    file = find_scenario("ramp-impact")
    return [execute(file.load(variant, [{"run": {"duration": 0.02}}])) for variant in ("uncontrolled", "pd-friction")]


def test_a_result_shows_verdict_words_and_picture(results: list[Result]) -> None:
    page = Page(results[1]._repr_html_())
    assert results[1].scenario.title in page.text
    (sentence,) = conclusion({"pd-friction": results[1].metrics})
    assert sentence in page.text
    known = [m for m in results[1].metrics if m.value is not None]
    assert [row[0] for row in page.rows] == ["", *(m.label for m in known)]
    assert page.fetched[0].startswith("data:image/png;base64,")


def test_a_failed_result_says_so(results: list[Result]) -> None:
    record, assembly = results[0].record, results[0].assembly
    failed = Result(assembly, record, [], None, StepError("wheels", 0.01, "a force is <nan>"), {"running": 0.1})
    page = Page(failed._repr_html_())
    assert "uncontrolled failed: " in page.text
    assert "a force is <nan>" in page.text
    assert page.rows == []


def test_a_comparison_marks_the_best(results: list[Result]) -> None:
    done = Comparison([Done(r, None) for r in results], Path("all.rrd"), None, notes=("mind <this>",))
    page = Page(done._repr_html_())
    assert "mind <this>" in page.text
    assert "all variants: all.rrd" in page.text
    assert page.rows[0] == ["", "unit", "uncontrolled", "pd-friction"]
    demand = page.row("largest traction demand at a wheel")
    assert float(demand[3]) > float(demand[2]) == 0
    assert (demand[0], "0") in page.bold
    assert (demand[0], demand[3]) not in page.bold
    assert len(page.fetched) == 1


def test_the_master_is_imported_without_any_page() -> None:
    """Only who shows something pays for the templates."""
    code = "import sys, cosim, cosim.show; print('jinja2' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
