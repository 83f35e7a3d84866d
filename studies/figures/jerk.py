"""The figures on jerk that need no run: of the DYMAC, the ASME and the TIMR paper."""

from __future__ import annotations

from . import jerk_dymac as dymac
from . import jerk_longitudinal as longitudinal
from .entry import Entry

_CONTOURS = "longitudinal jerk and acceleration by slope and traction"

ENTRIES: tuple[Entry, ...] = (
    Entry("DYMAC paper 3", "normal jerk by slope and traction", dymac.contour_figure, dymac.contour_claims),
    Entry("DYMAC paper 4", "ideal force over dimensions and speed", dymac.properties_figure, dymac.properties_claims),
    Entry("ASME paper 3", _CONTOURS, longitudinal.asme_figure, longitudinal.asme_claims),
    Entry("ASME paper 4", "ideal force of front and rear drive", longitudinal.drive_figure, longitudinal.drive_claims),
    Entry("TIMR paper 3", _CONTOURS, longitudinal.timr_figure, longitudinal.timr_claims),
)
