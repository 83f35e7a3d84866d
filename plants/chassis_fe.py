"""Modes of a solid finite-element model of the chassis: an aluminium plate with nine equipment boxes (thesis 8.2).

The thesis gives material, width, total mass and a mesh, but neither thickness nor boxes.  Thickness, boxes and the
share of the mass that is spread on the plate are fitted here to its ten published frequencies (24 to 153 Hz; 4 % rms,
the first nine shapes in its order).  What the fit does not meet: I_y is 26 kg.m2 where Table 8.1 has 47.

Axes of this file: x from rear to front, y from left to right, z up, origin at the middle of the plate's lower face.

The solver's libraries are imported where they solve: modes that are kept are there before these are.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable
from dataclasses import astuple, dataclass, fields
from itertools import pairwise
from math import pi
from pathlib import Path
from tempfile import NamedTemporaryFile
from typing import TYPE_CHECKING, Any

import numpy as np
import platformdirs

from cosim.errors import ScenarioError

from .chassis_modes import ModalData, load_modal_data

if TYPE_CHECKING:
    from skfem import MeshHex

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
    box_mass: float = 100.0  # nine boxes together; 270 kg in all, Table 8.1; 0 leaves the boxes away
    box_size: tuple[float, float, float] = (0.163, 0.062, 0.124)  # fitted
    box_pitch: tuple[float, float] = (0.379, 0.237)  # fitted, 3 x 3
    box_E: float = 2.65e9  # fitted
    damping: float = 5e-5  # zeta = eta / 2, Table 8.1
    refinement: int = 1  # bricks per length, as a multiple of the coarsest sensible mesh

    def __post_init__(self) -> None:
        for name in (f.name for f in fields(self)):
            _check(name, getattr(self, name))
        if self.box_mass > 0:
            self._check_boxes()

    def _check_boxes(self) -> None:
        """Raise ScenarioError unless three boxes in a row fit on the plate, along and across."""
        for axis, (name, whole) in enumerate((("length", self.length), ("width", self.width))):
            size, pitch = self.box_size[axis], self.box_pitch[axis]
            if size > pitch:
                raise ScenarioError(f"boxes of {size:g} m overlap at a box_pitch of {pitch:g} m along the {name}")
            if 2 * pitch + size > whole * (1 + 1e-9):
                raise ScenarioError(
                    f"three boxes of {size:g} m at a box_pitch of {pitch:g} m need {2 * pitch + size:g} m, but the "
                    f"{name} of the plate is {whole:g} m; shrink box_size or box_pitch, or set box_mass = 0 for none"
                )

    @property
    def mass(self) -> float:
        """The total mass, kg."""
        return self.plate_mass + self.box_mass

    def mesh(self) -> tuple[MeshHex, np.ndarray]:
        """Return the bricks, and which of them belong to boxes; station and wheel positions are vertices."""
        from skfem import MeshHex

        fine = self.refinement
        x = _lines(self.length / 2, self._edges(0), (0.0, 0.25 * self.length), 0.07 / fine)
        y = _lines(self.width / 2, self._edges(1), (self.width / 6,), 0.04 / fine)
        boxes = np.linspace(0, self.box_size[2], 2 * fine + 1) if self.box_mass > 0 else np.zeros(1)
        z = np.concatenate([[0.0], self.thickness + boxes])
        whole = MeshHex.init_tensor(x, y, z)
        cx, cy, cz = whole.p[:, whole.t].mean(axis=1)
        box = (cz > self.thickness) & self._in_a_box(cx, 0) & self._in_a_box(cy, 1)
        keep = np.flatnonzero((cz < self.thickness) | box)
        return whole.restrict(keep), box[keep]

    def _edges(self, axis: int) -> tuple[float, ...]:
        """Return the distances from the middle at which boxes begin and end; none without boxes."""
        size, pitch = self.box_size[axis], self.box_pitch[axis]
        return (size / 2, pitch - size / 2, pitch + size / 2) if self.box_mass > 0 else ()

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
        from scipy.sparse import csc_matrix
        from scipy.sparse.linalg import LinearOperator, eigsh, splu

        K, M, vertical, at = self.matrices()
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
        return frequency, vectors[vertical], at

    def matrices(self) -> tuple[Any, Any, np.ndarray, Callable[[float, float], int]]:
        """Return stiffness (N/m) and mass (kg), sparse (dofs, dofs), the vertical dofs (vertices,), a vertex finder.

        The finder gives the vertex of the lower face next to a position x, y in m.
        """
        from skfem import Basis, BilinearForm, ElementHexS2, ElementVector, asm

        mesh, box = self.mesh()
        # 2 x 2 x 2 points: the reduced integration that keeps quadratic bricks from locking in thin plates
        basis = Basis(mesh, ElementVector(ElementHexS2()), intorder=3)
        per_element = lambda plate, boxes: np.expand_dims(np.where(box, boxes, plate), 1)  # noqa: E731
        volume = self.length * self.width * self.thickness
        density = per_element(self.plate_mass / volume, self.box_mass / 9 / np.prod(self.box_size))
        K = asm(BilinearForm(_stiffness), basis, E=per_element(self.E, self.box_E), nu=self.nu)
        M = asm(BilinearForm(_mass), basis, rho=density)

        def at(px: float, py: float) -> int:
            return int(np.argmin(np.sum((mesh.p - np.array([[px], [py], [0.0]])) ** 2, axis=0)))

        return K, M, basis.nodal_dofs[2], at

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


def _lines(half: float, boxes: tuple[float, ...], extra: tuple[float, ...], step: float) -> np.ndarray:
    """Return grid lines from -half to half that hold the edges of the boxes and the extra positions, both ways."""
    edges = {half, *extra, *boxes}
    fixed = np.array(sorted({-e for e in edges} | edges))
    parts = [np.linspace(a, b, max(1, round((b - a) / step)) + 1)[:-1] for a, b in pairwise(fixed)]
    return np.append(np.concatenate(parts), half)


def _stiffness(u: Any, v: Any, w: Any) -> Any:
    from skfem.helpers import ddot, eye, sym_grad, trace

    strain = sym_grad(u)
    mu, lam = w.E / (2 * (1 + w.nu)), w.E * w.nu / ((1 + w.nu) * (1 - 2 * w.nu))
    return ddot(2 * mu * strain + eye(lam * trace(strain), 3), sym_grad(v))


def _mass(u: Any, v: Any, w: Any) -> Any:
    from skfem.helpers import dot

    return w.rho * dot(u, v)


def _check(name: str, value: Any) -> None:
    """Raise ScenarioError unless a dimension is a positive number, or as many of them as it should be."""
    default = PlateChassis.__dataclass_fields__[name].default
    if isinstance(default, tuple):
        values = value if isinstance(value, (tuple, list)) else ()
        if len(values) != len(default) or not all(_is_number(v) and v > 0 for v in values):
            raise ScenarioError(f"{name} of the chassis must be {len(default)} positive lengths in m, not {value!r}")
        return
    if not _is_number(value):
        raise ScenarioError(f"{name} of the chassis must be a number, not {value!r}")
    if name == "nu" and not -1 < value < 0.5:
        raise ScenarioError(f"nu of the chassis is {value!r}; Poisson's ratio lies between -1 and 0.5")
    if name == "damping" and not 0 <= value < 1:
        raise ScenarioError(f"damping of the chassis is {value!r}; it is a ratio from 0 to below 1")
    if name == "refinement" and (value != int(value) or not 1 <= value <= 4):
        raise ScenarioError(f"refinement of the chassis is {value!r}; it is 1, 2, 3 or 4 (some 30 s and 1 GB)")
    if name == "box_mass" and value == 0:
        return
    if name != "nu" and name != "damping" and not value > 0:
        raise ScenarioError(f"{name} of the chassis is {value!r}; it must be positive")


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float, np.number)) and not isinstance(value, bool) and bool(np.isfinite(value))
