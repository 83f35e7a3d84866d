"""Saved states: the same bits again, in the same instance, after bytes, and in another instance; early return."""

from __future__ import annotations

import numpy as np
import pytest
from specimens import Ball, Delayed, Road, Specimen
from test_twin_agreement import prepared

import fmus
from cosim import Component, Instance, StepError, event, output, parameter, state
from cosim.clock import NS


def history(instance: Instance, first: int, last: int, h: int) -> np.ndarray:
    """Take steps with inputs that change, and return all outputs and states."""
    found = []
    for n in range(first, last):
        instance.u[:] = np.cos(0.1 * n + np.arange(instance.u.size))
        instance.push()
        instance.step(n * h, (n + 1) * h)
        instance.pull()
        local = [np.ravel(instance.get(k)) for k, v in instance.variables.items() if v.causality == "local"]
        found.append(np.concatenate([instance.y, *local]))
    return np.array(found)


def test_restoring_gives_the_same_bits(specimen: Specimen, fmi: int, rng: np.random.Generator) -> None:
    h = round(specimen.step * NS)
    values = specimen.values(rng)
    fmu, other = (prepared(fmus.instantiate(specimen.component, fmi=fmi), values) for _ in range(2))
    history(fmu, 0, 3, h)
    saved, data = fmu.snapshot(), None
    u, y = fmu.u.copy(), fmu.y.copy()
    data = fmu.serialize(saved)
    first = history(fmu, 3, 8, h)
    for _ in range(2):
        fmu.restore(saved)
        fmu.pull()
        assert np.array_equal(fmu.u, u)
        assert np.array_equal(fmu.y, y)
        assert np.array_equal(history(fmu, 3, 8, h), first)
    fmu.restore(fmu.deserialize(data))
    assert np.array_equal(history(fmu, 3, 8, h), first)
    other.restore(other.deserialize(data))
    assert np.array_equal(other.u, u)
    assert np.array_equal(history(other, 3, 8, h), first)
    assert fmu.serialize(saved) == data
    fmu.forget(saved)
    for instance in (fmu, other):
        instance.close()


def test_the_same_inputs_give_the_same_bits(specimen: Specimen, fmi: int, rng: np.random.Generator) -> None:
    h, values = round(specimen.step * NS), specimen.values(rng)
    runs = [history(prepared(fmus.instantiate(specimen.component, fmi=fmi), values), 0, 5, h) for _ in range(2)]
    assert np.array_equal(*runs)


def test_a_failed_instance_can_be_set_back(fmi: int) -> None:
    fmu = prepared(fmus.instantiate(Ball(), fmi=fmi), {})
    saved = fmu.snapshot()
    fmu.u[0] = np.nan
    fmu.push()
    with pytest.raises(StepError):
        fmu.step(0, NS)
    fmu.restore(saved)
    fmu.push()
    assert fmu.step(0, NS // 100).reached == NS // 100


def test_a_state_of_other_tables_is_refused(fmi: int) -> None:
    a = prepared(fmus.instantiate(Road(), fmi=fmi), {})
    b = prepared(fmus.instantiate(Road(pieces=[[0, 1, 2]]), "road", fmi=fmi), {})
    with pytest.raises(StepError, match="saved with other tables than this instance has"):
        b.restore(b.deserialize(a.serialize(a.snapshot())))


def test_early_return_is_just_past_the_event() -> None:
    fmu, twin = fmus.instantiate(Ball()), Ball().instance()
    for instance in (fmu, twin):
        prepared(instance, {})
        instance.ending = instance.step(0, NS, early_return=True)  # type: ignore[attr-defined]
    fall = np.sqrt(2 * 0.2 / 9.81)  # s
    for instance in (fmu, twin):
        ending = instance.ending  # type: ignore[attr-defined]
        assert ending.early
        # the first tick at or after the impact, located to 1e-13 s: rounding up to a nanosecond is all that is left
        assert ending.reached == np.ceil(fall * NS)
        assert instance.get("bounces") == 1
    assert fmu.get("height") <= 0  # the far side
    assert abs(fmu.get("height")) < 1e-11
    assert fmu.get("speed") == pytest.approx(0.8 * 9.81 * fall, rel=1e-9)


class Swing(Component):
    """x'' = -w^2 x from x = 1 m at rest: through zero at pi/(2 w), upwards again at 3 pi/(2 w)."""

    w = parameter(7.0, "rad/s", "angular frequency")
    x = state(1.0, "m", "position")
    v = state(0.0, "m/s", "velocity")
    zero = event("the position changes its sign", announce=True)
    y = output("m", "position")

    def derivatives(s):
        return dict(x=s.v, v=-(s.w**2) * s.x)

    def crossings(s):
        return dict(zero=s.x)

    def outputs(s):
        return dict(y=s.x)


def test_an_event_on_a_curve_is_located() -> None:
    """On a path that is no polynomial the event is as good as the dense output, which is as good as the tolerance."""
    fmu = fmus.instantiate(Swing())
    fmu.enter_initialization(tolerance=1e-10)
    fmu.exit_initialization()
    now, found = 0, []
    while len(found) < 2:
        saved = fmu.snapshot()
        advance = fmu.step(now, NS, early_return=True)
        fmu.restore(saved)
        fmu.step(now, advance.reached, early_return=True)
        now = advance.reached
        found.append(now / NS)
    # global error a few times the tolerance, divided by the speed w; then up to the next nanosecond
    assert found == pytest.approx([np.pi / 14, 3 * np.pi / 14], abs=2e-9)


def test_nobody_returns_early_unasked(fmi: int) -> None:
    fmu = prepared(fmus.instantiate(Ball(), fmi=fmi), {})
    ending = fmu.step(0, NS)
    assert (ending.reached, ending.early) == (NS, False)
    # impacts at t1 = sqrt(2 h/g), t1 (1 + 2 e), t1 (1 + 2 e + 2 e^2), ...: 0.2019, 0.525, 0.783, 0.990 s
    assert fmu.get("bounces") == 4


def test_the_rest_of_a_step_is_no_new_step(fmi: int) -> None:
    """The position crosses zero at 0.5 s and is announced: whoever goes on must not start again at 0.5 m."""
    fmu = prepared(fmus.instantiate(Delayed(), fmi=fmi), {})
    fmu.step(0, NS)
    fmu.pull()
    # integral of 0.5 - t over 1 s
    assert fmu.get("x") == pytest.approx(-0.5, abs=1e-12)
    assert fmu.get("mean") == pytest.approx(0.0, abs=1e-12)


def test_a_step_again_to_the_event_meets_it() -> None:
    """What a master does: everybody back, and together to the tick of the event."""
    fmu = prepared(fmus.instantiate(Ball()), {})
    saved = fmu.snapshot()
    reached = fmu.step(0, NS, early_return=True).reached
    fmu.restore(saved)
    ending = fmu.step(0, reached, early_return=True)
    assert (ending.reached, ending.early) == (reached, True)  # it lies in the last nanosecond
    assert fmu.get("bounces") == 1
    assert fmu.time == reached / NS
    assert not fmu.step(reached, NS // 2, early_return=True).early
