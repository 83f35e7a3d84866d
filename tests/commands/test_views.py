"""The viewer opens what run and compare write: no view complains, and there is something to see in each.

The pictures are drawn without a screen.  Where the machine has no Vulkan adapter, not even one in software (Debian's
package ``mesa-vulkan-drivers``), the viewer cannot start and these tests are skipped.
"""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import matplotlib.image
import numpy as np
import pytest

from cosim.errors import ScenarioError
from logs.screenshot import show, viewer
from studies import session


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    """Start a viewer without a window, or skip."""
    with ExitStack() as stack:
        try:
            started = stack.enter_context(viewer())
        except ScenarioError as error:
            pytest.skip(str(error))
        yield started


@pytest.fixture(scope="module")
def compared(tmp_path_factory: pytest.TempPathFactory) -> session.Comparison:
    """Return 0.1 s of two variants: the impact, the front wheels in the air, and back."""
    folder = tmp_path_factory.mktemp("views")
    names = ("uncontrolled", "pd-friction")
    return session.compare("ramp-impact", names, ["run.duration=0.1", "run.step=2e-4"], folder, quiet=True)


@pytest.fixture(scope="module")
def uneven(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the log of 0.1 s on a hump under a law against jerk."""
    folder = tmp_path_factory.mktemp("views")
    changes = ["run.duration=0.1", "start.x=0.9"]
    log = session.run_one("jerk-hump", "estimated", changes, folder, quiet=True).log
    assert log is not None
    return log


def shown(client: Any, path: Path, question: str = "") -> tuple[list[Any], dict[str, np.ndarray]]:
    """Open a log at t = 50 ms; return its views and the pictures of those that are on the screen, (h, w, 4) each."""
    state = show(client, path, 0.05, question)
    pictures = {}
    for view in state.views:
        try:
            data = client.take_screenshot(view_id=view.view_id)
        except Exception as error:
            if "not found" not in str(error):  # as one that is in a tab behind another
                raise
            continue
        pictures[view.name] = matplotlib.image.imread(io.BytesIO(data), format="png")
    return list(state.views), pictures


def colours_in(picture: np.ndarray) -> int:
    """Return how many pixels are of a colour and not grey: curves, robots and arrows; background and text are grey."""
    rgb = picture[..., :3]
    return int(np.count_nonzero(rgb.max(axis=2) - rgb.min(axis=2) > 0.15))


def check(views: list[Any], pictures: dict[str, np.ndarray], kinds: set[str], drawn: int) -> None:
    """Check that a log opens with views of these *kinds* that do not complain, and that *drawn* or more show something.

    The thinnest thing is a curve across a plot that is at least 200 pixels wide.
    """
    assert {v.view_class for v in views} == kinds
    assert {v.name: v.reports for v in views if v.reports} == {}
    plots = {v.name for v in views if v.view_class not in ("TextDocument", "TextLog") and v.name in pictures}
    assert len(plots) >= drawn
    assert {name: n for name in plots if (n := colours_in(pictures[name])) < 200} == {}


QUESTIONS = {  # the views of each, and how many there are at least
    "impact": ({"3D", "TimeSeries", "TextDocument", "StateTimeline"}, 8),
    "smoothness": ({"3D", "TimeSeries", "TextDocument"}, 7),
    "shock": ({"3D", "TimeSeries", "BarChart"}, 6),
    "health": ({"Graph", "TimeSeries", "TextDocument", "TextLog"}, 5),
}


@pytest.mark.parametrize("question", QUESTIONS)
def test_a_question(client: Any, compared: session.Comparison, uneven: Path, question: str) -> None:
    log = uneven if question == "smoothness" else compared.runs[0].log
    assert log is not None
    kinds, drawn = QUESTIONS[question]
    check(*shown(client, log, question), kinds, drawn)


def test_a_run(client: Any, compared: session.Comparison) -> None:
    """It opens with a tab for each question, the one its scenario asks in front."""
    log = compared.runs[0].log
    assert log is not None
    views, pictures = shown(client, log)
    kinds = {"3D", "TimeSeries", "TextDocument", "TextLog", "StateTimeline", "BarChart", "Graph"}
    check(views, pictures, kinds, 8)
    assert "contact of each wheel" in pictures


def test_a_comparison(client: Any, compared: session.Comparison) -> None:
    assert compared.combined is not None
    views, pictures = shown(client, compared.combined)
    check(views, pictures, {"3D", "TimeSeries", "TextDocument"}, 8)
    (scene,) = (name for name in pictures if name.startswith("scene"))
    for rgb in ((31, 120, 209), (240, 128, 32)):  # both robots: the ghost's wires are drawn as they are
        distance = np.abs(pictures[scene][..., :3] * 255 - rgb).max(axis=2)
        assert np.count_nonzero(distance < 40) > 100, rgb
