"""What the chassis does, where the nodes of the rings are and what the ground does to each: for who looks closer."""

from __future__ import annotations

from math import pi
from typing import Any

import casadi as ca

from .full_order_ports import NAMES, WHEELS, packed, rows_of
from .ring import CONTACT, MATERIAL
from .ring_wheel import ring
from .tyre import wheel_slip

RINGS = ("ring_nodes", "ring_normal", "ring_friction")


def chassis_seen(s: Any, rate: Any) -> dict[str, Any]:
    """Return the outputs of the chassis, as those of `ChassisModal`; *rate* is one over the time since the step began.

    The acceleration is the mean over the step, as that of the body is: the forces inside a step are not constant.
    """
    return {
        "station_acceleration": s.station_shape @ ((s.modal_rate - s.modal_begun) * rate),
        "modal_displacement": s.modal_q,
        "strain_energy": ca.sumsqr(2 * pi * s.frequency * s.modal_q) / 2,
        "elastic_kinetic_energy": ca.sumsqr(s.modal_rate) / 2,
    }


def measured(s: Any, velocity: Any) -> dict[str, Any]:
    """Return slip ratio, slip angle and what they are measured against, as those of `WheelDrive`, by its definitions.

    *velocity* (4, 2) is that of the hubs along their headings, and to the left.
    """
    slip = wheel_slip(s.R * s.spin, velocity[:, 0], velocity[:, 1], s.v_min)
    return {
        "slip": slip.ratio, "slip_speed": slip.speed,
        "slip_angle": ca.atan2(velocity[:, 1], ca.sqrt(velocity[:, 0] ** 2 + s.v_min**2)),
    }  # fmt: skip


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
