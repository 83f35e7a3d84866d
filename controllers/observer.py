"""Deformations estimated from normal forces: a full-order observer, since z and z' cannot be measured (thesis 6.2).

At every tick the prediction z_, z_' is corrected by what the force sensors say, and carried on to the next tick,

    (z, z') = (z_, z_') + L (F_n + k_w z_ + c_w z_')             F_n = -k_w z - c_w z'
    z'' = P F + U F_a + b_free,   F = -k_w z - c_w z'            in the air: the measured force, which is zero

A wheel in the air says nothing about its deformation but that there is none: no correction, and a free flight.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import casadi as ca
import numpy as np

from cosim.errors import DeclarationError

from .state_space import check_poles, force_rows, placed, sampled

if TYPE_CHECKING:
    import control

_SUBSTEPS = 2  # of Runge-Kutta 4 per period: error (|pole| period / 2)^5 / 120 a half period, 3e-4 at |pole| period = 1


def observer_gain(model: control.StateSpace, poles: np.ndarray, k_w: float, c_w: float, period: float) -> np.ndarray:
    """Return L (2 n, n), in m/N and m/(N.s), that lets the error of the estimate decay at *poles*, in rad/s.

    *model* is that of `impact_model`, *k_w* and *c_w* those it was made with.  The error of the prediction obeys
    e(k+1) = A (I - L C) e(k) between ticks of *period* s, all contacts closed.  Raises DeclarationError like
    `check_poles`, and for poles that repeat more often than there are forces.
    """
    poles = check_poles(poles, model.nstates, period, "observer poles")
    n = model.noutputs
    A = sampled(model, period).A
    # in sizes that go together: metres, metres times the frequency, newtons of a metre
    rate = np.sqrt(np.max(np.abs(model.A[n:, :n])))
    scale = np.concatenate([np.ones(n), np.full(n, rate)])
    C = force_rows(n, k_w, c_w) / k_w
    try:
        gain = placed((A * scale / scale[:, None]).T, (C * scale).T, np.exp(poles * period)).T
    except ValueError as error:
        raise DeclarationError(
            f"observer poles: {error}; ask for no pole more often than there are forces, {n} times"
        ) from None
    return np.asarray(np.linalg.solve(A, scale[:, None] * gain / k_w))


def observer_system(
    model: control.StateSpace, L: np.ndarray, k_w: float, c_w: float, period: float
) -> control.StateSpace:
    """Return the observer of `observer_gain` as a system sampled every *period* s, all contacts closed.

    Inputs: the held tractions of the model and the measured normal forces Fn_i, in N, as deviations from where b_free
    is balanced; outputs: the estimate of the model's states at the tick.
    """
    import control

    d, n = sampled(model, period), model.noutputs
    keep = np.eye(model.nstates) - L @ force_rows(n, k_w, c_w)
    none = np.zeros((model.nstates, model.ninputs))
    return control.StateSpace(
        d.A @ keep, np.hstack([d.B, d.A @ L]), keep, np.hstack([none, L]), period,
        inputs=[*model.input_labels, *(f"Fn_{name.removeprefix('z_')}" for name in model.output_labels)],
        outputs=model.state_labels, name="observer",
    )  # fmt: skip


class Estimate(NamedTuple):
    """Deformations of the four wheels and their rates: m, m/s."""

    z: Any
    rate: Any


def corrected(s: Any, closed: Any) -> Estimate:
    """Return the estimate at a tick, in CasADi: the prediction corrected by the *closed* (4) wheels' normal forces.

    Reads ``z_next``, ``z_rate_next`` (the prediction made a period ago), ``normal_force``, ``k_w``, ``c_w`` and the
    gains ``L_z``, ``L_rate``.
    """
    surprise = closed * (s.normal_force + s.k_w * s.z_next + s.c_w * s.z_rate_next)
    return Estimate(s.z_next + s.L_z @ surprise, s.z_rate_next + s.L_rate @ surprise)


def predicted(s: Any, now: Estimate, closed: Any, P: Any, U: Any, traction: Any) -> Estimate:
    """Return the estimate a ``period`` later, in CasADi, under the *traction* (4) that is held until then.

    Feeding back what was really asked for, after the limits, keeps the estimate from winding up.
    """
    constant = U @ traction + s.b_free + P @ ((1 - closed) * s.normal_force)
    stiffness, damping = P @ ca.diag(closed * s.k_w), P @ ca.diag(closed * s.c_w)
    n = now.z.numel()
    A = ca.vertcat(
        ca.horzcat(ca.SX.zeros(n, n), ca.SX.eye(n)),
        ca.horzcat(-stiffness, -damping),
    )
    x = ca.vertcat(now.z, now.rate)
    h = s.period / _SUBSTEPS
    for _ in range(_SUBSTEPS):
        slope = A @ x + ca.vertcat(ca.SX.zeros(n), constant)
        term, change = slope, h * slope
        for order in (2, 3, 4):  # Runge-Kutta 4 of a linear system is its Taylor series
            term = A @ term
            change += h**order / float(np.prod(range(1, order + 1))) * term
        x += change
    return Estimate(x[:n], x[n:])
