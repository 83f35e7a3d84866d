"""The pitch controller for a ground made for its manoeuvre: plan, feed-forward table and start (thesis chapter 5)."""

from __future__ import annotations

from typing import Any

import numpy as np

from controllers.pitch_plan import PitchPlan
from controllers.pitch_trajectory import PitchTrajectory, gains
from cosim.errors import DeclarationError
from plants.manoeuvre import PitchManoeuvre

from .context import Context

_ROWS = 501  # of the plan: linear in between, the force is then within 1e-5 of its peak
_FADE = 0.15  # of the largest Phi: where the feedback has faded to a half of its share


def pitch_trajectory(parameters: dict[str, Any], context: Context) -> PitchTrajectory:
    """Return `PitchTrajectory` for the robot, its speed and the `PitchManoeuvre` under both tracks.

    ``bandwidth`` (rad/s) sets the feedback, 0 for open loop; ``robot`` what the plan believes of the robot.  The
    centre of mass keeps its speed, so the manoeuvre takes ground.length / speed.  Raises DeclarationError for any other
    ground, a ground made for other dimensions, and a time in which the robot would have to brake or slip.
    """
    believed = context.believed(parameters)
    ground = _manoeuvre(context)
    if not context.speed > 0:
        raise DeclarationError(
            f"start.speed is {context.speed:g} m/s, but the pitch manoeuvre needs a robot that moves forward"
        )
    T = ground.length / context.speed

    def slope(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return ground.centre(t).slope, ground.centre(t).slope_rate

    plan = PitchPlan(believed, ground.pitch, slope)
    mu = float(np.min(context.wheels().get("mu", np.inf)))
    _check_time(PitchPlan(context.robot, ground.pitch, slope), T, mu, ground.length)
    h0, h1 = gains(float(parameters.pop("bandwidth", 0.0)))
    rows = feed_forward(plan, T)
    t_start = (ground.start - context.x - context.robot.L_f) / context.speed
    if t_start < 0:
        raise DeclarationError(
            f"the pitch manoeuvre begins where the front wheel centres are at x = {ground.start:g} m, but they start "
            f"at {context.x + context.robot.L_f:g} m; set start.x to {ground.start - context.robot.L_f:g} m or less"
        )
    chosen = {"beta": ground.pitch, "T": T, "t_start": t_start, "h0": h0, "h1": h1, "plan": rows}
    return PitchTrajectory(**{**chosen, "Phi_0": _FADE * float(np.max(rows[:, 3])), **parameters})


def feed_forward(plan: PitchPlan, T: float) -> np.ndarray:
    """Return the plan as the table of `PitchTrajectory`, (rows, 5), for a manoeuvre of T seconds."""
    t = np.linspace(0, 1, _ROWS)
    columns = [np.column_stack([v, np.append(np.diff(v) / np.diff(t), 0.0)]) for v in (plan.force(t, T), plan.gain(t))]
    return np.column_stack([t, *columns])


def _manoeuvre(context: Context) -> PitchManoeuvre:
    left, right = context.ground.left, context.ground.right
    if not isinstance(left, PitchManoeuvre) or left != right:
        raise DeclarationError(
            f"the pitch plan is made for a pitch-manoeuvre under both tracks, not for a {type(left).__name__} and a "
            f'{type(right).__name__}; set ground.kind = "pitch-manoeuvre"'
        )
    for name in ("L_f", "L_r", "h", "R"):
        of_ground, of_robot = getattr(left, name), getattr(context.robot, name)
        if of_ground != of_robot:
            raise DeclarationError(
                f"ground.{name} of the pitch-manoeuvre is {of_ground:g} m, but the robot has {of_robot:g} m; make the "
                "ground for this robot"
            )
    return left


def _check_time(plan: PitchPlan, T: float, mu: float, length: float) -> None:
    shortest = plan.shortest_time()
    least = max(shortest, plan.time_for_friction(mu, shortest))
    if least > T:
        why = "without braking" if least == shortest else f"on a ground with mu = {mu:g}"
        raise DeclarationError(
            f"the pitch manoeuvre of {plan.beta:g} rad would take {T:.4g} s at {length / T:.4g} m/s, but takes at "
            f"least {least:.4g} s {why}; start with at most {length / least:.4g} m/s"
        )
