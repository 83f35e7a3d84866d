"""When does an axle leave the ground?  By traction, by speed over a crest, by the impact of the other axle.

Closed forms on the planar model of `planar`; the slope at which the front axle unloads by itself (figure 4.4) is
`Bicycle.contact_loss_slope`.  Axles in the thesis' order (rear, front).
"""

from __future__ import annotations

import numpy as np

from .planar import Bicycle, Posture


def traction_at_loss(
    bicycle: Bicycle, at: Posture, twist: np.ndarray, drive: np.ndarray, axle: int = 1
) -> float | None:
    """Return the traction, in N, above which an axle (1: front) would have to be pulled down, or None if none does it.

    *drive* (2,) says how the axles share the traction, *twist* (v_x, v_z, omega_y) how the body moves.  Contact forces
    are affine in the traction (figure 4.5); friction does not limit it here.
    """
    idle = bicycle.contact_forces(at, twist, np.zeros(2))[axle]
    gained = bicycle.contact_forces(at, twist, drive)[axle] - idle
    return float(-idle / gained) if gained < 0 else None


def speed_at_loss(bicycle: Bicycle, at: Posture) -> np.ndarray:
    """Return the forward speed (2,) in m/s above which each axle leaves the ground it rolls on; infinite where none is.

    Without traction.  The twist of a rolling robot is proportional to its speed and b holds its squares, so the contact
    forces are F(0) + v^2 (F(1) - F(0)).
    """
    still, rolling = (bicycle.contact_forces(at, bicycle.climbing_twist(at, v), np.zeros(2)) for v in (0.0, 1.0))
    lost = still - rolling
    return np.where(lost > 0, np.sqrt(np.maximum(0, still) / np.where(lost > 0, lost, 1)), np.inf)


def impact(bicycle: Bicycle, at: Posture, rate: np.ndarray, e: float = 0.0, *, bilateral: bool = False) -> np.ndarray:
    """Return the normal impulses (2,), in N.s, of an impact with the gap rates *rate* (2,) before it, in m/s.

    0 <= Lam _|_ P Lam + (1 + e) v >= 0, in place of the undetermined change of rate in (8.3)-(8.11).  *bilateral*: as
    if the ground could pull, so that the sign says which axle it would have to hold.  The other axle of a front impact
    takes -(P_12 / P_11) Lam_f: m L_f L_r = I_y makes the rear axle the centre of percussion on the flat.
    """
    P, q = bicycle.P(at), (1 + e) * np.asarray(rate, dtype=float)
    both = -np.linalg.solve(P, q)
    if bilateral or np.all(both >= 0):
        return both
    alone = np.maximum(0, -q / np.diag(P))  # each axle by itself
    only = np.diag(alone)
    fits = [axle for axle in (0, 1) if alone[axle] > 0 and (P @ only[axle] + q)[1 - axle] >= 0]
    return only[fits[0]] if fits else np.zeros(2)
