"""Controlled against uncontrolled impact on the full-order robot (thesis Figs 6.14, 6.15; impact paper Figs 9, 10)."""

from __future__ import annotations

import numpy as np

from ..metrics.metric import FRONT, REAR
from .claim import Claim, graded
from .full_case import ASSUMED, IMPACT, axle_force, run, value
from .sheet import LINES, Sheet, panels

UNCONTROLLED, RUBBER, OPEN, CLOSED = "uncontrolled", "uncontrolled-rubber", "playback", "pd"
OBSERVED, FRICTION, FLEXIBLE = "observer", "pd-friction", "flexible-pd"
FREE, PD = "realistic", "realistic-pd"
SHOWN = {
    UNCONTROLLED: "uncontrolled", OPEN: "forces played back, as in 6.6, no limit", CLOSED: "PD fed back, no limit",
    FRICTION: "PD fed back, friction 0.8 / 0.3",
}  # fmt: skip
REAL = {FREE: "2e5 N/m, ζ = 0.3: uncontrolled", PD: "PD fed back, friction 0.8 / 0.3"}


def _figure(title: str, axle: slice) -> Sheet:
    figure, axes = panels(title, 2, 1, figsize=(9, 6.5), sharex=True)
    time = run(UNCONTROLLED).record.time
    after = time >= IMPACT - 0.02
    columns = {"time since the impact [s]": time[after] - IMPACT}
    for axis, shown in zip(axes[:, 0], (SHOWN, REAL), strict=True):
        for (variant, label), colour in zip(shown.items(), LINES, strict=False):
            force = axle_force(variant, axle)[after]
            columns[f"{variant} [N]"] = force
            axis.plot(columns["time since the impact [s]"], force / 1e3, color=colour, lw=0.9, label=label)
        axis.set_ylabel("normal force of the axle / kN")
        axis.legend(frameon=False, fontsize=8, loc="upper right")
    axes[0, 0].set_ylim(-1, 25)  # what is played back goes far beyond
    axes[1, 0].set_xlabel("time since the impact / s")
    most = float(np.max(axle_force(OPEN, axle)))
    return Sheet(
        title, columns, figure, (ASSUMED, f"played back, the force of the axle goes up to {most / 1e3:.0f} kN")
    )


def front_figure() -> Sheet:
    """Return Fig 6.14: reaction forces of the front axle."""
    return _figure("Reaction of the front wheels, full-order robot (Fig 6.14)", FRONT)


def rear_figure() -> Sheet:
    """Return Fig 6.15: reaction forces of the rear axle."""
    return _figure("Reaction of the rear wheels, full-order robot (Fig 6.15)", REAR)


def paper_front_figure() -> Sheet:
    """Return Fig 9 of the impact paper: reaction forces of the front axle."""
    return _figure("Reaction of the front wheels, full-order robot (impact paper, Fig 9)", FRONT)


def paper_rear_figure() -> Sheet:
    """Return Fig 10 of the impact paper: reaction forces of the rear axle."""
    return _figure("Reaction of the rear wheels, full-order robot (impact paper, Fig 10)", REAR)


def _rebounds(where: str, axle: str) -> Claim:
    off, often = value(UNCONTROLLED, f"{axle}_off"), value(UNCONTROLLED, f"{axle}_rebounds")
    return Claim(
        where,
        "uncontrolled, the reaction force drops to zero several times: contact is lost",
        f"{axle} axle off the ground for {off:.0f} of 300 ms in {often:.0f} rebounds; with rubber of ζ = 0.05 "
        f"{value(RUBBER, f'{axle}_off'):.0f} ms in {value(RUBBER, f'{axle}_rebounds'):.0f}",
        graded(often >= 2, off > 0),
        {"off": off, "rebounds": often, "off, rubber": value(RUBBER, f"{axle}_off")},
        assumption=ASSUMED,
    )


def _off_line(where: str, axle: str) -> Claim:
    off, fastest = value(OPEN, f"{axle}_off"), max(value(OPEN, "speed_max"), -value(OPEN, "speed_min"))
    return Claim(
        where,
        "predetermined forces, applied open loop, keep the wheels on the ground after the impact",
        f"{axle} axle off the ground for {off:.0f} of 300 ms although nothing limits the forces; the first axle that "
        f"leaves the ground leaves the other one's force alone, and the robot is thrown to {fastest:.0f} m/s",
        graded(off == 0),
        {"off": off, "thrown": fastest},
        assumption="forces are laid on at the ground while a wheel presses it; how 6.7 applied them is not said",
    )


def _unlimited(where: str, axle: str) -> Claim:
    off, seen_off, bent = (value(v, f"{axle}_off") for v in (CLOSED, OBSERVED, FLEXIBLE))
    needed = [value(v, "friction_needed") for v in (CLOSED, OBSERVED)]
    return Claim(
        where,
        "the proposed control is able to maintain the contact immediately after the collision",
        f"fed back, and with traction that no friction limits, it is: off for {off:.0f} ms with PD to the static "
        f"deflection, {seen_off:.0f} ms with placed poles on an observer, at {needed[0]:.0f} and {needed[1]:.0f} times "
        f"the normal force; on a chassis that bends {bent:.0f} ms with PD",
        graded(off == seen_off == bent == 0, off == 0),
        {"pd": off, "observer": seen_off, "flexible": bent},
        assumption="a rigid chassis, as the beams of Table 6.2",
    )


def _friction(where: str, axle: str) -> Claim:
    free, held = value(UNCONTROLLED, f"{axle}_off"), value(FRICTION, f"{axle}_off")
    return Claim(
        where,
        "with static friction of 0.8 and dynamic friction of 0.3 the control maintains the contact",
        f"{axle} axle off the ground for {held:.0f} of 300 ms with PD within friction, {free:.0f} ms without control: "
        f"a wheel in the air takes no traction",
        graded(held == 0, held < free / 2),
        {"with": held, "without": free},
        assumption=ASSUMED,
    )


def _real(where: str, axle: str) -> Claim:
    free, held = value(FREE, f"{axle}_unloaded"), value(PD, f"{axle}_unloaded")
    peaks = value(FREE, "front_normal_peak"), value(PD, "front_normal_peak")
    return Claim(
        where,
        "the same on a wheel that a robot could have (2e5 N/m per axle, ζ = 0.3, chassis of 25 modes), within friction",
        f"{axle} axle without force for {free:.0f} ms uncontrolled and {held:.0f} ms with PD; front peak "
        f"{peaks[0]:.0f} and {peaks[1]:.0f} N",
        graded(held == 0 and peaks[1] < peaks[0], peaks[1] < peaks[0]),
        {"uncontrolled": free, "pd": held, "peak": peaks[0], "peak, pd": peaks[1]},
    )


def _claims(where: str, axle: str) -> list[Claim]:
    return [part(where, axle) for part in (_rebounds, _off_line, _unlimited, _friction, _real)]


def front_claims() -> list[Claim]:
    """Return the verdicts on Fig 6.14."""
    return _claims("6.7, Fig 6.14", "front")


def rear_claims() -> list[Claim]:
    """Return the verdicts on Fig 6.15."""
    return _claims("6.7, Fig 6.15", "rear")


def paper_front_claims() -> list[Claim]:
    """Return the verdicts on Fig 9 of the impact paper, which says besides that the rebounds get smaller."""
    peaks = _peaks(RUBBER)
    smaller = bool(np.all(np.diff(peaks) < 0))
    decays = Claim(
        "impact paper, section 5",
        "uncontrolled, each rebound is smaller than the one before, by the damping of the material",
        f"peaks of the front axle with ζ = 0.05: {', '.join(f'{p:.0f}' for p in peaks)} N",
        graded(smaller, peaks[-1] < peaks[0]),
        {"first": float(peaks[0]), "last": float(peaks[-1])},
        assumption="ζ = 0.05 for rubber",
    )
    return [*_claims("impact paper, Fig 9", "front"), decays]


def paper_rear_claims() -> list[Claim]:
    """Return the verdicts on Fig 10 of the impact paper."""
    return _claims("impact paper, Fig 10", "rear")


def _peaks(variant: str) -> np.ndarray:
    """Return the largest force (n,) of the front axle, N, in each stretch on the ground since the impact."""
    force = axle_force(variant, FRONT)[run(variant).record.time >= IMPACT]
    on = np.concatenate([[0], (force > 0).astype(int), [0]])
    starts, ends = np.flatnonzero(np.diff(on) > 0), np.flatnonzero(np.diff(on) < 0)
    least = 0.05 * float(np.max(force))  # what chatters is no landing
    return np.array([p for p in (float(np.max(force[a:b])) for a, b in zip(starts, ends, strict=True)) if p > least])
