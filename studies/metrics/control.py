"""The rows of control: what was asked for, what friction allowed, what it cost, how closely a reference was met."""

from __future__ import annotations

import numpy as np

from logs.parts import sliding

from .metric import Metric, Signals, held, unlimited
from .slip import motor_energy

_LOADED = 1.0  # N, below which a wheel's ratio of forces says nothing


def figures(time: np.ndarray, read: Signals, obstacle: float | None = None) -> list[Metric]:
    """Return the rows of a run; their values are None where a signal is missing."""
    demand = read("controller.traction_demand")
    asked = None if demand is None else float(np.max(np.abs(demand)))
    used, saturated, needed = _friction(time, read)
    return [
        Metric("demand_peak", "largest traction demand at a wheel", "N", "lower", asked),
        Metric("friction_used", "largest share of friction used", "1", "lower", used),
        Metric("friction_needed", "largest traction over normal force of a wheel", "1", "lower", needed),
        Metric("saturated", "time with a wheel at its friction limit", "%", "lower", saturated),
        Metric("actuator_energy", "actuator energy (sum of absolute work)", "J", "lower", _energy(time, read)),
        Metric("tracking_error", "RMS deformation error while the law is on", "mm", "lower", _tracking(read)),
    ]


def _friction(time: np.ndarray, read: Signals) -> tuple[float | None, float | None, float | None]:
    """Return the largest share of the friction, the time at its limit in percent, and the largest F_a / F_n.

    The first two are None where friction has no limit.
    """
    applied, limit, normal = read("wheels.traction"), read("wheels.friction_limit"), read("wheels.normal_force")
    slides = sliding(read)
    if applied is None or limit is None or normal is None or slides is None:
        return None, None, None
    needed = float(np.max(np.abs(applied) / np.where(normal > _LOADED, normal, np.inf)))
    if unlimited(limit, normal):
        return None, None, needed
    loaded = limit > 1e-9
    ratio = np.where(loaded, np.abs(applied) / np.where(loaded, limit, 1.0), 0.0)
    saturated = 100 * held(time, np.any(loaded & slides, axis=1)) / (time[-1] - time[0])
    return float(np.max(ratio)), saturated, needed


def _energy(time: np.ndarray, read: Signals) -> float | None:
    """Return the absolute work of the motors of a drive, or without one that of the tractions at the ground, in J."""
    motors = motor_energy(time, read)
    applied, speed = read("wheels.traction"), read("body.contact_velocity")
    if motors is not None or applied is None or speed is None:
        return motors
    power = np.sum(np.abs(applied * speed[:, :, 0]), axis=1)
    return float(np.sum(power[1:] * np.diff(time)))


def _tracking(read: Signals) -> float | None:
    """Return the RMS difference of gap and reference while the law is on, in mm."""
    reference, gap, active = read("controller.reference"), read("body.gap"), read("controller.active")
    if reference is None or gap is None or active is None or not np.any(active > 0.5):
        return None
    return 1e3 * float(np.sqrt(np.mean((gap - reference)[np.ravel(active) > 0.5] ** 2)))
