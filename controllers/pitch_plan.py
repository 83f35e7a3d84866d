"""Planning the pitch of a robot whose front wheels climb an obstacle, rears on the level (thesis chapter 5).

With the absolute slope theta under the front wheels, nose-up pitch p and rear-wheel traction F,

    p'' = Phi F + Gamma p'^2 + Lambda + K theta' v_t                                                (5.11, B.1)

The last term is missing in print: kappa v_t^2 = theta' v_t of the front wheel centre, whose speed is not free but
v_t = L cos p p' / sin theta.  Appendix B is corrected here: Phi (cos p was lost), and Gamma without tau_1 and tau_2,
which treat the contact as a point of the body.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike

from cosim.errors import DeclarationError

Slope = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]  # t_n -> theta (rad), d(theta)/dt_n (rad)

# Quotients that are 0/0 at the ends of a manoeuvre are carried on to them from so far inside, by a cubic.  The ratio of
# inertia to gravity is of higher order (t^6 / t^6 on an even manoeuvre), so that rounding spoils it earlier.
_EDGE, _EDGE_OF_RATIO = 1e-4, 3e-3
_GRID = np.linspace(0, 1, 2001)


class Vehicle(Protocol):
    """What a plan needs to know of a robot: kg, kg.m2 and m."""

    @property
    def m(self) -> float: ...
    @property
    def I_y(self) -> float: ...
    @property
    def L_f(self) -> float: ...
    @property
    def L_r(self) -> float: ...
    @property
    def h(self) -> float: ...
    @property
    def R(self) -> float: ...


class Pitch(NamedTuple):
    """Planned pitch and its derivatives: rad and powers of the unit of time."""

    p: Any
    rate: Any
    acceleration: Any
    jerk: Any


class Coefficients(NamedTuple):
    """Of the pitch equation (5.11)."""

    Phi: np.ndarray  # 1/(kg.m)
    Gamma: np.ndarray  # 1
    Lambda: np.ndarray  # 1/s2
    K: np.ndarray  # 1/m


def planned_pitch(t: Any, beta: Any, T: Any = 1.0) -> Pitch:
    """Return the degree-7 plan from 0 to *beta* (rad) at the normalised time *t* in [0, 1]; NumPy and CasADi alike.

    Velocity, acceleration and jerk vanish at both ends (5.12).  The derivatives carry the factors 1/T that
    (5.13)-(5.15) leave out, and are factored so that they keep their digits where they vanish.
    """
    u = 1 - t
    return Pitch(
        beta * t**4 * (35 - t * (84 - t * (70 - t * 20))),
        beta * 140 * t**3 * u**3 / T,
        beta * 420 * t**2 * u**2 * (u - t) / T**2,
        beta * 840 * t * u * (1 - 5 * t * u) / T**3,
    )


def sine_slope(xi: float) -> Slope:
    """Return the slope of the thesis' obstacle: theta = xi sin(pi t_n), rad (5.18 with alpha = pi, delta = 0)."""

    def slope(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        near = np.minimum(t, 1 - t)  # sin(pi t) = sin(pi (1 - t)), to the last digit near t = 1 too
        return xi * np.sin(np.pi * near), xi * np.pi * np.cos(np.pi * t)

    return slope


def coefficients(vehicle: Vehicle, p: ArrayLike, theta: ArrayLike, arm: float, g: float = 9.81) -> Coefficients:
    """Return the coefficients of the pitch equation at pitch *p* and front slope *theta* (rad, absolute).

    *arm* is the distance of the traction below the wheel centre along the normal: the wheel radius, or 0 for the
    thesis' text.  With D = m^2 I_y det P (Delta of B.2).
    """
    m, I_y, L_f, L_r, h = vehicle.m, vehicle.I_y, vehicle.L_f, vehicle.L_r, vehicle.h
    L = L_f + L_r
    s, c, sp, cp = np.sin(theta), np.cos(theta), np.sin(p), np.cos(p)
    even = 2 * L_f * L * c**2 - 2 * h * L * c * s + L_r**2 - L_f**2  # delta_2 / cos^2 p = tau_3 / (cos p sin p)
    odd = 2 * L_f * L * c * s - 2 * h * L * s**2  # delta_3 / (cos p sin p) = -tau_5 / cos^2 p
    D = I_y * s**2 + m * (even * cp**2 + odd * cp * sp + (L_f**2 + h**2) * s**2)
    Rn1, Rn2 = L_r * cp - h * sp, h * np.sin(theta - np.asarray(p)) - L_f * np.cos(theta - np.asarray(p))
    return Coefficients(
        Phi=(L * s * (s * sp + c * cp) + arm * s**2) / D,
        Gamma=m * (even * cp * sp + odd / 2 - odd * cp**2) / D,
        Lambda=-m * g * s**2 * Rn1 / D,
        K=m * (c * Rn1 - Rn2) / D,
    )


@dataclass(frozen=True)
class PitchPlan:
    """A manoeuvre of the front wheels that pitches a robot from 0 to *beta* (rad) along the degree-7 plan.

    *slope* gives the absolute slope under the front wheels over the normalised time.  ``curvature = False`` leaves out
    the term K theta' v_t, as the thesis does.  ``traction_arm`` as in `RigidBody`.
    """

    vehicle: Vehicle
    beta: float
    slope: Slope
    curvature: bool = True
    traction_arm: str = "ground"
    g: float = 9.81

    @property
    def _arm(self) -> float:
        return self.vehicle.R if self.traction_arm == "ground" else 0.0

    def speed(self, t: ArrayLike) -> np.ndarray:
        """Return v_t of the front wheel centres at normalised times, times T: L cos p p' / sin theta, in m."""
        L = self.vehicle.L_f + self.vehicle.L_r

        def inside(t: np.ndarray) -> np.ndarray:
            plan, (theta, _) = planned_pitch(t, self.beta), self.slope(t)
            return L * np.cos(plan.p) * plan.rate / np.sin(theta)

        return _to_the_ends(inside, t)

    def _terms(self, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return A, B and Phi of F = (A / T^2 + B) / Phi, strictly inside the manoeuvre."""
        plan, (theta, turning) = planned_pitch(t, self.beta), self.slope(t)
        of = coefficients(self.vehicle, plan.p, theta, self._arm, self.g)
        inertia = plan.acceleration - of.Gamma * plan.rate**2
        if self.curvature:
            inertia = inertia - of.K * turning * self.speed(t)
        return inertia, -of.Lambda, of.Phi

    def gain(self, t: ArrayLike) -> np.ndarray:
        """Return Phi, the pitch acceleration per traction, at normalised times, 1/(kg.m)."""
        t = np.asarray(t, dtype=float)
        return coefficients(self.vehicle, planned_pitch(t, self.beta).p, self.slope(t)[0], self._arm, self.g).Phi

    def force(self, t: ArrayLike, T: float) -> np.ndarray:
        """Return the rear-wheel traction F, in N, at normalised times of a manoeuvre that takes *T* s (5.17).

        Phi and all else vanish at the ends of a slope that begins and ends at 0: there F is the limit of the quotient.
        """

        def inside(t: np.ndarray) -> np.ndarray:
            A, B, Phi = self._terms(t)
            return (A / T**2 + B) / Phi

        return _to_the_ends(inside, t)

    def normal_forces(self, t: ArrayLike, T: float) -> tuple[np.ndarray, np.ndarray]:
        """Return the normal forces of the rear and of the front axle, in N; negative: it would have to pull.

        From the vertical balance m (z'' + g) = F_n1 + F_n2 cos theta and the moments about the centre of mass.
        """
        v = self.vehicle
        t = np.asarray(t, dtype=float)
        p, rate, acceleration, _ = planned_pitch(t, self.beta, T)
        theta, F = self.slope(t)[0], self.force(t, T)
        sp, cp = np.sin(p), np.cos(p)
        Rn1, Rn2 = v.L_r * cp - v.h * sp, v.h * np.sin(theta - p) - v.L_f * np.cos(theta - p)
        Ra1 = -(v.h * cp + v.L_r * sp) - self._arm
        weight = v.m * (self.g + Rn1 * acceleration - (v.L_r * sp + v.h * cp) * rate**2)
        front = (Ra1 * F + Rn1 * weight + v.I_y * acceleration) / (Rn1 * np.cos(theta) - Rn2)
        return weight - front * np.cos(theta), front

    def shortest_time(self) -> float:
        """Return the least manoeuvre time, in s, in which the traction F / Phi never changes its sign: no braking.

        F = (A / T^2 + B) / Phi with B >= 0, so T^2 is the largest -A / B, limits at both ends included.  Raises
        DeclarationError if there is none, as where A vanishes more slowly than B.
        """

        def needed(t: np.ndarray) -> np.ndarray:
            A, B, _ = self._terms(t)
            return -A / B

        edge = _EDGE_OF_RATIO
        ends = needed(np.array([edge, 2 * edge, 1 - 2 * edge, 1 - edge]))
        for at, beside, name in ((ends[0], ends[1], "start"), (ends[3], ends[2], "end")):
            if at > 1.5 * abs(beside):  # a limit of order 1/t or worse at least doubles
                raise DeclarationError(
                    f"no manoeuvre of beta = {self.beta:g} rad over this slope is without braking: at its {name} the "
                    "traction that inertia asks for vanishes more slowly than that against gravity"
                )
        squares = _to_the_ends(needed, _GRID, edge)
        i = int(np.argmax(squares))
        best = float(squares[i])
        if 0 < i < _GRID.size - 1:
            from scipy.optimize import minimize_scalar

            found = minimize_scalar(
                lambda t: -float(needed(np.array(t))), bounds=(_GRID[i - 1], _GRID[i + 1]), method="bounded"
            )
            best = max(best, -float(found.fun))
        return float(np.sqrt(max(best, 0.0)))

    def friction_needed(self, T: float) -> float:
        """Return the largest share F / F_n of the rear axle; infinite if an axle would have to pull."""
        rear, front = self.normal_forces(_GRID, T)
        if np.min(rear) <= 0 or np.min(front) < -1e-9 * self.vehicle.m * self.g:
            return np.inf
        return float(np.max(np.abs(self.force(_GRID, T)) / rear))

    def time_for_friction(self, mu: float, least: float = 0.0) -> float:
        """Return the shortest manoeuvre, in s, not below *least*, whose traction friction *mu* can transmit.

        Raises DeclarationError if even a slow one needs more: then no manoeuvre time helps.
        """
        slow = max(least, 1e-2)
        while self.friction_needed(slow) > mu:
            slow *= 2
            if slow > 1e4:
                raise DeclarationError(
                    f"the manoeuvre of beta = {self.beta:g} rad needs a friction coefficient of "
                    f"{self.friction_needed(slow):.3g} however slow it is, but mu is {mu:g}; take a gentler slope"
                )
        fast = max(least, slow / 2)
        if slow <= max(least, 1e-2) or self.friction_needed(fast) <= mu:
            return fast if self.friction_needed(fast) <= mu else slow
        for _ in range(60):  # by halving: the share jumps to infinity where an axle lifts
            middle = (fast + slow) / 2
            fast, slow = (fast, middle) if self.friction_needed(middle) <= mu else (middle, slow)
        return slow


def _to_the_ends(inside: Callable[[np.ndarray], np.ndarray], t: ArrayLike, edge: float = _EDGE) -> np.ndarray:
    """Evaluate a function of [0, 1] that is 0/0 at its ends; nearer to them than *edge*, carry it on by a cubic."""
    t = np.asarray(t, dtype=float)
    value = np.array(inside(np.clip(t, edge, 1 - edge)))
    steps = np.arange(1.0, 5.0)
    for side in (0, 1):
        from_end = np.abs(t - side) / edge
        if np.any(from_end < 1):
            cubic = np.polynomial.Polynomial.fit(steps, inside(np.abs(side - edge * steps)), 3)
            value = np.where(from_end < 1, cubic(from_end), value)
    return value


def shortest_time_on_a_sine(vehicle: Vehicle, beta: float, xi: float, g: float = 9.81) -> float:
    """Return the shortest time without braking for theta = xi sin(pi t_n), without the curvature term, in s.

    The limit t_n -> 1 in closed form: T^2 = 420 beta (L cos beta)^2 / (g (pi xi)^2 (L_r cos beta - h sin beta)).  Mass,
    moment of inertia and wheel radius do not matter.
    """
    L = vehicle.L_f + vehicle.L_r
    lever = vehicle.L_r * np.cos(beta) - vehicle.h * np.sin(beta)
    return float(np.sqrt(420 * beta * (L * np.cos(beta)) ** 2 / (g * (np.pi * xi) ** 2 * lever)))


def pitch_for_time(T: float, shortest: Callable[[float], float], most: float = 0.5) -> float:
    """Return the pitch beta (rad) up to *most* for which the *shortest* time of a manoeuvre, as a function of it, is T.

    Raises DeclarationError if none is.
    """
    from scipy.optimize import brentq

    low = 1e-6
    if not shortest(low) <= T <= shortest(most):
        raise DeclarationError(f"no pitch up to {most:g} rad has a shortest manoeuvre time of {T:g} s")
    return float(brentq(lambda beta: shortest(beta) - T, low, most, xtol=1e-12))
