"""The verdict on a run: what a robot designer compares controllers by, computed from the recorded ports.

Every figure states its unit and which direction is better.  Contacts are judged from the first touch of the obstacle
on; a chassis without suspension standing on three wheels is counted apart.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from plants.tables import G

FRONT, REAR = slice(0, 2), slice(2, 4)


@dataclass(frozen=True)
class Metric:
    """One row of the verdict table."""

    key: str
    label: str
    unit: str
    better: str  # "lower", "higher" or "" where neither is
    value: float | None  # None: the run has no such signal


Signals = Callable[[str], "np.ndarray | None"]


def verdict(time: np.ndarray, read: Signals, obstacle: float | None = None) -> list[Metric]:
    """Compute all metrics of a run.

    *time* (n,) in s; *read* returns a port's values (n, ...) by name, or None if the run has no such port; *obstacle*
    is the world x of a wheel centre where its path first leaves the level, in m: contacts count from the first touch
    there.
    """
    rows: list[Metric] = []
    rows += _contact(time, read, obstacle)
    rows += _forces(time, read)
    rows += _motion(time, read)
    rows += _chassis(time, read)
    rows += _control(time, read)
    return rows


def as_mapping(rows: list[Metric]) -> dict[str, float | None]:
    """Return key to value, for JSON and for the properties of a log."""
    return {row.key: row.value for row in rows}


def _rms(time: np.ndarray, values: np.ndarray) -> float:
    span = time[-1] - time[0]
    return float(np.sqrt(np.trapezoid(values**2, time) / span)) if span > 0 else float(np.abs(values[-1]))


def _held(time: np.ndarray, flags: np.ndarray) -> float:
    """Return for how long *flags* (n, at the end of each step) were true, in s."""
    return float(np.sum(np.diff(time)[np.asarray(flags, bool)[1:]]))


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


def _contact(time: np.ndarray, read: Signals, obstacle: float | None) -> list[Metric]:
    """Time off the ground (the gap is open), time without force (a damped wheel may still be pressed), and rebounds."""
    contact, gap, met = read("wheels.contact"), read("wheels.deformation"), after_impact(read, obstacle)
    found = {}
    if contact is not None and gap is not None and met is not None:
        unloaded = contact < 0.5
        off = unloaded & (gap >= 0)
        for name, axle in (("front", FRONT), ("rear", REAR)):
            found[f"{name}_off"] = 1e3 * _held(time, np.any(off[:, axle], axis=1) & met)
            left = np.any(~off[:-1, axle] & off[1:, axle], axis=1)
            found[f"{name}_rebounds"] = float(np.count_nonzero(left & met[1:]))
            found[f"{name}_unloaded"] = 1e3 * _held(time, np.any(unloaded[:, axle], axis=1) & met)
        count = np.count_nonzero(~off, axis=1)
        found["three_wheels"], found["airborne"] = 1e3 * _held(time, count == 3), 1e3 * _held(time, count == 0)
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


def _forces(time: np.ndarray, read: Signals) -> list[Metric]:
    F = read("wheels.normal_force")
    rows = []
    for name, axle in (("front", FRONT), ("rear", REAR)):
        sums = None if F is None else F[:, axle].sum(axis=1)
        peak = None if sums is None else float(np.max(sums))
        rows.append(Metric(f"{name}_normal_peak", f"peak normal force, {name} axle", "N", "lower", peak))
        rows.append(Metric(f"{name}_normal_rms", f"RMS normal force, {name} axle", "N", "lower",
                           None if sums is None else _rms(time, sums)))  # fmt: skip
    return rows


def _motion(time: np.ndarray, read: Signals) -> list[Metric]:
    rows = []
    for kind in ("body", "inertial", "thesis"):
        jerk = read(f"body.jerk_{kind}")
        size = None if jerk is None else (np.abs(jerk) if jerk.ndim == 1 else np.linalg.norm(jerk, axis=1))
        rows.append(Metric(f"jerk_{kind}_rms", f"RMS jerk, {kind} definition, forces frozen", "m/s3", "lower",
                           None if size is None else _rms(time, size)))  # fmt: skip
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
    return rows


def _chassis(time: np.ndarray, read: Signals) -> list[Metric]:
    a = read("chassis.acceleration")
    peak = None if a is None else float(np.max(np.abs(a)) / G)
    rms = None if a is None else max(_rms(time, column) for column in a.T) / G
    return [
        Metric("station_peak", "largest station acceleration, all modes of the model", "g", "lower", peak),
        Metric("station_rms", "largest station RMS acceleration", "g", "lower", rms),
    ]


def _control(time: np.ndarray, read: Signals) -> list[Metric]:
    demand, applied, limit = read("controller.traction_demand"), read("wheels.traction"), read("wheels.friction_limit")
    speed, reference, gap = read("body.contact_velocity"), read("controller.reference"), read("body.gap")
    active = read("controller.active")
    asked = None if demand is None else float(np.max(np.abs(demand)))
    used = saturated = energy = tracking = None
    if applied is not None and limit is not None:
        loaded = limit > 1e-9
        ratio = np.where(loaded, np.abs(applied) / np.where(loaded, limit, 1.0), 0.0)
        used = float(np.max(ratio))
        saturated = 100 * _held(time, np.any((ratio > 1 - 1e-6), axis=1)) / (time[-1] - time[0])
    if applied is not None and speed is not None:
        power = np.sum(np.abs(applied * speed[:, :, 0]), axis=1)
        energy = float(np.sum(power[1:] * np.diff(time)))
    if reference is not None and gap is not None and active is not None and np.any(active > 0.5):
        on = np.ravel(active) > 0.5
        tracking = 1e3 * float(np.sqrt(np.mean((gap - reference)[on] ** 2)))
    return [
        Metric("demand_peak", "largest traction demand at a wheel", "N", "lower", asked),
        Metric("friction_used", "largest share of friction used", "1", "lower", used),
        Metric("saturated", "time with a wheel at its friction limit", "%", "lower", saturated),
        Metric("actuator_energy", "actuator energy (sum of absolute work)", "J", "lower", energy),
        Metric("tracking_error", "RMS deformation error while the law is on", "mm", "lower", tracking),
    ]


def table(columns: Mapping[str, list[Metric]]) -> list[dict[str, Any]]:
    """Return the comparison as rows: key, label, unit, one value per variant, and which variants are best."""
    rows = []
    for i, first in enumerate(next(iter(columns.values()))):
        values = {variant: metrics[i].value for variant, metrics in columns.items()}
        known = [v for v in values.values() if v is not None]
        best: list[str] = []
        if first.better and len(known) > 1 and max(known) - min(known) > 1e-9 * max(abs(v) for v in known):
            target = min(known) if first.better == "lower" else max(known)
            best = [name for name, v in values.items() if v == target]
        rows.append({"key": first.key, "label": first.label, "unit": first.unit, "values": values, "best": best})
    return rows


def markdown(scenario: Any, rows: list[dict[str, Any]]) -> str:
    """Return the comparison as a Markdown document, for the log."""
    variants = list(rows[0]["values"])
    lines = [f"# {scenario.title}", "", scenario.claim, "", "| | unit | " + " | ".join(variants) + " |"]
    lines.append("| --- | --- |" + " ---: |" * len(variants))
    for row in rows:
        if any(v is not None for v in row["values"].values()):
            cells = [
                "-"
                if row["values"][v] is None
                else f"**{row['values'][v]:.4g}**"
                if v in row["best"]
                else f"{row['values'][v]:.4g}"
                for v in variants
            ]
            lines.append(f"| {row['label']} | {row['unit']} | " + " | ".join(cells) + " |")
    return "\n".join([*lines, "", "Bold: the best of its row."])
