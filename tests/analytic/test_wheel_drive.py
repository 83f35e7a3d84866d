"""Spinning wheels against SciPy, and what they owe to torque, load and ground.

The reference is the same law written again as scalar functions and integrated by an implicit method at 1e-10; the drive
integrates at 1e-10 itself.  The spin forgets its errors (its pole is negative), so both agree to 1e-7.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from carriage import F_N, J_W, V_MIN, Carriage, R, reference

import fmus
from cosim import Component, DeclarationError, GaussSeidel, Record, System, run
from cosim.errors import ScenarioError
from cosim.twin import PythonInstance
from plants.rigid_contact import RigidContact
from plants.tyre import LAWS, curves
from plants.wheel_deformation import WheelDeformation
from plants.wheel_drive import WheelDrive, tyre_of
from studies.catalog import component

NS = 1_000_000_000
RTOL = 1e-7
MU, C_X, SHAPE = 0.8, 8.0, 1.65


def coefficient(law: str) -> Callable[[float, float], float]:
    """Return mu_a of a wheel that runs straight, textbook formulas, over its slip ratio and 1 - |R w| / |V|."""

    def dugoff(slip: float, lag: float) -> float:
        u = C_X * abs(slip) / (1 - lag) if lag < 1 else np.inf
        return float(np.sign(slip)) * (u if u <= MU / 2 else MU - MU**2 / (4 * u))

    def magic(slip: float, lag: float) -> float:
        return MU * float(np.sin(SHAPE * np.arctan(C_X * slip / (SHAPE * MU))))

    return {"dugoff": dugoff, "magic": magic}[law]


def drive(
    law: str = "magic", *, torque: Any = 0.0, speed: Any = 0.0, load: Any = F_N, spin: Any = 0.0
) -> PythonInstance:
    made = WheelDrive(law=law, R=R, J_w=J_W, mu=MU, C_x=C_X, C=SHAPE, v_min=V_MIN).instance("drive")
    made.enter_initialization(0, None, 1e-10)
    made.set("omega", np.broadcast_to(spin, 4))
    made.set("torque", np.broadcast_to(torque, 4))
    made.set("normal_force", np.broadcast_to(load, 4))
    made.set("contact_velocity", np.column_stack([np.broadcast_to(speed, 4), np.zeros(4)]))
    made.exit_initialization()
    return made


# speed, spin at the start, torque: starts within friction and beyond it, driving on, braking, to lock too, reversing
CASES = [
    (0.0, 0.0, 20.0),
    (0.0, 0.0, 45.0),
    (2.0, 20.0, 20.0),
    (2.0, 20.0, -20.0),
    (2.0, 20.0, -45.0),
    (1.0, -15.0, 5.0),
]


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize(("speed", "spin", "torque"), CASES)
def test_the_spin_follows_the_torque_as_scipy_says(law: str, speed: float, spin: float, torque: float) -> None:
    stop = 0.05
    wanted = reference(lambda t: torque, coefficient(law), stop, speed=speed, spin=spin).y[0, -1]
    made = drive(law, torque=torque, speed=speed, spin=spin)
    made.step(0, round(stop * NS))
    np.testing.assert_allclose(made.get("spin"), wanted, rtol=RTOL, atol=RTOL)


@pytest.mark.parametrize("law", LAWS)
def test_what_the_motor_gives_goes_to_spin_traction_and_loss(law: str) -> None:
    """Momentum and energy of every wheel over one step, each an integral of the same right-hand side: to 1e-8."""
    h, speed, torque = 0.02, np.array([2.0, 0.5, 0.0, 2.0]), np.array([30.0, 40.0, 10.0, -30.0])
    spin = np.array([20.0, 3.0, 0.0, 22.0])
    made = drive(law, torque=torque, speed=speed, spin=spin)
    made.step(0, round(h * NS))
    after, traction = made.get("spin"), made.get("traction_demand")
    np.testing.assert_allclose(J_W * (after - spin), (torque - R * traction) * h, atol=1e-8)
    kinetic = np.sum(J_W * (after**2 - spin**2) / 2)
    carried = float(made.get("motor_energy")) - kinetic - np.sum(traction * speed) * h
    assert carried == pytest.approx(float(made.get("slip_energy")), abs=1e-6)
    assert made.get("slip_energy") > 0
    np.testing.assert_allclose(made.get("reaction"), [0, -np.sum(J_W * (after - spin)) / h, 0], atol=1e-5)


def test_a_wheel_in_the_air_spins_up_freely_and_asks_for_nothing() -> None:
    made = drive(torque=5.0, speed=1.0, load=[F_N, 0.0, F_N, 0.0], spin=10.0)
    made.step(0, NS // 100)
    np.testing.assert_allclose(made.get("spin")[1::2], 10.0 + 5.0 / J_W * 0.01, rtol=1e-9)
    np.testing.assert_array_equal(made.get("traction_demand")[1::2], 0)
    assert np.all(made.get("traction_demand")[::2] > 0)


def test_rolling_costs_nothing_and_rest_stays_at_rest() -> None:
    made = drive(speed=[2.0, 0.0, -1.0, 0.05], spin=np.array([2.0, 0.0, -1.0, 0.05]) / R)
    made.step(0, NS // 10)
    np.testing.assert_allclose(made.get("spin") * R, [2.0, 0.0, -1.0, 0.05], atol=1e-12)
    np.testing.assert_allclose(made.get("traction_demand"), 0, atol=1e-8)
    assert abs(float(made.get("slip_energy"))) < 1e-12


def test_a_slip_angle_takes_from_the_traction() -> None:
    """The same spin and speed, with and without sideways motion; the lateral force is against it."""
    straight, aslant = drive(speed=2.0, spin=22.0), drive(speed=2.0, spin=22.0)
    aslant.set("contact_velocity", np.array([[2.0, 0.3]] * 4))
    both = [(i.get("traction_demand")[0], i.get("lateral_demand")[0]) for i in (straight, aslant)]
    assert both[0][1] == 0
    assert 0 < both[1][0] < 0.9 * both[0][0]
    assert both[1][1] < 0
    assert np.hypot(*both[1]) <= MU * F_N
    assert aslant.get("slip_angle")[0] == pytest.approx(np.arctan(0.15), rel=2e-3)  # of 2 m/s, v_min is 0.1 percent


@pytest.mark.parametrize("kind", [WheelDeformation, RigidContact])
def test_the_wheel_plant_takes_the_lateral_demand_within_its_ellipse(kind: type[Component]) -> None:
    """Asked for more than mu F_n leaves beside the traction, it gives just that; by default it gives its own."""
    traction, asked = np.array([100.0, -200.0, 0.0, 300.0]), np.array([150.0, -900.0, 50.0, -900.0])
    forces = []
    for sideslip in ("demand", "stiffness"):
        wheels = kind(sideslip=sideslip, mu=0.8).instance("wheels")
        wheels.enter_initialization(0, None, 1e-10)
        state = {"gap": -4.17e-3, "P": np.diag(np.full(4, 1 / 42.5)), "b_free": -9.81, "traction_demand": traction,
                 "lateral_demand": asked, "contact_velocity": np.array([[2.0, 0.0]] * 4)}  # fmt: skip
        for name, value in state.items():
            wheels.set(name, np.broadcast_to(value, wheels.variables[name].shape))
        wheels.exit_initialization()
        wheels.step(0, 1000)
        forces.append(wheels.get("lateral"))
        limit = 0.8 * wheels.get("normal_force")
        np.testing.assert_allclose(wheels.get("traction"), np.clip(traction, -limit, limit), rtol=1e-9)
    room = np.sqrt(limit**2 - traction**2)
    np.testing.assert_allclose(forces[0], np.clip(asked, -room, room), rtol=1e-6)  # 1 us: the load hardly changes
    np.testing.assert_array_equal(forces[1], 0)


def worst_speed_error(law: str, step: int, torque: float, stop: float) -> float:
    """Return the largest error of the speed in a co-simulated start from rest, in m/s."""
    made = WheelDrive(law=law, R=R, J_w=J_W, mu=MU, C_x=C_X, C=SHAPE, v_min=V_MIN)
    parts = {"drive": fmus.instantiate(made, "drive"), "masses": Carriage().instance()}
    parts["drive"].set("torque", np.full(4, torque))
    wires = {"masses.F_a": "drive.traction_demand"}
    wires |= {f"drive.{name}": f"masses.{name}" for name in ("contact_velocity", "normal_force")}
    record, order = Record(), GaussSeidel(("drive", "masses"))
    with System(parts, wires) as system:
        run(system, order, step=step, stop=round(stop * NS), observers=[record], tolerance=1e-10)
    exact = reference(lambda t: torque, coefficient(law), stop, mass=42.5).sol(record.time)
    return float(np.max(np.abs(record["masses.contact_velocity"][:, 0, 0] - exact[1])))


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("torque", [20.0, 45.0])
def test_drive_and_mass_co_simulated_are_the_one_wheel_vehicle(law: str, torque: float) -> None:
    """Start from rest within friction and beyond: the error in speed is of first order and that of a single step.

    The drive sees the speed of the begin of each step, so the rim lags by up to the speed gained in one, a h, and the
    mass has the momentum J_w / R^2 a h too much: with a <= 7.85 m/s2 and 1 kg on 42.5 kg, 1.85e-5 m/s at 1e-4 s.
    """
    coarse, fine = (worst_speed_error(law, step, torque, 0.05) for step in (200_000, 100_000))
    assert fine < 1.85e-5
    assert 1.6 < coarse / fine < 2.4


def test_a_start_from_rest_is_stable_at_a_millisecond() -> None:
    """At rest the slip has a pole of some -7e4 1/s, a 70th of the step: the mean force keeps the coupling stable."""
    assert worst_speed_error("magic", 1_000_000, 20.0, 0.05) < 1.85e-4


@pytest.mark.parametrize(("name", "value"), [("C_x", -8.0), ("C_y", 0.0)])
def test_a_curve_of_negative_stiffness_is_refused(name: str, value: float) -> None:
    with pytest.raises(DeclarationError) as caught:
        WheelDrive(**{name: value})
    unit = " 1/rad" if name == "C_y" else ""
    assert str(caught.value) == (
        f"WheelDrive.{name} is {value:g}{unit}: a friction curve of negative or no stiffness pushes a slipping wheel "
        "on instead of holding it; give the slope of the curve at zero slip, above 0"
    )
    with pytest.raises(ScenarioError, match=r"components.drive: WheelDrive.*negative or no stiffness"):
        component("WheelDrive", {name: value}, "components.drive")


@pytest.mark.parametrize(("C", "E"), [(2.2, 0.0), (1.65, 1.2), (3.2, 1.0)])
def test_a_curve_that_changes_its_sign_is_refused(C: float, E: float) -> None:
    with pytest.raises(
        DeclarationError, match=r"push in the direction of a large slip; keep E at most 1 and C at most 2"
    ):
        WheelDrive(C=C, E=E)


def test_the_limits_of_its_shape_do_not_change_their_sign() -> None:
    for C, E in ((2.0, 0.99), (3.0, 1.0)):
        mu_a, _ = curves(tyre_of(WheelDrive(C=C, E=E, C_x=1e9)), np.linspace(1e-9, 1, 1001))
        assert np.min(mu_a) >= 0


def test_a_wheel_without_inertia_is_refused() -> None:
    with pytest.raises(DeclarationError, match=r"WheelDrive.J_w is 0 kg.m2; it must be positive"):
        WheelDrive(J_w=0.0)
