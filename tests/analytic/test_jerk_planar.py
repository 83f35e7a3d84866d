"""The affine jerk of the traction law against the planar model, and the forces that thesis and papers ask for."""

from dataclasses import replace
from functools import cache

import casadi as ca
import numpy as np
import pytest

from controllers.planar_jerk import DEFINITIONS, Frame, ideal_force, jerk
from plants.planar import FOUR, FRONT, REAR, Bicycle, Posture
from plants.tables import robot

TABLE_4_1 = robot("thesis_4_1")
PRINTED = 0.05  # N, half a digit of the forces as they are quoted


def frame(table: str = "thesis_4_1", arm: float = 0.0, share: float = 0.0) -> Frame:
    """Return what a law knows of a robot of the tables."""
    r = robot(table)
    return Frame(r.m, r.I_y, r.L_f, r.L_r, r.h, r.R, share, arm)


@cache
def function(law: Frame, definition: str) -> ca.Function:
    """Return J_0 + J_1 F as a function of pitch, slopes, curvatures and their rates (rear, front), speed and force."""
    s = [ca.SX.sym(name) for name in ("p", "rear", "front", "k_r", "k_f", "d_r", "d_f", "v", "F")]
    J_0, J_1 = jerk(law, definition, s[0], s[1:3], s[3:5], s[5:7], s[7])
    return ca.Function("J", s, [J_0 + J_1 * s[8]])


def affine(law: Frame, definition: str, at: Posture, bend_rate: tuple[float, float], v_x: float, F: float) -> float:
    """Return J_0 + J_1 F."""
    return float(function(law, definition)(at.pitch, at.rear, at.front, *at.curvature, *bend_rate, v_x, F))


@pytest.mark.parametrize("drive", [REAR, FRONT, FOUR], ids=["rear", "front", "four"])
@pytest.mark.parametrize("arm", ["centre", "ground"])
def test_it_is_the_total_derivative_of_the_planar_model(arm: str, drive: np.ndarray) -> None:
    """`Bicycle.jerk` differentiates by complex steps with the curvatures held; 200 random states, two forces each.

    Relative to the size of the terms, some 10 m/s3: each takes a solution with P, whose condition number stays below
    1e3 there, so 1e3 times rounding times some tens of operations.
    """
    rng = np.random.default_rng(4)
    law, model = frame(arm=1.0 if arm == "ground" else 0.0, share=float(drive[1])), Bicycle(TABLE_4_1, arm)
    for _ in range(200):
        front, rear, pitch = rng.uniform(-0.4, 0.4, 3)
        at = Posture(front, rear, pitch, (float(rng.uniform(-1, 1)), float(rng.uniform(-1, 1))))
        v_x, F = rng.uniform(0.2, 2.0), rng.uniform(-500, 500)
        expected = model.jerk(at, v_x, F * drive)
        for name, value in (
            ("body", expected.body[1]),
            ("inertial", expected.inertial[1]),
            ("thesis", expected.thesis),
        ):
            assert affine(law, name, at, (0, 0), v_x, F) == pytest.approx(value, rel=1e-10, abs=1e-10)


def test_a_changing_curvature_adds_what_the_acceleration_gains_with_it() -> None:
    """Central difference of the planar model's a_z over the curvatures: exact but for rounding, since a_z is linear."""
    at, v_x, F, rate = Posture(0.2, 0.05, 0.03, (0.4, -0.3)), 1.5, 120.0, np.array([7.0, -4.0])
    model, law = Bicycle(TABLE_4_1), frame(arm=1.0)

    def a_z(step: float) -> float:
        moved = replace(at, curvature=tuple(np.array(at.curvature) + step * rate))
        twist, traction = model.climbing_twist(moved, v_x), F * REAR
        return float(model.accelerations(moved, model.contact_forces(moved, twist, traction), traction)[1])

    gained = affine(law, "body", at, tuple(rate), v_x, F) - affine(law, "body", at, (0, 0), v_x, F)
    assert gained == pytest.approx((a_z(1.0) - a_z(-1.0)) / 2, rel=1e-10)


def test_the_papers_condition_is_the_stationary_force_of_the_planar_model() -> None:
    """A_z is stationary in the front slope with omega held, at any share of the drive."""
    model = Bicycle(TABLE_4_1, "centre")
    for slope in (0.1, 0.2, 0.35):
        omega = float(model.climbing_twist(Posture(slope), 2.0)[2])
        for drive in (REAR, FOUR):
            law = frame(share=float(drive[1]))
            found = ideal_force(law, "partial", slope, 2.0)
            assert found == pytest.approx(model.stationary_force(Posture(slope), omega, drive), rel=1e-10)


def test_the_forces_at_0_2_rad_of_table_4_1() -> None:
    """Traction at the wheel centres as in the thesis' text, rear drive, level body, 2 m/s."""
    law = frame()
    assert Bicycle(TABLE_4_1, "centre").climb_force(0.2) == pytest.approx(146.7, abs=PRINTED)
    assert ideal_force(law, "partial", 0.2, 0.0) == pytest.approx(277.5, abs=PRINTED)
    assert ideal_force(law, "partial", 0.2, 2.0) == pytest.approx(290.6, abs=PRINTED)
    assert ideal_force(law, "body", 0.2, 2.0) == pytest.approx(160.5, abs=PRINTED)
    assert ideal_force(law, "inertial", 0.2, 2.0) == pytest.approx(216.3, abs=PRINTED)
    assert ideal_force(law, "thesis", 0.2, 2.0) == pytest.approx(152.4, abs=PRINTED)


@pytest.mark.parametrize(
    ("table", "slope", "force", "printed", "off"),
    [
        ("dymac_paper", 0.3, 402.6, 380, 0.06),
        ("asme_paper", 0.2, 157.1, 160, 0.02),
        ("asme_paper", np.radians(25), 381.4, 350, 0.09),
        ("timr_paper", 0.2, 107.2, None, 0),
        ("timr_paper", 0.3, 166.3, None, 0),
    ],
)
def test_the_forces_of_the_papers(table: str, slope: float, force: float, printed: float | None, off: float) -> None:
    """A_z stationary in the slope at omega = 0; the papers' own readings of it are met within 2 to 9 %."""
    found = ideal_force(frame(table), "partial", slope, 0.0)
    assert found == pytest.approx(force, abs=PRINTED)
    if printed is not None:
        assert abs(found / printed - 1) == pytest.approx(off, abs=0.005)


def test_nothing_changes_the_jerk_on_level_ground() -> None:
    """J_0 and J_1 vanish there for every definition but the papers', which asks what a slope would do."""
    law = frame()
    for definition in DEFINITIONS[:3]:
        for F in (0.0, 300.0):
            assert affine(law, definition, Posture(0.0), (0, 0), 1.0, F) == pytest.approx(0, abs=1e-14)
