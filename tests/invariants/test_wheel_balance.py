"""What holds for deformable wheels whatever drives them: energy, momentum, friction cones, symmetry."""

from typing import Any

import casadi as ca
import numpy as np
import pytest

from cosim.symbols import Namespace
from cosim.twin import PythonInstance
from plants.wheel_deformation import WheelDeformation
from plants.wheels import cornering, friction

NS = 1_000_000_000
STEP = 1_000_000  # ns
K = 2e5  # N/m
TOLERANCE = 1e-10
# Mounting points (m), mass and inertia of a body, for a P of full rank: the fifth term is a soft twist of its frame.
X, Y = np.array([0.6, 0.6, -0.46, -0.46]), np.array([0.29, -0.29, 0.29, -0.29])
P = 1 / 170 + np.outer(Y, Y) / 20 + np.outer(X, X) / 47 + np.outer(X * Y, X * Y) / 1.0
U = np.outer(X, np.ones(4)) * 0.5 / 47


def started(seed: int, **parameters: Any) -> PythonInstance:
    """Wheels that fall on the ground unevenly and are driven and dragged sideways, differently for each seed."""
    rng = np.random.default_rng(seed)
    instance = WheelDeformation(k_w=K, **parameters).instance("wheels")
    instance.enter_initialization(0, None, TOLERANCE)
    instance.set("P", P)
    instance.set("U", U)
    instance.set("b_free", rng.uniform(-15, -5, 4))
    instance.set("gap", rng.uniform(-1e-3, 2e-3, 4))
    instance.set("gap_rate", rng.uniform(-1, 0.5, 4))
    instance.set("contact_velocity", rng.uniform(-2, 2, (4, 2)))
    instance.set("traction_demand", rng.uniform(-800, 800, 4))
    instance.exit_initialization()
    return instance


def chained(instance: PythonInstance, steps: int) -> Any:
    """Step on, handing the wheels' own deformation back as the gap, so that the steps join to one motion."""
    for k in range(steps):
        instance.step(k * STEP, (k + 1) * STEP)
        yield instance
        instance.set("gap", instance.get("deformation"))
        instance.set("gap_rate", instance.get("deformation_rate"))


@pytest.mark.parametrize("damping", [0.0, 300.0, 5000.0])
def test_energy_is_kept_or_accounted_for(damping: float) -> None:
    """Relative motion z'' = P F + b has the kinetic energy z' P^-1 z' / 2 and the potential -z P^-1 b, P symmetric.

    With no traction their sum with the elastic and the dissipated energy is constant, through impacts, releases of
    pressed wheels and flights, to the integrator's tolerance times its steps (some 1e3).
    """
    instance = started(1, c_w=damping)
    instance.set("traction_demand", np.zeros(4))
    b, inverse = instance.get("b_free"), np.linalg.inv(P)

    def mechanical(z: np.ndarray, rate: np.ndarray) -> float:
        return float(rate @ inverse @ rate / 2 - z @ inverse @ b)

    gap, rate = instance.get("gap"), instance.get("gap_rate")
    total = mechanical(gap, rate) + K * np.sum(np.minimum(gap, 0) ** 2) / 2
    dissipated, touched, left = 0.0, 0, 0
    for w in chained(instance, 60):
        now = mechanical(w.get("deformation"), w.get("deformation_rate")) + w.get("elastic_energy")
        assert abs(now + w.get("dissipated_energy") - total) < 1e-6 * total
        assert w.get("dissipated_energy") >= dissipated - 1e-9 * total
        dissipated = w.get("dissipated_energy")
        touched, left = touched + np.sum(w.get("contact")), left + np.sum(1 - w.get("contact"))
    assert touched > 0
    assert left > 0
    assert (dissipated > 0.1 * total) == (damping > 0)


@pytest.mark.parametrize("seed", range(3))
def test_forces_push_stay_in_the_cone_and_carry_the_momentum(seed: int) -> None:
    """The ellipse bounds the means as well: it is convex, and its width is proportional to F_n."""
    mu, sliding = 0.6, 0.0
    instance = started(seed, c_w=400.0, mu=mu)
    for w in chained(instance, 60):
        normal, traction, lateral = w.get("normal_force"), w.get("traction"), w.get("lateral")
        slack = 1e-6 * np.max(normal) + 1e-9  # the integrator's tolerance
        assert np.all(normal >= 0)
        assert np.all(w.get("normal_force_end") >= 0)
        assert np.all(np.hypot(traction, lateral) <= mu * normal + slack)
        np.testing.assert_allclose(w.get("friction_limit"), mu * normal, rtol=1e-14)
        np.testing.assert_allclose(w.get("normal_impulse"), normal * STEP / NS, rtol=1e-12, atol=0)
        assert np.all(lateral * w.get("contact_velocity")[:, 1] <= 0)  # against the sideslip
        assert w.get("sliding_energy") >= sliding
        sliding = w.get("sliding_energy")
    assert sliding > 0


def test_friction_is_inside_the_ellipse_at_every_load() -> None:
    names = {"traction_demand": (4, 1), "contact_velocity": (4, 2), "mu": (1, 1), "C_alpha": (1, 1), "v_min": (1, 1)}
    symbols = {n: ca.SX.sym(n, *shape) for n, shape in names.items()}
    load = ca.SX.sym("load", 4)
    given = Namespace(**symbols)
    forces = friction(given, load, cornering(given))
    slope = ca.jacobian(ca.vertcat(*forces), ca.vertcat(load, ca.vec(symbols["contact_velocity"])))
    evaluate = ca.Function("friction", [load, *symbols.values()], [*forces, slope])
    rng = np.random.default_rng(7)
    for _ in range(1000):
        loads = rng.choice([0.0, 1e-9, 1e-3, 1.0, 1e3, 1e6], 4)
        demand = rng.choice([0.0, -1e-9, 1.0, -500.0, 1e9], 4)
        velocity = rng.choice([0.0, 1e-9, -0.1, 3.0], (4, 2))
        values = (loads, demand, velocity, rng.choice([0.0, 0.8, 1e6]), 5e3, 0.1)
        traction, lateral, slopes = (np.asarray(v).ravel() for v in evaluate(*values))
        limit = values[3] * loads
        assert np.all(np.abs(traction) <= limit)
        assert np.all(np.hypot(traction, lateral) <= limit * (1 + 1e-12))
        assert np.all(np.isfinite(slopes))  # no slope is lost at the rim or at no load


def test_a_symmetric_landing_stays_symmetric_to_the_bit() -> None:
    instance = started(1, c_w=300.0)
    for name in ("gap", "gap_rate", "b_free", "traction_demand"):
        front, rear = instance.get(name)[[0, 2]]
        instance.set(name, np.array([front, front, rear, rear]))
    for w in chained(instance, 20):
        for name in ("normal_force", "traction", "deformation", "deformation_rate"):
            value = w.get(name)
            np.testing.assert_array_equal(value[[0, 2]], value[[1, 3]])
