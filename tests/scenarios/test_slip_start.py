"""Start on a slippery floor: the claim of ``slip-start``, against closed forms of a sliding and a gripping robot."""

import numpy as np
import pytest

from plants.tables import G
from plants.tyre import Tyre, curves
from studies.catalog import find_scenario
from studies.runner import Result, execute

MU, C_X, SHAPE = 0.2, 8.0, 1.65
PEAK = np.tan(np.pi / (2 * SHAPE)) * SHAPE * MU / C_X  # slip ratio
DEMAND = np.array([45.0, 45.0, 70.0, 70.0])


@pytest.fixture(scope="module")
def results() -> dict[str, Result]:
    """The three variants, run to the end."""
    scenario = find_scenario("slip-start")
    found = {name: execute(scenario.load(name)) for name in scenario.variants}
    assert all(result.error is None for result in found.values())
    return found


def last_speed(result: Result) -> float:
    return float(result.record["body.velocity_body"][-1, 0])


def test_a_constant_torque_spins_the_wheels_up_and_sliding_friction_is_left(results: dict[str, Result]) -> None:
    """The slip is 0.98 within 50 ms; then v = mu(0.98) g t with the whole weight on sliding wheels.

    Before, more than sliding friction was there for 50 ms at most: up to (0.2 - 0.12) g 0.05 s = 0.04 m/s more.
    """
    run = results["open-loop"]
    slip = run.record["drive.slip"]
    assert np.min(slip[run.record.time > 0.05]) > 0.97
    sliding = curves(Tyre("magic", MU, C_X, 12.0, SHAPE), np.array([0.983]))[0][0]
    assert -1e-3 < last_speed(run) - sliding * G * 1.0 < 0.04


def test_slip_control_reaches_the_traction_it_is_asked_for(results: dict[str, Result]) -> None:
    """From 10 ms on within 2 percent, while the axle loads still swing, and within 0.5 percent from 0.1 s on."""
    run = results["slip-control"]
    traction, t = run.record["wheels.traction"], run.record.time
    np.testing.assert_allclose(traction[t > 0.01], np.broadcast_to(DEMAND, traction[t > 0.01].shape), rtol=0.02)
    np.testing.assert_allclose(traction[t > 0.1], np.broadcast_to(DEMAND, traction[t > 0.1].shape), rtol=5e-3)
    assert last_speed(run) == pytest.approx(DEMAND.sum() / 170.0, rel=5e-3)
    assert np.max(run.record["drive.slip"]) < PEAK


def test_asked_for_too_much_it_stays_at_the_peak(results: dict[str, Result]) -> None:
    """V = mu g t with the whole weight at the peak, but for the first 0.1 s in which the slip still grows."""
    run = results["slip-control-peak"]
    slip, t = run.record["drive.slip"], run.record.time
    assert np.max(run.record["controller.slip_reference"]) <= PEAK * 1.01
    assert np.max(slip) < 1.02 * PEAK
    np.testing.assert_allclose(slip[t > 0.3], PEAK, rtol=0.01)
    assert last_speed(run) == pytest.approx(MU * G, rel=5e-3)


def test_it_is_faster_and_loses_less(results: dict[str, Result]) -> None:
    racing, holding = results["open-loop"], results["slip-control-peak"]
    assert last_speed(holding) > 1.7 * last_speed(racing)
    losses = [float(r.record["drive.slip_energy"][-1]) for r in (racing, holding)]
    assert losses[1] < losses[0] / 100


@pytest.mark.parametrize("variant", ["open-loop", "slip-control", "slip-control-peak"])
def test_the_energy_of_the_motors_is_accounted_for(results: dict[str, Result], variant: str) -> None:
    """Work of the motors, that of their reaction on the pitching body included, and where it went.

    The drive sees the speed of the begin of each step, on average h / 2 too early: as the force is constant, it counts
    a part h / 1 s = 1e-4 of the kinetic energy as lost in slip.
    """
    read = results[variant].record
    gained = {name: read[name][-1] - read[name][0] for name in (
        "body.kinetic_energy", "body.potential_energy", "wheels.elastic_energy", "wheels.dissipated_energy",
        "drive.slip_energy", "drive.motor_energy",
    )}  # fmt: skip
    spinning = 0.01 * np.sum(read["drive.spin"][-1] ** 2) / 2
    pitching = np.sum(read["controller.torque"][1:].sum(axis=1) * np.diff(read["body.pitch"]))
    rest = gained.pop("drive.motor_energy") + pitching - spinning - sum(gained.values())
    assert abs(rest) < 1.2e-4 * gained["body.kinetic_energy"]
