"""A run in memory: nothing is lost or mixed up, however long it is."""

import os
from typing import Any

import numpy as np
import pytest
from toys import Scripted, port

from cosim import Advance, Jacobi, Observer, Point, Record, System, WiringError, run
from cosim.errors import ScenarioError
from cosim.rows import CHUNK


def numbered(n: int) -> tuple[System, Scripted]:
    """Return a system of one instance whose outputs hold the number of its step, as (2, 2) and as a scalar."""
    ports = [port("u", "input", shape=(2,), unit="m"), port("A", "output", shape=(2, 2), unit="N", meaning="a force")]
    part = Scripted([*ports, port("k", "output"), port("on", "output", "Boolean")])
    part.pull = lambda: part.y.__setitem__(slice(None), part.steps * np.arange(1, 6))  # type: ignore[method-assign]
    part.get = lambda name: part.steps % 2 == 1  # type: ignore[method-assign]
    return System({"a": part}, {}), part


def test_more_rows_than_a_chunk() -> None:
    n = 10_000
    record = Record()
    run(numbered(n)[0], Jacobi(), step=1000, stop=n * 1000, observers=[record])
    steps = np.arange(n + 1)
    assert len(record) == n + 1
    np.testing.assert_array_equal(record["a.A"], steps[:, None, None] * np.array([[1, 2], [3, 4]]))
    np.testing.assert_array_equal(record["a.k"], 5 * steps)
    np.testing.assert_array_equal(record["a.on"], steps % 2 == 1)
    assert record["a.u"].shape == (n + 1, 2)
    assert list(record) == list(record.ports()) == ["a.u", "a.A", "a.k", "a.on"]


def test_a_selection_keeps_only_that() -> None:
    record = Record(["a.k", "a.on"])
    run(numbered(3)[0], Jacobi(), step=1000, stop=3000, observers=[record])
    assert record.ports() == ("a.k", "a.on")
    assert "a.A" not in record
    with pytest.raises(WiringError) as caught:
        record["a.kk"]
    assert str(caught.value) == "nothing called 'a.kk' was recorded; did you mean 'a.k'?"


def test_a_selection_of_what_is_not_there_is_refused() -> None:
    with pytest.raises(WiringError) as caught:
        run(numbered(1)[0], Jacobi(), step=1000, stop=1000, observers=[Record(["a.q"])])
    assert str(caught.value) == "nothing to record is called 'a.q'; did you mean 'a.u'?"


def test_a_dataset_has_units_and_named_axes() -> None:
    record = Record()
    run(numbered(3)[0], Jacobi(), step=1000, stop=3000, observers=[record])
    data = record.to_xarray()
    assert data["a.A"].dims == ("time", "a.A.0", "a.A.1")
    assert data["a.A"].attrs == {"units": "N", "long_name": "a force", "causality": "output"}
    assert data.attrs == {"algorithm": "Jacobi()", "step_ns": 1000}
    np.testing.assert_array_equal(data["a.A"].sel(time=2e-6), [[2, 4], [6, 8]])
    assert data["time_ns"].values.tolist() == [0, 1000, 2000, 3000]


def test_what_failed_says_so() -> None:
    system, part = numbered(3)
    part.script = {2: ValueError("stuck"), 1: lambda start, end: Advance(end)}
    record = Record()
    with pytest.raises(Exception, match="stuck"):
        run(system, Jacobi(), step=1000, stop=3000, observers=[record])
    assert record.to_xarray().attrs["failed"] == "a failed at t = 1e-06 s: ValueError: stuck (step 2)"
    np.testing.assert_array_equal(record["a.k"], [0, 5])


def test_a_point_shows_everything_in_one_row() -> None:
    """The row is what the components' own buffers hold, and the places say which part is whose."""
    first, second = numbered(1)[1], numbered(1)[1]
    system = System({"a": first, "b": second}, {})
    seen: list[int] = []

    class Look(Observer):
        def accepted(self, point: Point) -> None:
            seen.append(point.number)
            for name in ("a", "b"):
                for causality, held in (("input", point.inputs[name]), ("output", point.outputs[name])):
                    np.testing.assert_array_equal(point.row[system.places[name, causality]], held)
            np.testing.assert_array_equal(
                point.row[system.place("b", second.variables["A"])], second.steps * np.arange(1, 5)
            )

    run(system, Jacobi(), step=1000, stop=2000, observers=[Look()])
    assert seen == [0, 1, 2]
    assert len(system.row) == 2 * (2 + 5)


def test_start_values_move_into_the_row() -> None:
    part = Scripted([port("a", "input", start=2.0), port("b", "input", start=3.0), port("y", "output")])
    before = part.u
    system = System({"p": part}, {})
    assert system.row.tolist() == [2, 3, 0]
    part.u[:] = [5, 7]
    assert system.row.tolist() == [5, 7, 0]
    assert before.tolist() == [2, 3]


def test_a_long_record_moves_to_a_file_and_is_whole() -> None:
    """With room for one chunk in memory, all but the last of 14 lie in a temporary file, to the bit."""
    n, small = 14_000, 8 * 9 * CHUNK
    long, kept = Record(limit=small), Record()
    run(numbered(n)[0], Jacobi(), step=1000, stop=n * 1000, observers=[long, kept])
    assert long._rows._stored == n // CHUNK
    assert kept._rows._stored == 0
    assert long.points == kept.points
    assert long.ports() == kept.ports()
    for name in long.ports():
        assert long[name].tobytes() == kept[name].tobytes()
    assert long.to_xarray().equals(kept.to_xarray())


def _no_room(**how: Any) -> Any:
    raise OSError(28, "No space left on device")


def test_a_record_that_finds_no_room_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tempfile.TemporaryFile", _no_room)
    record = Record(limit=1)
    with pytest.raises(ScenarioError, match=r"the record of the run fits neither into .* \(No space left on device\)"):
        run(numbered(5000)[0], Jacobi(), step=1000, stop=5000 * 1000, observers=[record])
    assert len(record) == CHUNK  # and what it has is whole
    np.testing.assert_array_equal(record["a.k"], 5 * np.arange(CHUNK))


def test_where_the_file_is_full_memory_takes_the_rest(monkeypatch: pytest.MonkeyPatch) -> None:
    """The file takes two chunks and a half: the half is written again, or stays in memory, and nothing is lost."""
    size, write = 8 * 9 * CHUNK, os.pwrite

    def full(file: int, data: memoryview, at: int) -> int:
        if at >= 2.5 * size:
            raise OSError(28, "No space left on device")
        return write(file, data[: int(2.5 * size) - at], at)

    monkeypatch.setattr("cosim.rows.NEAR", 1)
    monkeypatch.setattr("os.pwrite", full)
    record, n = Record(), 9000
    run(numbered(n)[0], Jacobi(), step=1000, stop=n * 1000, observers=[record])
    assert record._rows._stored == 2
    np.testing.assert_array_equal(record["a.k"], 5 * np.arange(n + 1))
    np.testing.assert_array_equal(record.time_ns, 1000 * np.arange(n + 1))
