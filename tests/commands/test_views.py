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


def shown(client: Any, path: Path) -> tuple[list[Any], dict[str, np.ndarray]]:
    """Open a log at t = 50 ms; return its views and the pictures of those that are on the screen, (h, w, 4) each."""
    state = show(client, path, 0.05)
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


def check(views: list[Any], pictures: dict[str, np.ndarray], kinds: set[str]) -> None:
    assert {v.view_class for v in views} == kinds
    assert {v.name: v.reports for v in views if v.reports} == {}
    plots = {v.name for v in views if v.view_class in ("TimeSeries", "3D") and v.name in pictures}
    assert len(plots) >= 8
    # the thinnest thing is a curve across a plot that is at least 200 pixels wide
    assert {name: n for name in plots if (n := colours_in(pictures[name])) < 200} == {}


def test_a_run(client: Any, compared: session.Comparison) -> None:
    log = compared.runs[0].log
    assert log is not None
    views, pictures = shown(client, log)
    check(views, pictures, {"3D", "TimeSeries", "TextDocument", "TextLog"})


def test_a_comparison(client: Any, compared: session.Comparison) -> None:
    assert compared.combined is not None
    views, pictures = shown(client, compared.combined)
    check(views, pictures, {"3D", "TimeSeries", "TextDocument"})
    (scene,) = (name for name in pictures if name.startswith("scene"))
    for rgb in ((31, 120, 209), (240, 128, 32)):  # both robots: the ghost's wires are drawn as they are
        distance = np.abs(pictures[scene][..., :3] * 255 - rgb).max(axis=2)
        assert np.count_nonzero(distance < 40) > 100, rgb
