"""The claim of rigid-ramp: impacts, lost and regained contacts as in an independent run from event to event."""

import numpy as np
import pytest
from planar_impacts import FRONT_LEVEL, FRONT_SLOPE, REAR_LEVEL, Corner
from rigid_checks import assert_keeps_the_laws_of_contact, mechanical_energy
from scipy.optimize import brentq

from plants.contact_loss import impact
from plants.planar import Bicycle, Posture
from plants.tables import G, robot
from studies.catalog import find_scenario
from studies.runner import Result, execute

ANGLE, SPEED = 0.3, 2.0
ROBOT = robot("thesis_6_1")
FOOT = 0.63 - ROBOT.R * np.tan(ANGLE / 2)  # where the path of the wheel centres turns
MASS = {"plastic": 170.0, "payload": 270.0, "bouncing": 170.0}
HIT = (FOOT - ROBOT.L_f) / SPEED  # s, when the front wheels meet the slope


@pytest.fixture(scope="module")
def results() -> dict[str, Result]:
    return {variant: execute(find_scenario("rigid-ramp").load(variant)) for variant in MASS}


def flights(result: Result, wheel: int) -> np.ndarray:
    """Return the times between which a wheel is off the ground, (n, 2)."""
    time, pushes = result.record.time, result.record["wheels.contact"][:, wheel] > 0.5
    left, back = (np.flatnonzero(f) + 1 for f in (pushes[:-1] & ~pushes[1:], ~pushes[:-1] & pushes[1:]))
    return np.column_stack([time[left[: len(back)]], time[back]])


@pytest.mark.parametrize("variant", MASS)
def test_the_laws_of_contact_hold(results: dict[str, Result], variant: str) -> None:
    """And what a wheel sank in is undone: at the end, long after the impacts, all are at the surface."""
    record = results[variant].record
    assert_keeps_the_laws_of_contact(record, 1e-4)
    # b changes by less than 0.01 m/s2 in a step of the climb: 1e-8 s2 times that, and 500 N over 1e13 N/m
    np.testing.assert_allclose(record["body.gap"][-1], 0, atol=2e-10)


@pytest.mark.parametrize(("variant", "e"), [("plastic", 0.0), ("payload", 0.0), ("bouncing", 0.5)])
def test_the_first_impact_has_the_impulses_of_the_closed_form(
    results: dict[str, Result], variant: str, e: float
) -> None:
    """Rear and front: 0 and 57.5 N.s for 170 kg, 8.2 and 73.8 N.s for 270 kg; half as much again for e = 1/2.

    What an elastic impact gives back follows in the next step.  Gravity's share of a step, with inertia forces less
    than 2 m g h = 0.5 N.s, is part of what the wheels pass on.
    """
    record = results[variant].record
    at = int(np.argmax(record["wheels.normal_impulse"][:, 0]))
    assert record.time[at - 1] == pytest.approx(HIT, abs=1e-8)  # the kink is located to a few ns
    steps = 2 if e else 1
    passed = record["wheels.normal_impulse"][at : at + steps].sum(axis=0).reshape(2, 2).sum(axis=1)[::-1]
    bicycle = Bicycle(ROBOT.with_changes(m=MASS[variant]))
    expected = impact(bicycle, Posture(ANGLE), np.array([0.0, -SPEED * np.sin(ANGLE)]), e)
    np.testing.assert_allclose(passed, expected, rtol=1e-4, atol=2 * MASS[variant] * G * 1e-4 * steps)
    held = impact(bicycle, Posture(ANGLE), np.array([0.0, -SPEED * np.sin(ANGLE)]), e, bilateral=True)
    assert (held[0] < 0) == (variant != "payload")  # with 170 kg the ground would have to pull the rear axle


@pytest.mark.parametrize("variant", ["plastic", "payload"])
def test_the_run_is_that_of_an_independent_one_from_event_to_event(results: dict[str, Result], variant: str) -> None:
    """Contacts are lost and regained at the same times, to the macro step, and the robot ends where it should.

    Each of the few landings is misplaced by at most a step, in which gravity gives g h = 1e-3 m/s; that is carried on
    for half a second.
    """
    record = results[variant].record
    events, end = Corner(ROBOT.with_changes(m=MASS[variant]), ANGLE, FOOT).run(
        SPEED, float(record.time[-1]), (FRONT_LEVEL, REAR_LEVEL)
    )
    x, z, pitch, v_x, v_z, pitch_rate = end
    np.testing.assert_allclose(record["body.position"][-1, [0, 2]], [x, z], rtol=0, atol=5e-4)
    np.testing.assert_allclose(record["body.velocity"][-1, [0, 2]], [v_x, v_z], rtol=0, atol=1e-3)
    assert record["body.pitch"][-1] == pytest.approx(pitch, abs=5e-4 / ROBOT.L_r)
    assert -record["body.rate"][-1, 1] == pytest.approx(pitch_rate, abs=1e-3 / ROBOT.L_r)

    for wheel, contact in ((0, FRONT_SLOPE), (2, REAR_LEVEL)):
        opened = [e.time for e in events if e.contact == contact and e.impulse == 0]
        closed = [e.time for e in events if e.contact == contact and e.impulse > 0]
        found = flights(results[variant], wheel)
        expected = [(t, min(c for c in closed if c > t)) for t in opened if any(c > t + 1e-3 for c in closed)]
        expected = [hop for hop in expected if hop[1] - hop[0] > 3e-4]  # shorter ones fall between the steps
        assert len(found) == len(expected)
        if expected:
            np.testing.assert_allclose(found, expected, rtol=0, atol=2e-4)
    if variant == "plastic":
        assert flights(results[variant], 2)[0] == pytest.approx([HIT, HIT + 0.0155], abs=1.5e-4)


def test_after_a_bounce_the_wheels_come_back_as_a_thrown_body_does(results: dict[str, Result]) -> None:
    """With e = 1/2 all four wheels are in the air; the body flies as a stone until the first wheel is back."""
    record = results["bouncing"].record
    airborne = np.all(record["wheels.contact"] < 0.5, axis=1)
    first = int(np.argmax(airborne))
    back = first + int(np.argmin(airborne[first:]))
    assert back - first > 100
    r, v, pitch = record["body.position"][first], record["body.velocity"][first], record["body.pitch"][first]
    pitch_rate, t0 = -record["body.rate"][first, 1], record.time[first]

    def gaps(t: float) -> np.ndarray:
        turned = pitch + pitch_rate * t
        found = []
        for ahead, slope in ((ROBOT.L_f, ANGLE), (-ROBOT.L_r, 0.0)):
            x = r[0] + v[0] * t + np.cos(turned) * ahead + np.sin(turned) * ROBOT.h
            z = r[2] + v[2] * t - G * t**2 / 2 + np.sin(turned) * ahead - np.cos(turned) * ROBOT.h
            found.append(-np.sin(slope) * (x - FOOT) + np.cos(slope) * (z - ROBOT.R))
        return np.array(found)

    flight = brentq(lambda t: float(np.min(gaps(t))), 2e-3, 0.3)
    assert record.time[back] - t0 == pytest.approx(flight, abs=1e-4)  # a step
    energy = mechanical_energy(record)
    # in the air nothing changes but by the integrator, and every bounce takes some
    np.testing.assert_allclose(energy[first:back], energy[first], rtol=1e-9)
    aloft = energy[airborne]
    assert np.all(np.diff(aloft) < 1e-9 * energy[0])
    assert aloft[-1] < aloft[0]


@pytest.mark.parametrize("variant", ["plastic", "payload"])
def test_no_impact_adds_energy(results: dict[str, Result], variant: str) -> None:
    """What a wheel sank in is given back by lifting its load: no more than m |b| depth at any time."""
    record = results[variant].record
    energy, depth = mechanical_energy(record), np.max(-record["body.gap"])
    rise = np.max(energy - np.minimum.accumulate(energy))
    assert rise <= MASS[variant] * np.max(np.abs(record["body.b_free"])) * depth
    lost = record["wheels.dissipated_energy"][-1]
    assert energy[0] - energy[-1] == pytest.approx(lost, rel=1e-4)
    assert lost > 0.5 * SPEED**2 * np.sin(ANGLE) ** 2 * 40  # J: that of the normal motion of what the fronts carry


def test_the_verdict_tells_the_masses_apart(results: dict[str, Result]) -> None:
    off = {v: {m.key: m.value for m in r.metrics} for v, r in results.items()}
    assert off["plastic"]["rear_off"] == pytest.approx(15.5, abs=0.2)
    assert off["payload"]["front_off"] == off["payload"]["rear_off"] == 0
    assert off["bouncing"]["airborne"] > 50
