"""A whole rubber ring between its rim and the ground: the functions of one node mapped over all of them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import casadi as ca

from .ring import CONTACT, FRAME, MATERIAL, around, crossed, held, hinge, share, shifted
from .ring_contact import COLUMNS, touch


@dataclass(frozen=True)
class Ring:
    """Functions of one wheel."""

    forces: ca.Function
    energies: ca.Function


@lru_cache(maxsize=16)
def ring(nodes: int, points: int) -> Ring:
    """Return the functions of a ring of *nodes* nodes that meets the ground at *points* points.

    forces: (x, v, z, rows, frame, material, contact, dt) -> (f, f_c, f_n, f_t, z, hub, hub_c, sums): forces on the
    nodes (3, nodes), of the ring and the rim in body axes, of their dampers alone, and normal and tangential ones of
    the ground in the world; the bristles (2, points) at the end; force and moment of the ring on the hub (3, 2), and
    what of these is the dampers'; per wheel what `ring_contact.touch` sums up.
    energies: (x, v, z, rows, frame, material, contact) -> (energy of the ring, of its contact).
    """
    each = points // nodes
    shapes = {"x": (3, nodes), "v": (3, nodes), "z": (2, points), "rows": (COLUMNS, points), "frame": (FRAME, 1),
              "material": (len(MATERIAL), 1), "contact": (len(CONTACT), 1), "dt": (1, 1)}  # fmt: skip
    given: dict[str, Any] = {name: ca.MX.sym(name, *shape) for name, shape in shapes.items()}
    x, v, z, rows, frame, material, contact, dt = given.values()
    cell = share(material, nodes).length / each
    d, f, f_c, e_held = held(nodes).map("held_all", "serial", nodes, [3, 4], [])(
        x, v, _turned(frame[19]) @ ca.DM(around(nodes)), frame, material)  # fmt: skip
    plane = d[[0, 2], :]
    f_before, f_here, f_after, e_hinge = hinge(nodes).map("hinges", "serial", nodes, [3], [])(
        shifted(plane, -1), plane, shifted(plane, 1), material)  # fmt: skip
    bent = shifted(f_before, 1) + f_here + shifted(f_after, -1)
    f = f + ca.vertcat(bent[0, :], ca.MX.zeros(1, nodes), bent[1, :])
    met = touch(nodes, each).map("touches", "serial", nodes, [4, 5, 6], [])(
        _four(x), _four(v), rows, z, contact, cell, dt)  # fmt: skip
    hub, hub_c = (ca.horzcat(-ca.sum2(g), -ca.sum2(crossed(d, g))) for g in (f, f_c))
    forces = ca.Function("ring", list(given.values()),
                         [f, f_c, _gathered(met[0], nodes), _gathered(met[1], nodes), met[2], hub, hub_c,
                          ca.sum2(met[3])],
                         ["x", "v", "z", "rows", "frame", "material", "contact", "dt"],
                         ["f", "f_c", "f_n", "f_t", "z_end", "hub", "hub_c", "sums"])  # fmt: skip
    stored: Any = [ca.sum2(e_held) + ca.sum2(e_hinge), ca.sum2(met[3])[3] + cell * contact[1] * ca.sumsqr(z) / 2]
    bare = ca.Function("ring_energies", list(given.values()), stored)
    at_rest: Any = [*list(given.values())[:-1], 0]
    return Ring(forces, ca.Function("energies", list(given.values())[:-1], bare.call(at_rest)))


def _turned(angle: Any) -> Any:
    """Return the matrix (2, 2) that turns cosines and sines of nodes by *angle*: once per ring, not once per node."""
    c, s = ca.cos(angle), ca.sin(angle)
    return ca.blockcat([[c, -s], [s, c]])


def _four(columns: Any) -> Any:
    """Return for each node the columns of the nodes -1, 0, 1 and 2 from it, side by side."""
    n = columns.shape[1]
    return columns[:, [(i + by) % n for i in range(n) for by in (-1, 0, 1, 2)]]


def _gathered(columns: Any, nodes: int) -> Any:
    """Return the sums (3, nodes) of what the stretches do to the nodes -1, 0, 1 and 2 from their own."""
    by = [columns[:, [4 * ((i - at) % nodes) + j for i in range(nodes)]] for j, at in enumerate((-1, 0, 1, 2))]
    return by[0] + by[1] + by[2] + by[3]
