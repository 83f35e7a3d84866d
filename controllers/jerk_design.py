"""Forces planned before the run: the best constant force, and the force over a whole crossing with the least true jerk.

A robot that rolls on both axles has one degree of freedom.  Over the position x of its centre of mass, with w = v_x^2,

    w' = 2 (d_0 + d_w w + d_F F) / rho,      rho = dx/dt / v_x
    a_z = z_0 + z_w w + z_F F,   a_x and the normal forces alike

with coefficients of the posture, that is of x: linear in w and F.  The jerk with force changes included is then

    J = v_x rho a_z'                         (body; the other definitions add - omega a_x or (v_x omega)' v_x rho)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import casadi as ca
import numpy as np

from cosim.errors import ScenarioError

from .planar_jerk import Frame, motion

_STALLED = 0.05**2  # (m/s)^2, below which a crossing counts as failed
_STALLS = 1e6  # m/s3, the price of a constant force that does not cross, falling with the force


class Path(Protocol):
    """The path of a wheel centre over world x."""

    def height(self, x: np.ndarray, /) -> np.ndarray:
        """Return the height, m, at x (n,), m."""

    def slope(self, x: np.ndarray, /) -> np.ndarray:
        """Return dZ/dx."""

    def curvature(self, x: np.ndarray, /) -> np.ndarray:
        """Return the curvature, 1/m, concave up positive."""


@dataclass(frozen=True)
class Crossing:
    """A robot on a road, by the position of its centre of mass: coefficients (n, 3) of 1, w and F, see above."""

    x: np.ndarray  # (n,) m, evenly spaced
    rho: np.ndarray  # (n,) dx/dt over v_x
    turn: np.ndarray  # (n,) omega over v_x, 1/m
    slow: np.ndarray  # (n, 3) of v_x'
    a_x: np.ndarray  # (n, 3)
    a_z: np.ndarray  # (n, 3)
    normal: np.ndarray  # (n, 2, 3) normal force of rear and front axle
    share: float  # of the force on the front axle

    @property
    def dx(self) -> float:
        """Distance between two positions, m."""
        return float(self.x[1] - self.x[0])

    def jerk(self, definition: str, w: Any, F: Any) -> Any:
        """Return the normal jerk with force changes included between the positions, (n - 1,), m/s3.

        *w* (n,) in (m/s)^2 and *F* (n,) in N: arrays or CasADi columns.
        """
        value = lambda c, i: c[i, 0] + c[i, 1] * w[i] + c[i, 2] * F[i]  # noqa: E731
        n = len(self.x)
        low, high = slice(0, n - 1), slice(1, n)
        a_z = {i: value(self.a_z, s) for i, s in enumerate((low, high))}
        v = ((w[low] + w[high]) / 2) ** 0.5
        time_rate = v * (self.rho[low] + self.rho[high]) / 2 / self.dx
        J = (a_z[1] - a_z[0]) * time_rate
        if definition == "inertial":
            omega = v * (self.turn[low] + self.turn[high]) / 2
            J = J - omega * (value(self.a_x, low) + value(self.a_x, high)) / 2
        if definition == "thesis":  # v_z' = a_z + v_x omega
            J = J + (self.turn[high] * w[high] - self.turn[low] * w[low]) * time_rate
        return J

    def loads(self, w: Any, F: Any) -> list[Any]:
        """Return the normal forces of rear and front axle, N, each (n,)."""
        return [self.normal[:, k, 0] + self.normal[:, k, 1] * w + self.normal[:, k, 2] * F for k in range(2)]

    def seconds(self, w: Any) -> Any:
        """Return the time between the positions, (n - 1,), s."""
        v = ((w[:-1] + w[1:]) / 2) ** 0.5
        return self.dx / (v * (self.rho[:-1] + self.rho[1:]) / 2)

    def speeds(self, v_x: float, F: np.ndarray) -> np.ndarray:
        """Return w (n,) of a robot that starts with *v_x* (m/s) under the forces *F* (n,); NaN from where it stalls."""
        growth = 2 * self.slow[:, 1] / self.rho
        push = 2 * (self.slow[:, 0] + self.slow[:, 2] * F) / self.rho
        w = np.full(len(self.x), np.nan)
        w[0] = v_x**2
        for i in range(len(w) - 1):  # trapezoidal rule, linear in w
            ahead = w[i] + self.dx / 2 * (growth[i] * w[i] + push[i] + push[i + 1])
            w[i + 1] = ahead / (1 - self.dx / 2 * growth[i + 1])
            if not w[i + 1] > _STALLED:
                w[i + 1] = np.nan
                break
        return w


def crossing(robot: Frame, path: Path, x: np.ndarray) -> Crossing:
    """Return the crossing of a *path* by a robot whose centre of mass goes through the positions *x* (n,), m."""
    pitch, centres = _posture(robot, path, x)
    names = ("pitch", "rear", "front", "bend_rear", "bend_front", "v", "F")
    p, rear, front, k_r, k_f, v, F = (ca.SX.sym(name) for name in names)
    at = motion(robot, p, [rear, front], [k_r, k_f], v, F)
    rho_v = v * ca.cos(p) - at.v_z * ca.sin(p)
    result = ca.vertcat(rho_v, at.omega, at.a_x - at.omega * at.v_z, at.a_x, at.a_z, *at.normal)
    every = ca.Function("every", [p, rear, front, k_r, k_f, v, F], [result]).map(len(x))
    ground = [np.arctan(path.slope(c)) for c in centres] + [path.curvature(c) for c in centres]
    none, one = np.zeros_like(x), np.ones_like(x)
    rest, rolls, pushed = (
        np.array(every(*(row[None, :] for row in (pitch, *ground, v, F))))
        for v, F in ((none, none), (one, none), (none, one))
    )
    c = np.stack([rest, rolls - rest, pushed - rest], axis=-1)  # (quantity, n, 3)
    return Crossing(x, c[0, :, 1], c[1, :, 1], c[2], c[3], c[4], np.stack([c[5], c[6]], axis=1), float(robot.share))


def _posture(robot: Frame, path: Path, x: np.ndarray) -> tuple[np.ndarray, list[np.ndarray]]:
    """Return the pitch (n,) and the x of rear and front wheel centres: Newton on both lying on the path."""
    pitch, arms = np.zeros_like(x), (-robot.L_r, robot.L_f)
    for _ in range(20):
        s, c = np.sin(pitch), np.cos(pitch)
        centres = [x + arm * c + robot.h * s for arm in arms]
        rise = path.height(centres[1]) - path.height(centres[0])
        slopes = [path.slope(centre) * (-arm * s + robot.h * c) for centre, arm in zip(centres, arms, strict=True)]
        step = (rise - (robot.L_f + robot.L_r) * s) / ((robot.L_f + robot.L_r) * c - slopes[1] + slopes[0])
        pitch = pitch + step
        if np.max(np.abs(step)) < 1e-14:
            break
    return pitch, [x + arm * np.cos(pitch) + robot.h * np.sin(pitch) for arm in arms]


def rms(road: Crossing, jerk: np.ndarray, w: np.ndarray, where: np.ndarray | None = None) -> float:
    """Return the root mean square over time of a jerk (n - 1,), over the intervals *where* (n - 1,), m/s3."""
    weight = road.seconds(w) * (1.0 if where is None else where)
    return float(np.sqrt(np.sum(jerk**2 * weight) / np.sum(weight)))


def best_constant_force(
    road: Crossing, v_x: float, definition: str, bound: float, slowest: float = 0.0, where: np.ndarray | None = None
) -> float:
    """Return the constant force, N, within +-*bound* that crosses with the least RMS jerk (over *where*, (n - 1,)).

    Forces under which the robot stalls or gets slower than *slowest* (m/s) do not count; raises ScenarioError if none
    is left.
    """

    def cost(force: float) -> float:
        F = np.full(len(road.x), force)
        w = road.speeds(v_x, F)
        return (
            rms(road, road.jerk(definition, w, F), w, where)
            if np.all(w > slowest**2)
            else _STALLS * (1 + bound - force)
        )

    trials = np.linspace(-bound, bound, 41)
    costs = [cost(force) for force in trials]
    i = int(np.argmin(costs))
    if costs[i] >= _STALLS:
        raise ScenarioError(
            f"no constant force up to {bound:g} N brings the robot across from {v_x:g} m/s; start faster"
        )
    around = (trials[max(i - 1, 0)], trials[min(i + 1, len(trials) - 1)])
    from scipy.optimize import minimize_scalar

    return float(minimize_scalar(cost, bounds=around, method="bounded", options={"xatol": 0.01}).x)


@dataclass(frozen=True)
class Limits:
    """What a plan must keep to."""

    force: float  # N, of all wheels
    rate: float  # N/s
    mu: float  # friction, traction over normal force of an axle
    speed: float  # m/s, lowest
    end_speed: float  # m/s, lowest at the end
    seconds: float = np.inf  # longest time for the crossing


@dataclass(frozen=True)
class Plan:
    """A force over a crossing."""

    force: np.ndarray  # (n,) N
    w: np.ndarray  # (n,) (m/s)^2
    jerk: np.ndarray  # (n - 1,) m/s3, force changes included


def least_jerk(road: Crossing, v_x: float, definition: str, limits: Limits) -> Plan:
    """Return the plan with the least time integral of the squared true jerk from *v_x* (m/s) on, within *limits*.

    Raises ScenarioError if the solver finds none.
    """
    n = len(road.x)
    opti = ca.Opti()
    w, F = opti.variable(n), opti.variable(n) * 100.0  # N in hundreds: all unknowns of one size
    rate_of_w = 2 * (road.slow[:, 0] + road.slow[:, 1] * w + road.slow[:, 2] * F) / road.rho
    seconds, change = road.seconds(w), F[1:] - F[:-1]
    J = road.jerk(definition, w, F)
    # On level ground no force changes the jerk; a little price on changing it keeps it smooth there.
    opti.minimize(ca.sumsqr(J * seconds**0.5) + 1e-9 * ca.sumsqr(change / seconds**0.5))
    opti.subject_to(w[1:] - w[:-1] == road.dx / 2 * (rate_of_w[1:] + rate_of_w[:-1]))
    opti.subject_to(w[0] == v_x**2)
    opti.subject_to(w >= limits.speed**2)
    opti.subject_to(w[n - 1] >= limits.end_speed**2)
    if np.isfinite(limits.seconds):
        opti.subject_to(ca.sum1(seconds) <= limits.seconds)
    opti.subject_to(opti.bounded(-limits.force, F, limits.force))
    opti.subject_to(opti.bounded(-limits.rate * seconds, change, limits.rate * seconds))
    for load, share in zip(road.loads(w, F), (1 - road.share, road.share), strict=True):
        opti.subject_to(load >= 0)
        if share:
            opti.subject_to(share * F <= limits.mu * load)
            opti.subject_to(-share * F <= limits.mu * load)
    opti.set_initial(w, v_x**2)
    opti.solver("ipopt", {"print_time": False}, {"print_level": 0, "sb": "yes", "max_iter": 500})
    try:
        found = opti.solve()
    except RuntimeError:
        raise ScenarioError(
            f"no plan crosses at {limits.speed:g} m/s or more within {limits.force:g} N, {limits.rate:g} N/s and "
            f"mu = {limits.mu:g}; lower the speed floor or widen the limits"
        ) from None
    return Plan(*(np.asarray(found.value(value), float) for value in (F, w, J)))


def profile_rows(x: np.ndarray, force: np.ndarray) -> np.ndarray:
    """Return a force over position as the table of `ForceProfile`, none from the last position on: x, F, dF/dx."""
    growth = np.append(np.diff(force) / np.diff(x), 0.0)
    return np.column_stack([x, np.append(force[:-1], 0.0), growth])
