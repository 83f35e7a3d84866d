"""State space of the impact (thesis 6.4) and the gains designed on it, against closed forms and SciPy."""

from __future__ import annotations

import control
import numpy as np
import pytest
from scipy.linalg import expm, solve_discrete_are

from controllers import state_space as ss
from controllers.axles import wheel_forces_from_axles, wheel_motions_from_axles, wheels_from_axles
from controllers.observer import observer_gain, observer_system
from cosim.errors import DeclarationError
from plants.planar import Bicycle, Posture
from plants.tables import ROBOTS

K_W = 5.6e6  # N/m per axle
SIDE, AT = Bicycle(ROBOTS["thesis_6_1"]), Posture(front=0.3)
P, U = SIDE.P(AT), SIDE.U(AT)
MODEL = ss.impact_model(P, U, K_W)
POLES = ss.conjugate_poles([150.0, 200.0], 0.7)
PERIODS = (1e-4, 5e-4, 1e-3, 3e-3)  # s


def test_open_loop_swings_at_the_frequencies_of_the_thesis_robot() -> None:
    """226.6 and 253.8 rad/s, undamped: +k_w P; as printed (6.16) the poles would be real, a spring that pulls."""
    poles = MODEL.poles()
    np.testing.assert_allclose(np.sort(np.abs(poles))[::2], [226.6, 253.8], atol=0.05)  # as printed, one decimal
    assert np.max(np.abs(poles.real)) < 1e-9 * np.max(np.abs(poles))
    assert MODEL.state_labels == ["z_rear", "z_front", "z_rate_rear", "z_rate_front"]
    assert MODEL.input_labels == ["F_rear", "F_front"]


def test_model_is_the_equation_of_motion() -> None:
    """The rates against P F_n + U F_a with F_n = -k_w z - c_w z', for any state and force."""
    rng = np.random.default_rng(3)
    z, rate, F = rng.normal(size=2), rng.normal(size=2), rng.normal(size=2)
    model = ss.impact_model(P, U, K_W, 300.0)
    wanted = np.concatenate([rate, P @ (-K_W * z - 300.0 * rate) + U @ F])
    np.testing.assert_allclose(model.A @ np.concatenate([z, rate]) + model.B @ F, wanted, rtol=1e-12)


@pytest.mark.parametrize("period", PERIODS)
def test_poles_are_where_they_were_placed(period: float) -> None:
    """The sampled closed loop by SciPy's matrix exponential, so that nothing of the design checks itself."""
    K = ss.pole_gain(MODEL, POLES, period)
    whole = expm(period * np.block([[MODEL.A, MODEL.B], [np.zeros((2, 6))]]))
    poles = np.log(np.linalg.eigvals(whole[:4, :4] - whole[:4, 4:] @ K).astype(complex)) / period
    # rounding of A (|A| T ~ 10) spread by the conditioning of the eigenvectors, below 1e4
    np.testing.assert_allclose(np.sort_complex(poles), np.sort_complex(POLES), rtol=1e-8)
    np.testing.assert_allclose(
        np.sort_complex(ss.closed_loop_poles(MODEL, K, period)), np.sort_complex(POLES), rtol=1e-8
    )


def test_a_gain_designed_for_continuous_time_would_not_do() -> None:
    """What the discrete design is for: the gain of a short period, held for a long one, misses by more than 5 %."""
    K = ss.pole_gain(MODEL, POLES, 1e-6)
    poles = ss.closed_loop_poles(MODEL, K, 1e-3)
    assert np.max(np.abs(np.sort_complex(poles) - np.sort_complex(POLES)) / np.abs(POLES)) > 0.05


def test_lqr_is_the_solution_of_the_riccati_equation() -> None:
    weights = ss.Weights(z=4e-4, z_rate=0.1, force=1e4)
    K = ss.lqr_gain(MODEL, weights, 1e-3)
    d = ss.sampled(MODEL, 1e-3)
    Q = np.diag([1 / weights.z**2] * 2 + [1 / weights.z_rate**2] * 2)
    R = np.eye(2) / weights.force**2
    S = solve_discrete_are(d.A, d.B, Q, R)
    np.testing.assert_allclose(K, np.linalg.solve(R + d.B.T @ S @ d.B, d.B.T @ S @ d.A), rtol=1e-6)
    assert np.all(ss.closed_loop_poles(MODEL, K, 1e-3).real < 0)


def test_feed_forward_holds_the_deformation() -> None:
    """0 = -P k_w z + U F_a + b at the chosen z; without traction, the static deflection -0.152 and -0.145 mm."""
    b = SIDE.b(AT, np.zeros(3))
    z = np.array([-0.01, -0.02])
    forward = ss.feed_forward(P, U, K_W)
    F = forward.per_z @ z - forward.per_b @ b
    # terms of 1e3 m/s2 cancel to rounding
    np.testing.assert_allclose(-P @ z * K_W + U @ F + b, 0, atol=1e-9)
    np.testing.assert_allclose(1e3 * ss.static_deflection(P, b, K_W), [-0.152, -0.145], atol=5e-4)


def test_steady_traction_of_the_thesis() -> None:
    """z_R = -10 and -20 mm takes +628.9 and -470.9 kN where traction acts at the wheel centres (derived, not print)."""
    side = Bicycle(ROBOTS["thesis_6_1"], "centre")
    forward = ss.feed_forward(side.P(AT), side.U(AT), K_W)
    F = forward.per_z @ [-0.01, -0.02] - forward.per_b @ side.b(AT, np.zeros(3))
    np.testing.assert_allclose(F / 1e3, [628.9, -470.9], atol=0.05)


@pytest.mark.parametrize("period", PERIODS[:3])
def test_observer_error_has_its_poles(period: float) -> None:
    """The error of the corrected estimate, e -> (I - L C) A e, by SciPy's matrix exponential."""
    poles = ss.conjugate_poles([400.0, 500.0], 0.8)
    for c_w in (0.0, 300.0):
        model = ss.impact_model(P, U, K_W, c_w)
        L = observer_gain(model, poles, K_W, c_w, period)
        C = np.hstack([-K_W * np.eye(2), -c_w * np.eye(2)])
        M = (np.eye(4) - L @ C) @ expm(period * model.A)
        found = np.log(np.linalg.eigvals(M).astype(complex)) / period
        np.testing.assert_allclose(np.sort_complex(found), np.sort_complex(poles), rtol=1e-7)


def test_observer_as_a_system_finds_the_state() -> None:
    """Simulated by python-control beside the model: whatever the tractions, the estimate joins the state.

    exp(-320 rad/s * 0.1 s) = 1e-14 of the start, and rounding of numbers of that size.
    """
    T = 5e-4
    L = observer_gain(MODEL, ss.conjugate_poles([400.0, 500.0], 0.8), K_W, 0.0, T)
    watcher = observer_system(MODEL, L, K_W, 0.0, T)
    assert watcher.output_labels == MODEL.state_labels
    assert watcher.input_labels == ["F_rear", "F_front", "Fn_rear", "Fn_front"]
    t = T * np.arange(201)
    F = np.random.default_rng(4).normal(size=(2, len(t)), scale=100.0)
    plant = ss.sampled(MODEL, T)
    x = control.forced_response(plant, t, F, [1e-3, -1e-3, 0.1, 0.3]).states
    estimate = control.forced_response(watcher, t, np.vstack([F, -K_W * x[:2]])).outputs
    assert np.max(np.abs(estimate[:, 0] - x[:, 0])) > 0.1
    np.testing.assert_allclose(estimate[:, -1], x[:, -1], atol=1e-10)


def test_axles_act_on_wheels() -> None:
    """A matrix for axles, written for wheels, gives every wheel its axle's motion and half of its axle's force."""
    axle = np.array([[1.0, 2.0], [3.0, 4.0]])  # rear, front
    forces = np.array([5.0, 7.0, 11.0, 13.0])  # fl, fr, rl, rr: sums 12 and 24
    front, rear = 3 * 24 + 4 * 12, 1 * 24 + 2 * 12
    np.testing.assert_array_equal(wheels_from_axles(axle) @ forces, [front, front, rear, rear])
    z = np.array([5.0, 7.0, 11.0, 13.0])  # means 6 and 12
    front, rear = 3 * 12 + 4 * 6, 1 * 12 + 2 * 6
    np.testing.assert_array_equal(wheel_motions_from_axles(axle) @ z, [front, front, rear, rear])
    np.testing.assert_array_equal(wheel_forces_from_axles(axle) @ z, np.array([front, front, rear, rear]) / 2)


def test_four_equal_wheels_swing_like_their_axles() -> None:
    """P of single wheels, made of the axles' P, has the axles' frequencies; the rest of it is still."""
    wheels = ss.impact_model(wheels_from_axles(P), wheels_from_axles(U), K_W / 2)
    found = np.sort(np.abs(wheels.poles()))
    np.testing.assert_allclose(found[4:], np.sort(np.abs(MODEL.poles())), rtol=1e-9)
    # sqrt(eps) of a double zero eigenvalue, times the frequency
    assert np.max(found[:4]) < 1e-5 * np.max(found)


def test_damping_ratio_and_frequency_make_the_poles() -> None:
    np.testing.assert_allclose(np.poly(ss.conjugate_poles(30.0, 0.4)), [1, 2 * 0.4 * 30, 900], rtol=1e-12)
    np.testing.assert_allclose(np.poly(ss.conjugate_poles(30.0, 1.5)), [1, 2 * 1.5 * 30, 900], rtol=1e-12)


@pytest.mark.parametrize(
    ("poles", "period", "says"),
    [
        ([-100 + 50j, -100 - 40j, -60, -70], 1e-3, r"-100\+50j rad/s comes without its conjugate -100-50j rad/s"),
        ([-100 + 50j, -100 + 50j, -100 - 50j, -70], 1e-3, "comes without its conjugate"),
        ([-1000, -1100, -50, -60], 1e-2, r"a period of 0.01 s is too long for -1100 rad/s; take at most 0.00091 s"),
        ([-100, -110, -50], 1e-3, "3 were asked for, but the model has 4 states"),
        ([-100, 110, -50, -60], 1e-3, "110 rad/s does not decay"),
        ([-100, -100, -100, -60], 1e-3, "one is asked for 3 times, but 2 forces"),
    ],
)
def test_poles_that_cannot_be_had_are_refused(poles: list[complex], period: float, says: str) -> None:
    with pytest.raises(DeclarationError, match=says):
        ss.pole_gain(MODEL, np.array(poles), period)


def test_a_model_that_the_tractions_cannot_move_is_refused() -> None:
    """On the flat traction gives a moment only; with the centre of mass in the middle it cannot move the heave.

    Heave swings at sqrt(2 k_w / m) = 256.7 rad/s.
    """
    even = Bicycle(ROBOTS["thesis_6_1"].with_changes(L_f=0.46))
    model = ss.impact_model(even.P(Posture(0.0)), even.U(Posture(0.0)), K_W)
    for design in (
        lambda: ss.pole_gain(model, POLES, 1e-3),
        lambda: ss.lqr_gain(model, ss.Weights(1e-3, 0.1, 1e3), 1e-3),
    ):
        with pytest.raises(DeclarationError, match=r"F_rear, F_front cannot move the mode at 256.7 rad/s"):
            design()
