"""One FMU with event mode without a master: events inside a step, states through bytes, reset, input events."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from fmpy.validation import validate_fmu
from hybrid import MODELS, Make, hybrid

MS = 1_000_000  # ns


@pytest.mark.parametrize("model", MODELS)
def test_the_fmus_of_these_tests_are_valid(tmp_path: Path, model: str) -> None:
    assert validate_fmu(str(hybrid(tmp_path, model))) == []


def test_a_snapshot_goes_through_bytes_into_another_instance(make: Make) -> None:
    """Clock, clocked state and time travel along; what follows is the same to the bit."""
    one, other = make("CONTROLLER"), make("CONTROLLER")
    for instance in (one, other):
        instance.enter_initialization(0)
        instance.exit_initialization()
    one.step(0, 230 * MS)
    other.restore(other.deserialize(one.serialize(one.snapshot())))
    for instance in (one, other):
        instance.step(230 * MS, 660 * MS)
        instance.pull()
    assert one.get("ticks") == other.get("ticks") == 7
    np.testing.assert_array_equal(one.y, other.y)
    assert one.next_event() == other.next_event() == 700 * MS


def test_an_fmu_alone_handles_its_events_within_a_step(make: Make) -> None:
    """Without a master: time events, state events and clocks inside one long step, as if somebody had looked."""
    stair, ball, clocks = make("STAIR", width=0.1), make("BALL", h0=1.0), make("CLOCKS")
    for instance in (stair, ball, clocks):
        instance.enter_initialization(0)
        instance.push()
        instance.exit_initialization()
        assert instance.step(0, 1050 * MS).reached == 1050 * MS
        instance.pull()
    assert stair.get("count") == 10
    assert ball.get("bounces") == 1
    assert [clocks.get(f"n_{kind}") for kind in ("constant", "asked", "changing", "countdown")] == [4, 10, 6, 10]


def test_an_instance_can_be_reset_and_run_again(make: Make) -> None:
    ball = make("BALL", h0=1.0)
    runs = []
    for _ in range(2):
        ball.enter_initialization(0)
        ball.exit_initialization()
        ball.step(0, 800 * MS)
        ball.pull()
        runs.append((ball.get("bounces"), ball.y.copy()))
        ball.reset()
        ball.set("h0", 1.0)
    assert runs[0][0] == runs[1][0] == 1
    np.testing.assert_array_equal(runs[0][1], runs[1][1])


def test_discrete_inputs_wait_for_event_mode(make: Make) -> None:
    """A value set in step mode makes an input event at the beginning of the next step."""
    ball = make("BALL", g=8.0, h0=1.0)
    ball.enter_initialization(0)
    ball.push()
    ball.exit_initialization()
    ball.step(0, 250 * MS)
    ball.set("kick", 8.0)
    assert ball.next_event() == 250 * MS
    ball.push()
    ball.step(250 * MS, 500 * MS)
    ball.pull()
    # v = -8 / 4 from then on, without a force
    np.testing.assert_array_equal([ball.get("h"), ball.get("v")], [1 - 8 * 0.25**2 / 2 - 2 * 0.25, -2.0])
