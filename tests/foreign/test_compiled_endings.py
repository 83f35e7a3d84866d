"""However an FMU ends a run, the compiled loop ends it as the readable one does: the same points, the same sentence."""

from __future__ import annotations

from pathlib import Path

import pytest
from odd import ODDITIES, odd, state_flag
from toys import Mass

import fmus
from cosim import CosimError, GaussSeidel, Link, Observer, Point, Record, System, run
from cosim.observer import Block

AT_FIVE = "odd failed at t = 0.5 s: "
NO_TIME = "fmi{v}DoStep returned a last successful time that is no time (step 6)"
ENDED = {  # what is said; nothing if the run is complete or ends as asked
    "none": "",
    "chatty": "",
    "end": "",
    "fail": AT_FIVE + "the valve is stuck (fmi{v}DoStep returned error, step 6)",
    "fatal": AT_FIVE + "the heap is broken (fmi{v}DoStep returned fatal, step 6)",
    "nan": "mass failed at t = 0.5 s: input F is nan at t = 0.5 s (fmi{v}DoStep returned error, step 6)",
    "discard all": AT_FIVE + "it said nothing; with retry such steps are repeated in shorter ones, as it can be taken "
    "back; else use a shorter macro step (fmi{v}DoStep returned discard, step 6)",
    "refuse inputs": AT_FIVE + "the input is out of range (fmi{v}Set{float} returned error, step 6)",
    "refuse outputs": AT_FIVE + "it said nothing (fmi{v}Get{float} returned error, step 5)",
    "end nowhere": AT_FIVE + NO_TIME,
    "end before": "odd was asked to step from 0.500000000 s to 0.600000000 s and stopped at 0.450000000 s without "
    "having been allowed to",
}  # fmt: skip
EARLY = {  # the same for those who return early: whether that is allowed, and what is said
    "return nowhere": (True, AT_FIVE + NO_TIME),
    "creep": (
        False,
        AT_FIVE + "fmi3DoStep returns early again and again without reaching the end of the step (step 6)",
    ),
    "fail to save": (True, AT_FIVE + "it said nothing (fmi3GetFMUState returned error, step 6)"),
    "fail to restore": (True, AT_FIVE + "it said nothing (fmi3SetFMUState returned error, step 6)"),
}


class Told(Observer):
    """Keeps the ends of the points that it was told of, and what it was told of the end of the run."""

    def __init__(self) -> None:
        self.ends, self.last = list[int](), ""

    def accepted(self, point: Point) -> None:
        self.ends.append(point.end)

    def accepted_block(self, block: Block) -> None:
        self.ends += map(int, block.ends)

    def failed(self, error: BaseException) -> None:
        self.last = str(error)


def ending(path: Path, oddity: str, *, compiled: bool, locate: bool = True) -> tuple[str, Record, Told, list[str], str]:
    """Run a mass that an odd FMU pushes; return the error, what was recorded and told, warnings, who ended the run."""
    first, second = fmus.load(path, "odd"), fmus.instantiate(Mass(), "mass", fmi=fmus.load(path).archive.fmi)
    first.set("oddity", ODDITIES.index(oddity))
    record, told, by = Record(), Told(), ""
    with System({"odd": first, "mass": second}, {"mass.F": Link("odd.y", factor=1.0)}) as system:
        try:
            summary = run(system, GaussSeidel(), step=0.1, stop=1.0, observers=[record, told], locate_events=locate,
                          compiled=compiled)  # fmt: skip
            said, by = "", summary.terminated_by
        except CosimError as error:
            said = str(error)
        return said, record, told, first.warnings, by


def alike(path: Path, oddity: str, said: str, *, locate: bool = True) -> Record:
    """Assert that both loops end alike, with *said*, and that nobody missed a point; return the record."""
    one, other = (ending(path, oddity, compiled=compiled, locate=locate) for compiled in (True, False))
    assert one[0] == other[0] == said
    assert one[1].points == other[1].points
    assert all(one[1][port].tobytes() == other[1][port].tobytes() for port in other[1].ports())
    for _, record, told, _, _ in (one, other):
        assert told.ends == [end for _, end in record.points]
        assert told.last == said
    assert one[3:] == other[3:]
    return one[1]


@pytest.mark.parametrize("oddity", ENDED)
def test_a_run_ends_alike_in_both_loops(oddity: str, fmi: int, odd_fmus: dict[int, Path]) -> None:
    said = ENDED[oddity].format(v=fmi, float={2: "Real", 3: "Float64"}[fmi])
    record = alike(odd_fmus[fmi], oddity, said)
    assert len(record) == {"none": 11, "chatty": 11, "refuse outputs": 5}.get(oddity, 6)


@pytest.mark.parametrize("oddity", EARLY)
def test_who_returns_early_ends_alike(oddity: str, tmp_path: Path) -> None:
    flags = f'{state_flag(3)} mightReturnEarlyFromDoStep="true" canReturnEarlyAfterIntermediateUpdate="true"'
    locate, said = EARLY[oddity]
    assert len(alike(odd(tmp_path, 3, flags), oddity, said.format(v=3), locate=locate)) == 6
