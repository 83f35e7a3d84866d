"""Playing back traction forces computed before the run: the off-line scheme of the thesis (section 6.6)."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from cosim import Component, output, parameter, state, table
from cosim.errors import DeclarationError

_BEFORE = -1e9  # s
_LONGEST = 3.0  # usual spacings of a table: a wider one is a gap


class Playback(Component):
    """Asks for the traction that a table gives over time, whatever the robot does.

    Sampled: the table is read at the ticks of ``period`` and the demand held in between.  Rows t (s), F (4, N), dF/dt
    (4, N/s): from t on F grows with dF/dt until the next row.  It asks for nothing before ``t_start`` nor from
    ``t_end`` on.  Wheels in the order front-left, front-right, rear-left, rear-right.  `force_table` makes the rows.
    """

    period = parameter(1e-3, "s", "sample period")
    t_start = parameter(0.0, "s", "where the table begins")
    t_end = parameter(0.0, "s", "where the table ends")
    forces = table(9, "time | traction of each wheel in N | its slope in N/s")

    demand = state([0.0] * 4, "N", "traction demand held between samples", nominal=100.0)
    on = state(0.0, "1", "1 inside the table, else 0")

    traction_demand = output("N", "traction asked of each wheel, forward positive", shape=4)
    active = output("1", "1 inside the table, else 0")

    def lookups(s: Any) -> dict[str, Any]:
        return {"forces": s.time}

    def outputs(s: Any) -> dict[str, Any]:
        return {"traction_demand": s.demand, "active": s.on}

    def sync(s: Any) -> dict[str, Any]:
        on = ca.logic_and(s.time >= s.t_start, s.time < s.t_end)
        F = (s.forces[0, 1:5] + s.forces[0, 5:9] * (s.time - s.forces[0, 0])).T
        return {"demand": ca.if_else(on, F, ca.SX.zeros(4)), "on": on}


def force_table(
    time: np.ndarray, forces: np.ndarray, interpolation: str = "linear", largest_step: float | None = None
) -> dict[str, Any]:
    """Return ``forces``, ``t_start`` and ``t_end`` of `Playback` for samples (n,) in s and (n, 4) in N.

    *interpolation* ``linear`` joins the samples, ``held`` keeps each until the next.  Raises DeclarationError for times
    that do not ascend, values that are missing, and a gap: a step above *largest_step*, by default three times the
    median one.
    """
    if interpolation not in ("linear", "held"):
        raise DeclarationError(f"interpolation cannot be {interpolation!r}; it is 'linear' or 'held'")
    if len(time) < 2:
        raise DeclarationError(f"playback needs at least two rows, but has {len(time)}")
    missing = np.flatnonzero(~np.isfinite(np.column_stack([time, forces])).all(axis=1))
    if missing.size:
        raise DeclarationError(
            f"row {missing[0] + 1} (t = {time[missing[0]]:.9g} s) lacks a number; playback needs every force at every "
            "time"
        )
    steps = np.diff(time)
    if np.any(steps <= 0):
        i = int(np.argmax(steps <= 0))
        raise DeclarationError(f"time is {time[i + 1]:.9g} s after {time[i]:.9g} s, but must ascend")
    widest = int(np.argmax(steps))
    allowed = _LONGEST * float(np.median(steps)) if largest_step is None else largest_step
    if steps[widest] > allowed * (1 + 1e-9):
        raise DeclarationError(
            f"there is a gap from t = {time[widest]:.9g} s to {time[widest + 1]:.9g} s, wider than {allowed:.4g} s; "
            f"give the rows in between, or set largest_step = {steps[widest]:.4g} if nothing is missing"
        )
    slopes = np.diff(forces, axis=0) / steps[:, None] if interpolation == "linear" else np.zeros((len(steps), 4))
    rows = np.column_stack([time, forces, np.vstack([slopes, np.zeros(4)])])
    nothing = np.zeros((1, 9))
    nothing[0, 0] = min(_BEFORE, 2 * time[0])
    return {"forces": np.vstack([nothing, rows]), "t_start": float(time[0]), "t_end": float(time[-1])}
