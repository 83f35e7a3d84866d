"""Pulses and the exact response of modes: against quadrature, the chassis' equations integrated, and pyyeti."""

from __future__ import annotations

from itertools import pairwise
from math import pi

import numpy as np
import pytest
from pyyeti.ode import SolveUnc
from scipy.integrate import quad, solve_ivp

from cosim.errors import ScenarioError
from plants.chassis_modes import ModalData
from plants.pulses import SHAPES, Pulse
from plants.shock import held_response, pulse_response, station_response
from plants.shock_fourier import coefficients, fourier_response, printed_coefficients
from plants.shock_loads import (
    SYMMETRIC,
    TABLE_8_1,
    free_amplitude,
    load_factor,
    rigid_reaction,
    still_reaction,
    wheel_load,
)

FREQUENCY = np.array([24.0, 66.5, 139.0, 421.0])  # Hz
T = 0.05  # s


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("omega", [0.0, pi / T, 2 * pi / T, 400.0])
def test_transform_is_the_integral(shape: str, omega: float) -> None:
    """At the removable singularities of the half-sine and the versed sine as well."""
    pulse = Pulse(shape, T, 3.0)
    parts = [
        quad(
            lambda t, turn=turn: float(pulse.force(np.array(t))) * turn(omega * t), 0, T, points=[T / 2], epsabs=1e-13
        )[0]
        for turn in (np.cos, np.sin)
    ]
    assert pulse.transform(omega) == pytest.approx(parts[0] - 1j * parts[1], abs=1e-10)


@pytest.mark.parametrize("shape", SHAPES)
def test_series_comes_back_to_the_pulse(shape: str) -> None:
    pulse = Pulse(shape, T)
    t = (np.arange(3000) + 0.5) * 1e-4  # between the jumps, where a series takes the mean
    off = pulse.series(0.3, 20_000.0).force(t) - pulse.force(t)
    # a jump of 1 has harmonics 2 |sin|/(pi j): those above N = 6000 leave an rms of 1/(pi sqrt N); half as much again
    assert np.sqrt(np.mean(off**2)) < 1.5 / (pi * np.sqrt(6000))


@pytest.mark.parametrize("zeta", [0.0, 5e-5, 0.05])
@pytest.mark.parametrize("shape", SHAPES)
def test_closed_form_solves_the_equation(shape: str, zeta: float) -> None:
    """Against an integrator with error control, restarted where the force starts or stops something."""
    pulse, w = Pulse(shape, T, 2.0), 2 * pi * FREQUENCY
    times = [0.0, T / 2, T, 2 * T]
    state, found = np.zeros(2 * len(w)), []
    for a, b in pairwise(times):
        middle = (a + b) / 2

        def rate(t: float, x: np.ndarray, a: float = a, b: float = b, middle: float = middle) -> np.ndarray:
            inside = middle + (t - middle) * (1 - 1e-12)  # the force of this piece at its ends too
            q, v = np.split(x, 2)
            return np.concatenate([v, float(pulse.force(np.array(inside))) - 2 * zeta * w * v - w**2 * q])

        state = solve_ivp(rate, (a, b), state, method="DOP853", rtol=1e-11, atol=1e-15).y[:, -1]
        found.append(state)
    exact = pulse_response(FREQUENCY, zeta, pulse, np.array(times[1:]))
    q, v = np.split(np.array(found).T, 2)
    # some 100 cycles of the highest mode at a relative tolerance of 1e-11 a step
    np.testing.assert_allclose(exact.q * w[:, None] ** 2, q * w[:, None] ** 2, atol=1e-7)
    np.testing.assert_allclose(exact.rate * w[:, None], v * w[:, None], atol=1e-7)


def test_resonance_without_damping_is_finite() -> None:
    """A half-sine of half a period of the mode: q = (sin wt - wt cos wt)/(2 w^2) while it lasts."""
    w = 2 * pi * 10.0
    t = np.linspace(0, 0.0499, 50)
    found = pulse_response(np.array([10.0]), 0.0, Pulse("half-sine", 0.05), t).q[0]
    np.testing.assert_allclose(found, (np.sin(w * t) - w * t * np.cos(w * t)) / (2 * w**2), atol=1e-15)


@pytest.mark.parametrize("shape", SHAPES)
def test_rest_after_a_pulse_is_its_spectrum(shape: str) -> None:
    pulse = Pulse(shape, T)
    t = np.linspace(T, T + 2 / FREQUENCY[0], 40_001)
    found = np.max(np.abs(pulse_response(FREQUENCY, 0.0, pulse, t).acceleration), axis=1)
    # sampled every 2 us: cos of half a step of 421 Hz off the peak
    np.testing.assert_allclose(found, free_amplitude(pulse, FREQUENCY), rtol=1e-5, atol=1e-9)
    if shape == "rectangular":
        np.testing.assert_allclose(found, 2 * np.abs(np.sin(pi * FREQUENCY * T)), rtol=1e-5, atol=1e-9)


def test_held_response_equals_pyyeti() -> None:
    """The same hold (order 0) over 10 000 random steps, relative to the largest value: both round, no more."""
    rng = np.random.default_rng(3)
    w, dt, zeta = 2 * pi * FREQUENCY, 1e-4, np.array([5e-5, 1e-3, 0.02, 0.2])
    force = rng.normal(size=(4, 10_001))
    reference = SolveUnc(np.ones(4), 2 * zeta * w, w**2, dt, order=0).tsolve(force)
    found = held_response(FREQUENCY, zeta, np.arange(10_001) * dt, force)
    for ours, theirs in ((found.q, reference.d), (found.rate, reference.v), (found.acceleration, reference.a)):
        assert np.max(np.abs(ours - theirs)) < 1e-9 * np.max(np.abs(theirs))


def test_held_response_over_uneven_steps() -> None:
    """A rectangular pulse whose edges lie on the times, the rest of them anywhere: the closed form at all of them."""
    rng = np.random.default_rng(4)
    t = np.sort(np.concatenate([[0.0, T], rng.uniform(0, 0.2, 300)]))
    pulse = Pulse("rectangular", T)
    exact = pulse_response(FREQUENCY, 1e-3, pulse, t)
    found = held_response(FREQUENCY, 1e-3, t, pulse.force(t))
    for name in ("q", "rate", "acceleration"):
        wanted = getattr(exact, name)
        # 300 steps, each with a rounding of e^{s dt}
        np.testing.assert_allclose(getattr(found, name), wanted, rtol=0, atol=1e-12 * np.max(np.abs(wanted)))


def test_held_response_starts_at_rest_where_it_is_told_to() -> None:
    force = np.full((4, 50), 2.0)
    still = 2.0 / (2 * pi * FREQUENCY) ** 2
    for t in (np.arange(50) * 1e-3, np.cumsum(np.linspace(1e-3, 2e-3, 50))):
        found = held_response(FREQUENCY, 0.01, t, force, still, left=True)
        np.testing.assert_allclose(found.q, still[:, None].repeat(50, 1), rtol=1e-12)
        assert np.max(np.abs(found.acceleration)) < 1e-11


@pytest.mark.parametrize("zeta", [5e-5, 0.1])
def test_amplitudes_of_the_thesis(zeta: float) -> None:
    """From rest, and all printed ones too small by the same root."""
    w, p = 2 * pi * FREQUENCY, np.linspace(10, 3000, 50)
    right, printed = coefficients(w, np.full(4, zeta), p), printed_coefficients(w, np.full(4, zeta), p)
    wd = (w * np.sqrt(1 - zeta**2))[:, None]
    scale = np.max(np.abs(right.A_s))
    np.testing.assert_allclose(right.B_t + right.B_s, 0, atol=1e-15 * scale)
    np.testing.assert_allclose(right.D_t + right.D_s, 0, atol=1e-15 * scale)
    rates = wd * right.A_t - zeta * w[:, None] * right.B_t + p * right.A_s
    np.testing.assert_allclose(rates, 0, atol=1e-12 * scale * w.max())
    for name in ("A_t", "B_t", "A_s", "B_s", "C_t", "D_t", "C_s", "D_s"):
        ours, theirs = getattr(right, name), getattr(printed, name)
        np.testing.assert_allclose(theirs, ours * np.sqrt(1 - zeta**2), rtol=1e-10, atol=1e-12 * scale)


def test_series_converges_to_the_exact_response() -> None:
    """A versed sine has harmonics that fall with the third power; a rectangular pulse leaves what is above the top."""
    t = np.linspace(0, 0.5, 2001)
    errors = {}
    for shape in ("versed-sine", "rectangular"):
        exact = pulse_response(FREQUENCY, 5e-5, Pulse(shape, T), t).acceleration
        for top in (200.0, 2000.0):
            off = fourier_response(FREQUENCY, 5e-5, Pulse(shape, T), t, top=top).acceleration - exact
            errors[shape, top] = np.sqrt(np.mean(off**2) / np.mean(exact**2))
    assert errors["versed-sine", 2000.0] < 1e-4 < errors["versed-sine", 200.0] < 0.05
    assert errors["rectangular", 2000.0] < 0.05 < errors["rectangular", 200.0] < 1


def test_mean_is_what_is_missing_as_printed() -> None:
    """Its response is the step T/3 from rest, 2 F T/P at its largest: 0.033 of F for 0.05 s of 3 s."""
    t, pulse = np.linspace(0, 0.2, 4001), Pulse("rectangular", T)
    off = fourier_response(FREQUENCY, 5e-5, pulse, t).q - fourier_response(FREQUENCY, 5e-5, pulse, t, printed=True).q
    np.testing.assert_allclose(
        np.max(np.abs(off), axis=1) * (2 * pi * FREQUENCY) ** 2, 2 * T / 3, rtol=1e-3
    )  # fmt: skip


@pytest.mark.parametrize(("shape", "printed"), [("rectangular", 7.10), ("half-sine", 6.27), ("triangular", 5.16)])
def test_load_factors_of_the_paper(shape: str, printed: float) -> None:
    assert round(load_factor(Pulse(shape, 0.15), 1 / 3.98, 3.82), 2) == printed


def test_reactions() -> None:
    """Table 8.1: 1.30 and 1.23 without rotation; 0.264 = (m Lf Lr - Iy)/(Iy + m Lr^2) if the rear axle stays down."""
    assert still_reaction("four", TABLE_8_1) == pytest.approx(0.6 / 0.46)
    assert round(still_reaction("diagonal", TABLE_8_1), 4) == 1.2255
    assert still_reaction("four") == still_reaction("diagonal", SYMMETRIC) == 1.0
    m, I_y = 270.0, 47.0
    planar = (m * 0.6 * 0.46 - I_y) / (I_y + m * 0.46**2)
    assert rigid_reaction("four", TABLE_8_1, m, 20.0, I_y) == pytest.approx(planar, rel=1e-12)
    assert round(planar, 3) == 0.264
    np.testing.assert_allclose(wheel_load("diagonal", total=1000.0), [500, 0, 0, 500])


def test_station_response_is_the_sum_over_modes() -> None:
    """One mode of one station: phi_station phi_wheel F times the mode's own response."""
    data = ModalData(
        np.array([30.0]), np.array([0.01]), np.array([[0.1], [0.2], [0.3], [0.4]]), np.array([[0.5]]), ("a",)
    )
    t, pulse = np.linspace(0, 0.1, 101), Pulse("triangular", T)
    alone = pulse_response(data.frequency, data.damping, pulse, t).acceleration[0]
    found = station_response(data, np.array([1.0, 0, 0, 2.0]), pulse, t)
    np.testing.assert_allclose(found[:, 0], 0.5 * (0.1 + 0.8) * alone, rtol=1e-14)


def test_what_is_no_pulse_is_said() -> None:
    with pytest.raises(ScenarioError, match="no pulse 'square'"):
        Pulse("square", 0.1)
    with pytest.raises(ScenarioError, match="its duration must be positive"):
        Pulse("rectangular", 0.0)
    with pytest.raises(ScenarioError, match="cannot be repeated every"):
        Pulse("rectangular", 2.0).series(1.0, 10.0)
    with pytest.raises(ScenarioError, match="no load case 'triple'"):
        wheel_load("triple")
