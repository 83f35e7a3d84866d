"""A rigid robot seen from the side over a sharp corner, from one event to the next: what rigid runs must match.

Independent of the product: the wheel centres are two points of a body that must stay above two straight lines (the
level and the slope, both offset by the wheel radius), without friction.  Between events the motion is integrated by
SciPy; an event is a contact that opens (its force vanishes) or closes (plastic impact, by a complementarity problem).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.integrate import solve_ivp

from plants.tables import G, Robot

SHORTEST = 1e-5  # s; two axles that hit in turn do so in ever shorter hops
FRONT_LEVEL, FRONT_SLOPE, REAR_LEVEL, REAR_SLOPE = range(4)


@dataclass(frozen=True)
class Event:
    """A contact that took an impulse (N.s, of the axle) or opened (0) at a time (s)."""

    time: float
    contact: int
    impulse: float


@dataclass(frozen=True)
class Corner:
    """The robot, and a slope of *angle* (rad) whose foot lies at *foot* (m) on the path of the wheel centres."""

    robot: Robot
    angle: float
    foot: float

    def contacts(self, y: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return gaps (4,), their gradients (4, 3) by x, z, pitch, and their second rates for zero acceleration (4,).

        *y* is x, z, pitch of the centre of mass, and its rates.
        """
        x, z, pitch, pitch_rate = y[0], y[1], y[2], y[5]
        rotation = np.array([[np.cos(pitch), -np.sin(pitch)], [np.sin(pitch), np.cos(pitch)]])
        gaps, rows, turning = [], [], []
        for ahead in (self.robot.L_f, -self.robot.L_r):
            arm = rotation @ [ahead, -self.robot.h]
            point = np.array([x, z]) + arm - [self.foot, self.robot.R]
            for slope in (0.0, self.angle):
                n = np.array([-np.sin(slope), np.cos(slope)])
                gaps.append(n @ point)
                rows.append([*n, n @ [-arm[1], arm[0]]])
                turning.append(-(pitch_rate**2) * (n @ arm))
        return np.array(gaps), np.array(rows), np.array(turning)

    @property
    def mobility(self) -> np.ndarray:
        """The inverse of the masses of x, z and pitch."""
        return 1 / np.array([self.robot.m, self.robot.m, self.robot.I_y])

    def impact(self, y: np.ndarray, closed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the state after a plastic impact of the *closed* contacts, and the impulses (4,)."""
        _, rows, _ = self.contacts(y)
        J = rows[closed]
        impulses = np.zeros(4)
        impulses[closed] = complementary(J * self.mobility @ J.T, J @ y[3:])
        return np.concatenate([y[:3], y[3:] + self.mobility * (rows.T @ impulses)]), impulses

    def forces(self, y: np.ndarray, closed: np.ndarray) -> np.ndarray:
        """Return the normal forces (4,) of the *closed* contacts, those of an axle summed; 0 for the others."""
        _, rows, turning = self.contacts(y)
        J = rows[closed]
        F = np.zeros(4)
        F[closed] = np.linalg.solve(J * self.mobility @ J.T, G * J[:, 1] - turning[closed])
        return F

    def run(self, speed: float, duration: float, closed: tuple[int, ...]) -> tuple[list[Event], np.ndarray]:
        """Start level at x = 0 on the *closed* contacts; return the events and the state at the end."""
        y, time, events = np.array([0.0, self.robot.h + self.robot.R, 0.0, speed, 0.0, 0.0]), 0.0, []
        active, hop = np.isin(np.arange(4), closed), np.inf
        while time < duration:
            watched = [self._watch(k, active) for k in range(4)]

            def rates(t: float, y: np.ndarray, active: np.ndarray = active) -> np.ndarray:
                return np.concatenate([y[3:], self.acceleration(y, active)])

            end = min(duration, time + 2 * hop)  # a short hop is not to be stepped over
            found = solve_ivp(rates, (time, end), y, rtol=1e-9, atol=1e-12, events=watched, max_step=hop / 5)
            time, y, hop = float(found.t[-1]), found.y[:, -1], np.inf
            met = [k for k in range(4) if len(found.t_events[k])]
            for k in met[:1]:
                if active[k]:
                    active = active & (np.arange(4) != k)
                    events.append(Event(time, k, 0.0))
                    continue
                touching = active | (np.arange(4) == k)
                y, impulses = self.impact(y, touching)
                hops = self.hops(y, touching & (impulses > 0))
                kept = touching & ((impulses > 0) | (hops < SHORTEST))
                events += [Event(time, j, float(impulses[j])) for j in np.flatnonzero(touching & kept)]
                events += [Event(time, j, 0.0) for j in np.flatnonzero(touching & ~kept)]
                hop = min(hops[touching & ~kept], default=np.inf)
                active = kept
        return events, y

    def acceleration(self, y: np.ndarray, closed: np.ndarray) -> np.ndarray:
        """Return the rates of the velocities of x, z and pitch on the *closed* contacts."""
        return self.mobility * (self.contacts(y)[1].T @ self.forces(y, closed)) - [0, G, 0]

    def hops(self, y: np.ndarray, closed: np.ndarray) -> np.ndarray:
        """Return for how long each contact would stay open with its rate and acceleration of now, s."""
        _, rows, turning = self.contacts(y)
        falling = rows @ self.acceleration(y, closed) + turning
        return np.where(falling < 0, -2 * (rows @ y[3:]) / np.where(falling < 0, falling, 1), np.inf)

    def _watch(self, k: int, active: np.ndarray):
        def event(t: float, y: np.ndarray) -> float:
            return float(self.forces(y, active)[k] if active[k] else self.contacts(y)[0][k])

        event.terminal, event.direction = True, -1
        return event


def complementary(M: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Return x >= 0 with M x + q >= 0 and x (M x + q) = 0, by trying every set of contacts that push."""
    for pushing in product((False, True), repeat=len(q)):
        a = np.array(pushing)
        x = np.zeros(len(q))
        x[a] = np.linalg.solve(M[np.ix_(a, a)], -q[a])
        if np.all(x >= 0) and np.all(M @ x + q >= -1e-12 * max(1.0, np.max(np.abs(q)))):
            return x
    raise ValueError("no set of contacts fits")
