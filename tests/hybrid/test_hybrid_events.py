"""FMI 3.0 event mode across a system: time events, state events, input events and clocks, at one instant for all."""

from __future__ import annotations

from math import ceil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hybrid import Make
from superdense import Superdense
from toys import Gain

from benchmarks.bouncing import touches
from cosim import (
    Component,
    Consistent,
    GaussSeidel,
    Jacobi,
    System,
    output,
    run,
)
from logs.read import signals
from logs.recorder import RerunRecorder

MS = 1_000_000  # ns
ALGORITHMS = [Jacobi(), GaussSeidel(), Consistent(GaussSeidel())]
PERIOD, STRENGTH = 0.1, 4.0


def bouncing(make: Make, longest: float = 0.0, **how: Any) -> System:
    """Two balls; a controller sees the first and kicks the second at its ticks, and counts the touches by a clock.

    The balls discard steps above *longest*, if it is given.
    """
    balls = {"longest": longest, "retry": longest > 0, **how}
    parts = {
        "first": make("BALL", h0=1.0, **balls),
        "second": make("BALL", h0=0.7, **balls),
        "controller": make("CONTROLLER", strength=STRENGTH, **how),
    }
    wires = {"second.kick": "controller.command", "controller.seen": "first.h", "controller.bounced": "first.bounce"}
    return System(parts, wires)


@pytest.mark.parametrize("step", [0.01, 0.007, 0.3])
@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_two_bouncing_masses_and_a_clocked_controller(make: Make, algorithm: Any, step: float) -> None:
    """Every touch is met at the first nanosecond at or after its closed form, whatever the macro step.

    Each parabola is exact up to rounding, some 1e-15 s per touch: nothing beside a tick.
    """
    record, stop = Superdense(), 3.5
    run(bouncing(make), algorithm, step=step, stop=stop, observers=[record])
    first = list(touches(1.0, stop))
    second = list(touches(0.7, stop, kick=STRENGTH, period=PERIOD))
    assert len(first) > 6 and len(second) > 6  # noqa: PT018
    for name, times in (("first", first), ("second", second)):
        met = record.when(f"{name}.bounce")
        late = met - np.array(times) * 1e9
        assert len(met) == len(times)
        assert np.all((late > -1e-5) & (late < 1)), late
        assert [t for t, who in record.events if who == name] == met.tolist()
    ticks = np.arange(36) * 100 * MS
    np.testing.assert_array_equal(record.when("controller.sample"), ticks)
    np.testing.assert_array_equal(record.when("controller.bounced"), record.when("first.bounce"))  # the same instant
    assert record["controller.count"][-1] == len(first)
    assert record["controller.last"][-1] == pytest.approx(first[-1], abs=1e-9)


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_values_change_at_the_instant_of_their_event_for_all(make: Make, algorithm: Any) -> None:
    record = Superdense()
    run(bouncing(make), algorithm, step=0.01, stop=1.0, observers=[record])
    at = np.flatnonzero(record.time_ns == 300 * MS)
    assert [record.micro[i] for i in at] == [0, 1, 2]  # as reached; the clock ticks; the discrete states are updated
    before, after, last = at
    assert record["controller.ticks"][at].tolist() == [3, 3, 4]
    assert record["controller.command"][last] == STRENGTH
    assert (record["controller.command"][before], record["second.kick"][before]) == (0, 0)
    assert (record["controller.command"][after], record["second.kick"][after]) == (STRENGTH, STRENGTH)
    # t = 0.3 s, seen at once: h = 1 - g t^2 / 2
    assert record["controller.saw"][after] == pytest.approx(1 - 9.81 * 0.3**2 / 2, abs=1e-12)
    touch = np.flatnonzero(record["first.bounce"])[0]
    assert record["controller.bounced"][touch]
    assert record["controller.count"][touch : touch + 2].tolist() == [0, 1]
    assert record["first.v"][touch + 1] == pytest.approx(-0.8 * record["first.v"][touch])


def test_what_waits_for_events_has_no_delay_and_clocks_of_their_own_need_no_wire(make: Make) -> None:
    system = bouncing(make)
    assert set(system.delays(Jacobi()).values()) == {0}
    assert system.unconnected == ("first.push", "first.kick", "second.push")


def test_superdense_time_is_told_in_order(make: Make) -> None:
    record = Superdense()
    summary = run(bouncing(make), GaussSeidel(), step=0.01, stop=1.0, observers=[record])
    assert record.numbers == list(range(summary.steps + 1))
    starts, ends = np.array(record.points).T
    np.testing.assert_array_equal(starts[1:], ends[:-1])
    dense = np.array(record.micro) > 0
    np.testing.assert_array_equal(starts[dense], ends[dense])
    assert np.all(ends[1:][~dense[1:]] > starts[1:][~dense[1:]])


class Late(Component):
    """Shows 1 from 15 ms on."""

    y = output("1", "0, then 1")

    def outputs(s: Any) -> dict[str, Any]:
        return dict(y=s.time >= 0.015)


def test_who_is_in_the_midst_of_a_long_step_is_left_alone(make: Make) -> None:
    """The ball steps every four macro steps: it is kicked when it has arrived, not before."""
    parts = {"ball": make("BALL", h0=1.0, g=8.0), "late": Late().instance()}
    record = Superdense()
    system = System(parts, {"ball.kick": "late.y"}, every={"ball": 4})
    run(system, Jacobi(), step=0.01, stop=0.12, observers=[record], locate_events=False)
    change = int(np.flatnonzero(record["ball.kick"])[0])
    assert (record.time_ns[change], record.micro[change]) == (40 * MS, 1)
    # v = -8 t up to 40 ms, -7 t from there on
    assert record["ball.v"][-1] == pytest.approx(-8 * 0.04 - 7 * 0.08, abs=1e-15)


def test_rolling_back_a_system_with_clocks_leaves_nothing_behind(make: Make) -> None:
    """A run that met events, each with a step taken back, shows at common times what one in tiny steps shows.

    The second ball falls under the controller's kicks only, and each piece of its flight is exact.
    """
    coarse, fine = Superdense(), Superdense()
    first = run(bouncing(make), GaussSeidel(("controller", "first", "second")), step=0.3, stop=0.9, observers=[coarse])
    run(bouncing(make), GaussSeidel(("controller", "first", "second")), step=0.001, stop=0.9, observers=[fine])
    assert first.rejected >= 3
    for port in ("second.h", "first.v", "controller.count", "controller.ticks"):
        assert coarse[port][-1] == pytest.approx(fine[port][-1], abs=1e-12)


@pytest.mark.parametrize("locate", [True, False])
def test_clocks_tick_on_time_with_and_without_locating(make: Make, locate: bool) -> None:
    record = Superdense()
    run(bouncing(make), GaussSeidel(), step=0.07, stop=0.9, observers=[record], locate_events=locate)
    np.testing.assert_array_equal(record.when("controller.sample"), np.arange(10) * 100 * MS)
    # Nobody stopped for the touches, but they happened where they should.
    assert record["first.bounces"][-1] == len(list(touches(1.0, 0.9)))
    last = list(touches(1.0, 0.9))[-1]
    v = 0.8 * 9.81 * last - 9.81 * (0.9 - last)  # thrown back, and fallen since
    assert record["first.v"][-1] == pytest.approx(v, abs=1e-12)


def test_every_kind_of_clock(make: Make) -> None:
    """The FMU refuses a tick that is not due, an interval not asked for, and a step past a tick."""
    clocks = make("CLOCKS")
    clocks.set("given", 0.125)
    parts = {"clocks": clocks, "ball": make("BALL", h0=1.0)}
    record = Superdense()
    run(System(parts, {"clocks.triggered": "ball.bounce"}), Jacobi(), step=0.04, stop=1.2, observers=[record])

    def expect(name: str, times: list[float]) -> None:
        np.testing.assert_array_equal(record.when(f"clocks.{name}"), [ceil(t * 1e9 - 1e-3) for t in times])
        assert record[f"clocks.n_{name}"][-1] == len(times)

    asked = [0.05 + 0.1 * k for k in range(12)]
    expect("constant", [0, 1 / 3, 2 / 3, 1.0])
    np.testing.assert_array_equal(record.when("clocks.constant")[1:3], [333_333_334, 666_666_667])  # no drift
    expect("asked", asked)
    expect("given", [0.125 * k for k in range(10)])
    expect("tunable", [0.05, 0.25, 0.45, 0.65, 0.95])
    expect("changing", [0.01, 0.03, 0.07, 0.15, 0.31, 0.63])
    expect("countdown", [t + 0.025 for t in asked])
    expect("triggered", [0.451523640985728, 0.451523640985728 * 2.6])  # sqrt(2/g), and 1 + 2 e times that
    clocks.close()


def test_time_events_are_met_exactly_and_updated_as_often_as_asked(make: Make) -> None:
    """It cannot return early and need not go back: the step is shortened to where it said its event would be."""
    can = 'canHandleVariableCommunicationStepSize="true" hasEventMode="true"'
    parts = {"stair": make("STAIR", {"can": can}, width=0.0301), "gain": Gain().instance()}
    parts["controller"] = make("CONTROLLER", {"period": 1.0})
    record = Superdense()
    system = System(parts, {"controller.bounced": "stair.stepped"})
    summary = run(system, GaussSeidel(), step=0.02, stop=0.1, observers=[record])
    met = [30_100_000, 60_200_000, 90_300_000]
    assert record.events == [(t, "stair") for t in met]
    assert record.time_ns[np.array(record.micro) == 0].tolist() == sorted([*range(0, 101 * MS, 20 * MS), *met])
    assert (summary.rejected, summary.events) == (0, 3)
    assert record["stair.count"][-1] == record["controller.count"][-1] == 3
    # once at first, then three at each event, and one more that ends the tick of its clock
    assert record["stair.updates"][-1] == 1 + 3 * 4
    np.testing.assert_array_equal(record.when("controller.bounced"), met)


def test_an_event_exactly_at_a_communication_point(make: Make) -> None:
    """With g = 8 and h0 = 1 the touch lies at 0.5 s without any rounding, and so does the stair's step."""
    parts = {"ball": make("BALL", g=8.0, h0=1.0), "stair": make("STAIR", width=0.5)}
    record = Superdense()
    summary = run(System(parts, {}), Jacobi(), step=0.125, stop=0.75, observers=[record])
    assert record.when("ball.bounce").tolist() == [500 * MS]
    assert sorted(record.events) == [(500 * MS, "ball"), (500 * MS, "stair")]
    # Six macro steps; the stair shows its first update, then both events show, and four more updates of the stair.
    assert (summary.rejected, summary.steps) == (0, 6 + 1 + 1 + 4)
    assert record["ball.bounces"][-1] == record["stair.count"][-1] == 1


def test_simultaneous_events_in_two_fmus_are_one_instant(make: Make) -> None:
    parts = {"a": make("BALL", h0=1.0), "b": make("BALL", h0=1.0), "controller": make("CONTROLLER")}
    record = Superdense()
    system = System(parts, {"controller.bounced": "b.bounce"})
    summary = run(system, GaussSeidel(), step=0.05, stop=0.5, observers=[record])
    at = record.when("a.bounce")
    np.testing.assert_array_equal(at, record.when("b.bounce"))
    np.testing.assert_array_equal(at, record.when("controller.bounced"))
    assert record.events == [(int(at[0]), "a"), (int(at[0]), "b")]
    assert summary.rejected == 1


@pytest.mark.parametrize("isolated", [False, True])
def test_discarded_steps_are_repeated_between_events(make: Make, isolated: bool) -> None:
    """A ball that makes 1.3 ms at most meets the same events as one that makes any step, and those are no more."""
    free, cut, stop = Superdense(), Superdense(), 0.6
    run(bouncing(make), GaussSeidel(), step=0.01, stop=stop, observers=[free])
    with bouncing(make, longest=1.3e-3, isolated=isolated) as system:
        summary = run(system, GaussSeidel(), step=0.01, stop=stop, observers=[cut])
    assert np.diff(cut.time).max() <= 1.3e-3 * (1 + 1e-9)
    assert summary.rejected > 7 * 60  # 7 of 1.3 ms are discarded before the rest of 0.9 ms is made
    assert len(free.events) >= 2
    assert [who for _, who in cut.events] == [who for _, who in free.events]
    for (a, _), (b, _) in zip(cut.events, free.events, strict=True):
        assert abs(a - b) <= 1  # ns: the parabolas are the same up to rounding
    for clock in ("first.bounce", "second.bounce", "controller.sample", "controller.bounced"):
        np.testing.assert_allclose(cut.when(clock), free.when(clock), atol=1)
    for port in ("controller.count", "controller.saw", "second.v"):
        np.testing.assert_allclose(cut[port][-1], free[port][-1], rtol=1e-12)


def test_isolated_fmus_meet_the_same_events(make: Make) -> None:
    alone, together = Superdense(), Superdense()
    for isolated, record in ((True, alone), (False, together)):
        with bouncing(make, isolated=isolated) as system:
            run(system, GaussSeidel(), step=0.01, stop=0.6, observers=[record])
    assert alone.points == together.points
    assert alone.events == together.events
    for name in together.ports():
        np.testing.assert_array_equal(alone[name], together[name], err_msg=name)


def test_a_log_keeps_points_of_the_same_time_apart(make: Make, tmp_path: Path) -> None:
    record, path = Superdense(), tmp_path / "hybrid.rrd"
    run(bouncing(make), GaussSeidel(), step=0.01, stop=0.6, observers=[record, RerunRecorder(path, "hybrid")])
    found = signals(path)
    np.testing.assert_array_equal(found["first.v"].ns, record.time_ns)
    np.testing.assert_array_equal(found["first.v"].values.ravel(), record["first.v"])
    np.testing.assert_array_equal(found["first.bounce"].values.ravel(), record["first.bounce"])
