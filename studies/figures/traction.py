"""The rear traction of least normal jerk of the thesis' robot on a slope (thesis Fig 4.7 and the first Fig 4.8).

Jerk in the sense of (4.54) with the right accelerations, traction held:

    J = da_z/dgamma gamma' v_x + v_x alpha_y + omega (a_x - v_z omega)               gamma' = d gamma / dx, not given

gamma' -> 0 leaves the static force, gamma' -> inf the force at which a_z does not change with the slope, as in the
papers ("partial").
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes

from plants.planar import REAR, Bicycle, Posture
from plants.tables import Robot, robot

from .claim import CONTRADICTED, UNKNOWN, Claim, graded
from .entry import Entry
from .printed import PrintedBicycle, appendix_a_force
from .sheet import LINES, Sheet, panels

SPEED, SLOPE, FORCE = 2.0, 0.2, 367.0  # m/s, rad, N: section 4.6
ROBOT = robot("thesis_4_1")
MODEL = Bicycle(ROBOT, "centre")
_STEP = 1e-30  # of complex differentiation
_State = Callable[[Bicycle, float, float], np.ndarray]  # twist by slope (rad) and speed (m/s)

# what v_z and the pitch rate may have been: they are not given
STATES: dict[str, _State] = {
    "climbing": lambda b, slope, v: b.climbing_twist(Posture(slope), v),
    "no pitch rate": lambda b, slope, v: np.array([v, 0.0, 0.0]),
    "-v sin(gamma) / L": lambda b, slope, v: _turning(b.robot, v, -v * np.sin(slope) / b.robot.L),
}


def _turning(bot: Robot, v: float, omega: float) -> np.ndarray:
    return np.array([v, -omega * bot.L_r, omega])


@dataclass(frozen=True)
class Terms:
    """J = v_x (bent gamma' + level): each for no force and per newton."""

    bent: np.ndarray  # (2,)
    level: np.ndarray  # (2,)
    speed: float

    def force(self, bend: float) -> float:
        """Return the force in N without jerk at gamma' = *bend*, 1/m."""
        idle, gained = self.bent * bend + self.level
        return float(-idle / gained)

    def bend(self, force: float) -> float:
        """Return the gamma', 1/m, at which a *force* in N leaves no jerk; infinite force: at the pole."""
        weights = np.array([0.0, 1.0]) if np.isinf(force) else np.array([1.0, force])
        return float(-(self.level @ weights) / (self.bent @ weights))

    def jerk(self, bend: float, force: np.ndarray) -> np.ndarray:
        """Return J in m/s3."""
        idle, gained = self.bent * bend + self.level
        return self.speed * (idle + gained * force)


def terms(slope: float, v: float = SPEED, state: str = "climbing", model: Bicycle = MODEL) -> Terms:
    """Return the two summands of (4.54) over v_x, affine in the rear traction; twist held as gamma changes."""
    twist = STATES[state](model, slope, v)
    _, v_z, omega = twist

    def both(force: float) -> tuple[float, float]:
        traction = force * REAR
        at = Posture(slope + 1j * _STEP)
        a = model.accelerations(at, model.contact_forces(at, twist, traction), traction)
        a_x, _, alpha = a.real
        return float(a[1].imag / _STEP), float(alpha + omega / v * (a_x - v_z * omega))

    idle, pushed = np.array(both(0.0)), np.array(both(1.0))
    (bent, level), (bent_1, level_1) = idle, pushed - idle
    return Terms(np.array([bent, bent_1]), np.array([level, level_1]), v)


def felt_force(slope: float, name: str) -> float:
    """Return the force, N, at which the jerk called *name* vanishes on a straight ramp, everything else moving on."""
    idle, pushed = (_felt(slope, name, force) for force in (0.0, 1.0))
    return idle / (idle - pushed)


def _felt(slope: float, name: str, force: float) -> float:
    jerk = MODEL.jerk(Posture(slope), SPEED, force * REAR)
    return float(np.atleast_1d(getattr(jerk, name))[-1])


def contour_figure() -> Sheet:
    """Return Fig 4.7: the normal jerk by slope and traction, (4.54) and felt, and what (4.54) takes for granted."""
    slopes, forces = np.linspace(0.02, 0.5, 49), np.linspace(0, 1000, 51)
    bend = terms(SLOPE).bend(FORCE)
    maps = {
        f"(4.54), gamma' = {bend:.2f} 1/m [m/s3]": np.array([terms(s).jerk(bend, forces) for s in slopes]),
        "felt on a straight ramp [m/s3]": np.array([_straight(s, forces) for s in slopes]),
    }
    figure, axes = panels("Normal jerk by slope and traction, rear drive, 2 m/s (Fig 4.7)", 1, 3, figsize=(15, 4.4))
    columns = {
        "gamma [rad]": np.repeat(slopes, len(forces)),
        "traction [N]": np.tile(forces, len(slopes)),
        **{name: values.ravel() for name, values in maps.items()},
    }
    for axis, (name, values) in zip(axes.flat, maps.items(), strict=False):
        drawn = axis.contour(slopes, forces, values.T, levels=_levels(values), cmap="coolwarm", linewidths=0.9)
        axis.clabel(drawn, fontsize=7)
        axis.contour(slopes, forces, values.T, levels=[0], colors="black", linewidths=1.8)
        axis.plot(SLOPE, FORCE, "o", color="black", markersize=5)
        axis.set(title=name, xlabel="profile angle gamma / rad", ylabel="rear traction / N")
    _pole(axes[0, 2])
    notes = (
        "black line: no jerk; dot: the 367 N at 0.2 rad of section 4.6",
        "Fig 4.7 is drawn for the gamma' that puts its point P where the text has it",
    )
    return Sheet("Contours of the normal jerk", columns, figure, notes)


def _straight(slope: float, forces: np.ndarray) -> np.ndarray:
    idle, pushed = (_felt(slope, "body", f) for f in (0.0, 1.0))
    return idle + (pushed - idle) * forces


def _levels(values: np.ndarray) -> list[float]:
    size = 10.0 ** np.floor(np.log10(np.percentile(np.abs(values), 70)))
    return [k * size for k in (-8, -4, -2, -1, 1, 2, 4, 8)]


def _pole(axis: Axes) -> None:
    """Draw the force without jerk at 0.2 rad over gamma'."""
    bends = np.linspace(0, 5, 501)
    for state, colour in zip(STATES, LINES, strict=False):
        found = np.array([terms(SLOPE, SPEED, state).force(g) for g in bends])
        found[np.abs(found) > 2000] = np.nan  # the pole
        axis.plot(bends, found, color=colour, label=f"pitch rate: {state}")
    axis.axhline(FORCE, color="black", linewidth=0.8, linestyle=":")
    axis.set(title="force without jerk at 0.2 rad by (4.54)", xlabel="gamma' / (1/m)", ylabel="rear traction / N",
             ylim=(-1000, 1500))  # fmt: skip
    axis.legend(frameon=False, fontsize=8)


def contour_claims() -> list[Claim]:
    """Return the verdicts on Fig 4.7."""
    climb = terms(SLOPE)
    forces = {g: climb.force(g) for g in (0.0, 1.0, 2.0, 5.0)}
    flat, steady = MODEL.stationary_force(Posture(SLOPE), 0.0), climb.force(1e9)
    needed = {state: terms(SLOPE, SPEED, state).bend(FORCE) for state in STATES}
    printed = PrintedBicycle(ROBOT).stationary_force(Posture(SLOPE), 0.0)
    appendix = [appendix_a_force(ROBOT, SLOPE, g) for g in (1, 2, 5)]
    heavy = Bicycle(robot("thesis_5_1"), "centre").stationary_force(Posture(SLOPE), 0.0)
    ideal = {name: felt_force(SLOPE, name) for name in ("body", "inertial", "thesis")}
    left = {name: _felt(SLOPE, name, FORCE) for name in ideal}
    return [
        Claim(
            "4.6",
            "at gamma = 0.2 and 2 m/s a rear traction of 367 N avoids the normal jerk",
            f"by (4.54) climbing, for gamma' = {', '.join(f'{g:g}' for g in forces)} and without end, 1/m: "
            f"{', '.join(f'{f:.1f}' for f in forces.values())} and {steady:.1f} N ({flat:.1f} N without pitch rate, "
            f"{heavy:.0f} N with 270 kg); 367 N needs gamma' = {_listed(needed, 3)} 1/m",
            UNKNOWN,
            {**{f"{g:g}": f for g, f in forces.items()}, "steady": steady, "flat": flat, "heavy": heavy,
             "pole": climb.bend(np.inf), "pole without": terms(SLOPE, SPEED, "no pitch rate").bend(np.inf), **needed},
            f"{printed:.0f} N with P of (4.44), gamma' without end; {', '.join(f'{f:.0f}' for f in appendix)} N by "
            "Appendix A without pitch rate, gamma' = 1, 2, 5 1/m",
            "d gamma/dx, the pitch rate and v_z are not given, and the zero of (4.54) depends on all; its pole is at "
            f"gamma' = {climb.bend(np.inf):.3f} 1/m",
        ),
        Claim(
            "4.6",
            "the zero contour is a jerk-free motion",
            f"on a straight ramp of 0.2 rad the jerk vanishes at {_listed(ideal, 1)} N; 367 N leave "
            f"{_listed(left, 2)} m/s3: (4.54) leaves out that the body turns while it climbs",
            CONTRADICTED if min(abs(f - FORCE) for f in ideal.values()) > 50 else graded(True),
            {**{f"{k} ideal": v for k, v in ideal.items()}, **left},
            assumption="straight ramp, both axles rolling; jerk felt on board (body), of the centre of mass (inertial) "
            "and as (4.54) defines it (thesis), each with everything that changes",
        ),
    ]  # fmt: skip


def _listed(values: dict[str, float], digits: int) -> str:
    return ", ".join(f"{v:.{digits}f} ({k})" for k, v in values.items())


def velocity_figure() -> Sheet:
    """Return the first Fig 4.8: the force without jerk over the speed, 0.5 to 2.5 m/s, at 0.2 rad."""
    speeds = np.linspace(0.5, 2.5, 41)
    figure, axes = panels("Force without normal jerk over the speed, 0.2 rad, climbing (Fig 4.8, velocity)")
    columns: dict[str, np.ndarray] = {"speed [m/s]": speeds}
    for (name, bend), colour in zip(_bends().items(), LINES, strict=False):
        columns[f"{name} [N]"] = np.array([terms(SLOPE, v).force(bend) for v in speeds])
        axes[0, 0].plot(speeds, columns[f"{name} [N]"], color=colour, label=name)
    axes[0, 0].set(xlabel="speed / (m/s)", ylabel="rear traction / N", ylim=(0, 450))
    axes[0, 0].legend(frameon=False, fontsize=8)
    note = "F* = c_0 + c_2 v^2 for every gamma': the omega of a robot that climbs goes with v, and forces with omega^2"
    return Sheet("Force over speed", columns, figure, (note,))


def _bends() -> dict[str, float]:
    bend = terms(SLOPE).bend(FORCE)
    return {f"(4.54), gamma' = {bend:.2f} 1/m": bend, "a_z stationary in gamma (papers)": 1e9}


def velocity_claims() -> list[Claim]:
    """Return the verdict on the first Fig 4.8."""
    found = {name: [terms(SLOPE, v).force(b) for v in np.linspace(0.5, 2.5, 9)] for name, b in _bends().items()}
    growth = {name: f[-1] / f[0] - 1 for name, f in found.items()}
    rising = all(np.all(np.diff(f) > 0) for f in found.values())
    words = "; ".join(f"{n} {f[0]:.0f} to {f[-1]:.0f} N (+{100 * growth[n]:.0f} %)" for n, f in found.items())
    return [
        Claim(
            "4.6",
            "from 0.5 to 2.5 m/s the ideal force grows, though not by much",
            f"{words}; without pitch rate it does not depend on the speed",
            graded(rising and max(growth.values()) < 0.25, rising),
            growth,
            assumption="the robot climbs on both axles; gamma' such that 367 N belong to 2 m/s, or without end",
        )
    ]


ENTRIES = (
    Entry("thesis 4.7", "contours of the normal jerk", contour_figure, contour_claims, ("jerk-ramp", "printed")),
    Entry("thesis 4.8 velocity", "ideal force over the speed", velocity_figure, velocity_claims, ("jerk-ramp", "body")),
)
