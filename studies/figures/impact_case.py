"""The impact of chapter 6: the robot of Table 6.1, its fronts on a ramp of 0.3 rad, and the law that holds its wheels.

The thesis lets the axles (rear, front) move on springs that are always closed (6.7), with the posture of the impact
frozen and traction acting at the wheel centres.  The law 6.9 leaves e'' + h1 e' + h0 e = 0 of it, whatever P, U and k_w
are, and asks for the tractions

    F_a = U^-1 (z'' + P k_w z - b)                  (6.13, 6.14 with the spring that pushes)
"""

from __future__ import annotations

from functools import cache

import numpy as np

import studies
from controllers.off_line import AxleModel
from controllers.pd_impact import error_response
from controllers.reference import Motion, planned
from controllers.state_space import feed_forward
from plants.planar import Bicycle, Posture
from plants.tables import robot
from studies.metrics import as_mapping
from studies.runner import Result

ROBOT = robot("thesis_6_1")
SLOPE, SPEED = 0.3, 2.0  # rad, m/s
H0, H1 = 1500.0, 70.0  # 1/s2, 1/s; 6.3 prints them the other way round
TARGET = np.array([-0.01, -0.02])  # m, rear and front
APPROACH = np.array([0.0, -0.6])  # m/s, as printed
HARD, SOFT = 5.6e6, 4.1e6  # N/m of an axle
SECONDS = 0.2
FRICTION = 0.8  # 6.7
PERIODS = (0.1, 0.15, 0.2)  # s, of the planned paths
BAND = 0.02  # of the way to go, within which a deformation has settled
FRONT_WHEELS, REAR_WHEELS = slice(0, 2), slice(2, 4)


def times(seconds: float = SECONDS, step: float = 1e-4) -> np.ndarray:
    """Return sampling times (n,) from 0 to *seconds*, both included."""
    return np.arange(round(seconds / step) + 1) * step


@cache
def axles(k_w: float = HARD, arm: str = "centre") -> AxleModel:
    """Return P, U and b at rest at the posture of the impact, *k_w* in N/m per axle, traction acting at *arm*."""
    side, at = Bicycle(ROBOT, arm), Posture(SLOPE)
    return AxleModel(side.P(at), side.U(at), side.b(at, np.zeros(3)), k_w)


def stepped(h0: float, h1: float, target: float, rate: float, t: np.ndarray) -> Motion:
    """Return the deformation at *t* (n,) of an axle from 0 with *rate* (m/s), its *target* (m) given at once."""
    error, error_rate = error_response(h0, h1, -target, rate, t)
    return Motion(target + error, error_rate, -h1 * error_rate - h0 * error)


def both_stepped(t: np.ndarray, h0: float = H0, h1: float = H1) -> Motion:
    """Return the deformations (n, 2) of rear and front of section 6.3."""
    each = [stepped(h0, h1, d, v, t) for d, v in zip(TARGET, APPROACH, strict=True)]
    return Motion(*(np.column_stack(parts) for parts in zip(*each, strict=True)))


def both_planned(T: float, t: np.ndarray) -> Motion:
    """Return the degree-7 paths (n, 2) of rear and front in *T* seconds (6.17), at rest after that."""
    moving = (t < T)[:, None]
    path = planned(np.minimum(t, T)[:, None], T, 0.0, APPROACH, TARGET)
    return Motion(path.z, moving * path.rate, moving * path.acceleration)


def traction(model: AxleModel, motion: Motion) -> np.ndarray:
    """Return the axle tractions (n, 2), N, that make the axles move like this."""
    needs = feed_forward(model.P, model.U, model.k_w)
    return np.asarray(motion.z @ needs.per_z.T + (motion.acceleration - model.b) @ needs.per_b.T)


def normal(model: AxleModel, motion: Motion) -> np.ndarray:
    """Return the normal forces (n, 2), N, of the axles."""
    return model.normal_force(motion.z, motion.rate)


@cache
def cosimulated(variant: str, k_w: float = HARD) -> Result:
    """Run a variant of the scenario "ramp-impact" for 0.2 s from the impact on, *k_w* in N/m per axle."""
    return studies.run("ramp-impact", variant, wheels={"k_w": k_w / 2}, run={"duration": 0.2075})


def measured(variant: str, name: str, k_w: float = HARD) -> float:
    """Return a figure of the verdict on such a run."""
    value = as_mapping(cosimulated(variant, k_w).metrics)[name]
    assert value is not None
    return float(value)


def since_impact(result: Result) -> tuple[np.ndarray, np.ndarray]:
    """Return times (n,) from the first touch of the ramp on, s, and the rows (m,) of the record they are of."""
    struck = int(np.argmax(np.abs(result.record["body.slope"][:, 0]) > 1e-9))
    rows = np.arange(struck, len(result.record.time))
    return result.record.time[rows] - result.record.time[struck], rows


def deformations(result: Result) -> tuple[np.ndarray, np.ndarray]:
    """Return times since the impact (n,), s, and the deformations of rear and front axle (n, 2), m."""
    t, rows = since_impact(result)
    gap = result.record["body.gap"][rows]
    return t, np.column_stack([gap[:, REAR_WHEELS].mean(axis=1), gap[:, FRONT_WHEELS].mean(axis=1)])
