"""Figures on jerk: verdicts, and the forces that decide them by the closed forms of Appendix A, its errors removed."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from studies.catalog import find_scenario
from studies.figures.claim import CONTRADICTED, REPRODUCED, TREND
from studies.figures.entry import Entry
from studies.figures.jerk import ENTRIES

G = 9.81
SEVENTEEN, RAMP = np.radians(17), np.radians(25)
BY_KEY = {entry.key: entry for entry in ENTRIES}
VERDICTS = {
    "DYMAC paper 3": [TREND, REPRODUCED],
    "DYMAC paper 4": [REPRODUCED, CONTRADICTED, CONTRADICTED, REPRODUCED, CONTRADICTED],
    "ASME paper 3": [CONTRADICTED],
    "ASME paper 4": [REPRODUCED, TREND, TREND, TREND, REPRODUCED, TREND],
    "TIMR paper 3": [CONTRADICTED, REPRODUCED, REPRODUCED],
}


@dataclass(frozen=True)
class Robot:
    """The closed forms of Appendix A for a level robot, both axles on the ground, rears on the flat."""

    m: float
    I_y: float
    L_f: float
    L_r: float
    h: float

    def rates(self, g: float, F: float, w: float = 0.0, v_z: float = 0.0, front: bool = False) -> np.ndarray:
        """Return a_x, a_z, alpha at a slope *g* (rad) for a rear (or *front*) traction F, N."""
        m, I_y, L_f, L_r, h = self.m, self.I_y, self.L_f, self.L_r, self.h
        s, c, L = np.sin(g), np.cos(g), L_f + L_r
        psi = m * ((L * c - h * s) ** 2 + L_r**2 * s**2) + I_y * s**2
        drive = F if front else F * c
        alpha = -L * s * drive + m * G * L_r * s**2 + m * w**2 * L * s * (L_f * c - h * s)
        v_x_rate = (
            drive * (L**2 * c - h * L * s)
            - m * G * L_r * L * s * c + m * G * h * L_r * s**2
            + m * s * c * (2 * v_z * w * h * L + h * w**2 * L_r * L)
            + m * s**2 * (L_r * w**2 * (L_r * L_f - h**2) + v_z * w * (L_f**2 + 2 * L_r * L_f - h**2))
            - I_y * s**2 * (v_z * w - L_f * w**2) - m * v_z * w * L**2
        )  # fmt: skip
        return np.array([v_x_rate / psi + v_z * w, -L_r * alpha / psi - h * w**2, alpha / psi])

    def stationary(self, g: float, quantity: int = 1, w: float = 0.0, *, front: bool = False) -> float:
        """Return the traction, N, at which a_x (0), a_z (1) or alpha (2) does not change with the slope."""
        step = 1e-5  # central differences: step^2 and rounding / step, both near 1e-10

        def change(F: float) -> float:
            up, down = (self.rates(g + d, F, w, front=front)[quantity] for d in (step, -step))
            return float(up - down) / (2 * step)

        return change(0.0) / (change(0.0) - change(1.0))

    def pitch_rate(self, g: float, v_x: float) -> float:
        """Return omega of a robot that climbs."""
        return float(-v_x * np.sin(g) / ((self.L_f + self.L_r) * np.cos(g) - self.h * np.sin(g)))


DYMAC = Robot(120, 40, 0.8, 1.0, 0.27)
ASME, TIMR = Robot(80, 116, 1.2, 1.2, 0.4), Robot(50, 80, 1.0, 1.2, 0.42)
NEAR = 1e-6  # relative: differences right to some 1e-9 of terms that cancel to a hundredth


def numbers(key: str, claim: int) -> dict[str, float]:
    """Return the numbers of a claim, counted from 0."""
    return BY_KEY[key].claims()[claim].numbers


@pytest.mark.parametrize("key", VERDICTS)
def test_every_claim_has_its_verdict(key: str) -> None:
    claims = BY_KEY[key].claims()
    assert [c.verdict for c in claims] == VERDICTS[key]
    assert all(c.where and c.text and c.found and c.numbers for c in claims)


def test_every_entry_is_judged_here() -> None:
    assert list(VERDICTS) == [entry.key for entry in ENTRIES]


@pytest.mark.parametrize("entry", ENTRIES, ids=lambda entry: entry.key)
def test_every_figure_has_data_and_units(entry: Entry) -> None:
    sheet = entry.make()
    assert len({len(c) for c in sheet.columns.values()}) == 1
    assert all(np.all(np.isfinite(c)) for c in sheet.columns.values())
    labels = [axis.get_xlabel() for axis in sheet.figure.axes] + [axis.get_ylabel() for axis in sheet.figure.axes]
    assert any(" / " in label for label in labels)
    if entry.run is not None:
        assert entry.run[1] in find_scenario(entry.run[0]).variants


def test_the_forces_of_the_papers() -> None:
    dymac = numbers("DYMAC paper 3", 0)
    w = DYMAC.pitch_rate(0.3, 2.0)
    for name, force, printed in (
        ("0.3 rad", DYMAC.stationary(0.3), 402.6),
        ("17 degrees", DYMAC.stationary(SEVENTEEN), 397.7),
        ("climbing", DYMAC.stationary(0.3, w=w), 412.4),
        ("static", 120 * G * (1.0 / 1.8) * np.tan(0.3), 202.3),
    ):
        assert dymac[name] == pytest.approx(force, rel=NEAR)
        assert dymac[name] == pytest.approx(printed, abs=0.05)
    read = [numbers("ASME paper 4", i)["found"] for i in range(4)]
    jerk, hold = ASME.stationary(0.2), 80 * G / 2 * np.tan(0.2)
    assert read == pytest.approx([jerk, hold, jerk - hold, ASME.stationary(RAMP)], rel=NEAR)
    assert read == pytest.approx([157.1, 79.5, 77.6, 381.4], abs=0.05)
    timr = numbers("TIMR paper 3", 1)
    assert [timr["jerk, 0.2"], timr["jerk, 0.3"]] == pytest.approx([107.2, 166.3], abs=0.05)
    assert timr["static, 0.3"] == pytest.approx(50 * G * (1.2 / 2.2) * np.tan(0.3), rel=NEAR)


@pytest.mark.parametrize(("key", "robot"), [("ASME paper 3", ASME), ("TIMR paper 3", TIMR)])
def test_longitudinal_jerk_vanishes_elsewhere(key: str, robot: Robot) -> None:
    found = numbers(key, 0)
    assert found["normal"] == pytest.approx(found["pitch"], rel=1e-9)  # a_z = -L_r alpha - h omega^2
    assert found["normal"] == pytest.approx(robot.stationary(0.2), rel=NEAR)
    # far from 0, where the change is a small difference that the traction hardly moves
    assert found["longitudinal"] == pytest.approx(robot.stationary(0.2, 0), rel=1e-4)
    assert found["longitudinal"] < -1000
    assert found["static, apart"] < 1e-6
    assert numbers("ASME paper 3", 0)["longitudinal"] == pytest.approx(-8072, abs=0.5)


def test_front_drive_needs_less_on_steep_slopes() -> None:
    found = numbers("ASME paper 4", 4)
    for name, slope in (("0.2", 0.2), ("25", RAMP)):
        assert found[f"rear, {name}"] == pytest.approx(ASME.stationary(slope), rel=NEAR)
        assert found[f"front, {name}"] == pytest.approx(ASME.stationary(slope, front=True), rel=NEAR)
    assert [found["front, 0.2"], found["front, 25"]] == pytest.approx([148.3, 289.6], abs=0.05)


def test_a_lower_centre_of_mass_needs_more_uphill_and_less_downhill() -> None:
    found = numbers("DYMAC paper 4", 2)
    for h in (0.1, 0.7):
        robot = Robot(DYMAC.m, DYMAC.I_y, DYMAC.L_f, DYMAC.L_r, h)
        assert found[f"h {h:g}"] == pytest.approx(robot.stationary(SEVENTEEN), rel=NEAR)
        assert found[f"down {h:g}"] == pytest.approx(robot.stationary(-SEVENTEEN), rel=NEAR)
    assert found["h 0.1"] > found["h 0.7"]
    assert abs(found["down 0.1"]) < abs(found["down 0.7"])


def test_the_axles_downhill_as_uphill() -> None:
    up, down = numbers("DYMAC paper 4", 0), numbers("DYMAC paper 4", 1)
    for name in ("L_f", "L_r"):
        for value in (0.4, 1.2):
            robot = replace(DYMAC, **{name: value})
            assert up[f"{name} {value:g}"] == pytest.approx(robot.stationary(SEVENTEEN), rel=NEAR)
            assert down[f"{name} {value:g}"] == pytest.approx(-robot.stationary(-SEVENTEEN), rel=NEAR)


def test_speed_and_inertia() -> None:
    """The force goes with the square of the pitch rate, so with the speed: c0 + c2 v^2, no minimum."""
    inertia, speed = numbers("DYMAC paper 4", 3), numbers("DYMAC paper 4", 4)
    for I_y in (20, 100):
        assert inertia[f"I_y {I_y}"] == pytest.approx(replace(DYMAC, I_y=I_y).stationary(SEVENTEEN), rel=NEAR)
    still, w = DYMAC.stationary(SEVENTEEN), DYMAC.pitch_rate(SEVENTEEN, 3.0)
    assert speed["3 m/s"] == pytest.approx(DYMAC.stationary(SEVENTEEN, w=w), rel=NEAR)
    # differences of 0.15 N of 400 N, right to 1e-6 of these
    assert (speed["0.25 m/s"] - still) / (speed["3 m/s"] - still) == pytest.approx((0.25 / 3) ** 2, rel=3e-3)


def test_figure_3_is_drawn_from_the_closed_form() -> None:
    """The jerk at a corner of the grid, 0.5 rad and 1000 N: the change of a_z."""
    columns = BY_KEY["DYMAC paper 3"].make().columns
    assert (columns["gamma [rad]"][-1], columns["F [N]"][-1]) == (0.5, 1000.0)
    up, down = (DYMAC.rates(0.5 + d, 1000.0)[1] for d in (1e-5, -1e-5))
    assert columns["J [m/s³]"][-1] == pytest.approx((up - down) / 2e-5, rel=NEAR)
