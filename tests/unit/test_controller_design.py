"""Impact controllers as a scenario asks for them: what is taken from the run, what the slot says, what is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from controllers import state_space as ss
from controllers.axles import wheels_from_axles
from controllers.pd_impact import PdImpact
from controllers.pole_placement import PolePlacement
from cosim.errors import CosimError
from plants.ground import Ground, Ramp
from plants.planar import Bicycle, Posture
from plants.rigid_body import RigidBody
from plants.tables import ROBOTS
from plants.wheel_deformation import WheelDeformation
from studies.designs import DESIGNS, Context
from studies.designs.impact import interface

ROBOT = ROBOTS["thesis_6_1"]
AT = Posture(0.3)
UNLIMITED = {"limits": "motor", "F_max": 1e9}


def context(**wheels: Any) -> Context:
    values = {"k_w": 1e5, "c_w": 1322.8, "mu": 0.7, **wheels}
    parts = {"body": RigidBody(), "wheels": WheelDeformation(**values)}
    return Context(ROBOT, Ground.same(Ramp(0.63, 0.3)), 0.0, 2.0, 1.0, parts)


def design(type_name: str, /, **slot: Any) -> Any:
    return DESIGNS[type_name](dict(slot), context())


def poles_of(component: PolePlacement, robot: Any = ROBOT, k_w: float = 1e5, c_w: float = 1322.8) -> np.ndarray:
    """Return the closed-loop poles that a component gives a robot: by the axles' means, from its own gains."""
    mean = np.array([[0, 0, 0.5, 0.5], [0.5, 0.5, 0, 0]])
    spread, total = 2 * mean.T, 2 * mean
    K = np.hstack([total @ component.values[n] @ spread for n in ("K_z", "K_rate")])
    side = Bicycle(robot)
    model = ss.impact_model(side.P(AT), side.U(AT), 2 * k_w, 2 * c_w)
    return np.sort_complex(ss.closed_loop_poles(model, K, component.period))


def test_what_is_not_said_comes_from_the_run() -> None:
    for type_name in ("PdImpact", "PolePlacement"):
        made = design(type_name)
        assert (made.k_w, made.c_w, made.mu) == (1e5, 1322.8, 0.7)
    assert design("PdImpact", mu=0.5).mu == 0.5


def test_poles_are_placed_for_the_period_of_the_slot() -> None:
    asked = [[-30, 30], [-30, -30], [-40, 20], [-40, -20]]
    for period in (1e-4, 2e-3, 1e-2):
        made = design("PolePlacement", poles=asked, period=period)
        np.testing.assert_allclose(poles_of(made), np.sort_complex([a + 1j * b for a, b in asked]), rtol=1e-6)


def test_frequency_and_damping_in_place_of_poles() -> None:
    made = design("PolePlacement", frequency=[40.0, 60.0], damping=0.8)
    np.testing.assert_allclose(poles_of(made), np.sort_complex(ss.conjugate_poles([40.0, 60.0], 0.8)), rtol=1e-6)


def test_default_poles_are_the_rovers_own_but_damped() -> None:
    side = Bicycle(ROBOT)
    own = np.sort(np.abs(ss.impact_model(side.P(AT), side.U(AT), 2e5, 2 * 1322.8).poles()))
    np.testing.assert_allclose(np.sort(np.abs(poles_of(design("PolePlacement")))), own, rtol=1e-6)


def test_a_believed_robot_gets_the_gains_of_that_robot() -> None:
    asked = {"frequency": [40.0, 60.0], "damping": 0.8}
    wanted = np.sort_complex(ss.conjugate_poles([40.0, 60.0], 0.8))
    made = design("PolePlacement", robot={"m": 187.0}, k_w=1.2e5, **asked)
    np.testing.assert_allclose(poles_of(made, ROBOT.with_changes(m=187.0), 1.2e5), wanted, rtol=1e-6)
    assert np.max(np.abs(poles_of(made) - wanted)) > 1.0  # rad/s, on the robot that it drives


def test_a_law_by_ports_becomes_one_by_design_where_the_slot_believes_something() -> None:
    assert design("PdImpact").structure["interface"] == "ports"
    believing = design("PdImpact", robot={"m": 187.0})
    assert believing.structure["interface"] == "design"
    heavy = Bicycle(ROBOT.with_changes(m=187.0))
    np.testing.assert_allclose(believing.values["P_model"], wheels_from_axles(heavy.P(AT)))


def test_gains_by_rule_or_given() -> None:
    """h0 = k P22 = 2e5 * 0.010287, h1 = 2 sqrt(h0); what is given stays."""
    k_P = 2e5 * Bicycle(ROBOT).P(AT)[1, 1]
    for model in ("axles", "wheels"):  # the mean of two wheels moves like their axle
        made = design("PdImpact", model=model)
        assert (made.h0, made.h1) == pytest.approx((k_P, 2 * np.sqrt(k_P)))
    given = design("PdImpact", h0=1500.0, h1=70.0)
    assert (given.h0, given.h1) == (1500.0, 70.0)
    assert design("PdImpact", h0=1500.0).h1 == pytest.approx(77.46, abs=5e-3)


def test_a_planned_path_ends_at_the_static_deflection() -> None:
    side = Bicycle(ROBOT)
    static = ss.static_deflection(side.P(AT), side.b(AT, np.zeros(3)), 2e5)[[1, 1, 0, 0]]
    for model in ("axles", "wheels"):
        made = design("PdImpact", reference_kind="planned", model=model)
        np.testing.assert_allclose(made.values["z_target"], static, rtol=1e-9)
    given = design("PdImpact", reference_kind="planned", z_target=[-0.01] * 4)
    np.testing.assert_array_equal(given.values["z_target"], -0.01)


@pytest.mark.parametrize("model", ["axles", "wheels"])
def test_reference_is_static_or_held(model: str) -> None:
    """At rest at the reference, the law's traction and the springs balance b_free."""
    at = interface(ROBOT, AT, "wheels", 1e5, 1322.8)
    for slot in ({}, {"z_target": [-0.006, -0.006, -0.004, -0.004]}):
        v = design("PolePlacement", model=model, **slot).values
        z = v["z_0"] + v["z_per_b"] @ at.b
        F = v["F_0"] + v["F_per_b"] @ at.b
        # 10 m/s2 of gravity cancel, to the rounding of matrices with condition 168
        np.testing.assert_allclose(at.P @ (-1e5 * z) + at.U @ F + at.b, 0, atol=1e-9)
        np.testing.assert_allclose(z, slot.get("z_target", z), atol=1e-15)
        if not slot:
            np.testing.assert_array_equal(F, 0)


def test_four_wheel_model_is_the_rigid_body_and_its_axles_the_planar_closed_form() -> None:
    at = Posture(front=0.3, rear=-0.1, pitch=0.05)
    for arm in ("ground", "centre"):
        wheels = interface(ROBOT, at, "wheels", 1e5, 0.0, arm)
        axles = interface(ROBOT, at, "axles", 1e5, 0.0, arm)
        assert axles.k_w == 2 * wheels.k_w
        mean = np.array([[0, 0, 0.5, 0.5], [0.5, 0.5, 0, 0]])
        for name in ("P", "U"):
            np.testing.assert_allclose(mean @ getattr(wheels, name) @ mean.T, getattr(axles, name), rtol=1e-9)
        np.testing.assert_allclose(mean @ wheels.b, axles.b, rtol=1e-9)


@pytest.mark.parametrize(
    ("slot", "says"),
    [
        ({"posture": {"front": 0.0}}, r"posture front = 0, rear = 0, pitch = 0 rad, U has condition .* never act"),
        ({"posture": {"front": 0.3, "rear": 0.3}}, "the tractions cannot move all contacts apart"),
        ({"posture": {"gamma": 0.3}}, "posture.gamma is not known; known: front, rear, pitch"),
        ({"posture": 0.3}, "posture must be a table of front, rear, pitch, not 0.3"),
        ({"poles": [[-30, 30], [-30, -20], [-40, 0], [-50, 0]]}, "comes without its conjugate -30-30j rad/s"),
        ({"poles": [-30, -40, -50, -60]}, r"poles must be a list of \[real, imaginary\] in rad/s"),
        ({"frequency": 2000.0}, "a period of 0.001 s is too long for"),
        ({"period": 0.1}, "a period of 0.1 s is too long for"),
        ({"design": "h-infinity"}, "design cannot be 'h-infinity'; it is one of 'place', 'lqr'"),
        ({"design": "lqr", "weights": {"Z": 1.0}}, "weights.Z is not known"),
        ({"feedback": "observer", "observer_poles": [[-100, 0]] * 4}, "observer poles"),
        ({"feedback": "observer", "observer_frequency": 5000.0}, "observer poles: a period of 0.001 s is too long"),
        ({"frequency": [40.0, 50.0, 60.0]}, "frequency must be one number or 2, one for each mode"),
        ({"poles": []}, "0 were asked for, but the model has 4 states"),
        ({"period": 0.04, "frequency": 20.0}, "a period of 0.04 s is too long for wheels that swing at 47.97 rad/s"),
        ({"design": "lqr", "poles": [[-30, 0]] * 4}, "poles has no effect here"),
        ({"weights": {"z": 1.0}}, "weights has no effect here"),
        ({"observer_frequency": 300.0}, 'observer_frequency has no effect here: it goes with feedback = "observer"'),
        ({"robot": {"mass": 187.0}}, "a robot has no 'mass'"),
        ({"K": 1.0}, "PolePlacement has no parameter 'K'"),
        ({"model": "bicycle"}, "model cannot be 'bicycle'"),
    ],
)
def test_designs_that_cannot_be_are_refused_in_a_sentence(slot: dict[str, Any], says: str) -> None:
    with pytest.raises(CosimError, match=says):
        design("PolePlacement", **slot)


def test_a_pd_law_does_not_take_poles() -> None:
    with pytest.raises(CosimError, match="PdImpact has no parameter 'poles'"):
        design("PdImpact", poles=[[-30, 0]] * 4)


def test_every_variant_of_both_laws_can_be_made_and_stepped() -> None:
    for model in ("axles", "wheels"):
        for feedback in ("measured", "observer"):
            for type_name, kind in (("PdImpact", PdImpact), ("PolePlacement", PolePlacement)):
                made = design(type_name, model=model, feedback=feedback, **UNLIMITED)
                assert isinstance(made, kind)
                instance = made.instance()
                instance.enter_initialization(0)
                instance.exit_initialization()
                instance.step(0, 1_000_000)
                assert np.all(np.isfinite(instance.get("traction_demand")))
