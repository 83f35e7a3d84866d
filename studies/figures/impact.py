"""The figures of chapter 6 and of the wheel impact paper."""

from __future__ import annotations

from . import impact_gains as gains
from . import impact_plan as plan
from . import impact_poles as poles
from . import impact_response as response
from .entry import Entry
from .impact_stiffness import stiffness_claims, stiffness_figure

_PD, _PLANNED = ("ramp-impact", "pd"), ("ramp-impact", "pd-planned")
_LIMITED = ("ramp-impact", "pd-friction")

ENTRIES: tuple[Entry, ...] = (
    Entry("thesis 6.5", "the damping gain and the settling of the front wheels", gains.damping_gain,
          gains.damping_claims, _PD),
    Entry("thesis 6.6", "the proportional gain and the settling of the front wheels", gains.proportional_gain,
          gains.proportional_claims, _PD),
    Entry("thesis 6.7", "wheel deformations under the impact law", response.deformation_figure,
          response.deformation_claims, _PD),
    Entry("thesis 6.8", "tractions of the impact law", response.force_figure, response.force_claims, _LIMITED),
    Entry("thesis 6.9", "tractions on stiff and soft wheels", stiffness_figure, stiffness_claims, _PD),
    Entry("thesis 6.10", "the planned path of the front wheels", plan.path_figure, plan.path_claims, _PLANNED),
    Entry("thesis 6.11", "tracking errors of a step and of a plan", plan.tracking_figure, plan.tracking_claims,
          _PLANNED),
    Entry("thesis 6.16 poles", "poles of the wheels by the state space, controlled and not", poles.poles_figure,
          poles.poles_claims, ("ramp-impact", "uncontrolled")),
    Entry("wheel impact paper 4", "the damping gain and the settling of the front wheels", gains.damping_gain,
          gains.paper_damping_claims, _PD),
    Entry("wheel impact paper 5", "the proportional gain and the settling of the front wheels",
          gains.proportional_gain, gains.paper_proportional_claims, _PD),
    Entry("wheel impact paper 6", "the planned path of the front wheels", plan.path_figure, plan.paper_path_claims,
          _PLANNED),
    Entry("wheel impact paper 7", "tractions along the planned path", plan.plan_force_figure, plan.plan_force_claims,
          ("ramp-impact", "pd-planned-friction")),
    Entry("wheel impact paper 8", "tracking errors of a step and of a plan", plan.tracking_figure,
          plan.paper_tracking_claims, _PLANNED),
)  # fmt: skip
