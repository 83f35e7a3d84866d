"""The finite-element chassis: modal response against direct integration, a bare plate against theory and ngsolve."""

from __future__ import annotations

from math import pi

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu

from plants.chassis_fe import PlateChassis
from plants.pulses import Pulse
from plants.shock import pulse_response

BARE = PlateChassis(thickness=0.012, plate_mass=2700 * 1.06 * 0.58 * 0.012, box_mass=0.0, refinement=2)
FORCE, T, END, STEP = 1000.0, 0.05, 0.08, 5e-5  # N, s, s, s


def newmark(plate: PlateChassis) -> tuple[np.ndarray, np.ndarray]:
    """Return times (n,) and vertical displacements (n, 4) of the corners, a rectangular pulse at the front left one.

    Average acceleration (1/4, 1/2), undamped; the steps start and end the pulse at a time of their own.
    """
    K, M, vertical, at = plate.matrices()
    corners = [
        vertical[at(sx * plate.length / 2, sy * plate.width / 2)] for sx, sy in ((1, -1), (1, 1), (-1, -1), (-1, 1))
    ]
    factors = splu(csc_matrix(M + STEP**2 / 4 * K), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0,
                   options={"SymmetricMode": True})  # fmt: skip
    n = round(END / STEP)
    u, v, push = (np.zeros(K.shape[0]) for _ in range(3))
    push[corners[0]] = FORCE
    found = np.zeros((n + 1, 4))
    for k in range(n):
        # the force is constant within a step, so the mean acceleration solves for the whole step at once
        load = push if (k + 0.5) * STEP < T else 0.0
        a = factors.solve(load - K @ (u + STEP / 2 * v))
        u, v = u + STEP * v + STEP**2 / 2 * a, v + STEP * a
        found[k + 1] = u[corners]
    return np.arange(n + 1) * STEP, found


def test_modal_response_is_that_of_the_full_model() -> None:
    """Displacements of the four corners: six rigid modes and 120 elastic ones against all degrees of freedom.

    Newmark lengthens periods by (w h)^2/12, 5e-6 for mode 1 and 1.3e-3 for mode 25, and the modes left out are stiff.
    """
    plate = PlateChassis()
    t, full = newmark(plate)
    frequency, shapes, at = plate.eigenmodes(126)
    corner = [at(sx * plate.length / 2, sy * plate.width / 2) for sx, sy in ((1, -1), (1, 1), (-1, -1), (-1, 1))]
    phi = shapes[corner]
    q = FORCE * phi[0, 6:, None] * pulse_response(frequency[6:], 0.0, Pulse("rectangular", T), t).q
    rigid = np.where(t < T, t**2 / 2, T * t - T**2 / 2)
    modal = q.T @ phi[:, 6:].T + np.outer(rigid, FORCE * phi[0, :6] @ phi[:, :6].T)
    off = np.sqrt(np.mean((modal - full) ** 2, axis=0) / np.mean(full**2, axis=0))
    assert np.max(off) < 0.01, off


def kirchhoff(a: float, b: float, h: float, E: float, nu: float, rho: float, order: int = 13) -> np.ndarray:
    """Return the frequencies in Hz of a free thin plate by Ritz' method with products of Legendre polynomials."""
    x, weight = np.polynomial.legendre.leggauss(order + 2)
    P = np.array([[np.polynomial.Legendre.basis(k).deriv(d)(x) if d else np.polynomial.Legendre.basis(k)(x)
                   for k in range(order)] for d in range(3)])  # fmt: skip

    def table(i: int, j: int, length: float) -> np.ndarray:
        return np.einsum("ik,jk,k->ij", P[i], P[j], weight) * (2 / length) ** (i + j) * length / 2

    X = {(i, j): table(i, j, a) for i in range(3) for j in range(3)}
    Y = {(i, j): table(i, j, b) for i in range(3) for j in range(3)}
    D = E * h**3 / 12 / (1 - nu**2)
    K = D * (
        np.kron(X[2, 2], Y[0, 0]) + np.kron(X[0, 0], Y[2, 2])
        + nu * (np.kron(X[2, 0], Y[0, 2]) + np.kron(X[0, 2], Y[2, 0])) + 2 * (1 - nu) * np.kron(X[1, 1], Y[1, 1])
    )  # fmt: skip
    values = eigh(K, rho * h * np.kron(X[0, 0], Y[0, 0]), eigvals_only=True)
    return np.sqrt(np.maximum(values, 0)) / (2 * pi)


def test_bare_plate_against_plate_theory() -> None:
    """Six modes of 1.06 x 0.58 x 0.012 m: within 1 %, the finite elements lower, by shear and rotary inertia."""
    found = BARE.eigenmodes(12)[0][6:]
    theory = kirchhoff(1.06, 0.58, 0.012, BARE.E, BARE.nu, 2700.0)[3:9]
    # the Ritz values themselves, as an independent program printed them
    np.testing.assert_allclose(theory, [57.06, 64.03, 143.15, 158.30, 197.30, 238.91], rtol=2e-4)
    np.testing.assert_allclose(found, theory, rtol=0.01)


def test_bare_plate_against_ngsolve() -> None:
    """The same solid by ngsolve 6.2, polynomials of degree 4, converged: six values computed once with that program."""
    found = BARE.eigenmodes(12)[0][6:]
    np.testing.assert_allclose(found, [57.02, 63.59, 142.17, 157.96, 196.96, 237.69], rtol=0.005)


def test_stations_are_vertices_of_every_mesh() -> None:
    """Also of a refined one, and of a plate without boxes."""
    for plate in (PlateChassis(refinement=2), PlateChassis(box_mass=0.0), PlateChassis(box_size=(0.1, 0.1, 0.05))):
        x, y = (np.unique(np.round(c, 12)) for c in plate.mesh()[0].p[:2])
        for k in range(5):
            assert np.min(np.abs(x - plate.length * (0.5 - k / 4))) < 1e-12
        for k in range(4):
            assert np.min(np.abs(y - plate.width * (k / 3 - 0.5))) < 1e-12
