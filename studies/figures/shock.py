"""The figures of chapters 7 and 8 and of the shock paper as entries: each with the claims that are made about it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from plants.chassis_modes import ModalData
from studies.shock import FIGURES, claims_collision, claims_figures, claims_method, claims_modes, claims_peaks
from studies.shock.cases import platform
from studies.shock.collision import collision_figure, sensitivity_figure

from .claim import Claim
from .entry import Entry
from .sheet import Sheet

_Judge = Callable[[ModalData], Claim]
_ON_THE_CHASSIS = ("cut-off", "methods", *(f"8.{k}" for k in range(9, 16)), "paper 5")
_CHASSIS = "the chassis fitted to ten frequencies, its 25 lowest modes, damping ratio 5e-5"
_COLLISION = "fronts on a sharp ramp of 0.3 rad at 2 m/s, rover of Table 8.1, wheels of 1e5 N/m unless they are hard"


def _entry(key: str, name: str, title: str, *judges: _Judge) -> Entry:
    def make() -> Sheet:
        return FIGURES[name](platform())

    assumed = _CHASSIS if name in _ON_THE_CHASSIS else ""
    return Entry(key, title, make, lambda: [_under(assumed, judge(platform())) for judge in judges])


def _under(assumption: str, claim: Claim) -> Claim:
    """Return a claim with an *assumption* that it shares with others, before its own."""
    return replace(claim, assumption="; ".join(filter(None, (assumption, claim.assumption))))


ENTRIES = (
    _entry(
        "thesis 7.3", "7.3", "series and integral of a rectangular pulse",
        claims_figures.series_samples_the_integral, claims_method.transient_dies_out,
    ),
    _entry("thesis 7.4 cut-off", "cut-off", "peaks over the number of modes", claims_method.few_modes_suffice),
    _entry(
        "thesis 7.5 methods", "methods", "the series of the thesis against the exact response",
        claims_figures.series_to_200_hz,
    ),
    _entry("thesis 8.2", "8.2", "natural frequencies", claims_figures.frequencies),
    _entry(
        "thesis 8.3-8.5", "8.3-8.5", "shapes of the modes",
        claims_figures.shapes_in_order, claims_figures.signs_at_the_corners,
    ),
    _entry("thesis 8.6", "8.6", "two rectangular pulses"),
    _entry(
        "thesis 8.7-8.8", "8.7-8.8", "Fourier coefficients of both pulses", claims_figures.amplitudes_diminish
    ),
    _entry(
        "thesis 8.9", "8.9", "accelerations, one wheel, 0.05 s",
        claims_peaks.station_1_is_worst, claims_peaks.other_corners_5_g, claims_peaks.corners_edges_interior,
        claims_peaks.station_10,
    ),
    _entry(
        "thesis 8.10", "8.10", "accelerations, one wheel, 0.08 s", claims_figures.same_trend_for_the_longer_pulse
    ),
    _entry("thesis 8.11", "8.11", "station 1 under both pulses", claims_peaks.shorter_is_harsher),
    _entry("thesis 8.12", "8.12", "accelerations, diagonal wheels", claims_figures.diagonal_is_like_single),
    _entry(
        "thesis 8.13", "8.13", "participation, one wheel and diagonal ones",
        claims_modes.similar_modes, claims_modes.single_excites_all,
    ),
    _entry(
        "thesis 8.14", "8.14", "accelerations, all wheels and diagonal ones",
        claims_peaks.diagonal_is_worse_than_four, claims_modes.middle_row_alike,
    ),
    _entry("thesis 8.15", "8.15", "participation, all wheels and diagonal ones", claims_modes.four_wheels_spare_mode_2),
    _entry("shock paper table 1", "paper table 1", "ten frequencies", claims_figures.paper_frequencies),
    _entry("shock paper 3", "paper 3", "harmonics of three pulses", claims_figures.amplitudes_by_shape),
    _entry("shock paper 4", "paper 4", "dynamic loads of the first harmonics", claims_method.load_factors),
    _entry("shock paper 5", "paper 5", "station 1 under three pulses", claims_method.rectangular_is_worst),
    _entry("co-simulation spectra", "spectra", "what equipment on the chassis feels"),
    Entry(
        "co-simulation collision", "where not to mount a sensor", collision_figure,
        lambda: [
            _under(_COLLISION, judge())
            for judge in (
                claims_collision.reaction_of_the_diagonal, claims_collision.reaction_of_the_rear,
                claims_collision.faced, claims_collision.zones,
            )
        ],
        ("shock-collision", "one-wheel"),
    ),
    Entry(
        "co-simulation sensitivity", "what the map of a collision depends on", sensitivity_figure,
        lambda: [_under(_COLLISION, claims_collision.soft_wheels())], ("shock-collision", "two-wheels"),
    ),
)  # fmt: skip
