"""Impact controllers designed at a named posture: gains, references and observers from the robot and its wheels.

Beside the component's own parameters a slot may say

    posture = {front = 0.3, rear = 0.0, pitch = 0.0}    slopes under the axles and nose-up pitch, rad; these by default
    robot = {m = 187}, k_w = 1.2e5, c_w = 0.0           what the design believes, where it differs from the plant
    observer_poles = [[-800, 0], ...]                   as [real, imaginary], rad/s, or observer_frequency in rad/s

and for `PolePlacement`

    design = "place"                        poles = [[-150, 150], [-150, -150], ...], or frequency and damping
    design = "lqr"                          weights = {z = 1e-3, z_rate = 0.1, force = 1e3}, or some of them
    z_target = [-0.02, -0.02, -0.01, -0.01] a steady deformation; without it the static one, which needs no traction

and for `PdImpact`, which takes h0 = k_w P22 and h1 = 2 sqrt(h0) if they are not given, and the static deflection for
the end of a planned reference.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from controllers import state_space as ss
from controllers.axles import wheel_forces_from_axles, wheel_motions_from_axles, wheels_from_axles
from controllers.observer import observer_gain
from controllers.pd_impact import PdImpact, gains_by_stiffness
from controllers.pole_placement import PolePlacement
from cosim import Component
from cosim.errors import ScenarioError, nearest
from plants.planar import Bicycle, Posture
from plants.rigid_body import RigidBody
from plants.rover import quaternion
from plants.tables import Robot

from .context import Context

DAMPING = 0.7  # of the default poles, which are as fast as the wheels are without control
OBSERVER = 3.0  # default observer poles: so many times the fastest mode, and the closed loop's fastest pole
_WORDS: dict[type[Component], tuple[str, ...]] = {
    PdImpact: ("posture", "observer_poles", "observer_frequency"),
    PolePlacement: ("posture", "design", "poles", "frequency", "damping", "weights", "observer_poles",
                    "observer_frequency"),
}  # fmt: skip


@dataclass(frozen=True)
class Interface:
    """The reduced model at a posture: n contacts, axles (rear, front) or wheels, each of stiffness k_w (N/m), c_w."""

    P: np.ndarray  # (n, n), 1/kg
    U: np.ndarray  # (n, n), 1/kg
    b: np.ndarray  # (n,), m/s2, at rest
    k_w: float
    c_w: float

    def model(self) -> Any:
        """Return the state space 6.16."""
        return ss.impact_model(self.P, self.U, self.k_w, self.c_w)


def interface(robot: Robot, at: Posture, model: str, k_w: float, c_w: float, arm: str = "ground") -> Interface:
    """Return the reduced model of a robot at a posture, *model* "axles" or "wheels"; k_w and c_w of one wheel."""
    if model == "axles":
        side = Bicycle(robot, arm)
        return Interface(side.P(at), side.U(at), side.b(at, np.zeros(3)), 2 * k_w, 2 * c_w)
    return Interface(*_wheels(robot, at, arm), k_w, c_w)


@lru_cache(maxsize=64)
def _wheels(robot: Robot, at: Posture, arm: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return P, U and b_free of the rigid body itself, at rest: on two slopes that meet below it."""
    rows = [[x, *2 * (0, 0, np.tan(slope), 0, 0, 0, 0), 0] for x, slope in ((-1e9, at.rear), (0.0, at.front))]
    body = RigidBody(**robot.body_parameters(), traction_arm=arm, left=rows, right=rows).instance()
    body.enter_initialization(0)
    body.set("q", quaternion(float(np.real(at.pitch)), 0.0))
    body.set("r", [0.0, 0.0, robot.h])
    return body.get("P"), body.get("U"), body.get("b_free")


@dataclass
class _Order:
    """What a slot asks for, the design's own words taken out of its parameters."""

    given: dict[str, Any]  # the component's own parameters
    words: dict[str, Any]
    posture: Posture
    at: Interface
    period: float

    @property
    def axles(self) -> bool:
        return self.given.get("model", "axles") == "axles"


def _order(kind: type[Component], parameters: dict[str, Any], context: Context) -> _Order:
    robot = context.believed(parameters)
    words = {name: parameters.pop(name) for name in _WORDS[kind] if name in parameters}
    posture = _posture(words.pop("posture", {}))
    wheels = context.wheels()
    for name in ("k_w", "c_w", "mu"):
        if name in wheels and name in kind.declarations:
            parameters.setdefault(name, float(np.mean(wheels[name])))
    start = {name: d.start for name, d in kind.declarations.items()}
    asked = {name: parameters.get(name, start[name]) for name in ("period", "model", "k_w", "c_w")}
    if asked["model"] not in ("axles", "wheels"):
        kind(model=asked["model"])  # says what is wrong with it
    at = interface(robot, posture, asked["model"], asked["k_w"], asked["c_w"], context.traction_arm())
    return _Order(parameters, words, posture, at, asked["period"])


def _posture(words: Any) -> Posture:
    asked = {"front": 0.3, "rear": 0.0, "pitch": 0.0, **_table("posture", words, ("front", "rear", "pitch"))}
    return Posture(asked["front"], asked["rear"], asked["pitch"])


def _table(name: str, found: Any, known: tuple[str, ...]) -> dict[str, float]:
    if not isinstance(found, dict):
        raise ScenarioError(f"{name} must be a table of {', '.join(known)}, not {found!r}")
    for key in found:
        if key not in known:
            raise ScenarioError(f"{name}.{key} is not known; {nearest(key, known)}")
    return {key: float(value) for key, value in found.items()}


def _poles(name: str, pairs: Any) -> np.ndarray:
    try:
        array = np.array([[float(real), float(imaginary)] for real, imaginary in pairs])
    except (TypeError, ValueError):
        raise ScenarioError(f"{name} must be a list of [real, imaginary] in rad/s, not {pairs!r}") from None
    return array[:, 0] + 1j * array[:, 1] if len(array) else array


def _each(name: str, value: Any, n: int) -> np.ndarray:
    """Return a number, or one for each of *n* contacts, as n of them."""
    array = np.asarray(value, dtype=float)
    if array.shape not in ((), (n,)):
        raise ScenarioError(f"{name} must be one number or {n}, one for each mode, not {value!r}")
    return np.broadcast_to(array, n)


def _refuse_the_rest(order: _Order) -> None:
    """Refuse what the slot says without any effect."""
    for name in order.words:
        needs = 'feedback = "observer"' if name.startswith("observer") else 'another design, or without "poles"'
        raise ScenarioError(f"{name} has no effect here: it goes with {needs}; leave it out")


def _check_posture(order: _Order) -> None:
    """Refuse a posture at which the law would never act."""
    condition, most = np.linalg.cond(order.at.U), float(order.given.get("cond_max", 1e3))
    if not condition < most:
        at = order.posture
        raise ScenarioError(
            f"at the posture front = {at.front:g}, rear = {at.rear:g}, pitch = {at.pitch:g} rad, U has condition "
            f"{condition:.3g}, not below {most:g}: the tractions cannot move all contacts apart, so the law would "
            "never act; design for a posture with the front wheels on a slope and the rears on the flat"
        )


def _model_parameters(order: _Order, closed_loop: np.ndarray) -> dict[str, Any]:
    """Return P, U and the observer for the component; *closed_loop*: the poles of the law, in rad/s."""
    on_wheels = wheels_from_axles if order.axles else np.asarray
    found: dict[str, Any] = {"P_model": on_wheels(order.at.P), "U_model": on_wheels(order.at.U)}
    if order.given.get("feedback") != "observer":
        return found
    model, words = order.at.model(), order.words
    if "observer_poles" in words:
        poles = _poles("observer_poles", words.pop("observer_poles"))
    else:
        fastest = OBSERVER * max(np.max(np.abs(model.poles())), np.max(np.abs(closed_loop)))
        asked = words.pop("observer_frequency", min(fastest, ss.RATE_MAX / order.period))
        poles = ss.conjugate_poles(_each("observer_frequency", asked, model.ninputs), DAMPING)
    L = on_wheels(observer_gain(model, poles, order.at.k_w, order.at.c_w, order.period))
    return found | {"L_z": L[:4], "L_rate": L[4:]}


def pole_placement(parameters: dict[str, Any], context: Context) -> Component:
    """Design a `PolePlacement`; raises ScenarioError or DeclarationError for poles or a posture that cannot be had."""
    order = _order(PolePlacement, parameters, context)
    _check_posture(order)
    at, model, n = order.at, order.at.model(), len(order.at.P)
    K = _gain(order, model)
    target = order.given.pop("z_target", None)
    if target is None:
        reference = {"z_per_b": np.linalg.inv(at.P * at.k_w)}
        if order.axles:
            reference["z_per_b"] = wheel_motions_from_axles(reference["z_per_b"])
    else:
        reference = _held(order, np.broadcast_to(np.asarray(target, float), 4))
    forces = wheel_forces_from_axles if order.axles else np.asarray
    rest = _model_parameters(order, ss.closed_loop_poles(model, K, order.period))
    _refuse_the_rest(order)
    gains = {"K_z": forces(K[:, :n]), "K_rate": forces(K[:, n:])}
    return PolePlacement(**{**gains, **reference, **rest, **order.given})


def _gain(order: _Order, model: Any) -> np.ndarray:
    words, n = order.words, model.ninputs
    kind = words.pop("design", "place")
    if kind == "lqr":
        weights = ss.natural_weights(model)._replace(**_table("weights", words.pop("weights", {}), ss.Weights._fields))
        return ss.lqr_gain(model, weights, order.period)
    if kind != "place":
        raise ScenarioError(f"design cannot be {kind!r}; it is one of 'place', 'lqr'")
    if "poles" in words:
        poles = _poles("poles", words.pop("poles"))
    else:
        own = np.sort(np.abs(model.poles()))[::2]  # one of each pair
        frequency = _each("frequency", words.pop("frequency", own), n)
        poles = ss.conjugate_poles(frequency, _each("damping", words.pop("damping", DAMPING), n))
    return ss.pole_gain(model, poles, order.period)


def _held(order: _Order, target: np.ndarray) -> dict[str, Any]:
    """Return reference and steady traction for the deformations *target* (4,) of the wheels."""
    at, forward = order.at, ss.feed_forward(order.at.P, order.at.U, order.at.k_w)
    if order.axles:
        z = np.array([target[2:].mean(), target[:2].mean()])
        pairs = forward.per_z @ z / 2
        return {
            "z_0": [z[1], z[1], z[0], z[0]], "F_0": [pairs[1], pairs[1], pairs[0], pairs[0]],
            "F_per_b": -wheel_forces_from_axles(forward.per_b),
        }  # fmt: skip
    return {"z_0": target, "F_0": forward.per_z @ target, "F_per_b": -np.linalg.inv(at.U)}


def pd_impact(parameters: dict[str, Any], context: Context) -> Component:
    """Design a `PdImpact`: what is not given of h0, h1, the end of a planned path and the observer, by rule.

    A slot that names a ``robot`` or a ``posture`` gets the P and U of that design in place of the body's own.
    """
    believes = "robot" in parameters or "posture" in parameters
    order = _order(PdImpact, parameters, context)
    given, at = order.given, order.at
    if given.get("interface", "design" if believes else "ports") == "design":
        given["interface"] = "design"
        _check_posture(order)
    k_axle = at.k_w if order.axles else 2 * at.k_w
    h0, _ = gains_by_stiffness(k_axle, float(at.P[1, 1] if order.axles else at.P[:2, :2].mean()))
    given.setdefault("h0", h0)
    given.setdefault("h1", 2 * float(np.sqrt(given["h0"])))
    if given.get("reference_kind") == "planned" and "z_target" not in given:
        z = ss.static_deflection(at.P, at.b, at.k_w)
        given["z_target"] = [z[1], z[1], z[0], z[0]] if order.axles else z
    loop = np.roots([1.0, given["h1"], given["h0"]])
    rest = _model_parameters(order, loop)
    _refuse_the_rest(order)
    return PdImpact(**{**rest, **given})
