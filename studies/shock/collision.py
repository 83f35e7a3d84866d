"""What the thesis could not do: the chassis under the wheel forces of a co-simulated collision, one wheel against two.

Nothing depends on the chassis in the rover, so the forces recorded in a run drive any other set of modes exactly as the
FMU was driven (`replayed`): other dampings and other numbers of modes cost milliseconds, not runs.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from cosim.errors import ScenarioError
from plants.chassis_modes import ModalData
from plants.shock import held_response, peaks
from plants.tables import Robot
from studies.figures.sheet import LINES, Sheet, panels

from ..catalog import find_scenario
from ..runner import Result, execute
from .cases import CORNERS, INNER, MODES, RATE, STATIONS, at, platform
from .responses import CUT_OFFS
from .spectra import FREQUENCIES, response_spectrum

SCENARIO = "shock-collision"
ONE, TWO, ONE_HARD, TWO_HARD = "one-wheel", "two-wheels", "one-wheel-hard", "two-wheels-hard"
VARIANTS = (ONE, TWO, ONE_HARD, TWO_HARD)
DAMPINGS = (0.0, 5e-5, 0.005, 0.02, 0.05)
BAND = FREQUENCIES <= 200.0  # Hz, of what is mounted


@dataclass(frozen=True)
class Impact:
    """Wheel forces (n, 4) in N on the chassis, each held over the step that ends at its *time* (n,) in s."""

    time: np.ndarray
    force: np.ndarray
    recorded: np.ndarray  # (n, stations) m/s2, what the FMU of the chassis said
    rigid: np.ndarray  # (n, stations) m/s2, vertical acceleration of the rigid body at the stations, body axes


@cache
def collide(variant: str) -> Impact:
    """Run a variant of the scenario; raises ScenarioError if it fails."""
    result = execute(find_scenario(SCENARIO).load(variant))
    if result.error is not None:
        raise ScenarioError(f"{SCENARIO}, {variant}: {result.error}")
    record = result.record
    return Impact(
        record.time, record["chassis.wheel_force"], record["chassis.acceleration"], rigid_acceleration(result)
    )


def rigid_acceleration(result: Result) -> np.ndarray:
    """Return the acceleration (n, 20) in m/s2 of the rigid body at the stations, along its z axis, without gravity."""
    bot = result.assembly.robot
    if bot is None:
        raise ScenarioError("the stations of the chassis are known for a rover only")
    record = result.record
    x, y = station_positions(bot)
    alpha, omega = record["body.angular_acceleration"], record["body.rate"]
    turning = np.outer(alpha[:, 0], y) - np.outer(alpha[:, 1], x)
    towards = np.outer(omega[:, 2] * omega[:, 0], x) + np.outer(omega[:, 2] * omega[:, 1], y)
    return np.asarray(record["body.acceleration"][:, 2:3] + turning + towards)


def station_positions(bot: Robot) -> tuple[np.ndarray, np.ndarray]:
    """Return x forward and y left (20,) of the stations from the centre of mass, m, at its height."""
    rows, columns = np.linspace(bot.L_f, -bot.L_r, 5), np.linspace(bot.half_track, -bot.half_track, 4)
    return np.repeat(rows, 4), np.tile(columns, 5)


def replayed(impact: Impact, data: ModalData) -> np.ndarray:
    """Return the elastic acceleration (n, stations) in m/s2 of other modes under the forces of a collision, exact."""
    modal = data.wheel_shape.T @ impact.force.T
    following = np.concatenate([modal[:, 1:], modal[:, -1:]], axis=1)  # held from a time on, not up to it
    still = modal[:, 0] / (2 * np.pi * data.frequency) ** 2
    found = held_response(data.frequency, data.damping, impact.time, following, still, left=True).at_stations(data)
    found[0] = 0.0  # at rest
    return found


def felt(impact: Impact, acceleration: np.ndarray) -> np.ndarray:
    """Return the largest peak (stations,) in g of an oscillator of up to 200 Hz, Q = 10, on an *acceleration*."""
    even = np.arange(impact.time[0], impact.time[-1], 1 / RATE)
    resampled = np.column_stack([np.interp(even, impact.time, column) for column in acceleration.T])
    return np.asarray(response_spectrum(resampled, RATE, FREQUENCIES[BAND]).max(axis=0))


def ranking(values: np.ndarray) -> list[int]:
    """Return the stations from the worst to the quietest; equal ones by their number."""
    return [int(k) + 1 for k in np.argsort(-np.round(values, 9), kind="stable")]


@dataclass(frozen=True)
class Row:
    """The map of one collision for one number of modes and one damping."""

    variant: str
    modes: int
    damping: float
    peak: np.ndarray  # (stations,) g, elastic
    felt: np.ndarray  # (stations,) g, of what is mounted

    @property
    def worst(self) -> int:
        """The station with the largest peak."""
        return ranking(self.peak)[0]

    @property
    def quietest(self) -> int:
        """The station with the smallest peak."""
        return ranking(self.peak)[-1]


def row(variant: str, modes: int = MODES, damping: float | None = None) -> Row:
    """Return the map of a collision with so many modes, and with one *damping* ratio for all if it is given."""
    data = platform(CUT_OFFS[-1]).first(modes)
    if damping is not None:
        data = data.damped(damping)
    impact = collide(variant)
    a = replayed(impact, data)
    return Row(variant, modes, float(data.damping[0]), peaks(a), felt(impact, a))


@cache
def sensitivity(variant: str) -> tuple[Row, ...]:
    """Return the maps for all numbers of modes at the damping of the data, then for all dampings with 25 modes."""
    return (*(row(variant, n) for n in CUT_OFFS), *(row(variant, MODES, z) for z in DAMPINGS))


def sentence(one: str = ONE, two: str = TWO) -> str:
    """Return what a designer takes home, every number from the runs."""
    first, second = row(one), row(two)
    rows = [*sensitivity(one), *sensitivity(two)]
    worst = sum(r.worst in CORNERS for r in rows)
    calm = sum(r.quietest in INNER for r in rows)
    ratios = [at(r.peak, CORNERS).min() / at(r.peak, INNER).max() for r in rows]
    harder = int(np.sum(second.peak > first.peak))
    others = at(first.peak, CORNERS[1:])
    return (
        f"Do not mount a sensor at a corner: a front wheel on the ramp at 2 m/s gives {first.peak[0]:.1f} g at the "
        f"corner above it and {others.min():.1f} to {others.max():.1f} g at the others, at most "
        f"{at(first.peak, INNER).max():.1f} g at the six inner stations; with both wheels it is "
        f"{at(second.peak, CORNERS).max():.1f} and {at(second.peak, INNER).max():.1f} g, more at {harder} of 20 "
        f"stations. For 5 to 200 modes and damping 0 to 0.05 the worst station is a corner in {worst} of {len(rows)} "
        f"maps, the quietest an inner one in {calm}, and the mildest corner has {min(ratios):.1f} to "
        f"{max(ratios):.1f} times the peak of the worst inner station."
    )


def collision_figure(variants: tuple[str, ...] = (ONE, TWO)) -> Sheet:
    """Return the maps of peak acceleration of collisions, and their stations ranked."""
    figure, axes = panels("Peak elastic acceleration / g, 25 modes, front on top", 1, len(variants), figsize=(9, 5.5))
    columns: dict[str, np.ndarray] = {"station": STATIONS}
    rows = [row(v) for v in variants]
    limit = max(r.peak.max() for r in rows)
    for axis, found in zip(axes.flat, rows, strict=True):
        axis.imshow(found.peak.reshape(5, 4), cmap="YlOrRd", vmin=0, vmax=limit, aspect=1.1)
        for k, value in enumerate(found.peak):
            ink = "white" if value > 0.7 * limit else "black"
            axis.text(k % 4, k // 4, f"{k + 1}: {value:.1f}", ha="center", va="center", fontsize=8, color=ink)
        axis.set(title=found.variant, xticks=[], yticks=[])
        axis.grid(False)
        impact = collide(found.variant)
        columns[f"{found.variant}, elastic [g]"] = found.peak
        columns[f"{found.variant}, with the rigid body [g]"] = peaks(impact.recorded + impact.rigid)
        columns[f"{found.variant}, felt below 200 Hz [g]"] = found.felt
        columns[f"{found.variant}, rank"] = np.argsort(np.array(ranking(found.peak))) + 1
    return Sheet("Collision: where not to mount a sensor", columns, figure, (sentence(*variants),))


def sensitivity_figure(variants: tuple[str, ...] = VARIANTS) -> Sheet:
    """Return how the peaks at corners and inside depend on the number of modes and on damping."""
    figure, axes = panels("Worst corner (line) and worst inner station (dashed)", 1, 2, sharey=True)
    table: dict[str, list[object]] = {
        k: [] for k in ("collision", "modes", "damping", "corner [g]", "inner [g]", "worst", "quietest")
    }
    for variant, colour in zip(variants, LINES, strict=False):
        rows = sensitivity(variant)
        groups = (rows[: len(CUT_OFFS)], rows[len(CUT_OFFS) :])
        for axis, group, x in zip(axes.flat, groups, (CUT_OFFS, range(len(DAMPINGS))), strict=True):
            axis.semilogy(list(x), [at(r.peak, CORNERS).max() for r in group], "o-", color=colour, label=variant)
            axis.semilogy(list(x), [at(r.peak, INNER).max() for r in group], "o--", color=colour)
        for r in rows:
            values = (
                variant,
                r.modes,
                r.damping,
                at(r.peak, CORNERS).max(),
                at(r.peak, INNER).max(),
                r.worst,
                r.quietest,
            )
            for column, value in zip(table.values(), values, strict=True):
                column.append(value)
    axes[0, 0].set(xlabel="modes", ylabel="peak / g", xscale="log")
    axes[0, 1].set(
        xlabel="damping ratio, 25 modes", xticks=range(len(DAMPINGS)), xticklabels=[f"{z:g}" for z in DAMPINGS]
    )
    axes[0, 0].legend(frameon=False, fontsize=8)
    note = (
        "a damped wheel meets the ramp with a jump of its force, c times the jump of the gap rate, so its peaks grow "
        "with every mode; an undamped one does not, and its peaks settle above 50 modes"
    )
    return Sheet("Sensitivity of the map", {k: np.array(v) for k, v in table.items()}, figure, (note,))
