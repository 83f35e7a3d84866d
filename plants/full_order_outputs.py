"""Where the nodes of the rings are and what the ground does to each: outputs for whoever looks closer at a run."""

from __future__ import annotations

from typing import Any

import casadi as ca

from .full_order_ports import NAMES, WHEELS, packed, rows_of
from .ring import CONTACT, MATERIAL
from .ring_wheel import ring

RINGS = ("ring_nodes", "ring_normal", "ring_friction")


def rings_seen(s: Any, frame: Any) -> dict[str, Any]:
    """Return the outputs RINGS (nodes, 12), three columns per wheel; nothing where they are not asked for.

    The forces are those of the present: friction is what the bristles hold now.
    """
    if not s.seen:
        return dict.fromkeys(RINGS, ca.MX(0, 3 * len(NAMES)))
    of = [
        ring(s.nodes, s.points).forces(
            getattr(s, f"x_{NAMES[k]}").T, getattr(s, f"v_{NAMES[k]}").T, getattr(s, f"z_{NAMES[k]}").T, rows_of(s, k),
            frame[:, k], packed(s, MATERIAL), packed(s, CONTACT), 0) for k in WHEELS
    ]  # fmt: skip
    found = [[getattr(s, f"x_{name}") for name in NAMES], [o[2].T for o in of], [o[3].T for o in of]]
    return {name: ca.horzcat(*parts) for name, parts in zip(RINGS, found, strict=True)}
