"""What a log says about itself can be read without a viewer: numbers, tables, files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyarrow.csv
import pyarrow.parquet
import pytest
from toys import Gain, Scripted, port

from cosim import Jacobi, System, run
from cosim.errors import ScenarioError
from logs.inspect import describe, export
from logs.read import load, signals
from logs.recorder import RerunRecorder

MS = 1_000_000


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the log of five points of a (2, 2) output k * [[1, 2], [3, 4]] N in step k, and a gain."""
    path = tmp_path_factory.mktemp("read") / "run.rrd"
    part = Scripted([port("A", "output", shape=(2, 2), unit="N", meaning="a force"), port("k", "output", unit="m")])
    part.pull = lambda: part.y.__setitem__(slice(None), part.steps / 3 * np.arange(1, 6))  # type: ignore[method-assign]
    system = System({"a": part, "g": Gain().instance()}, {})
    properties = {"run": {"scenario": "s", "list": [1.5, 2.5], "none": None, "yes": True, "array": np.arange(2)}}
    run(system, Jacobi(), step=MS, stop=4 * MS, observers=[RerunRecorder(path, "x", properties=properties)])
    return path


def test_statistics_over_all_values(log: Path) -> None:
    facts = describe(log, ["a.A"])
    values = np.arange(5)[:, None] / 3 * np.arange(1, 5)
    found = facts["signals"]["a.A"]
    assert {k: found[k] for k in ("unit", "width", "rows", "min")} == {"unit": "N", "width": 4, "rows": 5, "min": 0.0}
    assert found["max"] == values.max()
    # numpy sums the same numbers in another order: a few ulp
    assert found["mean"] == pytest.approx(values.mean(), rel=1e-15)
    assert found["rms"] == pytest.approx(np.sqrt(np.mean(values**2)), rel=1e-15)
    assert facts["properties"]["run"] == {"scenario": "s", "list": [1.5, 2.5], "yes": True, "array": [0, 1]}
    assert facts["ports"] == ["a.A", "a.k", "g.in.u", "g.y", "master.step_size", "master.wall"]
    assert facts["status"] == "complete"


def test_parquet_and_csv_hold_the_bits(log: Path, tmp_path: Path) -> None:
    for name, read in (("x.parquet", pyarrow.parquet.read_table), ("x.csv", pyarrow.csv.read_csv)):
        table = read(export(log, tmp_path / name, ["a.A", "a.k"]))
        assert table.column_names == ["time [s]", *(f"a.A[{i}] [N]" for i in range(1, 5)), "a.k [m]"]
        np.testing.assert_array_equal(table["time [s]"].to_numpy(), np.arange(5) * MS * 1e-9)
        for i in range(4):
            np.testing.assert_array_equal(table[f"a.A[{i + 1}] [N]"].to_numpy(), np.arange(5) / 3 * (i + 1))


def test_files_that_cannot_be_written(log: Path, tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match=r"cannot write .*x\.xlsx: the name must end in \.csv or \.parquet"):
        export(log, tmp_path / "x.xlsx", ["a.A"])
    with pytest.raises(ScenarioError, match=r"cannot write .*x\.csv: "):
        export(log, tmp_path / "none" / "x.csv", ["a.A"])


def test_a_dataset_with_units(log: Path) -> None:
    data = load(log)
    assert data["a.A"].attrs == {"units": "N", "long_name": "a force"}
    np.testing.assert_array_equal(data["a.k"], np.arange(5) / 3 * 5)
    assert data.attrs["run.scenario"] == "s"
    with pytest.raises(ScenarioError, match=r"has no signal 'a.AA'; did you mean 'a.A'\?"):
        load(log, ["a.AA"])


def test_files_that_are_no_logs(tmp_path: Path) -> None:
    nothing, text = tmp_path / "nothing.rrd", tmp_path / "text.rrd"
    nothing.write_bytes(b"")
    text.write_text("hello, world")
    for path, said in ((nothing, "is not a Rerun log"), (text, "is not a Rerun log"), (tmp_path, "there is no log")):
        with pytest.raises(ScenarioError, match=said):
            signals(path)
