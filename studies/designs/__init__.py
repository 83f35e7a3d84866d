"""Components that a scenario asks for by their purpose: designed from the robot, its wheels and the ground of the run.

A design takes the slot's parameters and the `Context`, and returns the component with its numbers filled in.  Whatever
is not said in the slot is taken from the context, so that a slot may also say ``robot = {m = 187}``: a controller
designed for another robot than the one it drives.
"""

from __future__ import annotations

from .context import Context, Design
from .full_order import full_order
from .impact import pd_impact, pole_placement
from .jerk import force_profile, jerk_traction
from .pitch import pitch_trajectory
from .playback import playback
from .slip import open_loop_torque, slip_control, steered, wheel_drive

DESIGNS: dict[str, Design] = {
    "PdImpact": pd_impact,
    "PolePlacement": pole_placement,
    "PitchTrajectory": pitch_trajectory,
    "Playback": playback,
    "JerkTraction": jerk_traction,
    "ForceProfile": force_profile,
    "OpenLoopTorque": open_loop_torque,
    "SlipControl": slip_control,
    "Steered": steered,
    "WheelDrive": wheel_drive,
    "FullOrderRover": full_order,
}

__all__ = ["DESIGNS", "Context", "Design"]
