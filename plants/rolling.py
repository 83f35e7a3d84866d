"""Where the centre of a disc goes that rolls over a profile: the exact upper envelope of the circles about the ground.

The lowest centre above x is at Z(x) = max over u of g(x + u) + sqrt(R^2 - u^2).  Touching smooth ground at s,

    x = s - R sin(theta),  Z = g(s) + R cos(theta),  tan(theta) = g'(s),  dx/ds = 1 - R kappa_g(s),

so ground with kappa_g < 1/R makes a branch that ascends in x, a convex corner an arc of radius R that joins two
branches, and ground hollower than the disc is never touched.  A `Run` is a longest chain of such branches; runs end at
concave corners, at vertical faces and at hollows too tight.  Of two runs the one further along the ground gains on the
other as x grows (sqrt(R^2 - u^2) is concave), so they cross at most once: a kink of the path, found by bracketing.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from math import atan, ceil, inf, sin, sqrt

import numpy as np

from cosim.errors import ScenarioError

from .profile import SAME_ANGLE, SAME_HEIGHT, Piece, Profile

EDGE = 1e9  # m, where the world ends: the outermost straight pieces are cut off there
# Ground with 1 - R kappa_g below this counts as too tight: there the path would turn with a radius below 2 % of the
# wheel's, less than a tyre gives way, and gets a kink in its place.  It dips by about 0.02 R (1/cos(turn/2) - 1) at
# most; on rough roads, where such turns are short, by less than 1e-6 m.
_TIGHT = 0.02
_NEARLY_TIGHT = 0.1  # a minimum of 1 - R kappa_g among samples is looked at closely below this


@dataclass(frozen=True)
class Roll:
    """The disc rolls on smooth ground from contact ``start`` to contact ``end`` (m)."""

    piece: Piece
    R: float
    start: float
    end: float

    def frame(self, s: np.ndarray) -> np.ndarray:
        """Return x, Z, dZ/dx and d2Z/dx2 of the centre for the contacts s, shape (4, n)."""
        g, slope, second = self.piece.jet(s)
        root = np.sqrt(1 + slope**2)
        return np.array([s - self.R * slope / root, g + self.R / root, slope, second / self._stretch(slope, second)])

    def _stretch(self, slope: np.ndarray, second: np.ndarray) -> np.ndarray:
        """Return dx/ds = 1 - R kappa_g."""
        return 1 - self.R * second / (1 + slope**2) ** 1.5

    @cached_property
    def samples(self) -> tuple[np.ndarray, np.ndarray]:
        """Contacts and the x of the centre there, dense enough to bracket with; x never descends."""
        n = 2 if self.piece.straight else 1 + ceil((self.end - self.start) / self.piece.resolution)
        s = np.linspace(self.start, self.end, max(n, 2))
        return s, np.maximum.accumulate(self.frame(s)[0])

    def contact(self, x: float) -> float:
        """Return the contact at which the centre is above x; outside the roll its end."""
        s, centre = self.samples
        if x <= centre[0] or x >= centre[-1]:
            return self.start if x <= centre[0] else self.end
        if self.piece.straight:
            return x + self.R * sin(atan(self.piece.at(self.start)[1]))
        from scipy.optimize import brentq

        i = int(np.searchsorted(centre, x))

        def off(s: float) -> float:
            _, slope, _ = self.piece.at(s)
            return s - self.R * slope / sqrt(1 + slope**2) - x

        below, above = off(s[i - 1]), off(s[i])
        if below >= 0 or above <= 0:
            return float(s[i - 1] if below >= 0 else s[i])
        return float(brentq(off, s[i - 1], s[i], xtol=1e-15, rtol=1e-15))


@dataclass(frozen=True)
class Arc:
    """The disc pivots about the corner (x, z); its centre goes from above ``start`` to above ``end`` (m)."""

    x: float
    z: float
    R: float
    start: float
    end: float

    def frame(self, phi: np.ndarray) -> np.ndarray:
        """Return x, Z, dZ/dx and d2Z/dx2 of the centre for the angles phi from the vertical (rad), shape (4, n)."""
        s, c = np.sin(phi), np.cos(phi)
        return np.array([self.x + self.R * s, self.z + self.R * c, -s / c, -1 / (self.R * c**3)])


@dataclass(frozen=True)
class Run:
    """A chain of rolls joined by convex corners; the highest centre over any of its ground points is its ``height``."""

    rolls: tuple[Roll, ...]

    @property
    def R(self) -> float:
        """Radius of the disc, m."""
        return self.rolls[0].R

    @cached_property
    def joints(self) -> tuple[tuple[float, float], ...]:
        """The ground points between the rolls, and the first and the last one."""
        first = self.rolls[0]
        ends = [(roll.end, roll.piece.at(roll.end)[0]) for roll in self.rolls]
        return (first.start, first.piece.at(first.start)[0]), *ends

    @cached_property
    def nodes(self) -> np.ndarray:
        """The x of the centre where each roll starts and ends; between two rolls it pivots about a corner."""
        ends = [x for roll in self.rolls for x in (roll.samples[1][0], roll.samples[1][-1])]
        return np.maximum.accumulate(ends)

    @property
    def first(self) -> float:
        """Where the circle about the first ground point begins, m."""
        return self.joints[0][0] - self.R

    @property
    def last(self) -> float:
        """Where the circle about the last ground point ends, m."""
        return self.joints[-1][0] + self.R

    def height(self, x: float) -> float:
        """Return the highest centre at x over the points of this run, for first <= x <= last."""
        i, rolling = divmod(int(np.searchsorted(self.nodes, x)), 2)
        if rolling:
            roll = self.rolls[i]
            g, slope, _ = roll.piece.at(roll.contact(x))
            return g + self.R / sqrt(1 + slope**2)
        corner, g = self.joints[i]
        return g + sqrt(max(0.0, self.R**2 - (x - corner) ** 2))

    def between(self, start: float, end: float) -> list[Roll | Arc]:
        """Return what the disc does while its centre goes from above start to above end."""
        found: list[Roll | Arc] = []
        limits = np.concatenate([[-inf], self.nodes, [inf]])
        for i in range(limits.size - 1):
            lower, upper = max(limits[i], start), min(limits[i + 1], end)
            rolling = i % 2
            if upper <= lower or (not rolling and upper - lower <= SAME_ANGLE * self.R):
                continue
            if rolling:
                roll = self.rolls[i // 2]
                found.append(Roll(roll.piece, self.R, roll.contact(lower), roll.contact(upper)))
            elif abs(self.joints[i // 2][0]) < EDGE:
                found.append(Arc(*self.joints[i // 2], self.R, lower, upper))
        return found


@dataclass(frozen=True)
class Stretch:
    """A part of the path without a kink: one run, with its centre from above ``start`` to above ``end`` (m)."""

    run: Run
    start: float
    end: float


def stretches(profile: Profile, R: float) -> list[Stretch]:
    """Return the rolling path of a disc of radius *R* (m) over a profile, stretch by stretch; kinks lie between them.

    Raises ScenarioError where a vertical face as high as R or higher stops the disc or lets it fall.
    """
    stack: list[tuple[Run, float]] = []  # runs on the path so far, and the x from which each is the highest
    for run in runs(profile, R):
        while stack and stack[-1][1] >= run.first and run.height(stack[-1][1]) >= stack[-1][0].height(stack[-1][1]):
            stack.pop()
        stack.append((run, _crossing(stack[-1][0], stack[-1][1], run) if stack else -EDGE))
    ends = [start for _, start in stack[1:]] + [EDGE]
    for (before, _), (after, x) in pairwise(stack):
        if x == before.last:
            raise _too_high(R, before.last - R, before.joints[-1][1] - (after.height(x) - R), "drops")
    return [Stretch(run, start, end) for (run, start), end in zip(stack, ends, strict=True)]


def _crossing(before: Run, since: float, after: Run) -> float:
    """Return where *after* rises above *before*; the end of *before*, if it is still the higher one there."""
    from scipy.optimize import brentq

    def lead(x: float) -> float:
        return after.height(x) - before.height(x)

    lower, upper = max(since, after.first), min(before.last, after.last)
    if lead(lower) >= 0:
        raise _too_high(before.R, after.joints[0][0], after.joints[0][1] - (before.height(lower) - before.R), "rises")
    return before.last if lead(upper) < 0 else float(brentq(lead, lower, upper, xtol=1e-15, rtol=1e-15))


def _too_high(R: float, x: float, height: float, verb: str) -> ScenarioError:
    return ScenarioError(
        f"a wheel of radius R = {R:g} m cannot roll over x = {x:g} m, where the ground {verb} vertically by "
        f"{height:g} m; a step must be lower than R"
    )


def runs(profile: Profile, R: float) -> list[Run]:
    """Return the chains of ground the disc can touch, in the order of the ground."""
    chains: list[list[Roll]] = []
    for piece in profile.pieces:
        for start, end in _touchable(piece, R):
            roll = Roll(piece, R, start, end)
            if chains and _continues(chains[-1][-1], roll):
                chains[-1].append(roll)
            else:
                chains.append([roll])
    return [Run(tuple(chain)) for chain in chains]


def _continues(before: Roll, after: Roll) -> bool:
    """Whether two rolls meet at a convex corner or without one."""
    if before.end != after.start:
        return False
    (g_0, slope_0, _), (g_1, slope_1, _) = before.piece.at(before.end), after.piece.at(after.start)
    return abs(g_1 - g_0) <= SAME_HEIGHT and atan(slope_1) - atan(slope_0) <= SAME_ANGLE


def _touchable(piece: Piece, R: float) -> list[tuple[float, float]]:
    """Return the parts of a piece that are less hollow than the disc."""
    start, end = max(piece.start, -EDGE), min(piece.end, EDGE)
    if piece.straight:
        return [(start, end)]

    from scipy.optimize import brentq, minimize_scalar

    def room(s: np.ndarray) -> np.ndarray:
        _, slope, second = piece.jet(s)
        return 1 - R * second / (1 + slope**2) ** 1.5 - _TIGHT

    def room_at(s: float) -> float:
        return float(room(np.array([s]))[0])

    s = np.linspace(start, end, 1 + max(8, ceil((end - start) / min(piece.resolution, R / 20))))
    m = room(s)
    dips = 1 + np.flatnonzero((m[1:-1] <= m[:-2]) & (m[1:-1] <= m[2:]) & (m[1:-1] > 0) & (m[1:-1] < _NEARLY_TIGHT))
    s = np.union1d(s, [minimize_scalar(room_at, bounds=(s[i - 1], s[i + 1]), method="bounded").x for i in dips])
    free = room(s) > 0
    turns = np.flatnonzero(free[1:] != free[:-1])
    ends = [float(brentq(room_at, s[i], s[i + 1], xtol=1e-15, rtol=1e-15)) for i in turns]
    ends = ([start] if free[0] else []) + ends + ([end] if free[-1] else [])
    return [(a, b) for a, b in zip(ends[::2], ends[1::2], strict=True) if b > a]
