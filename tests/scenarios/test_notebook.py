"""The example notebook: committed without outputs, runs from top to bottom, and what it says in words comes out."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import nbformat
import numpy as np
import pytest
from nbclient import NotebookClient

import studies

NOTEBOOK = Path(studies.__file__).parent / "example.ipynb"


def test_it_is_committed_without_outputs() -> None:
    found = nbformat.read(NOTEBOOK, as_version=4)
    nbformat.validate(found)
    code = [cell for cell in found.cells if cell.cell_type == "code"]
    assert len(code) > 10
    assert [cell.id for cell in code if cell.outputs or cell.execution_count is not None] == []
    # a run leaves the times of its cells, an editor what was folded
    assert all(cell.metadata == {} for cell in found.cells)


@pytest.fixture(scope="module")
def cells(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Run it in a folder of its own, its logs go there; return the code cells by their id."""
    found = nbformat.read(NOTEBOOK, as_version=4)
    folder = tmp_path_factory.mktemp("notebook")
    NotebookClient(found, kernel_name="python3", timeout=120, resources={"metadata": {"path": str(folder)}}).execute()
    written = {p.suffix for p in (folder / "runs").iterdir()}
    assert written == {".rrd", ".png", ".fmu"}
    return {cell.id: cell for cell in found.cells if cell.cell_type == "code"}


def shown(cell: Any, kind: str) -> str:
    """Return what a cell displays as *kind*, all of it in one text."""
    return "\n".join(output.data[kind] for output in cell.outputs if kind in output.get("data", {}))


def printed(cell: Any) -> str:
    return "".join(output.text for output in cell.outputs if output.output_type == "stream")


def value(html: str, label: str) -> list[float]:
    """Return the numbers of a row of a verdict."""
    row = re.search(rf"<td[^>]*>{re.escape(label)}\s*</td>(.*?)</tr>", html, re.DOTALL)
    assert row is not None, label
    return [float(text) for text in re.findall(r">(?:<b>)?(-?[\d.]+(?:e[+-]\d+)?)[\s<]", row[1])]


def test_results_show_themselves(cells: dict[str, Any]) -> None:
    run, compared, mine = (shown(cells[name], "text/html") for name in ("run-code", "compare-code", "end-code"))
    for html in (run, compared, mine):
        assert "data:image/png;base64," in html
    assert "uncontrolled keeps all wheels on the ground, without traction." in run
    free, pd = value(compared, "peak normal force, front axle")
    assert pd < free
    assert f"<b>{pd:.0f}</b>" in compared
    # "It climbs where the others roll back."
    assert value(run, "lowest forward speed")[0] < 0 < value(mine, "lowest forward speed")[0]


def test_components_and_systems_show_themselves(cells: dict[str, Any]) -> None:
    wheels, system, own = (shown(cells[name], "text/html") for name in ("parts-code", "system-code", "own-code"))
    assert "radial damping of each wheel" in wheels
    assert "<b>1322.8</b>" in wheels
    assert "controller.traction_demand" in system
    assert "Hold the speed: traction for the speed that is missing" in own
    assert "Sampled every 0.001 s." in own


def test_pictures_are_drawn_in_the_notebook(cells: dict[str, Any]) -> None:
    """None of the modules that draw to files takes the backend away from whoever imports them."""
    for name in ("signals-code", "change-code", "linear-code", "fmu-code", "replace-code"):
        assert shown(cells[name], "image/png"), name


def test_the_poles_are_those_the_text_tells(cells: dict[str, Any]) -> None:
    lines = [line for line in printed(cells["linear-code"]).splitlines() if "step" in line]
    free, pd = ([complex(p) for p in line[line.index("[") + 1 : -1].split()] for line in lines)
    assert sorted(p.imag for p in free) == [40.9, 45.5]
    assert len(pd) == 4
    assert np.all(np.imag(pd) == 0)


def test_the_logs_can_be_opened(cells: dict[str, Any]) -> None:
    assert printed(cells["rerun-code"]).split() == ["rerun", str(Path("runs", "ramp-impact-realistic-all.rrd"))]


def test_its_kernel_is_nobodys_own() -> None:
    """The name of a private environment would not start elsewhere."""
    assert json.loads(NOTEBOOK.read_text(encoding="utf-8"))["metadata"]["kernelspec"]["name"] == "python3"
