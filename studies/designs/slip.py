"""Wheel drives, slip control and steering, filled in from the robot, its wheels and its drive.

Beside the component's own parameters a slot of `SlipControl` may say

    believes = {mu = 0.3, C_x = 6.0}        the friction curve it is designed for, where it differs from the drive's
    share = 0.3                             of the spin error, corrected in one period; without a gain K
    slip_max = 0.5                          largest slip asked for, where the curve has no peak below it
"""

from __future__ import annotations

from typing import Any

import numpy as np

from controllers.open_loop_torque import OpenLoopTorque
from controllers.slip_control import SlipControl
from controllers.slip_model import inverse_curve, spin_gain
from controllers.steered import Steered
from cosim import Component
from cosim.errors import ScenarioError
from plants.tyre import curves
from plants.wheel_drive import WheelDrive, tyre_of

from .context import Context

_SAMPLES = 2001  # of the curve: its peak is found to 3e-4


def wheel_drive(parameters: dict[str, Any], context: Context) -> Component:
    """Return a `WheelDrive` on the robot's wheels and, unless told otherwise, on the friction of the wheel plant."""
    given: dict[str, Any] = {"R": context.robot.R}
    if "mu" in context.wheels():
        given["mu"] = float(context.wheels()["mu"])
    return WheelDrive(**{**given, **parameters})


def open_loop_torque(parameters: dict[str, Any], context: Context) -> Component:
    """Return an `OpenLoopTorque` for the robot's wheels."""
    return OpenLoopTorque(**{"R": context.robot.R, **parameters})


def slip_control(parameters: dict[str, Any], context: Context) -> Component:
    """Design a `SlipControl` for the friction curve of the drive.

    Raises ScenarioError without a drive, DeclarationError for a curve that does not rise from zero slip.
    """
    drive = next((part for part in context.parts.values() if isinstance(part, WheelDrive)), None)
    believes, share = parameters.pop("believes", {}), parameters.pop("share", 0.3)
    slip_max = parameters.pop("slip_max", 0.5)
    if drive is None:
        raise ScenarioError(
            "SlipControl is designed for the friction curve of a drive, and there is none; "
            'add components.drive with type = "WheelDrive"'
        )
    if not isinstance(believes, dict):
        raise ScenarioError(f"believes must be a table of parameters of WheelDrive, not {believes!r}")
    if not 0 < slip_max <= 1:
        raise ScenarioError(f"slip_max is a slip ratio above 0 and at most 1, not {slip_max!r}")
    known = drive.replace(**believes)
    assert isinstance(known, WheelDrive)
    slips = np.linspace(0.0, slip_max, _SAMPLES)
    rows = inverse_curve(slips, curves(tyre_of(known), slips)[0])
    period = float(parameters.get("period", SlipControl.period.start))
    wheel = {name: float(known.values[name]) for name in ("R", "J_w", "C_x")}
    return SlipControl(**{
        **wheel, "m": context.robot.m, "K": spin_gain(wheel["J_w"], period, share),
        "curve": rows, "mu_peak": rows[-1, 0], "slip_peak": rows[-1, 1], **parameters,
    })  # fmt: skip


def steered(parameters: dict[str, Any], context: Context) -> Component:
    """Return a `Steered` with the dimensions of the robot."""
    robot = context.robot
    return Steered(**{
        "L_f": robot.L_f, "L_r": robot.L_r, "half_track": robot.half_track, "R": robot.R, **parameters,
    })  # fmt: skip
