"""Slip control: the inverted curve, its sampled loop by python-control, and what it does with a drive and a mass."""

from typing import Any

import control
import numpy as np
import pytest
from carriage import F_N, J_W, Carriage, M, R

import fmus
from controllers.slip_control import SlipControl
from controllers.slip_model import inverse_curve, slip_transfer_function, spin_gain
from cosim import DeclarationError, GaussSeidel, Record, System, run
from cosim.errors import ScenarioError
from plants.ground import Flat, Ground
from plants.tables import ROBOTS
from plants.tyre import LAWS, curves, slope
from plants.wheel_deformation import WheelDeformation
from plants.wheel_drive import WheelDrive, tyre_of
from studies.designs import DESIGNS, Context

SLIPS = np.linspace(0, 0.5, 1001)
PERIOD = 1e-3
NS = 1_000_000_000


@pytest.mark.parametrize("law", LAWS)
def test_the_table_is_the_inverse_of_the_curve(law: str) -> None:
    """Linear between points 1e-3 apart in slip, h^2 mu'' / 8 off: mu'' is below 700 where Dugoff begins to slide."""
    t = tyre_of(WheelDrive(law=law))
    rows = inverse_curve(SLIPS, curves(t, SLIPS)[0])
    mu = np.linspace(0, rows[-1, 0], 777)
    at = rows[np.searchsorted(rows[:, 0], mu, side="right") - 1]
    slip = at[:, 1] + at[:, 2] * (mu - at[:, 0])
    np.testing.assert_allclose(curves(t, slip)[0], mu, atol=1e-4)
    assert np.all(np.diff(rows[:, 1]) > 0)
    assert rows[-1, 2] == 0


def test_the_table_ends_at_the_peak() -> None:
    """Of the Magic Formula at tan(pi / 2 C) C mu / C_x; the samples are 5e-4 apart."""
    t = tyre_of(WheelDrive(law="magic"))
    rows = inverse_curve(SLIPS, curves(t, SLIPS)[0])
    assert rows[-1, 1] == pytest.approx(np.tan(np.pi / (2 * t.C)) * t.C * t.mu / t.C_x, abs=5e-4)
    assert rows[-1, 0] == pytest.approx(t.mu, rel=1e-5)


def test_a_curve_that_falls_from_the_start_is_refused() -> None:
    with pytest.raises(DeclarationError) as caught:
        inverse_curve(np.array([0.0, 0.1, 0.2]), np.array([0.3, 0.2, 0.1]))
    assert str(caught.value) == (
        "the friction curve has negative stiffness from the start: d mu / d lambda = -1 between slip 0 and 0.1; "
        "slip control needs a curve that rises"
    )
    with pytest.raises(DeclarationError, match=r"ascending from 0"):
        inverse_curve(np.array([0.1, 0.2]), np.array([0.1, 0.2]))


def loop_poles(V: float, slip: float, k: float, K: float, T_i: float) -> np.ndarray:
    """Return the poles of the sampled loop: Eq 3.16 behind a hold, and PI of the slip times w_0 (its spin error)."""
    w_0 = V / (R * (1 - slip))
    if k > 0:
        H = slip_transfer_function(V, R, J_W, M, F_N, k, slip)
    else:  # beyond the peak there is no design, but a transfer function all the same
        H = control.tf([V], [R * w_0**2 * J_W, (V * R + w_0 * J_W / M) * F_N * k])
    sampled = control.c2d(H, PERIOD, "zoh")
    z = control.tf([1, 0], [1], PERIOD)
    law = K * w_0 * (1 + PERIOD / T_i * z / (z - 1))
    return control.feedback(sampled * law, 1).poles()


@pytest.mark.parametrize("V", [0.05, 0.2, 1.0, 2.0, 5.0, 10.0])
def test_the_sampled_loop_is_stable_at_every_speed(V: float) -> None:
    t = tyre_of(WheelDrive(law="magic"))
    K, T_i = spin_gain(J_W, PERIOD), float(SlipControl().values["T_i"])
    for slip in (0.0, 0.05, 0.1, 0.15):
        assert np.max(np.abs(loop_poles(V, slip, slope(t, slip), K, T_i))) < 1


def test_it_holds_a_slip_beyond_the_peak_that_would_run_away_alone() -> None:
    """Its runaway is slower than share / period = 300 1/s; without control the pole lies outside the unit circle."""
    t = tyre_of(WheelDrive(law="magic"))
    k, T_i = slope(t, 0.5), float(SlipControl().values["T_i"])
    assert k < 0
    assert np.max(np.abs(loop_poles(2.0, 0.5, k, 1e-6, 1e6))) > 1
    assert np.max(np.abs(loop_poles(2.0, 0.5, k, spin_gain(J_W, PERIOD), T_i))) < 1


def test_the_gain_corrects_at_most_the_whole_error() -> None:
    assert spin_gain(J_W, PERIOD, 0.5) * PERIOD / J_W == pytest.approx(0.5)
    with pytest.raises(DeclarationError, match=r"0 < share <= 1 of the error in one period, not 1.5"):
        spin_gain(J_W, PERIOD, 1.5)


def designed(drive: Any, **parameters: Any) -> Any:
    parts = {"drive": drive, "wheels": WheelDeformation()} if drive is not None else {}
    context = Context(ROBOTS["thesis_6_1"], Ground.same(Flat()), 0.0, 0.0, 1.0, parts)
    return DESIGNS["SlipControl"](parameters, context)


def driven(
    stop: float, *, speed: float = 0.0, load: float = F_N, spin: float = 0.0, drive: WheelDrive | None = None,
    **parameters: Any,
) -> Record:  # fmt: skip
    """Co-simulate control, drive and masses."""
    drive = drive or WheelDrive(R=R, J_w=J_W)
    parts = {"control": fmus.instantiate(designed(drive, **parameters), "control"),
             "drive": fmus.instantiate(drive, "drive"), "masses": Carriage(load=load).instance()}  # fmt: skip
    parts["masses"].set("v", np.full(4, speed))
    parts["drive"].set("omega", np.full(4, spin))
    wires = {f"control.{n}": f"drive.{n}" for n in ("slip", "slip_speed")}
    wires |= {f"{a}.normal_force": "masses.normal_force" for a in ("control", "drive")}
    wires |= {"control.traction": "masses.traction", "drive.torque": "control.torque",
              "masses.F_a": "drive.traction_demand", "drive.contact_velocity": "masses.contact_velocity"}  # fmt: skip
    record = Record()
    order = GaussSeidel(("control", "drive", "masses"))
    with System(parts, wires) as system:
        run(system, order, step=100_000, stop=round(stop * NS), observers=[record])
    return record


@pytest.mark.parametrize("demand", [200.0, -200.0])
def test_it_reaches_the_demanded_traction(demand: float) -> None:
    """Driving from rest and braking from 2 m/s, 60 percent of what friction gives: within 1 percent from 50 ms on."""
    speed = 0.0 if demand > 0 else 2.0
    record = driven(0.1, speed=speed, spin=speed / R, demand=demand)
    late = record["masses.traction"][record.time > 0.05]
    np.testing.assert_allclose(late, demand, rtol=0.01)


def test_beyond_the_friction_it_stays_at_the_peak() -> None:
    """Asked for twice what there is, the slip settles at that of the peak (1e-3 of it), the traction at mu F_n."""
    record = driven(0.3, demand=2 * 0.8 * F_N)
    peak = float(designed(WheelDrive(R=R, J_w=J_W)).values["slip_peak"])
    slip = record["drive.slip"]
    assert np.max(slip) < 1.1 * peak
    np.testing.assert_allclose(slip[-1], peak, rtol=1e-3)
    np.testing.assert_allclose(record["masses.traction"][-1], 0.8 * F_N, rtol=1e-4)
    assert np.all(record["control.slip_reference"] <= peak)
    np.testing.assert_allclose(record["control.traction_demand"][-1], 0.8 * F_N, rtol=1e-4)


def test_a_wrong_curve_is_trimmed_away() -> None:
    """Designed for 0.7 of the slip stiffness, it asks for too much slip at first: 40 percent too much traction at most.

    The trim decays with some k_F = 10 1/s: after 0.5 s of it, less than 1 percent is left.
    """
    record = driven(0.6, speed=2.0, spin=20.0, demand=100.0, believes={"C_x": 5.6}, T_i=0.005)
    error = np.abs(record["masses.traction"] / 100.0 - 1)
    early = (record.time > 0.03) & (record.time < 0.05)
    assert np.min(error[early]) > 0.05
    np.testing.assert_allclose(record["masses.traction"][-1], 100.0, rtol=0.01)


def test_it_recovers_from_racing_wheels() -> None:
    """Wheels that spin at 4 times the ground speed come back to the slip asked for, within the torque limit."""
    record = driven(0.2, speed=2.0, spin=80.0, demand=100.0, T_max=15.0)
    assert record["drive.slip"][0, 0] == pytest.approx(0.75)
    assert np.max(np.abs(record["control.torque"])) <= 15.0
    assert np.min(record["control.torque"]) == -15.0
    np.testing.assert_allclose(record["masses.traction"][-1], 100.0, rtol=0.02)
    assert np.min(record["drive.slip"]) > -0.05  # the integral did not wind up while the torque was at its limit


def test_a_wheel_in_the_air_does_not_race() -> None:
    record = driven(0.2, speed=2.0, spin=20.0, load=0.0, demand=300.0)
    peak = float(designed(WheelDrive(R=R, J_w=J_W)).values["slip_peak"])
    assert np.max(record["drive.slip"]) < 1.3 * peak
    np.testing.assert_allclose(record["drive.slip"][-1], peak, rtol=0.01)


def test_the_design_takes_the_curve_of_the_drive_or_what_it_believes() -> None:
    drive = WheelDrive(R=R, J_w=J_W, mu=0.5, C_x=6.0)
    one, other = designed(drive), designed(drive, believes={"mu": 0.3})
    assert float(one.values["mu_peak"]) == pytest.approx(0.5, rel=1e-5)
    assert float(other.values["mu_peak"]) == pytest.approx(0.3, rel=1e-5)
    assert float(one.values["C_x"]) == 6.0
    assert float(one.values["K"]) == pytest.approx(spin_gain(J_W, PERIOD))


def test_without_a_drive_there_is_nothing_to_design_for() -> None:
    with pytest.raises(ScenarioError) as caught:
        designed(None)
    assert str(caught.value) == (
        "SlipControl is designed for the friction curve of a drive, and there is none; "
        'add components.drive with type = "WheelDrive"'
    )
