"""The poles that impact controllers have on the co-simulated rover, identified from differences of runs.

Bound 2 %: over 60 ms the rover rolls 2.5 mm back, its pitch changes by 8e-4 rad, P and U by 0.1 %, and it starts some
per cent of its deflection off the equilibrium of the law; measured are 0.04 to 0.4 %.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from controllers.state_space import closed_loop_poles, conjugate_poles, impact_model, pole_gain, sampled
from cosim.errors import CouplingError
from plants.planar import Bicycle, Posture
from plants.tables import ROBOTS
from studies.assembly import assemble
from studies.pole_identification import HARD, Bench, examine, identify, matched, simulate

STAND = Bench({"type": "Uncontrolled"})
POLES = conjugate_poles([150.0, 200.0], 0.7)  # 227 and 254 rad/s without control: more than half of it
UNLIMITED = {"limits": "motor", "F_max": 1e9}


def pairs(poles: np.ndarray) -> list[list[float]]:
    return [[s.real, s.imag] for s in poles]


def placed(poles: np.ndarray, bench: Bench = STAND, **more: Any) -> Bench:
    """Return a bench with a pole placement designed for how the rover stands on it."""
    slot = {"posture": {"front": 0.3, "pitch": bench.posture().pitch}, **UNLIMITED, **more}
    return replace(bench, controller={"type": "PolePlacement", "poles": pairs(poles), **slot})


def test_the_rover_stands_where_it_should() -> None:
    """Its fronts 0.1 m beyond the kink of their path, its rears on the flat, pitched by the height between them."""
    start = assemble(STAND.scenario()).starts
    pitch = STAND.posture().pitch
    front = start["body.r"][0] + 0.6 * np.cos(pitch) + 0.4 * np.sin(pitch)
    assert front == pytest.approx(0.63 - 0.1 * np.tan(0.15) + 0.1, abs=1e-4)  # wheels that give 0.15 mm
    assert np.all((start["wheels.z"] > -3e-4) & (start["wheels.z"] < 0))
    assert np.sin(STAND.posture().pitch) == pytest.approx(0.1 * np.tan(0.3) / 1.06, rel=2e-3)


@pytest.mark.parametrize("period", [1e-4, 5e-4, 1e-3])
def test_poles_are_where_they_were_placed(period: float) -> None:
    """From the difference of two runs."""
    found = examine(placed(POLES, replace(STAND, period=period)), POLES, together=True)
    assert np.max(found.errors) < 0.02, found


def test_poles_of_four_wheels_are_where_they_were_placed() -> None:
    """The model of four wheels knows no side forces; so the tyres of this bench have no grip to the side."""
    poles = conjugate_poles([150.0, 170.0, 200.0, 230.0], 0.7)
    bench = replace(STAND, wheels=True, C_alpha=1e-9)
    assert np.max(examine(placed(poles, bench, model="wheels"), poles).errors) < 0.02


def test_poles_of_the_rolling_rover() -> None:
    """At 0.5 m/s the fronts climb 30 mm in 60 ms: pitch changes by 9e-3 rad, P and U by 1 %."""
    assert np.max(examine(placed(POLES, replace(STAND, speed=0.5)), POLES).errors) < 0.02


def test_poles_on_soft_wheels() -> None:
    """2e5 N/m per axle, poles in the same proportion to the 43 and 48 rad/s of the rover without control."""
    soft = replace(STAND, k_axle=2e5)
    poles = POLES * np.sqrt(2e5 / HARD)
    assert np.max(examine(placed(poles, soft), poles).errors) < 0.02


def test_another_posture_moves_the_poles_as_its_P_and_U_say() -> None:
    """Designed for pitch 0, standing at 0.029 rad: 6 % off, and where the model at 0.029 rad has them."""
    bench = replace(placed(POLES), controller={"type": "PolePlacement", "poles": pairs(POLES), **UNLIMITED})
    found = examine(bench, POLES)
    assert 0.05 < np.max(found.errors) < 0.1
    side = Bicycle(ROBOTS[bench.table])
    design, real = (impact_model(side.P(at), side.U(at), HARD) for at in (Posture(0.3), bench.posture()))
    expected = closed_loop_poles(real, pole_gain(design, POLES, bench.period), bench.period)
    np.testing.assert_allclose(found.found, matched(expected, found.found), rtol=0.02)


def test_what_cancels_the_spring_has_little_left() -> None:
    """h0 = 1500 of 59 000: 97 % of the spring is cancelled, so 1 % of it is 40 % of h0; poles are off by more."""
    poles = np.repeat(np.roots([1.0, 70.0, 1500.0]), 2)
    assert np.max(examine(placed(poles), poles).errors) > 0.05


def test_sampling_adds_damping_to_a_law_that_cancels_the_spring() -> None:
    """PD, T = 0.1 ms: the cancelled part is held over T, as late as T/2, which is (k P22 - h0) T / 2 of damping.

    70 + 2.9 1/s and h0 = 1500: -36.5 +- 13.0j, within 2 % of the size of the poles.
    """
    pd = {"type": "PdImpact", "h0": 1500.0, "h1": 70.0, **UNLIMITED}
    bench = replace(STAND, controller=pd, period=1e-4)
    P = Bicycle(ROBOTS[bench.table]).P(bench.posture())
    h1 = 70.0 + (HARD * np.mean(np.diag(P)) - 1500.0) * 1e-4 / 2
    asked = np.repeat(np.roots([1.0, h1, 1500.0]), 2)
    assert np.max(examine(bench, asked).errors) < 0.02


def test_observer_error_decays_at_its_poles() -> None:
    """The error of the estimate obeys the observer alone, whatever the law does with it."""
    poles = conjugate_poles([500.0, 700.0], 0.8)
    bench = placed(POLES, replace(STAND, period=1e-4), feedback="observer", observer_poles=pairs(poles))
    assert np.max(examine(bench, poles, of="error").errors) < 0.02
    # and it ends small: below 1 % of the deflection of 0.15 mm, which it starts with
    error = simulate(bench, {}).error
    assert np.max(np.abs(error[0, :2])) > 5e-5
    assert np.max(np.abs(error[-100:, :2])) < 1.5e-6


def test_steady_state_is_the_reference() -> None:
    """A chosen deformation is held by feed-forward; 2 % as above (P and U scale the traction that holds it)."""
    z = [-3e-4, -3e-4, -2e-4, -2e-4]
    gap = simulate(placed(POLES, z_target=z), {}).motion[-1, :2]
    np.testing.assert_allclose(gap, [-2e-4, -3e-4], rtol=0.02)


def test_identification_finds_known_poles() -> None:
    """Of a linear system of the same size, without noise: to rounding."""
    side, at = Bicycle(ROBOTS["thesis_6_1"]), Posture(0.3)
    model = impact_model(side.P(at), side.U(at), HARD)
    K = pole_gain(model, POLES, 1e-3)
    d = sampled(model, 1e-3)
    x = [np.array([1e-6, -2e-6, 3e-4, 1e-4])]
    for _ in range(60):
        x.append((d.A - d.B @ K) @ x[-1])
    found = matched(identify([np.array(x)], 1e-3), POLES)
    np.testing.assert_allclose(found, POLES, rtol=1e-6)


def test_a_lost_contact_is_not_identified() -> None:
    with pytest.raises(CouplingError, match="a contact opened or the law was off"):
        examine(STAND, POLES)
