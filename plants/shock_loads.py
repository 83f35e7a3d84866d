"""Which wheels a collision excites and how strongly (thesis chapter 8), and what that makes of each mode.

Wheels in the order front-left, front-right, rear-left, rear-right; the front-left one, at station 1, is struck.  The
thesis finds the reaction from the change of angular momentum (8.3 to 8.11) but gives neither that change nor, in the
diagonal case, the moment of inertia.  Two readings close it: no change at all, and a reacting wheel that keeps to the
ground (`rigid_reaction`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cosim.errors import ScenarioError, nearest

from .chassis_modes import ModalData
from .pulses import Pulse

# struck wheels and those that react
CASES: dict[str, tuple[tuple[int, ...], tuple[int, ...]]] = {
    "single": ((0,), ()),
    "diagonal": ((0,), (3,)),
    "four": ((0, 1), (2, 3)),
}


@dataclass(frozen=True)
class Arms:
    """Distances of the axles from the centre of mass and half the track, m; equal distances: the symmetric platform."""

    front: float = 0.53
    rear: float = 0.53
    half_track: float = 0.29

    @property
    def diagonal(self) -> float:
        """The distance of a front wheel from the centre of mass over that of the opposite rear one."""
        return float(np.hypot(self.front, self.half_track) / np.hypot(self.rear, self.half_track))


SYMMETRIC = Arms()
TABLE_8_1 = Arms(front=0.6, rear=0.46)


def still_reaction(case: str, arms: Arms = SYMMETRIC) -> float:
    """Return the force on a reacting wheel per force on a struck one without rotation: 8.5, 8.11, Delta w = 0."""
    _known(case)
    return {"single": 0.0, "diagonal": arms.diagonal, "four": arms.front / arms.rear}[case]


def rigid_reaction(case: str, arms: Arms, m: float, I_x: float, I_y: float) -> float:
    """Return the same ratio if the reacting wheels keep to the ground: no normal velocity there after the impulse.

    A rigid body of mass *m* in kg and moments of inertia in kg.m2 about roll and pitch; -P_rs / P_rr with the normal
    impulses of all struck and of all reacting wheels equal.  Negative: these wheels leave the ground.
    """
    _known(case)
    struck, reacting = CASES[case]
    if not reacting:
        return 0.0
    x = np.array([arms.front, arms.front, -arms.rear, -arms.rear])
    y = arms.half_track * np.array([1.0, -1.0, 1.0, -1.0])
    P = 1 / m + np.outer(x, x) / I_y + np.outer(y, y) / I_x
    rows = P[list(reacting)].mean(axis=0)
    return float(-rows[list(struck)].sum() / rows[list(reacting)].sum())


def wheel_load(case: str, ratio: float | None = None, total: float | None = None) -> np.ndarray:
    """Return the forces (4,) on the wheels for 1 N on each struck one; the others react with *ratio* times that.

    Without a *ratio* they react as on the symmetric platform without rotation.  *total* scales the sum to so many N.
    """
    _known(case)
    struck, reacting = CASES[case]
    load = np.zeros(4)
    load[list(struck)] = 1.0
    load[list(reacting)] = still_reaction(case) if ratio is None else ratio
    return load if total is None else load * (total / load.sum())


def participation(data: ModalData, load: np.ndarray) -> np.ndarray:
    """Return gamma = phi^T R (8.7) of each mode (modes,), in N/kg^(1/2), under forces (4,) in N at the wheels."""
    return np.asarray(load @ data.wheel_shape)


def excited(gamma: np.ndarray) -> np.ndarray:
    """Return which modes (modes,) take part by more than what rounding and the eigensolver leave of a zero."""
    return np.abs(gamma) > 1e-6 * np.max(np.abs(gamma))


def free_amplitude(pulse: Pulse, frequency: np.ndarray) -> np.ndarray:
    """Return the acceleration (modes,) that undamped modes keep after a unit modal *pulse*: w |F(w)|.

    A rectangular pulse leaves 2 |sin(pi f T)|: no decay with frequency, so peaks grow with the number of modes.
    """
    w = 2 * np.pi * np.asarray(frequency, float)
    return np.asarray(w * np.abs(pulse.transform(w)))


def load_factor(pulse: Pulse, period: float, frequency: float, harmonic: int = 1) -> float:
    """Return the shock paper's dynamic factor (its Eq 9) of a pulse repeated every *period* s, on a mode in Hz.

    The amplitude of a harmonic times 1/|1 - (p/w)^2|, over the peak: undamped and steady, a resonance with the rate of
    repetition that was chosen, not a property of the shock.
    """
    p = harmonic / period
    amplitude = 2 / period * np.abs(pulse.transform(2 * np.pi * np.array(p))) / abs(pulse.peak)
    return float(amplitude / abs(1 - (p / frequency) ** 2))


def _known(case: str) -> None:
    if case not in CASES:
        raise ScenarioError(f"there is no load case {case!r}; {nearest(case, CASES)}")
