"""The verdict in words and as an HTML report: what it says, and that it needs nothing else."""

from __future__ import annotations

import shutil
import subprocess
from html.parser import HTMLParser
from pathlib import Path

import matplotlib.image
import numpy as np
import pytest

from cosim.errors import ScenarioError
from logs.style import colour
from studies.catalog import find_scenario
from studies.conclusion import conclusion
from studies.metrics import Metric
from studies.report import thinned, write_report
from studies.runner import Result, execute


def metrics(**values: float) -> list[Metric]:
    return [Metric(key, key, "1", "lower", value) for key, value in values.items()]


def test_the_sentences_name_contact_and_cost() -> None:
    rows = {
        "free": metrics(front_off=120.0, front_rebounds=2, rear_off=0.0, rear_rebounds=0, demand_peak=0.0),
        "pd": metrics(front_off=0.0, rear_off=0.0, demand_peak=975.1, actuator_energy=467.0, saturated=6.0),
    }
    assert conclusion(rows) == [
        "pd keeps all wheels on the ground, with up to 975 N asked of a wheel, 467 J of actuator work, a wheel at its "
        "friction limit 6 % of the time.",
        "free has a wheel off the ground for 120 ms at the front (2 rebounds), without traction.",
    ]


def test_without_contacts_there_is_nothing_to_say() -> None:
    assert conclusion({"a": [Metric("front_off", "", "ms", "lower", None)]}) == []


def test_thinning_keeps_the_extremes_and_the_ends() -> None:
    values = np.sin(np.linspace(0, 50, 100_001))
    values[77_777] = 9.0
    kept = thinned(values, 1000)
    assert len(kept) <= 1002
    assert 77_777 in kept
    assert (kept[0], kept[-1]) == (0, 100_000)
    np.testing.assert_array_equal(thinned(values[:50], 1000), np.arange(50))


class References(HTMLParser):
    """Collects what a page asks its browser to fetch."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        self.found += [value or "" for name, value in attributes if name in ("src", "href", "srcset")]


@pytest.fixture(scope="module")
def results() -> list[Result]:
    file = find_scenario("ramp-impact")
    return [execute(file.load(variant, [{"run": {"duration": 0.02}}])) for variant in ("uncontrolled", "pd-friction")]


def test_the_report_holds_everything(results: list[Result], tmp_path: Path) -> None:
    text = write_report(results, tmp_path / "new" / "r.html", "wmr-cosim compare ramp-impact").read_text()
    page = References()
    page.feed(text)
    assert len(page.found) == 2  # the empty icon and the sketches
    assert all(reference.startswith("data:") for reference in page.found)
    expected = (
        "front wheels since the impact: off the ground", "uncontrolled has a wheel off the ground", "pd-friction",
        "&#34;k_w&#34;: 2800000.0", "token_body", "wmr-cosim compare ramp-impact", "normal force, front axle",
    )  # fmt: skip
    for part in expected:
        assert part in text, part


CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
LOUD = "<script>console.error('one of ours')</script></body>"


def browsed(page: Path, picture: Path) -> list[str]:
    """Open a page in Chromium without a screen and take its *picture*; return what its console complained about."""
    assert CHROMIUM is not None
    profile = f"--user-data-dir={picture.parent / 'profile'}"
    told = subprocess.run(
        [CHROMIUM, "--headless=new", "--no-sandbox", "--disable-gpu", "--enable-logging=stderr", profile,
         "--window-size=1200,3000", "--virtual-time-budget=8000", f"--screenshot={picture}", page.as_uri()],
        capture_output=True, text=True, timeout=90, check=True,
    )  # fmt: skip
    return [line for line in told.stderr.splitlines() if "CONSOLE" in line]


@pytest.mark.skipif(CHROMIUM is None, reason="there is no Chromium on this machine")
def test_a_browser_shows_the_report_and_has_nothing_to_complain(results: list[Result], tmp_path: Path) -> None:
    """Both curves are in the picture in their colours; a page that does complain would be found out."""
    page = write_report(results, tmp_path / "r.html")
    assert browsed(page, tmp_path / "r.png") == []
    shown = matplotlib.image.imread(tmp_path / "r.png")[..., :3]
    for number in range(2):
        near = np.all(np.abs(shown - np.array(colour(number)) / 255) < 0.02, axis=2)
        assert np.count_nonzero(near[1500:]) > 200  # below the table and the sketches
    page.write_text(page.read_text().replace("</body>", LOUD))
    (line,) = browsed(page, tmp_path / "loud.png")
    assert "one of ours" in line


def test_a_report_that_cannot_be_written(results: list[Result], tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(ScenarioError, match=r"cannot write the report .*r\.html"):
        write_report(results, tmp_path / "file" / "r.html")
