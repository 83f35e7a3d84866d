"""When the front axle leaves the ground by itself and by traction (thesis Figs 4.4, 4.5): 2 m/s, rears on the level."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from plants.contact_loss import traction_at_loss
from plants.planar import FOUR, FRONT, REAR, Bicycle, Posture
from plants.tables import robot

from .claim import Claim, graded
from .entry import Entry
from .printed import PrintedBicycle
from .sheet import LINES, Sheet, panels

SPEED, RAMP, MU = 2.0, 0.3, 0.8  # m/s, rad: section 4.4; friction of section 6.7
RUN = ("rigid-ramp", "plastic")
ROBOT = robot("thesis_4_1")
DERIVED, PRINTED = Bicycle(ROBOT, "centre"), PrintedBicycle(ROBOT)
PAYLOAD = Bicycle(robot("thesis_5_1"), "centre")
DRIVES = {"rear": REAR, "four": FOUR, "front": FRONT}
_Rate = Callable[[float], float]  # pitch rate in rad/s by the slope in rad


def climbing(slope: float) -> float:
    """Return the pitch rate, in rad/s, of the robot that rolls on both axles: nose-up negative."""
    return float(DERIVED.climbing_twist(Posture(slope), SPEED)[2])


# what the pitch rate may have been: it is not given
RATES: dict[str, _Rate] = {
    "climbing": climbing,
    "no pitch rate": lambda slope: 0.0,
    "v sin(gamma) / L": lambda slope: -SPEED * np.sin(slope) / ROBOT.L,
    "2 rad/s": lambda slope: 2.0,
}


def loss_figure() -> Sheet:
    """Return Fig 4.4: the normal force of the front axle over the slope under it, without traction."""
    slopes = np.linspace(0.0, 1.4, 281)
    figure, axes = panels(
        "Front axle over the slope, 2 m/s, no torque (Fig 4.4)", 1, 2, sharey=True, figsize=(11.4, 3.9)
    )
    columns: dict[str, np.ndarray] = {"gamma [rad]": slopes}
    for axis, (name, bicycle) in zip(axes.flat, {"derived": DERIVED, "P as printed": PRINTED}.items(), strict=True):
        for (rate, omega), colour in zip(RATES.items(), LINES, strict=False):
            force = [_front(bicycle, slope, omega(slope)) for slope in slopes]
            columns[f"{name}, {rate} [N]"] = np.array(force)
            axis.plot(slopes, force, color=colour, label=f"pitch rate: {rate}")
        axis.axhline(0, color="black", linewidth=0.8)
        axis.axvline(0.98, color="black", linewidth=0.8, linestyle=":")
        axis.set(title=name, xlabel="profile angle gamma / rad", ylim=(-1500, 1200))
    axes[0, 0].set_ylabel("normal force of the front axle / N")
    axes[0, 0].legend(frameon=False, fontsize=8, loc="lower left")
    notes = (
        "dotted: the 0.98 rad of section 4.4; below 0 the ground would have to pull",
        f"with 270 kg contact is lost at {PAYLOAD.contact_loss_slope(climbing):.4f} rad climbing and at "
        f"{PAYLOAD.contact_loss_slope(RATES['2 rad/s']):.3f} rad with 2 rad/s: 0.98 rad is of 170 kg",
        "P as printed (4.44) with 2 rad/s loses contact beyond 88 degrees only, which is not loss in any sense of use",
    )
    return Sheet("Loss of contact by slope", columns, figure, notes)


def _front(bicycle: Bicycle, slope: float, omega: float) -> float:
    return float(bicycle.contact_forces(Posture(slope), np.array([0.0, 0.0, omega]), np.zeros(2))[1])


def _lost(bicycle: Bicycle, rate: str) -> str:
    slope = bicycle.contact_loss_slope(RATES[rate])
    return f"{rate} {slope:.4f}" if slope is not None else f"{rate}: never"


def loss_claims() -> list[Claim]:
    """Return the verdicts on Fig 4.4."""
    found = {rate: DERIVED.contact_loss_slope(RATES[rate]) or np.nan for rate in RATES}
    return [
        Claim(
            "4.4",
            "at 2 m/s without torque the front wheels lose contact at gamma = 0.98 rad",
            f"{found['climbing']:.3f} rad if the robot turns as it climbs; by pitch rate assumed, rad: "
            f"{', '.join(_lost(DERIVED, rate) for rate in RATES)}. 0.98 is met with 2 rad/s on every slope, as if the "
            "speed had been entered for the pitch rate",
            graded(abs(found["climbing"] - 0.98) < 0.005),
            found,
            ", ".join(_lost(PRINTED, rate) for rate in RATES) + ", rad: with P of (4.44) 0.98 is out of reach",
            "the pitch rate and the mass are not given (the row of Table 4.1 is shifted): 170 kg as in Table 6.1",
        ),
    ]


def _twist(rate: str) -> np.ndarray:
    return np.array([SPEED, 0.0, RATES[rate](RAMP)])


def loss_forces(bicycle: Bicycle, rate: str) -> dict[str, float]:
    """Return the traction, in N, by drive, at which the front axle leaves the ramp of 0.3 rad."""
    found = {d: traction_at_loss(bicycle, Posture(RAMP), _twist(rate), share) for d, share in DRIVES.items()}
    return {drive: np.inf if force is None else force for drive, force in found.items()}


def traction_figure() -> Sheet:
    """Return Fig 4.5: the normal force of the front axle over the traction, for three drives, on 0.3 rad."""
    force = np.linspace(0, 3500, 141)
    columns: dict[str, np.ndarray] = {"traction [N]": force}
    figure, axes = panels("Front axle over the traction, 0.3 rad, 2 m/s (Fig 4.5)", 1, 2, sharey=True)
    models = {"derived": DERIVED, "P as printed": PRINTED}
    for axis, (name, bicycle) in zip(axes.flat, models.items(), strict=True):
        for (drive, share), colour in zip(DRIVES.items(), LINES, strict=False):
            load = [bicycle.contact_forces(Posture(RAMP), _twist("climbing"), f * share)[1] for f in force]
            columns[f"{name}, {drive} drive [N]"] = np.array(load)
            axis.plot(force, load, color=colour, label=f"{drive}-wheel drive")
        axis.axhline(0, color="black", linewidth=0.8)
        axis.axvline(_grip(), color="black", linewidth=0.8, linestyle=":")
        axis.set(title=name, xlabel="traction / N")
    axes[0, 0].set_ylabel("normal force of the front axle / N")
    axes[0, 0].legend(frameon=False, fontsize=8)
    note = (
        f"dotted: {_grip():.0f} N, what friction of {MU:g} passes on at the rear axle at rest: the rest is out of reach"
    )
    return Sheet("Loss of contact by traction", columns, figure, (note,))


def _grip() -> float:
    """Return what friction can pass on at the rear axle of the robot that climbs without traction, N."""
    return MU * float(DERIVED.contact_forces(Posture(RAMP), _twist("climbing"), np.zeros(2))[0])


def _order(found: dict[str, float]) -> str:
    return ", ".join(f"{drive} {force:.0f}" for drive, force in found.items())


def traction_claims() -> list[Claim]:
    """Return the verdicts on Fig 4.5."""
    found = loss_forces(DERIVED, "climbing")
    others = [loss_forces(DERIVED, "2 rad/s"), loss_forces(Bicycle(ROBOT, "ground"), "climbing")]
    printed = loss_forces(PRINTED, "climbing")
    ordered = all(f["rear"] > f["four"] > f["front"] for f in (found, *others))
    return [
        Claim(
            "4.4",
            "rear-wheel traction can be largest before the front wheels lose contact, then four-wheel, then front",
            f"contact is lost at {_order(found)} N; with 2 rad/s {_order(others[0])} N; with traction at the ground "
            f"instead of the axles {_order(others[1])} N",
            graded(ordered),
            found,
            f"{_order(printed)} N: the same order",
            "the pitch rate of a robot that climbs; traction of four wheels shared equally between the axles",
        ),
        Claim(
            "10.1",
            "rear-wheel traction allows larger forces without loss of contact",
            f"friction of {MU:g} passes on {_grip():.0f} N at the rear axle: the wheels spin long before any of these "
            f"tractions, of which the smallest is {min(found.values()):.0f} N",
            graded(ordered and _grip() > max(found.values()), ordered),
            {"grip": _grip()},
            assumption=f"friction coefficient {MU:g}, of section 6.7, on what the rear axle bears without traction",
        ),
    ]


ENTRIES = (
    Entry("thesis 4.4", "front contact by profile angle", loss_figure, loss_claims, RUN),
    Entry("thesis 4.5", "front contact by traction and drive", traction_figure, traction_claims, RUN),
)
