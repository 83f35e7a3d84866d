"""A rubber ring on the ground: penalty contact of many points, each with Coulomb friction on a bristle.

A point of the ring at a distance d < 0 from the ground, moving along it with u (2,), has

    F_n = max(0, -k_c d)
    mu(u) = mu_d + (mu_s - mu_d) exp(-|u| / v_slip)                     smooth from static to dynamic friction
    F_t = -k_b z,   z = w min(1, mu F_n / |k_b w|),  w = z- + u dt      it sticks until mu F_n, then slides

k_c, k_b are per length of ring.  So a point sinks in by F_n / k_c at most: a penetration that is part of the
deformation of a calibrated wheel.  The transition is the one of LS-DYNA's contacts (decay 1 / v_slip).

The ground under a point is min(A, max(B, C)) of three signed distances to parabolas: at a concave corner the solid
is the union of its two sides, at a convex one their intersection, and at a step there is one of each.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np

from .ring import CONTACT, between

COLUMNS = 13  # x_start | xa, a0..a2 | xb, b0..b2 | xc, c0..c2
SUMS = 5  # normal force, force along, force to the left, energy of the penalty, normal force of what slides
_SMALL = 1e-12  # keeps roots differentiable at zero


def _distance(face: Any, x: Any, z: Any) -> tuple[Any, Any]:
    """Return signed distance (m) of a point from a parabola and the slope of that there."""
    u = x - face[0]
    slope = face[2] + 2 * face[3] * u
    return (z - face[1] - (face[2] + face[3] * u) * u) / ca.sqrt(1 + slope**2), slope


def _ground(row: Any, x: Any, z: Any) -> tuple[Any, Any]:
    """Return distance and slope of the ground under a point."""
    (a, ra), (b, rb), (c, rc) = (_distance(row[i : i + 4], x, z) for i in (1, 5, 9))
    bc, rbc = ca.fmax(b, c), ca.if_else(b > c, rb, rc)
    return ca.fmin(a, bc), ca.if_else(a < bc, ra, rbc)


def _top(row: Any, x: Any) -> Any:
    """Return a height (m) that the ground under a point does not exceed."""

    def height(face: Any) -> Any:
        u = x - face[0]
        return face[1] + (face[2] + face[3] * u) * u

    return ca.fmax(height(row[1:5]), ca.fmin(height(row[5:9]), height(row[9:13])))


@lru_cache(maxsize=16)
def keys(nodes: int, points: int) -> ca.Function:
    """Return (x of the nodes -1, 0, 1, 2) -> x of the *points* between the nodes 0 and 1."""
    x = ca.SX.sym("x", 4)
    return ca.Function("keys", [x], [ca.vertcat(*(ca.dot(w, x) for w in _weights(nodes, points)))])


def _weights(nodes: int, points: int) -> list[np.ndarray]:
    return [between(nodes, m / points) for m in range(points)]


@lru_cache(maxsize=16)
def touch(nodes: int, points: int) -> ca.Function:
    """Return the contact of the stretch between two nodes, which has *points* points.

    (x, v, rows, z, contact, cell, dt) -> (f_n, f_t, z, sums): *x*, *v* (3, 4) are those of the nodes -1, 0, 1, 2 in the
    world, *rows* (13, points) the ground, *z* (2, points) the bristles, along and to the left, *contact* the values of
    CONTACT and *cell* (m) the length of ring that a point stands for.  f_n, f_t (3, 4) push the nodes.
    """
    arguments = _arguments(points)
    x, _, rows, *_ = arguments.values()
    near = 0
    for m, w in enumerate(_weights(nodes, points)):
        at = x @ w
        near = ca.logic_or(near, at[2] < _top(rows[:, m], at[0]))
    pressed = ca.Function("pressed", list(arguments.values()), ca.cse(list(_pressed(nodes, points, **arguments))))
    zeros = [ca.SX.zeros(*pressed.size_out(i)) for i in range(pressed.n_out())]
    free = ca.Function("free", list(arguments.values()), zeros)
    chosen = ca.Function.if_else("chosen", pressed, free)
    is_near = ca.Function("is_near", [x, rows], [near])
    given = [ca.MX.sym(n, a.shape) for n, a in arguments.items()]
    return ca.Function("touch", given, chosen.call([is_near(given[0], given[2]), *given]))


def _arguments(points: int) -> dict[str, Any]:
    shapes = {"x": (3, 4), "v": (3, 4), "rows": (COLUMNS, points), "z": (2, points), "contact": (len(CONTACT), 1),
              "cell": (1, 1), "dt": (1, 1)}  # fmt: skip
    return {name: ca.SX.sym(name, *shape) for name, shape in shapes.items()}


def _pressed(nodes: int, points: int, x: Any, v: Any, rows: Any, z: Any, contact: Any, cell: Any, dt: Any) -> tuple:
    k_c, k_b, mu_s, mu_d, v_slip = (contact[i] for i in range(len(CONTACT)))
    normal, tangential, moved = ca.SX.zeros(3, 4), ca.SX.zeros(3, 4), []
    sums = ca.SX.zeros(SUMS)
    for m, w in enumerate(_weights(nodes, points)):
        at, rate = x @ w, v @ w
        d, slope = _ground(rows[:, m], at[0], at[2])
        s = ca.sqrt(1 + slope**2)
        n, t = ca.vertcat(-slope / s, 0, 1 / s), ca.vertcat(1 / s, 0, slope / s)
        F = cell * k_c * ca.fmax(0, -d)
        u = ca.vertcat(ca.dot(t, rate), rate[1])
        mu = mu_d + (mu_s - mu_d) * ca.exp(-ca.sqrt(ca.sumsqr(u) + _SMALL) / v_slip)
        wish = z[:, m] + u * dt
        pull = cell * k_b * ca.sqrt(ca.sumsqr(wish) + _SMALL**2)
        new = wish * ca.fmin(1, mu * F / pull)
        f_t, f_l = -cell * k_b * new[0], -cell * k_b * new[1]
        normal += F * n @ ca.SX(w).T
        tangential += (f_t * t + ca.vertcat(0, f_l, 0)) @ ca.SX(w).T
        moved.append(new)
        sums += ca.vertcat(F, f_t, f_l, F * ca.fmax(0, -d) / 2, F * (mu * F < pull))
    return normal, tangential, ca.horzcat(*moved), sums
