"""The jerk-ramp scenario keeps its claim: on the straight of a ramp the ideal force is nearly constant, and helps."""

from functools import cache

import casadi as ca
import numpy as np
import pytest

from controllers.planar_jerk import Frame, ideal_force
from controllers.planar_jerk import jerk as jerk_of
from studies.catalog import find_scenario
from studies.jerk_stretch import best_rival, held_jerk
from studies.metrics import as_mapping
from studies.metrics.jerk import normal_jerk, rms
from studies.runner import Result, execute

FILE = find_scenario("jerk-ramp")
LAWS = ("body", "inertial", "thesis")
MARGIN = 0.02  # s, past the end of the fillet, where the acceleration steps


@cache
def run(variant: str, force: float | None = None) -> Result:
    """Return a finished run of a variant, or of a constant force."""
    change = [] if force is None else [{"components": {"controller": {"force": force}}}]
    result = execute(FILE.load(variant, change))
    assert result.error is None
    return result


def straight(result: Result) -> np.ndarray:
    """Return (n,): where the fronts are on the straight of the ramp and the rears still on the level."""
    record = result.record
    slope, bend = record["body.slope"], record["body.curvature"]
    on = (np.abs(slope[:, 0] - 0.2) < 1e-6) & (np.max(np.abs(bend), axis=1) < 1e-6) & (np.abs(slope[:, 2]) < 1e-6)
    t = record.time
    return on & (t > t[on][0] + MARGIN) & (t < t[on][-1] - MARGIN)


def jerk(result: Result, definition: str, kind: str = "held") -> float:
    """Return an RMS normal jerk on the straight, m/s3."""
    found = normal_jerk(result.record.time, result.record.get)
    value = rms(result.record.time, getattr(found, kind)[definition], straight(result))
    assert value is not None
    return value


@pytest.mark.parametrize("definition", LAWS)
def test_the_jerk_with_the_force_held_is_3_times_below_the_best_constant_force(definition: str) -> None:
    """All of the straight is within the limits; the best constant force lies between the ends of the ideal one."""
    law = run(definition)
    there = straight(law)
    assert np.min(law.record["controller.unlimited"].ravel()[there]) == 1
    best = best_rival(law, definition, there, until=1.36)
    rivals = [run("printed", best.force + off) for off in (-10.0, 0.0, 10.0)]
    lower, constant, upper = (held_jerk(rival, definition, law, there) for rival in rivals)
    assert constant < min(lower, upper)
    ideal = law.record["wheels.traction"].sum(axis=1)[there]
    assert np.min(ideal) < best.force < np.max(ideal)
    assert held_jerk(law, definition, law, there) < constant / 3


def test_the_true_jerk_is_better_too_and_the_printed_force_makes_it_worse() -> None:
    """The ideal force falls slowly, so that force changes add little; 367 N is far past it."""
    law = run("body")
    ideal = law.record["wheels.traction"].sum(axis=1)[straight(law)]
    assert (ideal[0], ideal[-1]) == (pytest.approx(150, abs=1), pytest.approx(106, abs=1))
    free = jerk(run("uncontrolled"), "body", "true")
    assert jerk(run("body"), "body", "true") < free / 5
    assert jerk(run("printed"), "body", "true") > 2 * free
    assert jerk(run("partial"), "body", "true") > free


@pytest.mark.parametrize("definition", LAWS)
def test_the_force_is_that_of_the_closed_form(definition: str) -> None:
    """`ideal_force` at the recorded pitch and speed, traction at the ground, all along the straight.

    The weight on the speed takes J_1min^2 / (J_1^2 + J_1min^2) of the way to F_v = k_v (speed - v); a sample is up to
    1 ms old, in which the force falls by 0.2 N, and the rest to 0.3 N covers what a lost 0.1 % of J_1 F is.
    """
    law = run(definition)
    controller, robot = law.assembly.components["controller"], law.assembly.robot
    frame, record = Frame(robot.m, robot.I_y, robot.L_f, robot.L_r, robot.h, robot.R), law.record
    weight = controller.J_1_min**2
    for i in np.flatnonzero(straight(law))[::100]:
        v, pitch = float(record["body.velocity_body"][i, 0]), float(np.ravel(record["body.pitch"])[i])
        ideal = ideal_force(frame, definition, 0.2, v, pitch)
        J_1 = float(ca.evalf(ca.SX(jerk_of(frame, definition, pitch, [0, 0.2], [0, 0], [0, 0], v)[1])))
        expected = ideal + weight / (J_1**2 + weight) * (controller.k_v * (controller.speed - v) - ideal)
        assert float(record["wheels.traction"][i].sum()) == pytest.approx(expected, abs=0.3)


def test_the_plan_lowers_the_jerk_of_the_whole_obstacle_and_no_law_does() -> None:
    """Whose largest part are the steps at the ends of the fillet: it brakes before them, the laws do not."""
    free, plan = (as_mapping(run(variant).metrics) for variant in ("uncontrolled", "planned"))
    assert plan["jerk_true_body"] < 0.7 * free["jerk_true_body"]
    for law in LAWS:
        assert as_mapping(run(law).metrics)[f"jerk_true_{law}"] > free[f"jerk_true_{law}"]
