"""Modes of a solid finite-element model of the chassis: an aluminium plate with nine equipment boxes (thesis 8.2).

The thesis gives material, width, total mass and a mesh, but neither thickness nor boxes.  Thickness, boxes and the
share of the mass that is spread on the plate are fitted here to its ten published frequencies (24 to 153 Hz; 4 % rms,
the first nine shapes in its order).  What the fit does not meet: I_y is 26 kg.m2 where Table 8.1 has 47.

Axes of this file: x from rear to front, y from left to right, z up, origin at the middle of the plate's lower face.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable
from dataclasses import astuple, dataclass
from itertools import pairwise
from math import pi
from pathlib import Path
from tempfile import NamedTemporaryFile
from typing import Any, cast

import numpy as np
import platformdirs
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import LinearOperator, eigsh, splu
from skfem import Basis, BilinearForm, ElementHexS2, ElementVector, MeshHex, asm
from skfem.helpers import ddot, dot, eye, sym_grad, trace

from .chassis_modal import ChassisModal
from .chassis_modes import ModalData, load_modal_data

_SHIFT = (2 * pi * 10.0) ** 2  # below zero by it: K is singular, its six rigid modes lie at zero
_VERSION = 1  # of the mesh and the solver, part of the key of cached modes


@dataclass(frozen=True)
class PlateChassis:
    """The default chassis: dimensions in m, masses in kg, moduli in Pa."""

    length: float = 1.06  # L_f + L_r, wheels at the corners
    width: float = 0.58  # Table 8.1
    thickness: float = 0.0156  # fitted
    E: float = 72e9  # Table 8.1, aluminium
    nu: float = 0.33  # Table 8.1
    plate_mass: float = 170.0  # fitted: 26 kg of aluminium and equipment spread on it
    box_mass: float = 100.0  # nine boxes together; 270 kg in all, Table 8.1
    box_size: tuple[float, float, float] = (0.163, 0.062, 0.124)  # fitted
    box_pitch: tuple[float, float] = (0.379, 0.237)  # fitted, 3 x 3
    box_E: float = 2.65e9  # fitted
    damping: float = 5e-5  # zeta = eta / 2, Table 8.1
    refinement: int = 1  # bricks per length, as a multiple of the coarsest sensible mesh

    def mesh(self) -> tuple[MeshHex, np.ndarray]:
        """Return the bricks, and which of them belong to boxes; station and wheel positions are vertices."""
        fine = self.refinement
        x = _lines(self.length / 2, self.box_pitch[0], self.box_size[0], (0.25 * self.length,), 0.07 / fine)
        y = _lines(self.width / 2, self.box_pitch[1], self.box_size[1], (self.width / 6,), 0.04 / fine)
        z = np.concatenate([[0.0], self.thickness + np.linspace(0, self.box_size[2], 2 * fine + 1)])
        whole = MeshHex.init_tensor(x, y, z)
        cx, cy, cz = whole.p[:, whole.t].mean(axis=1)
        box = (cz > self.thickness) & self._in_a_box(cx, 0) & self._in_a_box(cy, 1)
        keep = np.flatnonzero((cz < self.thickness) | box)
        return whole.restrict(keep), box[keep]

    def _in_a_box(self, c: np.ndarray, axis: int) -> np.ndarray:
        distances = [np.abs(c - i * self.box_pitch[axis]) for i in (-1, 0, 1)]
        return np.min(distances, axis=0) < self.box_size[axis] / 2

    def modes(self, count: int = 25) -> ModalData:
        """Solve for the *count* lowest elastic modes; about 2 s.

        Stations 1 to 20 lie row by row from the front, left to right (5 x 4, the corners are 1, 4, 17, 20); the wheels
        are at the corners: front-left 1, front-right 4, rear-left 17, rear-right 20.  Station 1 moves up in every mode.
        """
        frequency, shapes, at = self.eigenmodes(count + 6)
        frequency, vertical = frequency[6:], shapes[:, 6:]  # the first six are rigid
        rows = [self.length * (0.5 - i / 4) for i in range(5)]
        columns = [self.width * (i / 3 - 0.5) for i in range(4)]
        station_shape = np.array([vertical[at(x, y)] for x in rows for y in columns])
        station_shape *= np.where(station_shape[0] < 0, -1.0, 1.0)
        wheels = station_shape[[0, 3, 16, 19]]
        names = tuple(str(i) for i in range(1, 21))
        return ModalData(frequency, np.full(count, self.damping), wheels, station_shape, names)

    def eigenmodes(self, count: int) -> tuple[np.ndarray, np.ndarray, Callable[[float, float], int]]:
        """Return frequencies (count,) in Hz, vertical shapes at the vertices (vertices, count), and a vertex finder.

        Rigid modes included; shapes are mass-normalised.
        """
        mesh, box = self.mesh()
        # 2 x 2 x 2 points: the reduced integration that keeps quadratic bricks from locking in thin plates
        basis = Basis(mesh, ElementVector(ElementHexS2()), intorder=3)
        per_element = lambda plate, boxes: np.expand_dims(np.where(box, boxes, plate), 1)  # noqa: E731
        volume = self.length * self.width * self.thickness
        density = per_element(self.plate_mass / volume, self.box_mass / 9 / np.prod(self.box_size))
        K = asm(_stiffness, basis, E=per_element(self.E, self.box_E), nu=self.nu)
        M = asm(_mass, basis, rho=density)
        factors = splu(
            csc_matrix(K + _SHIFT * M),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
        inverse = LinearOperator(K.shape, matvec=factors.solve)
        start = np.random.default_rng(0).standard_normal(K.shape[0])  # a fixed one: the same bits every time
        values, vectors = eigsh(K, k=count, M=M, sigma=-_SHIFT, OPinv=inverse, v0=start)
        order = np.argsort(values)
        values, vectors = values[order], vectors[:, order]
        vectors /= np.sqrt(np.einsum("ij,ij->j", vectors, M @ vectors))
        frequency = np.sign(values) * np.sqrt(np.abs(values)) / (2 * pi)

        def at(px: float, py: float) -> int:
            return int(np.argmin(np.sum((mesh.p - np.array([[px], [py], [0.0]])) ** 2, axis=0)))

        return frequency, vectors[basis.nodal_dofs[2]], at

    def cached_modes(self, count: int = 25) -> ModalData:
        """Return `modes`, kept in the user's cache directory under a hash of all dimensions."""
        key = hashlib.sha256(repr((_VERSION, count, astuple(self))).encode()).hexdigest()[:16]
        path = Path(platformdirs.user_cache_dir("wmr-cosim")) / "modes" / f"{key}.json"
        if path.is_file():
            return load_modal_data(path)
        found = self.modes(count)
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            with NamedTemporaryFile(dir=path.parent, suffix=".json", delete=False) as scratch:
                pass
            found.save(Path(scratch.name))
            os.replace(scratch.name, path)
        except OSError:
            pass  # a cache that cannot be written costs two seconds next time, no more
        return found


def _lines(half: float, pitch: float, size: float, extra: tuple[float, ...], step: float) -> np.ndarray:
    """Return grid lines from -half to half that hold the edges of three boxes and the extra positions."""
    edges = {half, *extra, size / 2, pitch - size / 2, pitch + size / 2}
    fixed = np.array(sorted({-e for e in edges} | edges))
    parts = [np.linspace(a, b, max(1, round((b - a) / step)) + 1)[:-1] for a, b in pairwise(fixed)]
    return np.append(np.concatenate(parts), half)


@BilinearForm
def _stiffness(u: Any, v: Any, w: Any) -> Any:
    strain = sym_grad(u)
    mu, lam = w.E / (2 * (1 + w.nu)), w.E * w.nu / ((1 + w.nu) * (1 - 2 * w.nu))
    return ddot(2 * mu * strain + eye(lam * trace(strain), 3), sym_grad(v))


@BilinearForm
def _mass(u: Any, v: Any, w: Any) -> Any:
    return w.rho * dot(u, v)


def chassis(modal_data: str | None = None, modes: int = 25, damping: float | None = None) -> ChassisModal:
    """Return a chassis: from a file of modal data, or else the default plate; *damping* replaces every ratio."""
    data = load_modal_data(Path(modal_data)) if modal_data is not None else PlateChassis().cached_modes(max(modes, 25))
    found = data.component(modes if modal_data is None else min(modes, len(data.frequency)))
    return found if damping is None else cast(ChassisModal, found.replace(damping=damping))
