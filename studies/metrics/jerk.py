"""The jerk rows of the verdict: normal jerk by its three definitions, traction held or all forces changing.

Along the body's z axis, from the recorded acceleration alone, as difference quotients over 10 ms:

    true     body a_z',   inertial a_z' - omega a_x,   thesis a_z' + v_x alpha + omega v_x'
    held     the same with a_z' - G F_a' in place of a_z'

G F_a' is what a change of the tractions adds to a_z while the normal forces follow it, P dF_n + U dF_a = 0: "held" is
the jerk that a law sees which takes its own force for constant.  The robot counts as seen from the side: means of each
axle.  RMS are taken over the time in which a wheel is on the obstacle.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from plants.tables import G as GRAVITY

from .metric import Metric, Signals

WINDOW = 0.01  # s, of the difference quotients
KINDS = ("body", "inertial", "thesis")
_LEVEL = 1e-6  # rad and 1/m: below them a wheel is on level ground
_NEEDED = (
    "acceleration", "angular_acceleration", "orientation", "velocity_body", "rate", "axle_force", "contact_normal",
    "traction_direction", "P", "U", "slope", "curvature",
)  # fmt: skip


@dataclass(frozen=True)
class NormalJerk:
    """Normal jerk over a run, each array (n,), m/s3, by definition: body, inertial, thesis."""

    true: dict[str, np.ndarray]
    held: dict[str, np.ndarray]
    crossing: np.ndarray  # (n,) whether a wheel is on the obstacle


def normal_jerk(time: np.ndarray, read: Signals) -> NormalJerk | None:
    """Return the jerks at the communication points *time* (n,), s, or None if a signal is missing or the run is short.

    Within half a window of either end of the run the quotient is taken one-sided.
    """
    body = {name: read(f"body.{name}") for name in _NEEDED}
    traction = read("wheels.traction")
    if any(v is None for v in body.values()) or traction is None or time[-1] - time[0] <= WINDOW:
        return None
    found = {name: v for name, v in body.items() if v is not None}
    a, omega, v = found["acceleration"], found["rate"][:, 1], found["velocity_body"]
    gain = _gain(found)
    forces = np.column_stack([traction[:, :2].sum(axis=1), traction[:, 2:].sum(axis=1)])
    by_force = np.sum((gain[1:] + gain[:-1]) / 2 * np.diff(forces, axis=0), axis=1)
    held = np.concatenate([[0.0], np.cumsum(np.diff(a[:, 2]) - by_force)])
    turning = {
        "body": 0.0,
        "inertial": -omega * a[:, 0],
        "thesis": v[:, 0] * found["angular_acceleration"][:, 1] + omega * (a[:, 0] - omega * v[:, 2]),
    }
    on = (np.abs(found["slope"]) > _LEVEL) | (np.abs(found["curvature"]) > _LEVEL)
    quotients = [_quotient(time, values) for values in (a[:, 2], held)]
    true, frozen = ({name: q + more for name, more in turning.items()} for q in quotients)
    return NormalJerk(true, frozen, np.any(on, axis=1))


def _quotient(time: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return the difference quotients of *values* over the window about each time."""
    low, high = np.maximum(time - WINDOW / 2, time[0]), np.minimum(time + WINDOW / 2, time[-1])
    return (np.interp(high, time, values) - np.interp(low, time, values)) / (high - low)


def _gain(body: dict[str, np.ndarray]) -> np.ndarray:
    """Return d(a_z)/dF_a of front and rear axle (n, 2), 1/kg, with the normal forces following."""
    q = body["orientation"]
    down = _third_row(q)  # world z in body axes
    push = body["axle_force"].sum(axis=1)
    felt = body["acceleration"] + GRAVITY * down
    mass = np.sum(push * felt) / np.sum(felt * felt)  # the forces on the wheels are all there are
    n_z, A_z = (
        _axles(np.einsum("nwi,ni->nw", body[name], _body_z(q))) for name in ("contact_normal", "traction_direction")
    )
    P, U = _axle_form(body["P"]), _axle_form(body["U"])
    follow = -np.linalg.solve(P, U)  # (n, normal force, traction)
    return (A_z + np.einsum("ni,nij->nj", n_z, follow)) / mass


def _axles(v: np.ndarray) -> np.ndarray:
    return np.column_stack([v[:, :2].mean(axis=1), v[:, 2:].mean(axis=1)])


def _axle_form(M: np.ndarray) -> np.ndarray:
    """Return (n, 2, 2) for (n, 4, 4): means over an axle's rows, for a force that its wheels share equally."""
    return M.reshape(-1, 2, 2, 2, 2).mean(axis=(2, 4))


def _third_row(q: np.ndarray) -> np.ndarray:
    """Return the world's z axis in body axes, (n, 3)."""
    w, x, y, z = q.T
    return np.column_stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)])


def _body_z(q: np.ndarray) -> np.ndarray:
    """Return the body's z axis in the world, (n, 3)."""
    w, x, y, z = q.T
    return np.column_stack([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)])


def rms(time: np.ndarray, values: np.ndarray, where: np.ndarray) -> float | None:
    """Return the root mean square over the steps that end *where* (n,) is true, None if there are none."""
    weight = np.diff(time) * where[1:]
    return float(np.sqrt(np.sum(values[1:] ** 2 * weight) / np.sum(weight))) if np.any(weight > 0) else None


def figures(time: np.ndarray, read: Signals, obstacle: float | None = None) -> list[Metric]:
    """Return the rows of a run; their values are None where a signal is missing."""
    jerk, free = normal_jerk(time, read), read("controller.unlimited")
    rows: list[Metric] = []
    for kind in KINDS:
        for key, label in (("held", "traction held"), ("true", "forces changing")):
            value = None if jerk is None else rms(time, getattr(jerk, key)[kind], jerk.crossing)
            what = f"RMS normal jerk on the obstacle, {kind}, {label}"
            rows.append(Metric(f"jerk_{key}_{kind}", what, "m/s3", "lower", value))
    if jerk is not None and free is not None:
        acts = jerk.crossing & (np.ravel(free) > 0.5)
        ideal = {kind: rms(time, values, acts) for kind, values in jerk.held.items()}
        crossing = np.sum(np.diff(time) * jerk.crossing[1:])
        limited = 100 * (1 - float(np.sum(np.diff(time) * acts[1:]) / crossing)) if crossing > 0 else None
    else:
        ideal, limited = dict.fromkeys(KINDS), None
    for kind, value in ideal.items():
        label = f"RMS normal jerk while the ideal force acts, {kind}, traction held"
        rows.append(Metric(f"jerk_ideal_{kind}", label, "m/s3", "lower", value))
    rows.append(Metric("law_limited", "time on the obstacle without the ideal force", "%", "lower", limited))
    return rows
