"""The compiled loop makes the runs of the readable one: the same points, values, events and rejections, to the bit."""

from __future__ import annotations

import ctypes
import subprocess
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from toys import Alarm, Journal, Mass, Sampled, Spring, Watch

import fmus
from cosim import Component, CouplingError, GaussSeidel, Jacobi, Link, Observer, Record, Summary, System, run
from cosim.compiled import build
from cosim.compiled.layout import CComponent, CLoop
from studies.catalog import find_scenario
from studies.runner import execute

MS = 1_000_000  # ns
ALGORITHMS = [Jacobi(), GaussSeidel()]

# scenario, variant, duration in s: all plants, controllers and elements of any kind; the first three locate an event
ROVERS = [
    ("ramp-impact", "pd-friction", 0.03),
    ("ramp-impact-realistic", "pole-placement-observer", 0.03),
    ("rigid-ramp", "bouncing", 0.03),
    ("ramp-impact-noise", "pd", 0.02),
    ("slip-start", "slip-control", 0.02),
    ("jerk-hump", "body", 0.1),
]


def same(one: Record, other: Record) -> None:
    """Assert that two runs are the same to the bit, what was told of events and rejections included."""
    assert one.points == other.points
    assert (one.events, one.rejections) == (other.events, other.rejections)
    assert one.ports() == other.ports()
    for name in one.ports():
        assert one[name].tobytes() == other[name].tobytes(), name


@pytest.mark.parametrize(("scenario", "variant", "duration"), ROVERS, ids=[f"{s}-{v}" for s, v, _ in ROVERS])
def test_a_rover_crosses_alike_in_both_loops(scenario: str, variant: str, duration: float, fmi: int) -> None:
    found = []
    for compiled in (True, False):
        settings = {"run": {"duration": duration, "fmi": fmi, "compiled": compiled}}
        result = execute(find_scenario(scenario).load(variant, [settings]))
        assert result.error is None
        found.append(result)
    same(found[0].record, found[1].record)
    counts = [(r.summary.steps, r.summary.rejected, r.summary.events) for r in found if r.summary]
    assert counts[0] == counts[1]
    if fmi == 3 and scenario in ("ramp-impact", "ramp-impact-realistic", "rigid-ramp"):  # FMI 2.0 has no early return
        assert counts[0][1:] == (1, 1)


def both(
    parts: Callable[[], dict[str, Component]], wires: dict[str, Any], algorithm: Any, fmi: int, **how: Any
) -> tuple[Record, Summary]:
    """Run a system of FMUs in both loops; return what the compiled one made, which is what the other one made."""
    every, told, found = how.pop("every", None), how.pop("observers", []), []
    for compiled in (True, False):
        record = Record()
        instances = {name: fmus.instantiate(part, name, fmi=fmi) for name, part in parts().items()}
        with System(instances, wires, every=every) as system:
            summary = run(system, algorithm, observers=[record, *told], compiled=compiled, **{"step": MS, **how})
            found.append((record, summary, dict(system.time), [i.time for i in instances.values()]))
    (one, done, *where), (other, done_too, *where_too) = found
    same(one, other)
    assert where == where_too
    assert (done.steps, done.rejected, done.events) == (done_too.steps, done_too.rejected, done_too.events)
    return one, done


def oscillator() -> dict[str, Component]:
    return {"mass": Mass(), "spring": Spring(), "sampled": Sampled(period=4e-3), "watch": Watch(), "clock": Watch()}


WIRES: dict[str, Any] = {
    "mass.F": "spring.F", "spring.x": Link("mass.pos", factor=2, offset=1), "watch.u": "clock.y", "clock.u": "watch.y",
}  # fmt: skip


@pytest.mark.parametrize("algorithm", [*ALGORITHMS, GaussSeidel(("watch", "spring", "sampled", "clock", "mass"))])
@pytest.mark.parametrize("every", [{}, {"watch": 3, "sampled": 2}, {"mass": 2, "spring": 4}])
def test_some_step_less_often_than_others(algorithm: Any, every: dict[str, int], fmi: int) -> None:
    """The stop time is no whole number of macro steps, and these are no whole number of the slow components'."""
    record, _ = both(oscillator, WIRES, algorithm, fmi, every=every, stop=10 * MS + 300_000)
    assert len(record) == 12
    assert len(np.unique(record["mass.pos"])) > 2


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_events_are_located_alike(algorithm: Any) -> None:
    """Early returns in some steps, a slow component in the midst of its own one when everybody is taken back."""
    parts = lambda: {**oscillator(), "alarm": Alarm(at=2.345e-3), "bell": Alarm(at=3.1415e-3)}  # noqa: E731
    record, summary = both(parts, WIRES, algorithm, 3, every={"watch": 3}, stop=40 * MS)
    assert summary.rejected >= 20
    assert len({name for _, name in record.events}) == 2


def test_who_may_stop_at_events_but_need_not(fmi: int) -> None:
    parts = lambda: {**oscillator(), "alarm": Alarm(at=2.345e-3)}  # noqa: E731
    record, summary = both(parts, WIRES, Jacobi(), fmi, stop=20 * MS, locate_events=False)
    assert (summary.rejected, summary.events) == (0, 0)
    assert record["alarm.count"][-1] == 8


def test_a_run_may_start_later_and_end_between_ticks(fmi: int) -> None:
    parts = lambda: {**oscillator(), "sampled": Sampled(period=333_333e-9)}  # noqa: E731
    record, _ = both(parts, WIRES, GaussSeidel(), fmi, start=2.0, stop=2.0105 + 1e-9, step=333_333)
    assert record.points[0] == (2_000_000_000, 2_000_000_000)
    assert record.points[-1][1] == 2_010_500_001


def test_who_is_told_of_single_points_hears_the_same() -> None:
    journal = Journal()
    parts = lambda: {**oscillator(), "alarm": Alarm(at=2.345e-3)}  # noqa: E731
    both(parts, WIRES, GaussSeidel(), 3, stop=20 * MS, observers=[journal])
    half = len(journal.entries) // 2
    assert [e for e in journal.entries[:half] if e[0] != "started"] == [
        e for e in journal.entries[half:] if e[0] != "started"
    ]
    assert sum(entry[0] == "event" for entry in journal.entries[:half]) == 8


# who is told, and what becomes of an observer that breaks the run off


class Blocks(Observer):
    """Keeps the numbers and times of blocks; fails with the one that holds the point number *last*."""

    def __init__(self, last: int = -1) -> None:
        self.last, self.numbers, self.sizes = last, list[int](), list[int]()

    def accepted(self, point: Any) -> None:
        self.numbers.append(point.number)

    def accepted_block(self, block: Any) -> None:
        self.sizes.append(len(block.ends))
        self.numbers += range(block.first, block.first + len(block.ends))
        if self.last in self.numbers:
            raise OSError("disk full")


def chain() -> System:
    return System({"a": fmus.instantiate(Watch(), "a"), "b": fmus.instantiate(Watch(), "b")}, {"b.u": "a.y"})


def test_blocks_hold_every_point_once() -> None:
    blocks, steps = Blocks(), 20_000
    with chain() as system:
        run(system, Jacobi(), step=1000, stop=1000 * steps, observers=[blocks], compiled=True)
    assert blocks.numbers == list(range(steps + 1))
    assert max(blocks.sizes) > 1000  # else there would be nothing to gain


def test_an_observer_that_fails_breaks_the_run_off() -> None:
    blocks, record = Blocks(last=50), Record()
    with chain() as system, pytest.raises(OSError, match="disk full"):
        run(system, Jacobi(), step=MS, stop=100 * MS, observers=[record, blocks], compiled=True)
    assert str(record.error) == "disk full"
    assert record.points[50] == (49 * MS, 50 * MS)


# which loop makes a run


def refused(system: System, algorithm: Any = Jacobi(), **how: Any) -> str:  # noqa: B008
    with system, pytest.raises(CouplingError) as caught:
        run(system, algorithm, step=MS, compiled=True, **{"stop": 4 * MS, **how})
    return str(caught.value)


def test_what_the_compiled_loop_cannot_run_is_refused_only_if_it_is_asked_for() -> None:
    mixed = lambda: System({"a": fmus.instantiate(Watch(), "a"), "b": Watch().instance()}, {})  # noqa: E731
    assert refused(mixed()) == (
        "the compiled loop cannot make this run: b is no FMU that is stepped by its C functions alone; "
        "leave out compiled=True"
    )
    with mixed() as system:
        assert run(system, Jacobi(), step=MS, stop=4 * MS).steps == 4
    assert "it knows Jacobi and GaussSeidel, not Other" in refused(chain(), type("Other", (Jacobi,), {})())


@pytest.mark.parametrize(
    ("command", "why"),
    [(None, "no C compiler was found"), (["false"], "the C compiler false failed: it said nothing")],
)
def test_without_a_compiler_the_readable_loop_runs(
    command: Sequence[str] | None, why: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(build, "compiler", lambda: command)
    monkeypatch.setattr(build, "cache_folder", lambda: tmp_path)
    build.library.cache_clear()
    try:
        assert why in refused(chain())
        with chain() as system:
            assert run(system, Jacobi(), step=MS, stop=4 * MS).steps == 4
    finally:
        build.library.cache_clear()


def test_the_structures_are_those_of_the_c_source(tmp_path: Path) -> None:
    """Offsets and sizes by the C compiler, against ctypes'."""
    kinds: dict[str, Any] = {"Component": CComponent, "Loop": CLoop}
    fields = [(kind, name) for kind, layout in kinds.items() for name, _ in layout._fields_]
    asked = [*(f"offsetof({kind}, {name})" for kind, name in fields), *(f"sizeof({kind})" for kind in kinds)]
    lines = "\n".join(f'printf("%zu ", {what});' for what in asked)
    source, program = tmp_path / "sizes.c", tmp_path / "sizes"
    source.write_text(f'#include <stdio.h>\n#include "{build.HEADER}"\nint main(void) {{ {lines} return 0; }}\n')
    subprocess.run([*(build.compiler() or ["cc"]), str(source), "-o", str(program)], check=True)
    said = subprocess.run([str(program)], capture_output=True, text=True, check=True).stdout
    expected = [*(getattr(kinds[kind], name).offset for kind, name in fields), *map(ctypes.sizeof, kinds.values())]
    assert list(map(int, said.split())) == expected
