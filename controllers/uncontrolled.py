"""No control: the robot rolls freely."""

from __future__ import annotations

from typing import Any

import casadi as ca

from .traction import TractionController


class Uncontrolled(TractionController):
    """Asks for no traction: what every other controller is compared with."""

    def sync(s: Any) -> dict[str, Any]:
        return {"demand": ca.SX.zeros(4), "on": 0}
