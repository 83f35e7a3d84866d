"""Robots of the thesis and its papers, each named after the table that gives its dimensions.

Only the planar quantities are printed (L_f, L_r, h, R, I_y, m).  What a 3-D robot needs besides is our assumption, the
same for every table: ``half_track`` 0.29 m (half the platform width of Table 8.1), ``I_x`` = 20 and ``I_z`` = 55 kg.m2
(a box of the platform's size with the given I_y).  Further assumptions stand where they are made.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from cosim.errors import ScenarioError, nearest

G = 9.81  # m/s2


@dataclass(frozen=True)
class Robot:
    """Dimensions of a rigid four-wheeled robot; body axes x forward, y left, z up at the centre of mass."""

    source: str
    m: float  # kg, platform and payload
    I_y: float  # kg.m2, pitch
    L_f: float  # m, centre of mass to front axle
    L_r: float  # m, centre of mass to rear axle
    h: float  # m, centre of mass above the wheel centres
    R: float = 0.1  # m, wheel radius
    I_x: float = 20.0  # kg.m2, roll; assumed
    I_z: float = 55.0  # kg.m2, yaw; assumed
    half_track: float = 0.29  # m, from the centre plane to a wheel; assumed

    @property
    def L(self) -> float:
        """Wheelbase, m."""
        return self.L_f + self.L_r

    def body_parameters(self) -> dict[str, Any]:
        """Return the parameters of `RigidBody`."""
        return {
            "m": self.m, "inertia": np.array([self.I_x, self.I_y, self.I_z]), "L_f": self.L_f, "L_r": self.L_r,
            "half_track": self.half_track, "h": self.h, "R": self.R,
        }  # fmt: skip

    def with_changes(self, **changes: float) -> Robot:
        """Return the robot with some dimensions changed; raises ScenarioError for an unknown or non-positive one."""
        known = [f.name for f in fields(self) if f.name != "source"]
        for name, value in changes.items():
            if name not in known:
                raise ScenarioError(f"a robot has no {name!r}; {nearest(name, known)}")
            if isinstance(value, bool) or not isinstance(value, (int, float)):
                raise ScenarioError(f"robot.{name} must be a number, not {value!r}")
            if not value > 0:
                raise ScenarioError(f"robot.{name} is {value!r}; it must be positive")
        return replace(self, **changes)  # type: ignore[arg-type]


ROBOTS: dict[str, Robot] = {
    # The row of m is misprinted (shifted); 170 kg is inferred from Table 6.1 and from I_y = m L_f L_r.
    "thesis_4_1": Robot("thesis, Table 4.1 (mass assumed)", m=170, I_y=47, L_f=0.6, L_r=0.46, h=0.4),
    "thesis_5_1": Robot("thesis, Table 5.1: with 100 kg payload", m=270, I_y=47, L_f=0.6, L_r=0.46, h=0.4),
    "thesis_6_1": Robot("thesis, Table 6.1", m=170, I_y=47, L_f=0.6, L_r=0.46, h=0.4),
    "thesis_8_1": Robot("thesis, Table 8.1: platform width 0.58 m", m=270, I_y=47, L_f=0.6, L_r=0.46, h=0.4),
    "impact_paper": Robot("impact control paper, Table 1", m=170, I_y=47, L_f=0.6, L_r=0.46, h=0.4),
    "pitch_paper": Robot("pitch trajectory paper, Table 1", m=270, I_y=47, L_f=0.6, L_r=0.46, h=0.4),
    # No wheel radius is printed for this one; 0.1 m as in all the others.
    "dymac_paper": Robot("DYMAC jerk paper, section 3.1", m=120, I_y=40, L_f=0.8, L_r=1.0, h=0.27),
    "asme_paper": Robot("ASME jerk paper, case study", m=80, I_y=116, L_f=1.2, L_r=1.2, h=0.4),
    # "Distance between front axle and centre of mass, Lr = 1.0 m": taken as L_f; no wheel radius printed.
    "timr_paper": Robot("TIMR jerk paper, section 3", m=50, I_y=80, L_f=1.0, L_r=1.2, h=0.42),
}


def robot(table: str) -> Robot:
    """Return the robot of a table; raises ScenarioError naming the nearest table if there is none."""
    if table not in ROBOTS:
        raise ScenarioError(f"there is no robot table {table!r}; {nearest(table, ROBOTS)}")
    return ROBOTS[table]
