"""Events of components that announce none, as in FMI 2.0: located by going back, to the same nanoseconds."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from toys import Mass, Scripted, Spring, port

import fmus
from benchmarks.bouncing import KICK, PERIOD, Announcing, Ball, Switch, touches
from cosim import (
    Capabilities,
    Component,
    CouplingError,
    GaussSeidel,
    Instance,
    Jacobi,
    Record,
    System,
    WiringError,
    run,
)

MS = 1_000_000  # ns


def instance(component: Component, name: str, kind: str) -> Instance:
    return component.instance(name) if kind == "python" else fmus.instantiate(component, name, fmi=int(kind[-1]))


def bouncing(kind: str, ball: type[Ball], events: dict[str, str]) -> System:
    parts = {
        "controller": instance(Switch(), "controller", kind),
        "first": instance(ball(z0=1.0), "first", kind),
        "second": instance(ball(z0=0.7), "second", kind),
    }
    return System(parts, {"second.kick": "controller.kick", "controller.seen": "first.height"}, events=events)


SPEEDS = {"first.speed": "rising", "second.speed": "rising"}
COUNTS = {"first.touches": "change", "second.touches": "change"}


CASES = {
    f"{way}-{kind}": (kind, ball, events)
    for way, (ball, events) in {
        "speeds": (Ball, SPEEDS),
        "counts": (Ball, COUNTS),
        "announced": (Announcing, {}),
    }.items()
    for kind in ("python", "fmi2", "fmi3")
    if events or kind != "fmi2"  # FMI 2.0 has no early return
}


@pytest.mark.parametrize(("kind", "ball", "events"), list(CASES.values()), ids=list(CASES))
def test_two_bouncing_masses_and_a_sampled_controller(kind: str, ball: type[Ball], events: dict[str, str]) -> None:
    """Each touch is met at the first nanosecond at or after its closed form.

    The integrators solve a parabola without an error of their own, but locate the floor on it to 1e-13 s only, some
    1e-4 of a nanosecond, at each of the touches.
    """
    record, stop = Record(), 3.5
    algorithm = GaussSeidel(("controller", "first", "second"))
    run(bouncing(kind, ball, events), algorithm, step=0.01, stop=stop, observers=[record])
    times = {
        "first": list(touches(1.0, stop)),
        "second": list(touches(0.7, stop, kick=KICK, period=PERIOD)),
    }
    for name, closed in times.items():
        late = np.array([t for t, who in record.events if who == name]) - np.array(closed) * 1e9
        assert len(closed) > 6
        assert np.all((late > -0.01) & (late < 1.01)), late


def test_the_other_components_are_brought_to_the_event() -> None:
    """An oscillator of two parts, x = cos 2t, of which the position is watched: it crosses zero at pi/4 and 3 pi/4."""
    parts = {"mass": fmus.instantiate(Mass(), "mass", fmi=2), "spring": fmus.instantiate(Spring(), "spring", fmi=2)}
    record = Record()
    wires = {"mass.F": "spring.F", "spring.x": "mass.pos"}
    summary = run(
        System(parts, wires, events={"mass.pos": "crossing"}), GaussSeidel(), step=0.01, stop=2.5, observers=[record]
    )
    assert summary.events == len(record.events) == 2
    for time, who in record.events:
        at = int(np.flatnonzero(record.time_ns == time)[0])
        x, before = record["mass.pos"][at], record["mass.pos"][at - 1]
        assert who == "mass"
        assert x * before < 0
        assert abs(x) <= 2.1e-9  # |v| is 2 at most, and the next nanosecond is there at once
    assert record.events[0][0] / 1e9 == pytest.approx(np.pi / 4, abs=0.02)  # the error of the coupling


class Kinked(Scripted):
    """y counts the steps taken, and is -1 before *at* and 1 from there on."""

    def __init__(self, at: int, **can: bool) -> None:
        super().__init__([port("y", "output")], **can)
        self.at, self.now = at, 0

    def step(self, start: int, end: int, *, early_return: bool = False) -> Any:
        self.now = end
        return super().step(start, end)

    def pull(self) -> None:
        self.y[:] = 1.0 if self.now >= self.at else -1.0

    def snapshot(self) -> Any:
        return self.now

    def restore(self, snapshot: Any) -> None:
        self.now = snapshot


def test_locating_costs_a_step_per_halving() -> None:
    kinked, record = Kinked(1_234_567, rollback=True), Record()
    run(System({"a": kinked}, {}, events={"a.y": "rising"}), Jacobi(), step=MS, stop=3 * MS, observers=[record])
    assert record.events == [(1_234_567, "a")]
    assert record.time_ns.tolist() == [0, MS, 1_234_567, 2 * MS, 3 * MS]
    # 20 halvings of a millisecond, twice that where a secant is tried in vain before; once more to meet there, and what
    # is left of the macro step.
    assert kinked.steps <= 1 + 1 + 2 * 20 + 3 + 2 + 1


def test_an_event_at_the_end_of_a_step_is_told() -> None:
    record = Record()
    parts = {"a": Kinked(2 * MS, rollback=True)}
    summary = run(System(parts, {}, events={"a.y": "rising"}), Jacobi(), step=MS, stop=3 * MS, observers=[record])
    assert record.events == [(2 * MS, "a")]
    assert summary.rejected == 0


def test_falling_is_not_rising() -> None:
    record = Record()
    parts = {"a": Kinked(MS + 1, rollback=True)}
    run(System(parts, {}, events={"a.y": "falling"}), Jacobi(), step=MS, stop=3 * MS, observers=[record])
    assert record.events == []


def test_who_cannot_go_back_cannot_be_searched() -> None:
    with pytest.raises(
        CouplingError, match="a cannot be taken back to an earlier state, which the events of a ask for"
    ):
        run(System({"a": Kinked(MS)}, {}, events={"a.y": "rising"}), Jacobi(), step=MS, stop=2 * MS)


def test_without_location_nobody_is_searched() -> None:
    kinked = Kinked(MS + 5, rollback=True)
    run(System({"a": kinked}, {}, events={"a.y": "rising"}), Jacobi(), step=MS, stop=3 * MS, locate_events=False)
    assert kinked.steps == 3


@pytest.mark.parametrize(
    ("events", "sentence"),
    [
        ({"b.y": "rising"}, "the event indicator 'b.y' names no component; known: a"),
        ({"a.x": "rising"}, "the event indicator 'a.x' is no output of a; known: y, flag"),
        ({"a.y": "risen"}, "the event indicator a.y cannot be 'risen'; did you mean 'rising'?"),
        ({"a.flag": "rising"}, "the event indicator a.flag is a Boolean; only its 'change' can be an event"),
    ],
)
def test_an_indicator_that_is_none_is_refused(events: dict[str, str], sentence: str) -> None:
    part = Scripted([port("y", "output"), port("flag", "output", "Boolean")])
    with pytest.raises(WiringError) as caught:
        System({"a": part}, {}, events=events)
    assert str(caught.value) == sentence


def test_an_fmu_with_an_event_mode_needs_no_indicator() -> None:
    part = Scripted([port("y", "output")])
    part.can = Capabilities(event_mode=True)
    with pytest.raises(WiringError, match="is not needed: a has an event mode of its own"):
        System({"a": part}, {}, events={"a.y": "rising"})
