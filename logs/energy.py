"""Whether the energy balance of a co-simulated rover closes: what the splitting in steps adds or takes.

    residual = E(t) - E(0) - W(t),   E = kinetic + potential + stored in wheels and contacts + lost in them,
    W = work of traction, lateral force, external force and moment on the body; or what the body itself accounts for

Normal forces are no work: what they take from the body is in the wheels.  The chassis moves one way and takes none.
The forces are means over a step; their work is taken with the mean of the velocities at its ends.  A robot whose
wheels and chassis are part of its body has them in its energies, and counts the work itself: ``body.work``.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import rerun as rr

from cosim.system import System

from .drawing import Drawing, Read, summed
from .ports import index, scalars
from .rotation import matrices

_STORED = ("body.kinetic_energy", "body.potential_energy", "wheels.elastic_energy", "wheels.dissipated_energy")
_NEEDED = ("body.position", "body.orientation", "body.velocity", "body.rate", "body.wheel_centre",
           "body.contact_normal", "body.traction_direction")  # fmt: skip


RESIDUAL = "master/energy_residual"


class EnergyResidual(Drawing):
    """Adds up the work over a run; *arm* is the way from a wheel's centre to where traction acts, in m."""

    def __init__(self, arm: float) -> None:
        self.arm = arm
        self._start: float | None = None
        self._work = 0.0
        self._power: tuple[int, np.ndarray] | None = None  # time and velocities at the end of the last chunk

    def started(self, recording: Any, system: System) -> None:
        named = rr.SeriesLines(names=["energy_residual [J]"], colors=[(31, 120, 209)], widths=[1.2])
        recording.log(RESIDUAL, named, rr.AnyValues(signal_name=["energy_residual"], signal_unit="J"), static=True)

    def emit(self, recording: Any, ns: np.ndarray, step: np.ndarray, read: Read) -> None:
        values = self.over(ns, read)
        if values is not None:
            recording.send_columns(RESIDUAL, index(ns, step), scalars(values[:, None]))

    def over(self, ns: np.ndarray, read: Read) -> np.ndarray | None:
        """Return the residual (n,) in J over a chunk of n steps, or None without the ports it takes."""
        parts = [read(port) for port in _STORED]
        if any(p is None for p in parts) or any(read(port) is None for port in _NEEDED):
            return None
        energy = np.sum([p for p in [*parts, read("body.contact_energy")] if p is not None], axis=0)
        own = read("body.work")
        work = self._done(ns, read) if own is None else own
        if self._start is None:
            self._start = float(energy[0] - work[0])
        return np.asarray(energy - self._start - work)

    def _done(self, ns: np.ndarray, read: Read) -> np.ndarray:
        """Return the work (n,) in J of the forces on the body since the start."""
        velocities, forces = self._velocities(read), self._forces(read)
        before_ns, before = self._power or (int(ns[0]), velocities[0])
        mean = (velocities + np.concatenate([before[None], velocities[:-1]])) / 2
        dt = np.diff(ns, prepend=before_ns) * 1e-9
        work = summed(self._work, np.einsum("ij,ij->i", forces, mean) * dt)
        self._work, self._power = float(work[-1]), (int(ns[-1]), velocities[-1])
        return np.asarray(work)

    def _velocities(self, read: Read) -> np.ndarray:
        """Return the velocities that the forces of `_forces` work along, (n, 14), world axes, rates in body axes."""
        position, q, v, rate, centre, normal, along = (np.asarray(read(port)) for port in _NEEDED)
        omega = np.einsum("nij,nj->ni", matrices(q), rate)
        arm = centre - self.arm * normal - position[:, None]
        points = v[:, None] + np.cross(omega[:, None], arm)
        across = np.cross(normal, along)
        ways = [np.sum(points * along, axis=2), np.sum(points * across, axis=2)]
        return np.concatenate([*ways, v, rate], axis=1)

    def _forces(self, read: Read) -> np.ndarray:
        n = len(np.asarray(read("body.velocity")))
        given = [("body.traction", 4), ("body.lateral", 4), ("body.force", 3), ("body.moment", 3)]
        return np.concatenate([(np.zeros((n, w)) if (f := read(p)) is None else f) for p, w in given], axis=1)
