"""The robot seen from the side, derived anew: a body of three coordinates, its velocities and the work of its forces.

World axes X forward and Z up, nose-up pitch p; the axles lie on the slopes 0 (rear) and theta (front), absolute.  No
cross product and no equation of the thesis is used: the equations of motion are those of Lagrange with the virtual work
of a force on the point of the body where it acts, and the gap accelerations are second derivatives of positions.
omega = -p' is the thesis' nose-down pitch rate, v_x and v_z are velocities in body axes.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import sympy as sp

from .algebra import symbols

m, I_y, L_f, L_r, h, R, g = symbols("m I_y L_f L_r h R g")
p, theta, gamma, omega, v_x, v_z, kappa = symbols("p theta gamma omega v_x v_z kappa")
F_r, F_f, F_1, F_2 = symbols("F_r F_f F_1 F_2")
_X, _Z, _x, _z = sp.symbols("X Z x z")
_COORDINATES = sp.Matrix([_X, _Z, p])
CENTRES = ((-L_r, -h), (L_f, -h))  # body axes, rear and front


@dataclass(frozen=True)
class SideView:
    """Expressions in p, theta, omega and the dimensions; forces (rear, front)."""

    P: sp.Matrix  # (2, 2) gap acceleration per normal force
    U: sp.Matrix  # (2, 2) the same per traction
    G: sp.Matrix  # (2,) that of gravity
    a_w: sp.Matrix  # (2,) that of turning, without the bend of the path
    N: sp.Matrix  # (3, 2) generalised acceleration per normal force
    A: sp.Matrix  # (3, 2) the same per traction

    def acceleration(self, normal: sp.Matrix, traction: sp.Matrix) -> sp.Matrix:
        """Return X'', Z'' and p'' under forces."""
        return self.N * normal + self.A * traction + sp.Matrix([0, -g, 0])

    def contact_forces(self, traction: sp.Matrix, bend: sp.Expr = sp.S.Zero) -> sp.Matrix:
        """Return the normal forces that keep both wheels on the ground; *bend* is kappa v_t^2 at the front."""
        return -self.P.adjugate() / self.P.det() * (self.U * traction + self.G + self.a_w - sp.Matrix([0, bend]))


def turned(x: sp.Expr, z: sp.Expr) -> sp.Matrix:
    """Return a vector of the body in world axes."""
    return sp.Matrix([x * sp.cos(p) - z * sp.sin(p), x * sp.sin(p) + z * sp.cos(p)])


def in_body(vector: sp.Matrix, pitch: sp.Expr = p) -> sp.Matrix:
    """Return a vector of the world in the axes of a body with this pitch."""
    x, z = vector
    return sp.Matrix([x * sp.cos(pitch) + z * sp.sin(pitch), -x * sp.sin(pitch) + z * sp.cos(pitch)])


def normal_of(slope: sp.Expr) -> sp.Matrix:
    """Return the outward normal of a slope in world axes: its tangent turned left."""
    return sp.Matrix([-sp.sin(slope), sp.cos(slope)])


def tangent_of(slope: sp.Expr) -> sp.Matrix:
    """Return the direction uphill along a slope in world axes."""
    return sp.Matrix([sp.cos(slope), sp.sin(slope)])


@cache
def side_view(arm: sp.Expr = R) -> SideView:
    """Derive the model; traction acts *arm* below the wheel centre along the normal."""
    position = sp.Matrix([_X, _Z]) + turned(_x, _z)
    jacobian = position.jacobian(_COORDINATES)
    inertia = sp.diag(m, m, I_y).inv()
    moves, bends, pushes, drives, normals = [], [], [], [], []
    for (x, z), slope in zip(CENTRES, (sp.Integer(0), theta), strict=True):
        n, A = normal_of(slope), tangent_of(slope)
        centre = {_x: x, _z: z}
        down = in_body(-arm * n)
        at_ground = {_x: x + down[0], _z: z + down[1]}
        moves.append((n.T * jacobian.subs(centre)).row(0))
        bends.append((n.T * sp.diff(position, p, 2).subs(centre))[0])
        pushes.append(inertia * jacobian.subs(at_ground, simultaneous=True).T * n)
        drives.append(inertia * jacobian.subs(at_ground, simultaneous=True).T * A)
        normals.append(n)
    J, N, A = sp.Matrix.vstack(*moves), sp.Matrix.hstack(*pushes), sp.Matrix.hstack(*drives)
    G = J * sp.Matrix([0, -g, 0])
    return SideView(J * N, J * A, G, sp.Matrix(bends) * omega**2, N, A)


@cache
def body_rates(arm: sp.Expr = R, bend: sp.Expr = sp.S.Zero) -> sp.Matrix:
    """Return v_x', v_z', alpha_y = -p'', a_x and a_z of a robot with both wheels on the ground under F_r and F_f."""
    model = side_view(arm)
    traction = sp.Matrix([F_r, F_f])
    X_dd, Z_dd, p_dd = model.acceleration(model.contact_forces(traction, bend), traction)
    a = in_body(sp.Matrix([X_dd, Z_dd]))
    # body components v = turned^-1 (X', Z'): their rate is that of the world components and of the axes, p' = -omega
    axes = sp.diff(in_body(sp.Matrix(_COORDINATES[:2])), p).subs(dict(zip((_X, _Z), turned(v_x, v_z), strict=True)))
    return sp.Matrix([*(a - omega * axes), -p_dd, *a])


def level(expression: sp.Basic) -> sp.Basic:
    """Return an expression at p = 0, where theta is the thesis' gamma (chapter 4, Appendix A)."""
    return expression.subs({p: 0, theta: gamma}, simultaneous=True)


def from_body(expression: sp.Basic) -> sp.Basic:
    """Return an expression with gamma = theta - p, the slope seen from the body (chapter 5)."""
    return expression.subs(theta, gamma + p)
