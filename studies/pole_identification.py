"""Are the poles of an impact controller where they were placed?  Identified from differences of co-simulated runs.

The rover stands with its front wheels on the slope; one run starts from equilibrium, another a few micrometres off.
The difference of deformations and rates obeys the sampled closed loop, d(k+1) = M d(k), whatever both runs have in
common; M is fitted, and its eigenvalues, as rates log(lambda) / period, are set beside the poles of the design.  The
difference of what an observer is wrong by obeys the observer's own dynamics in the same way.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import linear_sum_assignment

from cosim.clock import NS, ticks
from cosim.errors import CouplingError
from cosim.master import run
from cosim.record import Record
from cosim.scenario import Scenario
from plants.planar import Bicycle, Posture
from plants.tables import ROBOTS

from .assembly import assemble
from .runner import algorithm_of, connect, instantiate

FOOT, ANGLE = 0.63, 0.3  # m, rad: the ramp of the scenarios
# What the other run starts off by, times 5.6e6 N/m per axle: some 3 % of the deflection, so that all contacts stay
# closed, and far more than what rounding and the integrators leave of a gap.  Single wheels: roll and yaw as well.
_OFF = {"heave": 3e-6, "pitch": 4e-6, "roll": 5e-6, "yaw": 2e-5}  # m, rad
HARD = 5.6e6  # N/m per axle
_MEANS = np.array([[0, 0, 0.5, 0.5], [0.5, 0.5, 0, 0]])  # of the axles, rear and front


@dataclass(frozen=True)
class Bench:
    """A rover with its front wheels on the ramp, friction unlimited, and the controller that is asked about."""

    controller: Mapping[str, Any]  # the slot, as in a scenario file
    period: float = 1e-3  # s, of the controller
    k_axle: float = HARD  # N/m
    c_axle: float = 0.0  # N.s/m
    speed: float = 0.0  # m/s along the road, rolling without impact
    C_alpha: float = 5e3  # N/rad, cornering stiffness of a wheel
    up: float = 0.1  # m, how far the front wheel centres are beyond the kink of their path, along the road
    duration: float = 0.06  # s
    table: str = "thesis_6_1"
    wheels: bool = False  # identify all four wheels, not the means of the axles

    @property
    def x(self) -> float:
        """Position of the centre of mass, m."""
        robot = ROBOTS[self.table]
        pitch = float(np.arcsin(self.up * np.tan(ANGLE) / robot.L))  # on rigid wheels
        kink = FOOT - robot.R * float(np.tan(ANGLE / 2))
        return kink + self.up - robot.L_f * float(np.cos(pitch)) - robot.h * float(np.sin(pitch))

    def scenario(self) -> Scenario:
        """Return the bench as a scenario."""
        step = min(1e-4, self.period)
        return Scenario.model_validate({
            "name": "bench", "title": "", "claim": "", "assembly": "rover", "robot": {"table": self.table},
            "ground": {"kind": "ramp", "start": FOOT, "angle": ANGLE}, "start": {"x": self.x},
            "run": {"step": step, "duration": self.duration, "tolerance": 1e-10},
            "components": {
                "controller": {"period": self.period, **self.controller},
                "wheels": {"type": "WheelDeformation", "k_w": self.k_axle / 2, "c_w": self.c_axle / 2, "mu": 1e6,
                           "C_alpha": self.C_alpha},
            },
        })  # fmt: skip

    def posture(self) -> Posture:
        """Return how the rover stands: on the level with its rears, pitched by the height of its fronts."""
        w, _, y, _ = assemble(self.scenario()).starts["body.q"]
        return Posture(front=ANGLE, pitch=-2 * float(np.arctan2(y, w)))


@dataclass(frozen=True)
class Samples:
    """One run, or what two runs differ by, at the controller's ticks."""

    motion: np.ndarray  # (ticks, 2 n + 2): deformations in m, rates in m/s, and how far the rover rolled, m and m/s
    error: np.ndarray  # (ticks, 2 n): estimate minus truth of the deformations and rates


def differences(bench: Bench, together: bool = False) -> list[Samples]:
    """Return what disturbed runs differ by from the undisturbed one: one for every motion that the model has.

    Or all motions *together* in a single run, which is enough where poles are far from those of the rolling rover.
    Raises CouplingError if a contact opens or the law switches off: there is then no one closed loop.
    """
    motions = {name: size for name, size in _OFF.items() if bench.wheels or name in ("heave", "pitch")}
    base = simulate(bench, {})
    runs = [simulate(bench, off) for off in ([motions] if together else [{n: s} for n, s in motions.items()])]
    return [Samples(r.motion - base.motion, r.error - base.error) for r in runs]


def simulate(bench: Bench, off: Mapping[str, float]) -> Samples:
    """Run a bench that starts *off* its equilibrium: heave in m; pitch, roll and yaw in rad; as on hard wheels."""
    assembly = assemble(bench.scenario())
    instances = instantiate(assembly)
    start, settings = assembly.starts, assembly.scenario.run
    heave, pitch, roll, yaw = (off.get(n, 0.0) * HARD / bench.k_axle for n in ("heave", "pitch", "roll", "yaw"))
    r, q = start["body.r"] + [0, 0, heave], _times(start["body.q"], np.array([1, roll / 2, -pitch / 2, yaw / 2]))
    v, omega = _rolling(bench)
    for name, value in (("r", r), ("q", q), ("v", v), ("omega", omega)):
        instances["body"].set(name, value)
    record = Record()
    with connect(assembly, instances) as system:
        run(system, algorithm_of(assembly), step=ticks(settings.step, "step"), stop=ticks(bench.duration, "duration"),
            observers=[record], tolerance=settings.tolerance)  # fmt: skip
    if np.any(record["wheels.contact"][1:] < 0.5) or not np.all(record["controller.active"][1:] > 0.5):
        raise CouplingError("a contact opened or the law was off: there is no one closed loop to identify")
    return _samples(bench, record)


def _samples(bench: Bench, record: Record) -> Samples:
    """Pick the ticks: what the controller made of a tick is in the step that follows it."""
    tick = np.flatnonzero(record.time_ns % round(bench.period * NS) == 0)[:-1]
    axles = np.eye(4) if bench.wheels else _MEANS
    x = np.hstack([record[port][tick] @ axles.T for port in ("body.gap", "body.gap_rate")])
    along = [record[port][tick, :1] for port in ("body.position", "body.velocity")]
    used = ("controller.estimate", "controller.estimate_rate")
    if used[0] not in record:
        return Samples(np.hstack([x, *along]), np.zeros_like(x))
    return Samples(np.hstack([x, *along]), np.hstack([record[port][tick + 1] @ axles.T for port in used]) - x)


def _rolling(bench: Bench) -> tuple[np.ndarray, np.ndarray]:
    """Return velocity (world) and angular velocity of the rover that rolls on both slopes at the bench's speed."""
    at = bench.posture()
    v_x, v_z, omega = Bicycle(ROBOTS[bench.table]).climbing_twist(at, 1.0)
    c, s = np.cos(at.pitch), np.sin(at.pitch)
    world = np.array([c * v_x - s * v_z, 0.0, s * v_x + c * v_z])
    share = bench.speed / world[0]
    return share * world, share * np.array([0.0, omega, 0.0])


def _times(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Return the product of two quaternions (w, x, y, z), normalised."""
    product = np.array([p[0] * q[0] - p[1:] @ q[1:], *(p[0] * q[1:] + q[0] * p[1:] + np.cross(p[1:], q[1:]))])
    return product / np.linalg.norm(product)


def identify(runs: list[np.ndarray], period: float) -> np.ndarray:
    """Return the poles, in rad/s, of d(k+1) = M d(k) fitted by least squares to the *runs*, each (ticks, states)."""
    size = np.max(np.abs(np.vstack(runs)), axis=0)
    before, after = (np.vstack([d[part] / size for d in runs]) for part in (slice(None, -1), slice(1, None)))
    M = np.linalg.lstsq(before, after, rcond=None)[0].T
    return np.log(np.linalg.eigvals(M).astype(complex)) / period


def matched(found: np.ndarray, asked: np.ndarray) -> np.ndarray:
    """Return the poles *found* in the order of those *asked*: the pairs whose distances sum to the least."""
    rows, columns = linear_sum_assignment(np.abs(np.asarray(asked)[:, None] - np.asarray(found)[None, :]))
    return np.asarray(found)[columns[np.argsort(rows)]]


@dataclass(frozen=True)
class Finding:
    """Poles asked of a controller and poles identified, in the same order, rad/s."""

    asked: np.ndarray
    found: np.ndarray

    @property
    def errors(self) -> np.ndarray:
        """Distance of every pole from where it was asked, relative to its size."""
        return np.abs(self.found - self.asked) / np.abs(self.asked)


def examine(bench: Bench, asked: np.ndarray, *, together: bool = False, of: str = "motion") -> Finding:
    """Identify the closed loop of a bench, or the *of* = "error" of its observer; *asked* for poles in rad/s.

    The closed loop has two poles more than the law places, those of the rolling rover: the slowest, left out here.
    """
    found = identify([getattr(d, of) for d in differences(bench, together)], bench.period)
    found = found[np.argsort(np.abs(found))[len(found) - len(asked) :]]
    return Finding(np.asarray(asked), matched(found, asked))
