"""What the thesis and the shock paper claim about the shock response, judged."""

from __future__ import annotations

from collections.abc import Callable

from plants.chassis_modes import ModalData
from studies.figures.claim import Claim

from .cases import platform
from .claims_collision import faced, reaction_of_the_diagonal, reaction_of_the_rear, soft_wheels, zones
from .claims_method import few_modes_suffice, load_factors, rectangular_is_worst, transient_dies_out
from .claims_modes import four_wheels_spare_mode_2, middle_row_alike, similar_modes, single_excites_all
from .claims_peaks import (
    corners_edges_interior,
    diagonal_is_worse_than_four,
    other_corners_5_g,
    shorter_is_harsher,
    station_1_is_worst,
    station_10,
)

CLAIMS: tuple[Callable[[ModalData], Claim], ...] = (
    few_modes_suffice,
    transient_dies_out,
    station_1_is_worst,
    other_corners_5_g,
    corners_edges_interior,
    station_10,
    shorter_is_harsher,
    similar_modes,
    single_excites_all,
    four_wheels_spare_mode_2,
    diagonal_is_worse_than_four,
    middle_row_alike,
    load_factors,
    rectangular_is_worst,
)
# judged on co-simulated collisions of the default chassis
COLLISION_CLAIMS: tuple[Callable[[], Claim], ...] = (
    reaction_of_the_diagonal,
    reaction_of_the_rear,
    faced,
    zones,
    soft_wheels,
)


def judged(data: ModalData | None = None) -> list[Claim]:
    """Return the verdicts on all claims that modal data decide; the default chassis if none are given."""
    given = platform() if data is None else data
    return [claim(given) for claim in CLAIMS]


def judged_collisions() -> list[Claim]:
    """Return the verdicts on the claims that a collision decides: four runs of less than a second."""
    return [claim() for claim in COLLISION_CLAIMS]
