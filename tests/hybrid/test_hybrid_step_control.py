"""Event mode under steps of varying length: taken back for errors and for events, and events stay put."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hybrid import Make
from toys import Mass, Spring

from benchmarks.bouncing import touches
from cosim import PI, Extrapolated, GaussSeidel, Iterated, Jacobi, Record, Richardson, System, run

S = 1_000_000_000  # ns


@pytest.mark.filterwarnings("ignore:mass takes no derivatives of its inputs")
@pytest.mark.parametrize("inner", [GaussSeidel(), Jacobi(), Iterated(), Extrapolated(Jacobi(), 1)], ids=repr)
def test_a_ball_with_event_mode_bounces_on_time_under_pi(make: Make, inner: Any) -> None:
    """Beside an oscillator whose errors decide on the steps, the ball touches the floor when it must.

    The ball is a closed form in C, so what is left is the tick: it meets at the first one at or after the touch.
    """
    parts = {"ball": make("BALL", h0=1.0), "mass": Mass().instance(), "spring": Spring(k=400.0).instance()}
    system = System(parts, {"mass.F": "spring.F", "spring.x": "mass.pos", "spring.v": "mass.vel"})
    record, algorithm = Record(["ball.h", "mass.pos"]), Richardson(inner, outputs=("mass.*",))
    control = PI(5e-2, 5e-2)
    summary = run(system, algorithm, step=S // 10, stop=2 * S, observers=[record], control=control)
    met = sorted({time for time, who in record.events if who == "ball"})
    expected = np.array(list(touches(1.0, 2.0)))
    assert len(expected) == 3
    np.testing.assert_allclose(np.array(met) / S, expected, atol=1.5e-9)
    assert summary.rejected > len(met)  # some for their error
    assert np.all(np.diff(record.time_ns) >= 0)
    assert len(set(np.diff(record.time_ns))) > 10


def test_the_ticks_of_clocks_are_met_and_cut_no_later_steps(make: Make) -> None:
    """A controller samples the position every 0.1 s: every tick is a point of the run, and steps between are longer."""
    parts = {"controller": make("CONTROLLER"), "mass": Mass().instance(), "spring": Spring(k=1.0).instance()}
    wires = {"mass.F": "spring.F", "spring.x": "mass.pos", "spring.v": "mass.vel"}
    record = Record()
    control = PI(1e-2, 1e-2)
    algorithm = Richardson(outputs=("mass.*",))
    run(System(parts, wires), algorithm, step=S // 1000, stop=S, observers=[record], control=control)
    ticks = np.arange(11) * (S // 10)
    assert set(ticks) <= set(record.time_ns)
    last = np.diff(np.unique(record.time_ns[record.time_ns > S // 2]))
    assert np.min(last) > S // 100  # ten times the first: cut to end at a tick, but never chosen anew from a cut one
