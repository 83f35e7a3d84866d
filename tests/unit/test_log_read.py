"""What a log says about itself can be read without a viewer: numbers, tables, files."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pyarrow.csv
import pyarrow.parquet
import pytest
import rerun as rr
from toys import Gain, Scripted, port

import logs
from cosim import Jacobi, System, run
from cosim.errors import ScenarioError
from logs.inspect import describe, export
from logs.ports import index, scalars
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


def test_mcap_holds_the_bits(log: Path, tmp_path: Path) -> None:
    """JSON writes a double with as many digits as it needs to come back as it was."""
    from mcap.reader import make_reader

    with export(log, tmp_path / "x.mcap", ["a.A", "a.k"]).open("rb") as stream:
        found = list(make_reader(stream).iter_messages())
    assert [m.log_time for _, _, m in found] == [k * MS for k in range(5) for _ in range(2)]
    for name, width in (("a.A", 4), ("a.k", 1)):
        rows = [json.loads(m.data) for _, channel, m in found if channel.topic == name]
        labels = ["k"] if width == 1 else ["A[1,1]", "A[1,2]", "A[2,1]", "A[2,2]"]
        assert [list(row) for row in rows] == [labels] * 5
        first = 5 if width == 1 else 1
        for i, label in enumerate(labels):
            assert [row[label] for row in rows] == (np.arange(5) / 3 * (first + i)).tolist()
    schema, channel, _ = next(m for m in found if m[1].topic == "a.A")
    assert channel.metadata == {"unit": "N"}
    assert schema is not None
    assert json.loads(schema.data)["description"] == "a force"


def test_mcap_is_an_extra(log: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mcap.writer", None)
    with pytest.raises(
        ScenarioError, match=r"without the package mcap; install it with: pip install 'wmr-cosim\[mcap\]'"
    ):
        export(log, tmp_path / "x.mcap", ["a.k"])
    assert not (tmp_path / "x.mcap").exists()


def test_files_that_cannot_be_written(log: Path, tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match=r"cannot write .*x\.xlsx: the name must end in \.csv, \.parquet or \.mcap"):
        export(log, tmp_path / "x.xlsx", ["a.A"])
    with pytest.raises(ScenarioError, match=r"cannot write .*x\.csv: "):
        export(log, tmp_path / "none" / "x.csv", ["a.A"])


def test_a_dataset_with_units(log: Path) -> None:
    data = load(log)
    assert data["a.A"].attrs == {"units": "N", "long_name": "a force"}
    assert data["a.A"].dims == ("time", "a.A.0", "a.A.1")
    np.testing.assert_array_equal(data["a.A"][3], [[1.0, 2.0], [3.0, 4.0]])
    assert data["time"].attrs["units"] == "s"
    np.testing.assert_array_equal(data["time_ns"], np.arange(5) * MS)
    assert "a.A.0" not in data.coords  # what is no rover has no wheels
    np.testing.assert_array_equal(data["a.k"], np.arange(5) / 3 * 5)
    assert data.attrs["run.scenario"] == "s"
    with pytest.raises(ScenarioError, match=r"has no signal 'a.AA'; did you mean 'a.A'\?"):
        load(log, ["a.AA"])


def test_the_wheels_of_a_rover_have_names(log: Path, tmp_path: Path) -> None:
    """A log that says it is a rover's: axes of four are the wheels', but for the quaternion's."""
    ports = [port("gap", "output", shape=(4,), unit="m"), port("orientation", "output", shape=(4,), unit="1")]
    system, path = System({"body": Scripted(ports)}, {}), tmp_path / "rover.rrd"
    recorder = RerunRecorder(path, "r", properties={"run": {"config_json": '{"assembly": "rover"}'}})
    run(system, Jacobi(), step=MS, stop=2 * MS, observers=[recorder])
    data = logs.load(path)
    assert data["body.gap"].sel({"body.gap.0": "rl"}).sizes == {"time": 3}
    assert set(data.coords) == {"time", "time_ns", "body.gap.0"}


def test_signals_at_different_times(tmp_path: Path) -> None:
    """Each keeps its own; at the times of another it is not a number."""
    recording = rr.RecordingStream("wmr_cosim", recording_id="t")
    recording.save(str(tmp_path / "t.rrd"))
    for name, ns in (("a", [0, 2, 4]), ("b", [1, 2])):
        values = np.array(ns, float)[:, None]
        recording.send_columns(f"plant/x/{name}", index(np.array(ns), np.array(ns)), scalars(values))
    recording.flush()
    recording.disconnect()
    data = logs.load(tmp_path / "t.rrd")
    assert data["time_ns"].values.tolist() == [0, 1, 2, 4]
    np.testing.assert_array_equal(data["x.a"], [0, np.nan, 2, 4])
    np.testing.assert_array_equal(data["x.b"], [np.nan, 1, 2, np.nan])


def test_files_that_are_no_logs(tmp_path: Path) -> None:
    nothing, text = tmp_path / "nothing.rrd", tmp_path / "text.rrd"
    nothing.write_bytes(b"")
    text.write_text("hello, world")
    for path, said in ((nothing, "is not a Rerun log"), (text, "is not a Rerun log"), (tmp_path, "there is no log")):
        with pytest.raises(ScenarioError, match=said):
            signals(path)
