"""The rows of forces and motion: normal forces, jerks with the forces frozen, payload, speed, chassis."""

from __future__ import annotations

import numpy as np

from plants.tables import G

from .metric import FRONT, REAR, Metric, Signals, rms_over_time


def figures(time: np.ndarray, read: Signals, obstacle: float | None = None) -> list[Metric]:
    """Return the rows of a run."""
    return [*_forces(time, read), *_motion(time, read), *_chassis(time, read)]


def _forces(time: np.ndarray, read: Signals) -> list[Metric]:
    F = read("wheels.normal_force")
    rows = []
    for name, axle in (("front", FRONT), ("rear", REAR)):
        sums = None if F is None else F[:, axle].sum(axis=1)
        peak = None if sums is None else float(np.max(sums))
        rows.append(Metric(f"{name}_normal_peak", f"peak normal force, {name} axle", "N", "lower", peak))
        rows.append(Metric(f"{name}_normal_rms", f"RMS normal force, {name} axle", "N", "lower",
                           None if sums is None else rms_over_time(time, sums)))  # fmt: skip
    return rows


def _motion(time: np.ndarray, read: Signals) -> list[Metric]:
    rows = []
    for kind in ("body", "inertial", "thesis"):
        jerk = read(f"body.jerk_{kind}")
        size = None if jerk is None else (np.abs(jerk) if jerk.ndim == 1 else np.linalg.norm(jerk, axis=1))
        rows.append(Metric(f"jerk_{kind}_rms", f"RMS jerk, {kind} definition, forces frozen", "m/s3", "lower",
                           None if size is None else rms_over_time(time, size)))  # fmt: skip
    a, q, v = read("body.acceleration"), read("body.orientation"), read("body.velocity_body")
    margin = None
    if a is not None and q is not None:
        up = 1 - 2 * (q[:, 1] ** 2 + q[:, 2] ** 2)  # body z axis against world z
        margin = float(np.min(a[:, 2] + G * up) / G)
    label = "payload lift-off margin (specific force / g, below 0 it lifts)"
    rows.append(Metric("liftoff_margin", label, "1", "higher", margin))
    for key, label, pick in (
        ("speed_min", "lowest forward speed", np.min),
        ("speed_max", "highest forward speed", np.max),
    ):
        rows.append(Metric(key, label, "m/s", "", None if v is None else float(pick(v[:, 0]))))
    lost = None if v is None else float(v[0, 0] - v[-1, 0])
    rows.append(Metric("speed_lost", "forward speed lost", "m/s", "", lost))
    return rows


def _chassis(time: np.ndarray, read: Signals) -> list[Metric]:
    a = read("chassis.acceleration")
    peak = None if a is None else float(np.max(np.abs(a)) / G)
    rms = None if a is None else max(rms_over_time(time, column) for column in a.T) / G
    return [
        Metric("station_peak", "largest station acceleration, all modes of the model", "g", "lower", peak),
        Metric("station_rms", "largest station RMS acceleration", "g", "lower", rms),
    ]
