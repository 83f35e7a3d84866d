"""How a run is cut into chunks is a matter of the clock: on a slow machine they are shorter.  No signal may tell."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import pytest

from logs.difference import differences
from logs.recorder import RerunRecorder
from studies.catalog import find_scenario
from studies.logged import log_observer
from studies.runner import execute

STEPS = 100
SIZES = (STEPS + 1, 7, 1)


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """Return the logs of one run, in chunks of each of SIZES."""
    folder = tmp_path_factory.mktemp("chunks")
    paths = [folder / f"{size}.rrd" for size in SIZES]
    file = find_scenario("ramp-impact")
    scenario = file.load("pd-friction", file.overrides([f"run.duration={STEPS * 1e-4!r}"]))
    execute(scenario, lambda a, i, r: [
        log_observer(a, path, i, r, partial(RerunRecorder, chunk=size)) for path, size in zip(paths, SIZES, strict=True)
    ])  # fmt: skip
    return paths


@pytest.mark.parametrize("other", range(1, len(SIZES)))
def test_signals_do_not_depend_on_the_chunks(other: int, logs: list[Path]) -> None:
    """To the bit, the sums over the run included."""
    found = differences(logs[0], logs[other])
    assert "master.energy_residual" in {d.port for d in found}
    assert [(d.port, d.largest) for d in found if not d.identical] == []
