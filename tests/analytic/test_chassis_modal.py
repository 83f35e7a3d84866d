"""The modal plant: its exact step against the matrix exponential, closed forms, and its energy."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.signal import lfilter

from cosim.clock import NS
from plants.chassis_modal import ChassisModal, static_deflection

MODES, STATIONS = 6, 5
RNG = np.random.default_rng(7)
FREQUENCY = np.sort(RNG.uniform(20, 400, MODES))
WHEEL, STATION = RNG.normal(size=(4, MODES)), RNG.normal(size=(STATIONS, MODES))


def chassis(zeta: float = 5e-5) -> ChassisModal:
    return ChassisModal(modes=MODES, stations=STATIONS, frequency=FREQUENCY, damping=zeta,
                        wheel_shape=WHEEL, station_shape=STATION)  # fmt: skip


@pytest.mark.parametrize("zeta", [0.0, 5e-5, 0.05, 0.7])
@pytest.mark.parametrize("dt", [1e-7, 1e-4, 1e-2])
def test_step_is_the_matrix_exponential(zeta: float, dt: float) -> None:
    instance = chassis(zeta).instance()
    q, rate, force = RNG.normal(size=MODES), RNG.normal(size=MODES), RNG.normal(size=4) * 1e3
    for name, value in (("modal_q", q), ("modal_rate", rate), ("wheel_force", force)):
        instance.set(name, value)
    instance.enter_initialization(0)
    instance.exit_initialization()
    instance.step(0, round(dt * NS))
    for i, w in enumerate(2 * pi * FREQUENCY):
        A = np.array([[0, 1, 0], [-(w**2), -2 * zeta * w, WHEEL[:, i] @ force], [0, 0, 0]])
        exact = expm(A * dt) @ [q[i], rate[i], 1]
        scale = np.array([1, w]) * np.hypot(q[i], rate[i] / w) + np.abs(WHEEL[:, i] @ force) * np.array(
            [1 / w**2, 1 / w]
        )
        # both lose w dt eps in the phase; expm some roundings more by squaring
        assert np.all(
            np.abs([instance.get("modal_q")[i], instance.get("modal_rate")[i]] - exact[:2])
            < 1e-12 * scale * (1 + w * dt)
        )


def test_a_step_may_be_split_anywhere() -> None:
    whole, parts = chassis(0.01).instance(), chassis(0.01).instance()
    for instance in (whole, parts):
        instance.set("wheel_force", np.array([300.0, -100.0, 50.0, 0.0]))
        instance.enter_initialization(0)
        instance.exit_initialization()
    whole.step(0, 1_000_000)
    for start, end in ((0, 7), (7, 400_001), (400_001, 1_000_000)):
        parts.step(start, end)
    # three steps instead of one: a few roundings of the largest amplitude, 2 f / w^2
    np.testing.assert_allclose(parts.get("modal_q"), whole.get("modal_q"), rtol=0, atol=1e-14)


def test_rectangular_pulse_against_the_closed_form() -> None:
    """Acceleration of a mode under a pulse of length Td: f (q(t) - q(t - Td)), q = e^{-zwt} (cos - zw/w_d sin)."""
    zeta, Td, F = 0.02, 0.05, 1000.0
    instance = chassis(zeta).instance()
    instance.enter_initialization(0)
    instance.exit_initialization()
    w = 2 * pi * FREQUENCY
    wd = w * np.sqrt(1 - zeta**2)
    kernel = lambda t: np.where(t >= 0, np.exp(-zeta * w * t) * (np.cos(wd * t) - zeta * w / wd * np.sin(wd * t)), 0)  # noqa: E731
    step = 1_000_000
    for k in range(100):
        instance.set("wheel_force", np.array([F if k * step < Td * NS else 0.0, 0, 0, 0]))
        instance.step(k * step, (k + 1) * step)
        t = (k + 1) * step / NS
        exact = STATION @ (F * WHEEL[0] * (kernel(t) - kernel(t - Td)))
        instance.set("wheel_force", np.array([F if t < Td else 0.0, 0, 0, 0]))  # right-hand limit, as the closed form
        np.testing.assert_allclose(instance.get("acceleration"), exact, atol=1e-9 * F, rtol=0)


def test_against_an_independent_recursion() -> None:
    """One mode by SciPy's filter with the poles of a sampled oscillator, random forces held over each step."""
    dt, n, i = 1e-4, 400, 2
    forces = RNG.normal(size=n)
    instance = chassis(0.03).instance()
    instance.enter_initialization(0)
    instance.exit_initialization()
    found = []
    for k, F in enumerate(forces):
        instance.set("wheel_force", np.array([F, 0, 0, 0]))
        instance.step(round(k * dt * NS), round((k + 1) * dt * NS))
        found.append(instance.get("modal_q")[i])
    w = 2 * pi * FREQUENCY[i]
    A = np.array([[0, 1], [-(w**2), -0.06 * w]])
    E = expm(A * dt)
    B = np.linalg.solve(A, (E - np.eye(2)) @ [0, WHEEL[0, i]])
    a = np.poly(E)
    b = [B[0], E[0, 1] * B[1] - E[1, 1] * B[0]]
    # the filter's recursion loses digits as its poles near the unit circle: eps / (w dt)^2 of the amplitude
    np.testing.assert_allclose(found, lfilter(b, a, forces), rtol=0, atol=1e-9 * np.max(np.abs(found)))


def test_energy_without_damping_is_the_work_done() -> None:
    """Held force: work = force times displacement of the wheel nodes = strain + kinetic energy from rest."""
    instance = chassis(0.0).instance()
    force = np.array([400.0, 100.0, -50.0, 20.0])
    instance.set("wheel_force", force)
    instance.enter_initialization(0)
    instance.exit_initialization()
    for k in range(50):
        instance.step(k * 777_777, (k + 1) * 777_777)
        work = force @ WHEEL @ instance.get("modal_q")
        np.testing.assert_allclose(
            instance.get("strain_energy") + instance.get("elastic_kinetic_energy"), work, rtol=1e-10
        )


def test_static_deflection_stays() -> None:
    component = chassis(0.01)
    force = np.array([361.8, 361.8, 472.0, 472.0])
    instance = component.instance()
    instance.set("wheel_force", force)
    instance.set("modal_q", static_deflection(component, force))
    instance.enter_initialization(0)
    instance.exit_initialization()
    instance.step(0, 10_000_000)
    # f - w^2 q cancels to eps f, which the shapes carry to the stations
    assert np.max(np.abs(instance.get("acceleration"))) < 1e-11 * np.max(np.abs(force))
