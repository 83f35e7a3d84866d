"""A folder of logs as one table: what is found, filtered and sorted, and what is said about a bad question."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import rerun as rr

from cosim.errors import ScenarioError
from logs.difference import differences
from logs.ports import index, scalars
from logs.runs import runs, select


def write(path: Path, values: np.ndarray, *, ns: np.ndarray | None = None, **run: object) -> Path:
    """Write a log with one port of one value and the properties of a run."""
    recording = rr.RecordingStream("wmr_cosim", recording_id=path.stem)
    recording.save(str(path))
    recording.send_property("run", rr.AnyValues(**{"scenario": "ramp", **run}))
    recording.send_property("metrics", rr.AnyValues(front_off=float(values[-1])))
    recording.send_property("outcome", rr.AnyValues(status="complete"))
    times = np.arange(len(values)) * 1000 if ns is None else ns
    recording.send_columns("plant/body/pitch", index(times, np.arange(len(values))), scalars(values[:, None]))
    recording.flush()
    recording.disconnect()
    return path


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for k, variant in enumerate(("soft", "hard", "pd")):
        write(tmp_path / f"{variant}.rrd", np.array([0.0, 30.0 - 10 * k]), variant=variant)
    (tmp_path / "broken.rrd").write_bytes(b"no log at all")
    return tmp_path


def test_every_log_is_a_row_with_its_verdict(folder: Path) -> None:
    rows = {Path(row["path"]).stem: row for row in runs(folder)}
    assert set(rows) == {"soft", "hard", "pd", "broken"}
    assert (rows["hard"]["scenario"], rows["hard"]["variant"], rows["hard"]["front_off"]) == ("ramp", "hard", 20.0)
    assert rows["hard"]["metrics.front_off"] == 20.0
    assert rows["broken"]["status"] == "unreadable"


def test_conditions_and_sorting(folder: Path) -> None:
    rows = runs(folder)
    kept = select(rows, ["scenario=ramp", "front_off<25"], "front_off")
    assert [row["variant"] for row in kept] == ["pd", "hard"]
    assert [row["variant"] for row in select(rows, ["variant!=pd"], "-front_off")] == ["soft", "hard"]
    assert [row["variant"] for row in select(rows, ["status=complete"], "variant")] == ["hard", "pd", "soft"]


@pytest.mark.parametrize(
    ("conditions", "sort", "said"),
    [
        (["front_off"], None, "cannot read the condition 'front_off'; write it like scenario=ramp-impact"),
        (["front_of<1"], None, "no log has a property or metric 'front_of'; did you mean 'front_off'?"),
        ([], "varian", "no log has a property or metric 'varian'; did you mean 'variant'?"),
    ],
)
def test_a_bad_question(folder: Path, conditions: list[str], sort: str | None, said: str) -> None:
    with pytest.raises(ScenarioError) as raised:
        select(runs(folder), conditions, sort)
    assert str(raised.value).startswith(said)


def test_no_folder(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match=r"there is no folder .*nowhere of logs"):
        runs(tmp_path / "nowhere")


def test_a_log_differs_from_itself_nowhere(tmp_path: Path) -> None:
    values = np.array([0.1, np.nan, 0.3])
    found = differences(write(tmp_path / "a.rrd", values), write(tmp_path / "b.rrd", values))
    assert [d.identical for d in found] == [True]


def test_the_first_bit_that_differs_is_found(tmp_path: Path) -> None:
    one = np.array([0.1, 0.2, 0.3])
    other = one.copy()
    other[1] = np.nextafter(0.2, 1)
    (found,) = differences(write(tmp_path / "a.rrd", one), write(tmp_path / "b.rrd", other))
    assert not found.identical
    assert found.since == pytest.approx(1e-6)
    assert found.largest == other[1] - one[1]


def test_minus_zero_is_another_bit(tmp_path: Path) -> None:
    a, b = (write(tmp_path / f"{k}.rrd", np.array([0.1, zero])) for k, zero in enumerate((0.0, -0.0)))
    (found,) = differences(a, b)
    assert (found.identical, found.largest) == (False, 0.0)
    assert found.since == pytest.approx(1e-6)


def test_what_comes_after_the_end_of_an_unfinished_log_is_no_difference(tmp_path: Path) -> None:
    whole, half = (write(tmp_path / f"{n}.rrd", np.arange(float(n))) for n in (6, 3))
    assert [d.identical for d in differences(half, whole, unfinished=True)] == [True]
    assert [d.identical for d in differences(half, whole)] == [False]
    assert [d.identical for d in differences(whole, half, unfinished=True)] == [False]


def test_a_step_that_one_log_lacks_is_a_difference(tmp_path: Path) -> None:
    a = write(tmp_path / "a.rrd", np.array([0.1, 0.2, 0.3]))
    b = write(tmp_path / "b.rrd", np.array([0.1, 0.3]), ns=np.array([0, 2000]))
    (found,) = differences(a, b)
    assert not found.identical
    assert found.since == pytest.approx(1e-6)
    assert found.largest == 0
