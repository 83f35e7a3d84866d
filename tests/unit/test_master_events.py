"""Announced events: everybody meets at them to the nanosecond, nobody keeps anything of a step taken back."""

from math import ceil, sqrt
from typing import Any

import numpy as np
import pytest
from toys import Alarm, Ball, Journal, Mass, Position, Sampled, Scripted, Spring, port, silent

from cosim import (
    Advance,
    Component,
    CouplingError,
    GaussSeidel,
    Jacobi,
    Record,
    StepError,
    System,
    input,
    output,
    run,
    state,
)

MS = 1_000_000  # ns
ALGORITHMS = [Jacobi(), GaussSeidel()]


def oscillator() -> dict[str, Any]:
    return {"mass": Mass().instance(), "spring": Spring().instance()}


WIRES = {"mass.F": "spring.F", "spring.x": "mass.pos"}


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_an_event_is_met_at_the_first_nanosecond_after_it(algorithm: Any) -> None:
    # x = t is integrated exactly, so the event lies at t = at up to rounding.
    at = 2.3456784321e-3
    system = System({**oscillator(), "alarm": Alarm(at=at).instance()}, WIRES)
    journal, record = Journal(), Record()
    summary = run(system, algorithm, step=MS, stop=4 * MS, observers=[journal, record])
    met = ceil(at * 1e9)
    assert record.points == [(0, 0), (0, MS), (MS, 2 * MS), (2 * MS, met), (met, 3 * MS), (3 * MS, 4 * MS)]
    assert record.events == [(met, "alarm")]
    assert record.rejections == [(2 * MS, 3 * MS, met, "alarm")]
    assert (summary.steps, summary.rejected, summary.events) == (5, 1, 1)
    assert journal.entries[4:8] == [
        ("rejected", 2 * MS, 3 * MS, met, "alarm"),
        ("accepted", 3, 2 * MS, met),
        ("event", met, "alarm"),
        ("accepted", 4, met, 3 * MS),
    ]
    assert set(system.time.values()) == {4 * MS}
    assert record["alarm.count"].tolist() == [0, 0, 0, 1, 1, 1]


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_a_step_taken_back_leaves_nothing_behind(algorithm: Any) -> None:
    """To the bit: the run through an event equals the run that was told to stop there."""
    at = 2.3456784321e-3
    met = ceil(at * 1e9)
    through, until = Record(), Record()
    for stop, record in ((3 * MS, through), (met, until)):
        parts = {"sampled": Sampled(period=1e-3).instance(), **oscillator(), "alarm": Alarm(at=at).instance()}
        run(System(parts, WIRES), algorithm, step=MS, stop=stop, observers=[record])
    assert (len(through.rejections), len(until.rejections)) == (1, 0)
    for name in until.ports():
        np.testing.assert_array_equal(through[name][: len(until)], until[name], err_msg=name)


def test_what_is_no_float64_is_taken_back_too() -> None:
    class Counter(Scripted):
        """Sends the number of its steps."""

        def pull(self) -> None:
            self.values["n"] = self.steps

        def snapshot(self) -> Any:
            return self.steps

        def restore(self, snapshot: Any) -> None:
            self.steps = snapshot

    reader = Scripted([port("n", "input", "Int32", start=0)], rollback=True)
    parts = {"reader": reader, "counter": Counter([port("n", "output", "Int32")], rollback=True)}
    record = Record()
    system = System({**parts, "alarm": Alarm(at=1.5e-3).instance()}, {"reader.n": "counter.n"})
    run(system, GaussSeidel(), step=MS, stop=2 * MS, observers=[record])
    assert record["counter.n"].tolist() == [0, 1, 2, 3]
    assert record["reader.n"].tolist() == [0, 0, 1, 2]  # the one before: it steps first


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_two_components_with_events_in_one_step(algorithm: Any) -> None:
    late, early = 2.71828182e-3, 2.14142135e-3
    parts = {"late": Alarm(at=late).instance(), **oscillator(), "early": Alarm(at=early).instance()}
    record = Record()
    run(System(parts, WIRES), algorithm, step=MS, stop=4 * MS, observers=[record])
    assert record.events == [(ceil(early * 1e9), "early"), (ceil(late * 1e9), "late")]
    # "late" steps first and stops; on its shorter step "early" stops; what is left is stopped by "late" again.
    assert [r[3] for r in record.rejections] == ["late", "early", "late"]
    np.testing.assert_array_equal(np.diff(record.time_ns) > 0, True)


def test_two_events_at_the_same_instant_are_met_once() -> None:
    parts = {"a": Alarm(at=1.5e-3).instance(), "b": Alarm(at=1.5e-3).instance()}
    record = Record()
    run(System(parts, {}), Jacobi(), step=MS, stop=2 * MS, observers=[record])
    assert record["a.count"][-1] == record["b.count"][-1] == 1
    assert record.time_ns[2] in (1_500_000, 1_500_001)  # 1.5e-3 is a float a little off the tick
    assert len(record.points) <= 5


def test_several_events_in_one_macro_step() -> None:
    record = Record()
    run(System({"a": Alarm(at=0.23e-3).instance()}, {}), Jacobi(), step=MS, stop=MS, observers=[record])
    assert [time for time, _ in record.events] == pytest.approx([230_000, 460_000, 690_000, 920_000], abs=1)


class Ramp(Component):
    """Gives the mean of t over its last step: what others do depends on where a step ends."""

    u = input("1", "nothing")
    began = state(0.0, "s", "time at the begin of the step")
    y = output("1/s", "1000 times the middle of the last step, per s^2")

    def sync(s: Any) -> dict[str, Any]:
        return dict(began=s.time)

    def outputs(s: Any) -> dict[str, Any]:
        return dict(y=1000 * (s.began + s.time) / 2)


def test_an_event_that_moves_with_the_length_of_the_step_is_still_met() -> None:
    """A rate of 1000 t, handed over as its mean over the step: on each shorter step the event moves.

    x grows by 1000 (t^2 - t_n^2) / 2 over a step whatever its length, so x = 500 t^2 and the event at x = 1e-3 lies at
    sqrt(2e-6) s = 1.414 ms.
    """
    alarm = Alarm(at=1e-3).instance()
    system = System({"ramp": Ramp().instance(), "alarm": alarm}, {"alarm.rate": "ramp.y"})
    record = Record()
    run(system, GaussSeidel(), step=MS, stop=1.9e-3, observers=[record])
    first = record.rejections[0][2]
    # Over the whole step [1, 1.9] ms the mean rate is 1.45: x = 5e-4 + 1.45 (t - 1e-3) reaches 1e-3 too early.
    assert first == pytest.approx(1e6 + 0.5e6 / 1.45, abs=1)
    assert len(record.events) == 1
    met = record.events[0][0]
    assert met == pytest.approx(sqrt(2e-6) * 1e9, abs=2)
    assert record["alarm.total"][-1] == pytest.approx(500 * 1.9e-3**2, rel=1e-9)
    assert record["alarm.count"][-1] == 1


def test_a_bouncing_ball_meets_at_every_touch() -> None:
    # t_1 = sqrt(2 z0 / g); each flight lasts e times the one before, the first one from the floor 2 e t_1.
    g, e = 9.81, 0.8
    t1 = sqrt(2 / g)
    touches = t1 + np.cumsum([0, *(2 * t1 * e**k for k in range(1, 5))])
    record = Record()
    run(System({"ball": Ball().instance()}, {}), Jacobi(), step=0.01, stop=1.8, observers=[record])
    met = np.array([time for time, _ in record.events]) / 1e9
    # A tick late at most, and the error of the flights before, each computed to 1e-8.
    np.testing.assert_allclose(met, touches[touches < 1.8], atol=2e-8)


def test_a_slow_component_is_brought_to_the_event_as_well() -> None:
    parts = {"alarm": Alarm(at=1.25e-3).instance(), "slow": Position().instance()}
    record = Record()
    system = System(parts, {}, every={"slow": 4})
    seen = []
    observe = Journal()
    observe.accepted = lambda point: seen.append((point.end, system.time["slow"]))  # type: ignore[method-assign]
    run(system, Jacobi(), step=MS, stop=8 * MS, observers=[record, observe], locate_events=True)
    met = record.events[0][0]
    assert (met, met) in seen
    assert seen[:3] == [(0, 0), (MS, 0), (met, met)]
    assert (4 * MS, 4 * MS) in seen


def test_without_location_nobody_stops() -> None:
    system = System({"alarm": Alarm(at=1.7e-3).instance(), **oscillator()}, WIRES)
    record = Record()
    summary = run(system, Jacobi(), step=MS, stop=3 * MS, observers=[record], locate_events=False)
    assert (summary.steps, summary.rejected, summary.events) == (3, 0, 0)
    assert record["alarm.count"].tolist() == [0, 0, 1, 1]


def test_a_system_without_events_takes_no_snapshots() -> None:
    part = silent(rollback=True)
    part.snapshot = lambda: pytest.fail("a snapshot was taken")  # type: ignore[method-assign]
    run(System({"a": part}, {}), Jacobi(), step=MS, stop=3 * MS)


def test_snapshots_are_given_back() -> None:
    part, held = silent(rollback=True), []
    part.snapshot = lambda: held.append(1) or len(held)  # type: ignore[method-assign, func-returns-value]
    part.forget = lambda snapshot: held.pop()  # type: ignore[method-assign]
    run(System({"a": part, "alarm": Alarm(at=1.5e-3).instance()}, {}), GaussSeidel(), step=MS, stop=3 * MS)
    assert held == []
    assert part.steps == 5  # three macro steps, one of them twice begun and once left over


def test_jacobi_needs_rollback_only_of_those_who_announce() -> None:
    part = silent()
    run(System({"fixed": part, "alarm": Alarm(at=1.5e-3).instance()}, {}), Jacobi(), step=MS, stop=3 * MS)
    assert part.steps == 4  # it stepped only once each attempt was known to succeed


def refused(parts: dict[str, Any], algorithm: Any, every: dict[str, int] | None = None) -> str:
    with pytest.raises(CouplingError) as caught:
        run(System(parts, {}, every=every), algorithm, step=MS, stop=4 * MS)
    return str(caught.value)


def test_who_cannot_go_back_is_named() -> None:
    assert refused({"brake": silent(), "body": Alarm().instance()}, GaussSeidel()) == (
        "brake cannot be taken back to an earlier state, which the events of body ask for; "
        "let brake step after body in GaussSeidel, or run with locate_events=False"
    )


def test_who_announces_and_cannot_go_back_is_told_what_would_work() -> None:
    assert refused({"body": silent(early_return=True)}, Jacobi()) == (
        "body cannot be taken back to an earlier state, which the events of body ask for; run with locate_events=False"
    )


def test_who_announces_steps_at_every_macro_step() -> None:
    assert refused({"body": Alarm().instance()}, Jacobi(), {"body": 4}) == (
        "body announces events and cannot step every 4 macro steps, since the others would have passed them; "
        "let it step every one, or run with locate_events=False"
    )


def test_who_needs_equal_steps_cannot_meet_at_events() -> None:
    assert refused({"body": Alarm().instance(), "fixed": silent(variable_step=False)}, Jacobi()) == (
        "fixed needs steps of equal length, but events are located; run with locate_events=False"
    )


def test_events_without_end_are_an_error() -> None:
    class Nagging(Scripted):
        def step(self, start: int, end: int, *, early_return: bool = False) -> Advance:
            return Advance(end) if end == start + 1 else Advance(start + 1, early=True)

    sentence = refused({"nag": Nagging([], rollback=True, early_return=True)}, Jacobi())
    assert sentence == (
        "nag returned early 1001 times in one macro step, last at 0.000001001 s in the step from 0.000001000 s to "
        "0.001000000 s: its events do not come to an end; run with locate_events=False or look at its jump"
    )


def test_an_event_at_the_very_start_of_a_step_does_not_stop_time() -> None:
    stuck = Scripted([], rollback=True, early_return=True)
    stuck.script = {1: lambda start, end: Advance(start, early=True)}
    record = Record()
    run(System({"a": stuck}, {}), Jacobi(), step=MS, stop=2 * MS, observers=[record])
    assert record.points[1:3] == [(0, 1), (1, MS)]
    assert record.events == [(1, "a")]


def test_an_event_exactly_at_the_end_of_a_step_is_told() -> None:
    part = Scripted([], {2: lambda start, end: Advance(end, early=True)}, rollback=True, early_return=True)
    record = Record()
    summary = run(System({"a": part}, {}), Jacobi(), step=MS, stop=3 * MS, observers=[record])
    assert record.events == [(2 * MS, "a")]
    assert (summary.events, summary.rejected) == (1, 0)


def test_the_event_before_a_failure_is_told() -> None:
    def stops(start: int, end: int) -> Advance:
        return Advance(start + 10, early=True)

    part = Scripted([], {1: stops, 3: ValueError("torn")}, rollback=True, early_return=True)
    journal = Journal()
    with pytest.raises(StepError, match="torn"):
        run(System({"a": part}, {}), Jacobi(), step=MS, stop=2 * MS, observers=[journal])
    assert journal.entries[-3:] == [
        ("accepted", 1, 0, 10),
        ("event", 10, "a"),
        ("failed", "a failed at t = 1e-08 s: ValueError: torn (step 2)"),
    ]


def test_time_in_the_accepted_points_only_grows() -> None:
    parts = {"ball": Ball().instance(), "alarm": Alarm(at=0.0371).instance()}
    record = Record()
    run(System(parts, {}), GaussSeidel(), step=0.02, stop=1.5, observers=[record])
    starts, ends = np.array(record.points[1:]).T
    np.testing.assert_array_equal(starts[1:], ends[:-1])
    assert np.all(ends > starts)
    np.testing.assert_array_equal(np.intersect1d(ends, np.arange(1, 76) * 20 * MS), np.arange(1, 76) * 20 * MS)
