"""The contact rows: time off the ground, time without force, and rebounds, from the first touch of the obstacle on.

A chassis without suspension standing on three wheels is counted apart.
"""

from __future__ import annotations

import numpy as np

from .metric import FRONT, REAR, Metric, Signals, held


def after_impact(read: Signals, obstacle: float | None) -> np.ndarray | None:
    """Return (n,): whether any wheel has touched the obstacle by each communication point."""
    centre, slope, contact = read("body.wheel_centre"), read("body.slope"), read("wheels.contact")
    if contact is None:
        return None
    if centre is None or slope is None:
        return np.ones(len(contact), bool)
    beyond = np.abs(slope) > 1e-9
    if obstacle is not None:
        beyond |= centre[:, :, 0] >= obstacle
    return np.logical_or.accumulate(np.any(beyond & (contact > 0.5), axis=1))


def figures(time: np.ndarray, read: Signals, obstacle: float | None = None) -> list[Metric]:
    """Time off the ground (the gap is open), time without force (a damped wheel may still be pressed), and rebounds."""
    contact, gap, met = read("wheels.contact"), read("wheels.deformation"), after_impact(read, obstacle)
    found = {}
    if contact is not None and gap is not None and met is not None:
        unloaded = contact < 0.5
        off = unloaded & (gap >= 0)
        for name, axle in (("front", FRONT), ("rear", REAR)):
            found[f"{name}_off"] = 1e3 * held(time, np.any(off[:, axle], axis=1) & met)
            left = np.any(~off[:-1, axle] & off[1:, axle], axis=1)
            found[f"{name}_rebounds"] = float(np.count_nonzero(left & met[1:]))
            found[f"{name}_unloaded"] = 1e3 * held(time, np.any(unloaded[:, axle], axis=1) & met)
        count = np.count_nonzero(~off, axis=1)
        found["three_wheels"], found["airborne"] = 1e3 * held(time, count == 3), 1e3 * held(time, count == 0)
    labels = (
        ("front_off", "front wheels since the impact: off the ground", "ms"),
        ("front_rebounds", "front wheels since the impact: rebounds", "1"),
        ("front_unloaded", "front wheels since the impact: without force", "ms"),
        ("rear_off", "rear wheels since the impact: off the ground", "ms"),
        ("rear_rebounds", "rear wheels since the impact: rebounds", "1"),
        ("rear_unloaded", "rear wheels since the impact: without force", "ms"),
        ("three_wheels", "standing on three wheels", "ms"),
        ("airborne", "all four wheels off the ground", "ms"),
    )
    return [Metric(key, label, unit, "lower", found.get(key)) for key, label, unit in labels]
