"""Points told many at once end up in logs and records as those told one by one, whatever the sizes of the blocks."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from toys import Scripted, port

from cosim import Observer, Record, System
from cosim.observer import Block, Point, RunInfo, Summary
from logs.read import signals
from logs.recorder import RerunRecorder

MS = 1_000_000
POINTS = 137
ODD = (np.nan, -0.0, np.inf, 5e-324)


def system() -> System:
    ports = [port("u", "input", shape=(2,)), port("y", "output", shape=(3, 2)), port("k", "output")]
    return System({"a": Scripted(ports), "b": Scripted(ports[1:])}, {})


def whole(made: System) -> Block:
    """Return a run as one block: random rows with some odd numbers, steps of 1 ms but one of 0.4 and 0.6."""
    rows = np.random.default_rng(3).standard_normal((POINTS, len(made.row)))
    rows[5, :4] = ODD[: rows.shape[1]]
    ends = np.arange(POINTS) * MS
    ends[70] -= 600_000
    starts = np.concatenate([[0], ends[:-1]])
    return Block(0, starts, ends, np.linspace(0, 0.1, POINTS), rows, made.places)


def cut(block: Block, size: int) -> Iterator[Block]:
    """Yield the run in blocks of *size* that all lie in the same memory, as those of a compiled loop do."""
    room = [np.empty((size, *part.shape[1:]), part.dtype) for part in block[1:5]]
    for first in range(0, POINTS, size):
        n = min(size, POINTS - first)
        for place, part in zip(room, block[1:5], strict=True):
            place[:n] = part[first : first + n]
        starts, ends, walls, rows = (place[:n] for place in room)
        yield Block(first, starts, ends, walls, rows, block.places)
        for place in room:
            place[:] = -7


def tell(observer: Observer, made: System, size: int) -> None:
    """Tell an observer of the run; in blocks of *size*, or one by one if it is 0."""
    observer.started(made, RunInfo(MS, POINTS * MS, 0, "test"))
    for block in cut(whole(made), size or POINTS):
        if size:
            observer.accepted_block(block)
        else:
            for point in block.points():
                observer.accepted(point)
    observer.finished(Summary(POINTS - 1, 0, 0, 0.1, POINTS * 1e-3))


def logged(path: Path, size: int) -> dict[str, tuple[bytes, bytes]]:
    tell(RerunRecorder(path, "x", chunk=50), system(), size)
    return {port: (s.ns.tobytes(), s.values.tobytes()) for port, s in signals(path).items()}


@pytest.mark.parametrize("size", [1, 7, 50, 64, 200])
def test_a_log_of_blocks_is_that_of_points(tmp_path: Path, size: int) -> None:
    """Blocks that are smaller than a chunk of 50, as large, larger, and the whole run."""
    expected = logged(tmp_path / "points.rrd", 0)
    assert set(expected) == {"a.in.u", "a.y", "a.k", "b.y", "b.k", "master.step_size", "master.wall"}
    assert len(expected["a.y"][0]) == 8 * POINTS
    assert logged(tmp_path / "blocks.rrd", size) == expected


@pytest.mark.parametrize("names", [None, ["b.k", "a.y"]])
def test_a_record_of_blocks_is_that_of_points(names: list[str] | None) -> None:
    one, many = Record(names), Record(names)
    tell(one, system(), 0)
    tell(many, system(), 64)
    assert one.points == many.points
    assert one.ports() == many.ports()
    for name in one.ports():
        assert one[name].shape == many[name].shape
        assert one[name].tobytes() == many[name].tobytes()


def test_a_port_of_another_type_is_told_point_by_point(tmp_path: Path) -> None:
    part = Scripted([port("y", "output"), port("on", "output", "Boolean")])
    part.get = lambda name: True  # type: ignore[method-assign]
    made, record = System({"a": part}, {}), Record()
    tell(record, made, 64)
    assert record["a.on"].tolist() == [True] * POINTS
    tell(RerunRecorder(tmp_path / "x.rrd", "x", chunk=50), made, 64)
    assert signals(tmp_path / "x.rrd")["a.on"].values.ravel().tolist() == [1.0] * POINTS


class _Unread(Block):
    def points(self) -> Iterator[Point]:
        raise AssertionError("the points were made for nobody")


def test_no_points_are_made_for_an_observer_that_looks_at_none() -> None:
    """Making them takes a third of a step of the rover; who defines ``accepted`` has them."""
    block = _Unread(*whole(system()))
    Observer().accepted_block(block)

    class Listens(Observer):
        def accepted(self, point: Point) -> None:
            """Want each."""

    with pytest.raises(AssertionError, match="for nobody"):
        Listens().accepted_block(block)
