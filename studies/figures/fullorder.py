"""The figures that the thesis and its papers made with LS-DYNA, on the full-order robot."""

from __future__ import annotations

from . import full_impact as impact
from .entry import Entry

ENTRIES: tuple[Entry, ...] = (
    Entry("thesis 6.14", "Reaction of the front wheels, full-order robot", impact.front_figure, impact.front_claims,
          ("full-order-ramp", "pd")),
    Entry("thesis 6.15", "Reaction of the rear wheels, full-order robot", impact.rear_figure, impact.rear_claims,
          ("full-order-ramp", "pd")),
    Entry("wheel impact paper 9", "Reaction of the front wheels, full-order robot", impact.paper_front_figure,
          impact.paper_front_claims, ("full-order-ramp", "playback")),
    Entry("wheel impact paper 10", "Reaction of the rear wheels, full-order robot", impact.paper_rear_figure,
          impact.paper_rear_claims, ("full-order-ramp", "playback")),
)  # fmt: skip
