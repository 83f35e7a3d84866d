"""The slip rows of the verdict: what spinning wheels lose, and how near each wheel comes to its friction ellipse."""

from __future__ import annotations

import numpy as np

from .metric import Metric, Signals, unlimited

_LOADED = 1.0  # N, below which a wheel's share of its friction says nothing


def motor_energy(time: np.ndarray, read: Signals) -> float | None:
    """Return the sum of the absolute work of the motors of a drive, in J; None without one or without its torques."""
    torque, spin = read("drive.torque"), read("drive.spin")
    if torque is None or spin is None or not np.any(torque):
        return None
    power = np.sum(np.abs(torque * spin), axis=1)
    return float(np.sum(power[1:] * np.diff(time)))


def figures(time: np.ndarray, read: Signals, obstacle: float | None = None) -> list[Metric]:
    """Return the rows of a run; their values are None where the run has no drive or no lateral force."""
    slip, lost = read("drive.slip"), read("drive.slip_energy")
    along, across, limit = read("wheels.traction"), read("wheels.lateral"), read("wheels.friction_limit")
    peak = None if slip is None else float(np.max(np.abs(slip)))
    used = side = None
    if along is not None and across is not None and limit is not None and np.any(across):
        loaded, normal = limit > _LOADED, read("wheels.normal_force")
        if normal is None or not unlimited(limit, normal):
            used = float(np.max(np.hypot(along, across)[loaded] / limit[loaded], initial=0.0))
        side = float(np.max(np.abs(across)))
    return [
        Metric("slip_peak", "largest slip ratio of a wheel", "1", "lower", peak),
        Metric("slip_loss", "energy lost in slip", "J", "lower", None if lost is None else float(lost[-1])),
        Metric("lateral_peak", "largest lateral force of a wheel", "N", "", side),
        Metric(
            "ellipse_used", "largest share of the friction ellipse used, traction and lateral force", "1", "lower", used
        ),
    ]
