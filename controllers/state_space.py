"""The impact as a linear system (thesis 6.4), and state feedback for it: poles or LQR, designed for a sample period.

With the deformations z of n contacts, x = (z, z'), and the signs of a spring that pushes (6.16 prints +P k_w),

    x' = [[0, I], [-P k_w, -P c_w]] x + [[0], [U]] F_a,    y = [I 0] x

around the deformation at which the constant b_free is balanced.  n = 2 in the planar model: rear axle, front axle,
P and U per axle force and k_w of both wheels of an axle; n = 4 with every wheel.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from cosim.errors import DeclarationError
from cosim.quiet import without

if TYPE_CHECKING:
    import control

AXLES, WHEELS = ("rear", "front"), ("fl", "fr", "rl", "rr")
RATE_MAX = 1.0  # largest |pole| times period: six samples per 2 pi / |pole|, below which a zero-order hold governs
SAMPLES = 4  # least number of samples per swing of the wheels without control
_UNCONTROLLABLE = 1e-9  # smallest singular value of [pole I - A, B], all scaled to 1
_PLACED = 1e-6  # largest miss of the characteristic polynomial, whose coefficients are of order 1 to 100
_SAME = 1e-9  # relative, for poles that should be conjugates


def impact_model(P: np.ndarray, U: np.ndarray, k_w: float, c_w: float = 0.0) -> control.StateSpace:
    """Return the state space 6.16 with the right signs, in continuous time.

    *P*, *U* (n, n) in 1/kg, *k_w* in N/m and *c_w* in N.s/m of one contact: an axle for n = 2, a wheel for n = 4.
    States z_i in m and z_rate_i in m/s, inputs F_i in N, outputs z_i, for i = rear, front or fl, fr, rl, rr.
    """
    import control  # brings pyplot and half of SciPy, which a run that needs no such design should not wait for

    n = len(P)
    names = AXLES if n == 2 else WHEELS
    none, one = np.zeros((n, n)), np.eye(n)
    z = [f"z_{i}" for i in names]
    return control.StateSpace(
        np.block([[none, one], [-np.asarray(P) * k_w, -np.asarray(P) * c_w]]), np.vstack([none, U]),
        np.hstack([one, none]), none,
        states=[*z, *(f"z_rate_{i}" for i in names)], inputs=[f"F_{i}" for i in names], outputs=z, name="impact",
    )  # fmt: skip


def sampled(model: control.StateSpace, period: float) -> control.StateSpace:
    """Return the model between the ticks of a controller that holds its forces over *period* seconds, exact."""
    import control

    return control.sample_system(model, period, method="zoh")


def force_rows(n: int, k_w: float, c_w: float = 0.0) -> np.ndarray:
    """Return the output matrix (n, 2 n) of the normal forces: F_n = -k_w z - c_w z', in N."""
    return np.hstack([-k_w * np.eye(n), -c_w * np.eye(n)])


def conjugate_poles(frequency: Any, damping: Any) -> np.ndarray:
    """Return a pair of poles, in rad/s, for each circular *frequency* (rad/s) and *damping* ratio; broadcast."""
    w, zeta = np.broadcast_arrays(np.atleast_1d(frequency).astype(float), np.atleast_1d(damping).astype(float))
    root = np.sqrt((zeta**2 - 1).astype(complex))
    return np.concatenate([-w * (zeta - root), -w * (zeta + root)])


def check_poles(poles: np.ndarray, n: int, period: float, of: str = "closed-loop poles") -> np.ndarray:
    """Return the poles of a design, as given in rad/s, if a real gain sampled every *period* s can have them.

    Raises DeclarationError when there are not *n*, when one is not in the left half plane, when a complex one comes
    without its conjugate, or when the period is too long for the fastest one.
    """
    poles = np.atleast_1d(np.asarray(poles, dtype=complex))
    if len(poles) != n:
        raise DeclarationError(f"{of}: {len(poles)} were asked for, but the model has {n} states; give {n}")
    if np.any(poles.real >= 0):
        worst = poles[np.argmax(poles.real)]
        raise DeclarationError(f"{of}: {spelt(worst)} rad/s does not decay; give poles with a negative real part")
    lone = [s for s in poles if abs(s.imag) > _SAME * abs(s) and _count(poles, s) != _count(poles, np.conj(s))]
    if lone:
        raise DeclarationError(
            f"{of}: {spelt(lone[0])} rad/s comes without its conjugate {spelt(np.conj(lone[0]))} rad/s, which no real "
            "gain can give; ask for complex poles in conjugate pairs"
        )
    fastest = poles[np.argmax(np.abs(poles))]
    if abs(fastest) * period > RATE_MAX:
        raise DeclarationError(
            f"{of}: a period of {period:g} s is too long for {spelt(fastest)} rad/s; take at most "
            f"{RATE_MAX / abs(fastest):.2g} s, or poles no faster than {RATE_MAX / period:.4g} rad/s"
        )
    return poles


def spelt(pole: complex) -> str:
    """Write a pole as -100+50j, or as -100 where it is real."""
    return f"{pole.real:.4g}" + (f"{pole.imag:+.4g}j" if abs(pole.imag) > _SAME * abs(pole) else "")


def _count(poles: np.ndarray, s: complex) -> int:
    return int(np.count_nonzero(np.abs(poles - s) <= _SAME * abs(s)))


def pole_gain(model: control.StateSpace, poles: np.ndarray, period: float) -> np.ndarray:
    """Return K (n inputs, 2 n states) of F_a = -K x, sampled, that puts the closed-loop poles at *poles*, in rad/s.

    They are placed in discrete time, at exp(pole period).  Raises DeclarationError for poles that cannot be had (see
    `check_poles`; no pole more often than there are inputs) and for a model that the forces cannot move.
    """
    poles = check_poles(poles, model.nstates, period)
    check_controllable(model)
    check_period(model, period)
    z = sampled(model, period)
    most = max(_count(poles, s) for s in poles)
    if most > model.ninputs:
        raise DeclarationError(
            f"closed-loop poles: one is asked for {most} times, but {model.ninputs} forces can repeat a pole "
            f"{model.ninputs} times at most; move some of them apart"
        )
    scale = _scale(model)
    return placed(*_scaled(z.A, z.B, scale), np.exp(poles * period)) / scale


def placed(A: np.ndarray, B: np.ndarray, poles: np.ndarray) -> np.ndarray:
    """Return K that gives A - B K these eigenvalues, by `control.place`, checked."""
    import control

    with without(UserWarning):  # of a search for the most robust K that ended early: its poles are right
        K = np.asarray(control.place(A, B, poles))
    off = np.abs(np.poly(A - B @ K) - np.poly(poles))
    if np.max(off) > _PLACED:
        raise DeclarationError(
            f"the poles {', '.join(f'{s:.4g}' for s in poles)} (discrete time) cannot be placed: the characteristic "
            f"polynomial misses them by {np.max(off):.2g}; move them apart, or nearer to where they are without control"
        )
    return K


class Weights(NamedTuple):
    """Sizes that count alike in an LQR (Bryson's rule): deformation (m), rate (m/s), traction of a contact (N)."""

    z: float
    z_rate: float
    force: float


def natural_weights(model: control.StateSpace, z_rate: float = 0.1, effort: float = 4.0) -> Weights:
    """Return weights that go together: the deformation that swings at *z_rate* (m/s), and *effort* times its force."""
    n = model.ninputs
    frequency = float(np.max(np.abs(model.poles())))
    return Weights(z_rate / frequency, z_rate, effort * frequency * z_rate / float(np.linalg.norm(model.B[n:], 2)))


def lqr_gain(model: control.StateSpace, weights: Weights, period: float) -> np.ndarray:
    """Return K (n inputs, 2 n states) of F_a = -K x, the discrete-time LQR: costs 1/z^2, 1/z_rate^2 and 1/force^2.

    Raises DeclarationError for a model that the forces cannot move.
    """
    import control

    check_controllable(model)
    check_period(model, period)
    n = model.ninputs
    discrete = sampled(model, period)
    Q = np.diag([1 / weights.z**2] * n + [1 / weights.z_rate**2] * n)
    K, _, _ = control.dlqr(discrete.A, discrete.B, Q, np.eye(n) / weights.force**2)
    return np.asarray(K)


def closed_loop_poles(model: control.StateSpace, K: np.ndarray, period: float) -> np.ndarray:
    """Return the poles of the model under the sampled law F_a = -K x as rates in rad/s: log(eigenvalue) / period."""
    z = sampled(model, period)
    return np.log(np.linalg.eigvals(z.A - z.B @ K).astype(complex)) / period


def check_controllable(model: control.StateSpace) -> None:
    """Raise DeclarationError naming the mode that no force moves, if there is one (by Popov, Belevitch and Hautus)."""
    A, B = _scaled(model.A, model.B, _scale(model))
    A, B = A / np.linalg.norm(A, 2), B / max(np.linalg.norm(B, 2), 1e-300)
    for s, true in zip(np.linalg.eigvals(A), model.poles(), strict=True):
        if np.linalg.svd(np.hstack([s * np.eye(len(A)) - A, B]), compute_uv=False)[-1] < _UNCONTROLLABLE:
            raise DeclarationError(
                f"the tractions {', '.join(model.input_labels)} cannot move the mode at {abs(true):.4g} rad/s, so its "
                "poles stay where they are; design for a posture where U has full rank, front wheels on a slope"
            )


def check_period(model: control.StateSpace, period: float) -> None:
    """Raise DeclarationError if the wheels swing faster than a law sampled every *period* s can see."""
    fastest = float(np.max(np.abs(model.poles())))
    if fastest * period > 2 * np.pi / SAMPLES:
        raise DeclarationError(
            f"a period of {period:g} s is too long for wheels that swing at {fastest:.4g} rad/s without control: take "
            f"at most {2 * np.pi / SAMPLES / fastest:.2g} s, {SAMPLES} samples per swing"
        )


def _scale(model: control.StateSpace) -> np.ndarray:
    """Return sizes of the states (2 n,) that go together: 1 m with the speed it swings at."""
    n = model.nstates // 2
    rate = np.sqrt(np.max(np.abs(model.A[n:, :n])))
    return np.concatenate([np.ones(n), np.full(n, rate)])


def _scaled(A: np.ndarray, B: np.ndarray, scale: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return A * scale / scale[:, None], B / scale[:, None]


class FeedForward(NamedTuple):
    """What a steady state needs: F_a = per_z z - per_b b_free holds the deformations z under b_free."""

    per_z: np.ndarray  # (n, n), N/m
    per_b: np.ndarray  # (n, n), kg


def feed_forward(P: np.ndarray, U: np.ndarray, k_w: float) -> FeedForward:
    """Return the tractions that hold a deformation: 0 = -P k_w z + U F_a + b_free."""
    inverse = np.linalg.inv(U)
    return FeedForward(inverse @ P * k_w, inverse)


def static_deflection(P: np.ndarray, b_free: np.ndarray, k_w: float) -> np.ndarray:
    """Return the deformations (n,), in m and negative, that balance b_free (m/s2) without any traction."""
    return np.linalg.solve(np.asarray(P) * k_w, b_free)
