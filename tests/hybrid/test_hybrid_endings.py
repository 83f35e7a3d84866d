"""Events that come to an end, and runs that end since they do not: rest, Zeno, chattering, loops, termination."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hybrid import Make
from superdense import Superdense
from toys import Gain, Journal

from cosim import CouplingError, GaussSeidel, Jacobi, System, WiringError, run


def refused(parts: dict[str, Any], wires: dict[str, str], **span: Any) -> str:
    journal = Journal()
    with pytest.raises(CouplingError) as caught:
        run(System(parts, wires), GaussSeidel(), observers=[journal], **{"step": 0.1, "stop": 5.0, **span})
    assert journal.entries[-1] == ("failed", str(caught.value))
    return str(caught.value)


def test_a_ball_that_comes_to_rest(make: Make) -> None:
    """The touches accumulate towards t1 (1 + e) / (1 - e); slower than 1 um/s the ball stays, before they are denser

    than a nanosecond: v_k = e^k g t1, the last one above 1e-6 m/s is k = 67, and each flight lasts 2 v / g.
    """
    record = Superdense()
    run(System({"ball": make("BALL", rest=1e-6)}, {}), Jacobi(), step=0.1, stop=5.0, observers=[record])
    t1 = 0.451523640985728
    assert record["ball.bounces"][-1] == int(np.log(1e-6 / (9.81 * t1)) / np.log(0.8)) + 1
    assert record["ball.h"][-1] == record["ball.v"][-1] == 0
    assert record.events[-1][0] / 1e9 == pytest.approx(t1 * 1.8 / 0.2, abs=2e-6)


def test_zeno(make: Make) -> None:
    """Touches that accumulate end the run with a sentence, not with a run that never ends."""
    sentence = refused({"ball": make("BALL")}, {})
    assert sentence.startswith("ball returned early 1001 times in one macro step, last at 4.06371")
    assert "its events do not come to an end" in sentence
    last = float(sentence.split("last at ")[1].split(" s ")[0])
    assert last == pytest.approx(0.451523640985728 * 1.8 / 0.2, abs=1.1e-6)  # a thousand returns, each a ns at least


def test_chattering(make: Make) -> None:
    """Two relays in a ring, y = 1 - u after each update: they change as long as one lets them."""
    sentence = refused(
        {"a": make("RELAY"), "b": make("RELAY"), "c": make("RELAY")}, {"a.u": "c.y", "b.u": "a.y", "c.u": "b.y"}
    )
    assert sentence == (
        "the events at t = 0.000000000 s do not come to an end: after 1000 micro steps a.y, b.y, c.y still change; "
        "let one of them change at the tick of a clock only, or give it a hysteresis"
    )


def test_an_algebraic_loop_of_discrete_values(make: Make) -> None:
    sentence = refused({"b": make("SUMMING"), "c": make("SUMMING")}, {"b.u": "c.y", "c.u": "b.y"})
    assert sentence == (
        "the events at t = 0.000000000 s do not come to an end: after 100 passes over the connections b.y, c.y still "
        "change; let one of them change at the tick of a clock only, or give it a hysteresis"
    )


def test_time_events_that_do_not_let_time_go_on(make: Make) -> None:
    sentence = refused({"stair": make("STAIR", width=1e-9)}, {})
    assert sentence == (
        "the time events of stair do not let time go on: 1000 of them, each a nanosecond after the one before, ended "
        "at t = 0.000001000 s"
    )


def test_a_time_event_that_is_due_again_at_once(make: Make) -> None:
    sentence = refused({"stair": make("STAIR", width=0.0)}, {})
    assert sentence == (
        "the events at t = 0.000000000 s do not come to an end: after 1000 micro steps stair.updates "
        "still change; let one of them change at the tick of a clock only, or give it a hysteresis"
    )


def test_the_end_of_the_simulation_at_an_event(make: Make) -> None:
    record = Superdense()
    parts = {"stair": make("STAIR", width=0.03, last=2.0), "gain": Gain().instance()}
    with System(parts, {}) as system:
        summary = run(system, GaussSeidel(), step=0.02, stop=1.0, observers=[record])
    assert (summary.terminated_by, summary.simulated) == ("stair", 0.06)
    assert record["stair.count"][-1] == 2


def test_a_clock_that_ticks_by_itself_takes_no_connection(make: Make) -> None:
    parts = {"ball": make("BALL"), "controller": make("CONTROLLER")}
    with pytest.raises(WiringError) as caught:
        run(System(parts, {"controller.sample": "ball.bounce"}), Jacobi(), step=0.1, stop=1.0)
    assert str(caught.value) == (
        "controller.sample is a constant clock, which ticks by itself; connect ball.bounce to a triggered one"
    )
