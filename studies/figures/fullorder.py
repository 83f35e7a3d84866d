"""The figures that the thesis and its papers made with LS-DYNA, on the full-order robot."""

from __future__ import annotations

from . import full_impact as impact
from . import full_jerk as jerk
from . import full_shock as shock
from .entry import Entry

ENTRIES: tuple[Entry, ...] = (
    Entry("thesis 6.14", "reaction of the front wheels, full-order robot", impact.front_figure, impact.front_claims,
          ("full-order-ramp", "pd")),
    Entry("thesis 6.15", "reaction of the rear wheels, full-order robot", impact.rear_figure, impact.rear_claims,
          ("full-order-ramp", "pd")),
    Entry("wheel impact paper 9", "reaction of the front wheels, full-order robot", impact.paper_front_figure,
          impact.paper_front_claims, ("full-order-ramp", "playback")),
    Entry("wheel impact paper 10", "reaction of the rear wheels, full-order robot", impact.paper_rear_figure,
          impact.paper_rear_claims, ("full-order-ramp", "playback")),
    Entry("DYMAC paper 5", "normal jerk at three tractions, full-order robot", jerk.dymac_figure, jerk.dymac_claims,
          ("full-order-jerk", "dymac-ideal")),
    Entry("ASME paper 6", "longitudinal jerk at three tractions, full-order robot", jerk.asme_figure, jerk.asme_claims,
          ("full-order-jerk", "asme-ideal")),
    Entry("shock paper 5-full", "station 1 under three pulses, full-order robot", shock.figure, shock.claims),
)  # fmt: skip
