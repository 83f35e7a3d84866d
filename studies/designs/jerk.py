"""Jerk traction for the robot of a run, and forces planned over its road."""

from __future__ import annotations

from typing import Any

import numpy as np

from controllers.force_profile import ForceProfile
from controllers.jerk_design import Crossing, Limits, best_constant_force, crossing, least_jerk, profile_rows
from controllers.jerk_traction import JerkTraction
from controllers.planar_jerk import DEFINITIONS, Frame
from cosim import Component
from cosim.errors import ScenarioError, nearest
from plants.tables import Robot
from plants.wheel_path import rolling_path

from .context import Context

# A tenth of the friction is kept back: at its limit four rigid wheels share a load as they like, and the wheel with
# less of it slides first.
_USED = 0.9
_SPACING = 0.01  # m, of the positions of a plan
_TORQUE = 25.0  # N.m, of a wheel's motor where nothing else is said
_PLANS = ("constant", "least-jerk")
_PLANNED = {
    "definition": "body",
    "until": None,
    "slowest": 0.4,
    "rate_max": 2e4,
    "mu": None,
    "end_speed": None,
    "seconds": np.inf,
}


def _frame(robot: Robot, arm: str, share: float) -> Frame:
    return Frame(robot.m, robot.I_y, robot.L_f, robot.L_r, robot.h, robot.R, share, 1.0 if arm == "ground" else 0.0)


def _friction(context: Context) -> float:
    return _USED * float(context.wheels().get("mu", 0.8))


def jerk_traction(parameters: dict[str, Any], context: Context) -> Component:
    """Return a `JerkTraction` that knows the robot, where its traction acts, and nine tenths of its friction.

    Without ``speed`` it holds the speed of the start where the jerk leaves the force open.  ``robot = {m = 187}``: it
    believes in another robot.
    """
    robot = context.believed(parameters)
    known = {
        "m": robot.m, "I_y": robot.I_y, "L_f": robot.L_f, "L_r": robot.L_r, "h": robot.h, "R": robot.R,
        "mu": _friction(context), "speed": context.speed, "traction_arm": context.traction_arm(), "torque_max": _TORQUE,
    }  # fmt: skip
    return JerkTraction(**{**known, **parameters})


def force_profile(parameters: dict[str, Any], context: Context) -> Component:
    """Return a `ForceProfile` with a constant ``force`` (N), a ``profile``, or a ``plan`` for the road of the run.

    ``plan = "constant"``: the constant force with the least RMS of the true jerk of a ``definition``.
    ``plan = "least-jerk"``: the force over the crossing with the least time integral of its square.  Both from the
    start to ``until`` (m; by default as far as the start's speed reaches), nowhere slower than ``slowest`` (m/s); the
    latter also within ``rate_max`` (N/s), ``mu``, ``end_speed`` (m/s; by default the start's) and ``seconds``.

    Raises ScenarioError for an unknown plan or definition, or for tracks that differ.
    """
    robot = context.believed(parameters)
    plan, force = parameters.pop("plan", None), parameters.pop("force", None)
    given = {name: parameters.pop(name, default) for name, default in _PLANNED.items()}
    values = {"R": robot.R, "torque_max": _TORQUE, **parameters}
    if force is not None:
        values["profile"] = [[context.x, float(force), 0.0]]
    if plan is None:
        return ForceProfile(**values)
    if plan not in _PLANS:
        raise ScenarioError(f"there is no plan {plan!r}; {nearest(str(plan), _PLANS)}")
    if given["definition"] not in DEFINITIONS[:3]:
        raise ScenarioError(
            f"a plan needs a jerk with force changes, not {given['definition']!r}; it is one of {DEFINITIONS[:3]}"
        )
    road = road_of(context, robot, float(values.get("share", 0.0)), given["until"])
    bound = min(2 * float(values["torque_max"]) / robot.R / part for part in (road.share, 1 - road.share) if part > 0)
    if plan == "constant":
        best = best_constant_force(road, context.speed, given["definition"], bound, slowest=given["slowest"])
        return ForceProfile(**{**values, "profile": [[context.x, best, 0.0]]})
    limits = Limits(
        force=bound,
        rate=given["rate_max"],
        mu=_friction(context) if given["mu"] is None else given["mu"],
        speed=given["slowest"],
        end_speed=context.speed if given["end_speed"] is None else given["end_speed"],
        seconds=given["seconds"],
    )
    found = least_jerk(road, context.speed, given["definition"], limits)
    return ForceProfile(**{**values, "profile": profile_rows(road.x, found.force)})


def road_of(context: Context, robot: Robot, share: float, until: float | None = None) -> Crossing:
    """Return the crossing of the run's road from its start to *until* (m), for a robot seen from the side.

    Raises ScenarioError if the tracks differ.
    """
    if context.ground.left != context.ground.right:
        raise ScenarioError("a plan sees the robot from the side, but the left and the right track differ here")
    end = context.x + context.speed * context.duration if until is None else until
    x = np.linspace(context.x, end, 1 + max(2, round((end - context.x) / _SPACING)))
    return crossing(_frame(robot, context.traction_arm(), share), rolling_path(context.ground.left, robot.R), x)
