"""Rigid wheels against statics, impact closed forms and the flight of a ball.

The body is the smallest one that shows it: the gaps themselves, with gap'' = P F_n + U F_a + b_free, integrated exactly
under the constant force of a step, as `RigidBody` is.
"""

from typing import Any

import numpy as np
import pytest

from cosim.twin import PythonInstance
from plants.rigid_body import RigidBody
from plants.rigid_contact import RigidContact
from plants.wheel_deformation import WheelDeformation

H = 100_000  # ns
DT = 1e-4  # s
G = 9.81
# Mounting points (x forward, y left, m), inertia and height of a rover on the flat: P has rank 3, U rank 1.
LF, LR, HALF, IX, IY, HEIGHT = 0.6, 0.46, 0.29, 20.0, 47.0, 0.5
X, Y = np.array([LF, LF, -LR, -LR]), np.array([HALF, -HALF, HALF, -HALF])
U = np.outer(X, np.ones(4)) * HEIGHT / IY


def flat(m: float) -> np.ndarray:
    return 1 / m + np.outer(Y, Y) / IX + np.outer(X, X) / IY


class Drop:
    """Contacts and the gaps of their body, stepped in turn."""

    def __init__(self, P: np.ndarray, gap: Any, rate: Any, b: Any, U: np.ndarray = U, **values: Any) -> None:
        given = ("traction_demand", "contact_velocity", "V", "sideslip_mobility")
        inputs = {n: values.pop(n) for n in tuple(values) if n in given}
        self.contacts: PythonInstance = RigidContact(**values).instance("contacts")
        self.P, self.U, self.b, self.steps = P, U, np.broadcast_to(float(b) if np.ndim(b) == 0 else b, 4), 0
        self.V = np.asarray(inputs.get("V", np.zeros((4, 4))))
        self.gap, self.rate = np.array(np.broadcast_to(gap, 4), float), np.array(np.broadcast_to(rate, 4), float)
        for name, value in {"P": P, "U": U, "b_free": self.b, **inputs}.items():
            self.contacts.set(name, np.broadcast_to(value, self.contacts.variables[name].shape))

    def step(self, n: int = 1) -> None:
        """Advance contacts and body by *n* steps."""
        for _ in range(n):
            self.contacts.set("gap", self.gap)
            self.contacts.set("gap_rate", self.rate)
            self.contacts.set("b_free", self.b + self.V @ self["lateral"])  # the body knows those of the last step
            self.contacts.step(self.steps * H, (self.steps + 1) * H)
            pushed = self.P @ self["normal_force"] + self.U @ self["traction"] + self.V @ self["lateral"]
            change = DT * (pushed + self.b)
            self.gap, self.rate = self.gap + DT * (self.rate + change / 2), self.rate + change
            self.steps += 1

    def __getitem__(self, name: str) -> Any:
        return self.contacts.get(name)


def test_it_has_the_ports_of_the_deformable_wheels() -> None:
    """And an input more, which the body has for it: how lateral forces move the gaps."""

    def ports(component: Any) -> dict[str, Any]:
        described = {n: (v.causality, v.shape, v.unit) for n, v in component.variables.items()}
        return {n: d for n, d in described.items() if d[0] in ("input", "output")}

    rigid, deformable, body = ports(RigidContact()), ports(WheelDeformation()), ports(RigidBody())
    more = {name: rigid.pop(name) for name in ("V",)}
    assert rigid == deformable
    assert more == {name: ("input", *body[name][1:]) for name in more}
    assert set(RigidContact().equations.feedthrough.values()) == {()}


def test_a_standing_rover_has_the_axle_loads_of_statics() -> None:
    """The front axle bears m g L_r / L, left and right alike although P leaves that open.

    The compliance eps lets the contacts creep by eps Lam, 4e-4 of the load at first, until they have sunk by
    F / k_split.  Near that depth the errors of gap and velocity shrink by sqrt(1/2) a step: 60 steps leave 4e-13.
    """
    m = 170.0
    stand = Drop(flat(m), 0.0, 0.0, -G)
    stand.step(60)
    front, rear = m * G * LR / (LF + LR) / 2, m * G * LF / (LF + LR) / 2
    np.testing.assert_allclose(stand["normal_force"], [front, front, rear, rear], rtol=1e-9)
    np.testing.assert_allclose(stand["friction_limit"], 0.8 * stand["normal_force"], rtol=1e-14)
    # They sink by F / k_split = 4e-11 m at most.
    assert np.all(np.abs(stand.gap) < 1.1 * rear / 1e13)


def test_an_uneven_load_is_shared_as_even_springs_would() -> None:
    """The forces are those of least squares: A F = load, F = A^+ load, with heave, roll and pitch in the rows of A."""
    A = np.array([np.ones(4), Y, X])
    load = np.array([170 * G, 40.0, -100.0])
    stand = Drop(flat(170.0), 0.0, 0.0, -flat(170.0) @ np.linalg.lstsq(A, load, rcond=None)[0])
    stand.step(60)
    np.testing.assert_allclose(stand["normal_force"], np.linalg.lstsq(A, load, rcond=None)[0], rtol=1e-8)


@pytest.mark.parametrize("e", [0.0, 0.5])
@pytest.mark.parametrize("m", [170.0, 270.0])
def test_a_front_impact_loads_the_rear_axle_by_the_ratio_of_P(m: float, e: float) -> None:
    """Lam_r = -(P12 / P11) Lam_f with 1 the rear axle, if that is positive; Lam_f = (1 + e) v / (P22 - P12^2 / P11).

    For m = 170 kg the rear axle is the centre of percussion but for 0.2 %, and lifts off.  The compliance is taken so
    low that its floor of 1e-5 |P| is left, which changes impulses by 1.3e-5: the least non-zero eigenvalue of P is
    0.014 1/kg, its greatest element 0.018 1/kg.
    """
    v = 0.6
    P11, P12, P22 = 1 / m + LR**2 / IY, 1 / m - LF * LR / IY, 1 / m + LF**2 / IY
    # a free acceleration that tells rest from impact, and gives m b dt = 2e-3 N.s a step
    impact, passed = Drop(flat(m), 0.0, [-v, -v, 0.0, 0.0], -0.1, e=e, k_split=1e20), np.zeros(4)
    for _ in range(2 if e else 1):  # the impact, and what it gives back
        impact.step()
        passed += impact["normal_impulse"]
    ratio = (m * LF * LR - IY) / (IY + m * LR**2)
    assert ratio == pytest.approx(-P12 / P11)
    front = (1 + e) * v / (P22 - P12**2 / P11) if ratio > 0 else (1 + e) * v / P22
    wanted = np.array([front, front, max(ratio, 0) * front, max(ratio, 0) * front]) / 2
    np.testing.assert_allclose(passed, wanted, rtol=0, atol=1e-4 * front)
    np.testing.assert_allclose(impact.rate[:2], e * v, rtol=0, atol=1e-4 * v)
    assert np.all(impact.rate[2:] >= -1e-4 * v)


def test_a_plastic_impact_takes_the_energy_of_the_normal_motion() -> None:
    """All of m v^2 / 2 but for the square of the 1e-5 that the compliance leaves."""
    masses, v = np.array([30.0, 40.0, 50.0, 60.0]), 0.5
    impact = Drop(np.diag(1 / masses), 0.0, -v, 0.0, k_split=1e20)
    impact.step()
    assert impact["dissipated_energy"] == pytest.approx(np.sum(masses) * v**2 / 2, rel=1e-8)


@pytest.mark.parametrize("phase", [0.0, 0.1, 0.5, 0.9])
def test_a_ball_bounces_to_e_squared_of_its_height(phase: float) -> None:
    """Wherever in a step it lands: landing, stopping and leaving take a step each, in which gravity gives g dt."""
    v, e, masses = 1.0, np.array(0.7), np.array([30.0, 40.0, 50.0, 60.0])
    ball = Drop(np.diag(1 / masses), v * DT * (10 + phase), -v, -G, e=float(e))
    ball.step(15)
    landed = np.sqrt(v**2 + 2 * G * v * DT * (10 + phase))
    rising = ball.rate + G * DT * 2  # it left two steps ago at the latest
    np.testing.assert_allclose(rising, e * landed, rtol=0, atol=4 * G * DT)
    heights = []
    for _ in range(1600):
        ball.step()
        heights.append(ball.gap.copy())
    np.testing.assert_allclose(np.max(heights, axis=0), (e * landed) ** 2 / (2 * G), rtol=0.02)  # 2 (4 g dt) / (e v)
    assert np.min(heights) > -v * DT  # never deeper than the way of one step


def test_a_ball_with_restitution_comes_to_rest() -> None:
    ball = Drop(np.diag([0.02] * 4), 0.01, 0.0, -G, e=0.5)
    ball.step(3000)  # (1 + e) / (1 - e) sqrt(2 z / g) = 0.14 s of bouncing, then rest
    np.testing.assert_allclose(ball["normal_force"], G / 0.02, rtol=1e-6)
    np.testing.assert_allclose(ball.gap, 0, atol=1e-9)


def test_a_plastic_impact_neither_rebounds_nor_stays_in_the_ground() -> None:
    """Spread over a step, its impulse lets it sink by v dt / 2; it rises at sqrt(2 a depth), slowed by a = 1 m/s2."""
    v, m = 0.6, 170.0
    impact = Drop(flat(m), 0.0, [-v, -v, 0.0, 0.0], -G)
    impact.step()
    depth = v * DT / 2
    # gravity's share of the first step is g dt^2, the compliance's 4e-4 of v
    np.testing.assert_allclose(-impact.gap[:2], depth, rtol=2 * G * DT / v + 1e-3)
    lost = np.zeros(4, int)
    for _ in range(300):
        impact.step()
        assert np.all(impact.rate[:2] <= np.sqrt(2 * 1.0 * depth) * 1.01)
        assert np.all(impact.gap < 1e-7)
        lost += impact["contact"] == 0
    # sqrt(2 depth / a) = 7.7 ms later all is at rest, and the fronts never lost the ground
    np.testing.assert_array_equal(lost[:2], 0)
    np.testing.assert_allclose(impact.gap, 0, atol=1e-8)
    np.testing.assert_allclose(impact.rate, 0, atol=1e-6)


def test_contacts_do_not_drift_into_the_ground() -> None:
    """5000 steps with a free acceleration that is held wrong over each: penetration stays what one step gives.

    b changes by 40 m/s2 within 2 ms, so over a step the held value is off by 2 m/s2: v is off by 2e-4 m/s, the gap by
    1e-8 m, and is brought back.
    """
    stand = Drop(flat(170.0), 0.0, 0.0, -G)
    deepest = []
    for k in range(5000):
        late = stand.b
        stand.step()
        stand.b = np.full(4, -G - 4 * np.sin(2 * np.pi * k / 200))
        stand.gap, stand.rate = stand.gap + DT**2 / 2 * (stand.b - late), stand.rate + DT * (stand.b - late)
        deepest.append(np.min(stand.gap))
    first, last = np.min(deepest[:1000]), np.min(deepest[-1000:])
    assert last > 1.01 * first
    assert first > -1e-7


@pytest.mark.parametrize("sign", [1, -1])
def test_braking_shifts_the_load_by_friction_at_its_limit(sign: int) -> None:
    """All wheels at the limit: (P + mu U sign) F_n = -b, axle by axle; three passes a step have settled long since."""
    mu, m = 0.5, 170.0
    stand = Drop(flat(m), 0.0, 0.0, -G, traction_demand=sign * 1e5, mu=mu)
    stand.step(30)
    total = m * G
    front = (LR * total - sign * mu * total * HEIGHT) / (LF + LR) / 2
    rear = total / 2 - front
    np.testing.assert_allclose(stand["normal_force"], [front, front, rear, rear], rtol=1e-8)
    np.testing.assert_allclose(stand["traction"], sign * mu * stand["normal_force"], rtol=1e-12)


@pytest.mark.parametrize("slip", [-0.5, 0.5])
def test_sliding_sideways_shifts_the_load_by_friction_at_its_limit(slip: float) -> None:
    """All wheels slide, far beyond the stiffness C_alpha: their lateral forces mu m g roll the load over by h / 2 s.

    The contacts learn of a step's lateral forces in that step, so nothing alternates: after the passes of the first
    steps, which halve an error at least, the loads are those of statics, with those of no step apart.
    """
    mu, m = 0.4, 170.0
    V = np.outer(Y, np.ones(4)) * -HEIGHT / IX  # gap'' of a wheel on the left falls under a force to the left
    slide = Drop(flat(m), 0.0, 0.0, -G, V=V, mu=mu, C_alpha=1e7, contact_velocity=np.outer(np.ones(4), [0.0, slip]))
    slide.step(40)
    side = np.sign(slip) * mu * m * G * HEIGHT / (2 * HALF)  # N, from right to left or back
    front, rear = m * G * LR / (LF + LR) / 2, m * G * LF / (LF + LR) / 2
    shares = np.array([front, front, rear, rear]) - np.sign(Y) * side * np.array([1, 1, 1, 1]) / 2
    for _ in range(4):
        slide.step()
        np.testing.assert_allclose(slide["normal_force"], shares, rtol=1e-6)
        np.testing.assert_allclose(slide["lateral"], -np.sign(slip) * mu * slide["normal_force"], rtol=1e-6)


def test_sideslip_held_over_a_step_is_not_turned_round() -> None:
    """A standing wheel pushes by at most v / (h times the mobility), whatever its cornering stiffness."""
    mobility, v = np.array([0.02, 0.04, 0.06, 0.1]), 1e-5
    stand = Drop(flat(170.0), 0.0, 0.0, -G, sideslip_mobility=mobility, C_alpha=1e5, contact_velocity=[[0.0, v]] * 4)
    stand.step(20)
    # the friction ellipse bends it by (S / room)^2 / 2 with S = 5 N at most of 289 N, the tangent by less
    np.testing.assert_allclose(stand["lateral"], -v / (DT * mobility), rtol=2e-4)


def test_no_impact_adds_energy() -> None:
    """Wheels that land one after the other, some lifted or pressed by the others, elastic or not.

    Gaps and rates as heave, roll and pitch give them.  The recovery of a wheel that sank by v dt / 2 puts m v dt / 2
    times its 1 m/s2 into the body, 4e-3 J, which gravity would take back.
    """
    rng, modes = np.random.default_rng(7), np.array([np.ones(4), Y, X]).T
    for e in np.repeat([0.0, 0.5, 0.8, 1.0], 50):
        gap, rate = modes @ rng.normal(size=3) * 3e-5, modes @ (rng.normal(size=3) - [1, 0, 0])
        impact = Drop(flat(170.0), gap - np.min(gap), rate, 0.0, e=float(e), k_split=1e20)
        impact.step(10)
        assert impact["dissipated_energy"] > -170.0 * DT * np.max(np.abs(rate)) / 2 - 1e-9


def test_friction_stays_in_the_cone_through_impacts() -> None:
    rng = np.random.default_rng(3)
    for _ in range(50):
        impact = Drop(
            flat(170.0), rng.uniform(-1e-5, 1e-4, 4), rng.uniform(-1, 0.3, 4), -G, mu=0.8,
            traction_demand=rng.uniform(-5e3, 5e3, 4), contact_velocity=rng.uniform(-2, 2, (4, 2)),
        )  # fmt: skip
        for _ in range(5):
            impact.step()
            assert np.all(impact["normal_force"] >= 0)
            assert np.all(np.hypot(impact["traction"], impact["lateral"]) <= impact["friction_limit"] * (1 + 1e-12))
            assert np.all(impact["lateral"] * impact.contacts.get("contact_velocity")[:, 1] <= 0)
            np.testing.assert_allclose(impact["normal_impulse"], impact["normal_force"] * DT, rtol=1e-12)


def test_rounding_in_the_gaps_does_not_move_the_load() -> None:
    """Gaps off by d = 1e-16 m in the twist that P leaves open shift d k_split = 1e-3 N per wheel, no more."""
    still, noisy = (Drop(flat(170.0), twist * np.array([1, -1, -1, 1]), 0.0, -G) for twist in (0.0, 1e-16))
    still.step()
    noisy.step()
    shifted = np.abs(still["normal_force"] - noisy["normal_force"])
    np.testing.assert_allclose(shifted, 1e-3, rtol=1e-3)
