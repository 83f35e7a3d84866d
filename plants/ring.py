"""A wheel as a rim and a rubber ring of nodes: the forces inside it, for one node and for one wheel.

A node at d from the hub, in body axes, is held by the rim, which has turned by psi (e_r, e_t, e_y turn with it):

    f = -(k_r (d_r - R) + c_r d_r') e_r - (k_t d_t + c_t d_t') e_t - (k_t d_y + c_t d_y') e_y        (all times l)

and by its neighbours, with D_i = d_i+1 - d_i and s_i = (D_i-1 x D_i)_y / l^2, the sine of its turn:

    E = sum EA l / 2 (|D_i| / l - 1)^2 + EI / (2 l) (s_i - sin(2 pi / N))^2                    f = -dE/dd

l = 2 R sin(pi/N) is the distance of the nodes; k_r, c_r, ... are per length of ring.  Whatever pulls a node pulls the
hub back, with -f and the moment -d x f, whose part about the axle turns the rim: momentum is kept to rounding.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import cos, pi, sin
from typing import Any

import casadi as ca
import numpy as np

# what a ring is made of, in the order in which the functions below take it
MATERIAL = ("R", "ring_mass", "k_radial", "k_tangential", "c_radial", "c_tangential", "EA", "EI")
CONTACT = ("k_contact", "k_bristle", "mu_s", "mu_d", "v_slip")
UNLIMITED = 1e6  # friction coefficient that stands for none
_SMALL = 1e-12  # m, keeps a ring finite whose nodes are in one point, as they are before start values are set
FRAME = 20  # rotation (9, column by column), hub (3), its velocity (3), omega (3), turning of the rim, its angle


@dataclass(frozen=True)
class Share:
    """What one node has of a ring, from the values of MATERIAL; symbols or numbers."""

    length: Any  # m, to the next node
    mass: Any  # kg
    k: tuple[Any, Any, Any]  # N/m, radial, tangential, lateral
    c: tuple[Any, Any, Any]  # N.s/m
    stretch: Any  # N/m
    bend: Any  # N.m


def share(material: Any, nodes: int) -> Share:
    """Return what each of *nodes* nodes has of a ring."""
    R, mass, k_r, k_t, c_r, c_t, EA, EI = (material[i] for i in range(len(MATERIAL)))
    length = 2 * R * sin(pi / nodes)
    return Share(
        length, mass / nodes, (k_r * length, k_t * length, k_t * length), (c_r * length, c_t * length, c_t * length),
        EA / length, EI / length,
    )  # fmt: skip


@lru_cache(maxsize=16)
def held(nodes: int) -> ca.Function:
    """Return (x, v, around, frame, material) -> (d, f, f_c, energy): a node and the rim; f_c is the dampers' part.

    *x*, *v* (3,) in the world, *around* (2,) cosine and sine of where on the ring the node sits now; the rest in body
    axes.
    """
    x, v, around = ca.SX.sym("x", 3), ca.SX.sym("v", 3), ca.SX.sym("around", 2)
    frame, material = ca.SX.sym("frame", FRAME), ca.SX.sym("material", len(MATERIAL))
    turned, of = ca.reshape(frame[:9], 3, 3), share(material, nodes)
    omega = frame[15:18] + ca.vertcat(0, frame[18], 0)  # of the rim
    d = turned.T @ (x - frame[9:12])
    rate = turned.T @ (v - frame[12:15]) - ca.cross(omega, d)
    cosine, sine = around[0], around[1]
    axes: list[Any] = [ca.vertcat(sine, 0, cosine), ca.vertcat(cosine, 0, -sine), ca.vertcat(0, 1, 0)]
    off = [ca.dot(d, axes[0]) - material[0], ca.dot(d, axes[1]), d[1]]
    damped = -sum(of.c[i] * ca.dot(rate, axes[i]) * axes[i] for i in range(3))
    f = damped - sum(of.k[i] * off[i] * axes[i] for i in range(3))
    energy = sum(of.k[i] * off[i] ** 2 for i in range(3)) / 2
    return ca.Function("held", [x, v, around, frame, material], ca.cse([d, f, damped, energy]))


@lru_cache(maxsize=16)
def hinge(nodes: int) -> ca.Function:
    """Return (before, here, after, material) -> (f_before, f_here, f_after, energy): the ring between nodes.

    The places (2,) are x and z in body axes; the bending is that at *here*, the stretching that from *here* to *after*.
    """
    a, b, c = (ca.SX.sym(n, 2) for n in ("a", "b", "c"))
    material = ca.SX.sym("material", len(MATERIAL))
    of = share(material, nodes)
    back, on = b - a, c - b
    length = ca.sqrt(ca.sumsqr(on) + _SMALL**2)
    tension = of.stretch * (length - of.length) / length * on
    excess = (back[1] * on[0] - back[0] * on[1]) / of.length**2 - sin(2 * pi / nodes)
    moment = of.bend * excess / of.length**2
    by_back, by_on = moment * ca.vertcat(-on[1], on[0]), moment * ca.vertcat(back[1], -back[0])
    energy = (of.stretch * (length - of.length) ** 2 + of.bend * excess**2) / 2
    forces = [by_back, tension - by_back + by_on, -tension - by_on]
    return ca.Function("hinge", [a, b, c, material], ca.cse([*forces, energy]))


def around(nodes: int) -> np.ndarray:
    """Return cosine and sine (2, nodes) of where on the ring the nodes sit; from the top towards the front."""
    angle = 2 * pi * np.arange(nodes) / nodes
    return np.array([np.cos(angle), np.sin(angle)])


def shifted(rows: Any, by: int) -> Any:
    """Return the columns of the nodes *by* further round the ring, at the place of each node."""
    n = rows.shape[1]
    return rows[:, [(i + by) % n for i in range(n)]]


def crossed(a: Any, b: Any) -> Any:
    """Return the cross products of the columns (3, n)."""
    return ca.vertcat(a[1, :] * b[2, :] - a[2, :] * b[1, :], a[2, :] * b[0, :] - a[0, :] * b[2, :],
                      a[0, :] * b[1, :] - a[1, :] * b[0, :])  # fmt: skip


def between(nodes: int, at: float) -> np.ndarray:
    """Return the weights (4,) of the nodes -1, 0, 1, 2 in the point at the fraction *at* of the way from 0 to 1.

    They give back straight lines, and circles with the nodes on them: a ring of few nodes rolls like a round one.
    """
    step = 2 * pi / nodes
    angles = step * np.array([-1, 0, 1, 2])
    shapes = np.array([np.ones(4), angles, np.cos(angles), np.sin(angles)])
    return np.linalg.solve(shapes, np.array([1, at * step, cos(at * step), sin(at * step)]))
