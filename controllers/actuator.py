"""An actuator between a demand and who obeys it: limited, and late by a lag of first order."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from cosim import Component, DeclarationError, input, output, parameter, state, structural

_ANY = 1e300  # a rate that no demand asks for
_NONE = 1e-9  # s, the grain of time: a lag of 0 counts as one in the derivative


class Actuator(Component):
    """Actuator of a signal of any shape and unit: saturation, lag of first order, limited rate.

        lag y' = sat(u, limit) - y,   |y'| <= rate_limit

    advanced exactly for a demand held over the step: with a rate limit, y first moves at it until the lag alone would
    be slower.  It starts from 0.
    """

    unit = structural("1", "unit of the signal")
    shape = structural((), "shape of the signal")

    lag = parameter(0.0, "s", "time constant, of all elements or of each; 0: none", shape="shape")
    limit = parameter(0.0, "unit", "largest magnitude, of all elements or of each; 0: any", shape="shape")
    rate_limit = parameter(0.0, "unit/s", "largest rate, of all elements or of each; 0: any", shape="shape")

    u = input("unit", "demand", shape="shape")

    position = state(0.0, "unit", "what the actuator gives", shape="shape")

    y = output("unit", "what the actuator gives", shape="shape")

    def __init__(self, **values: Any) -> None:
        super().__init__(**values)
        for name in ("lag", "limit", "rate_limit"):
            if (least := np.min(getattr(self, name), initial=0)) < 0:
                raise DeclarationError(f"Actuator.{name} is {least:g}; it must be 0 or positive")

    def flow(s: Any) -> dict[str, Any]:
        asked = _saturated(s)
        missing = asked - s.position
        rate = ca.if_else(s.rate_limit > 0, s.rate_limit, _ANY)
        slow = ca.fmin(ca.fabs(missing), rate * s.lag)  # what the lag closes without the limit of the rate
        left = s.dt - (ca.fabs(missing) - slow) / rate  # time left for that, after moving at the limit
        lagging = asked - ca.sign(missing) * slow * ca.exp(-ca.fmax(0, left) / ca.fmax(s.lag, 1 / _ANY))
        limited = s.position + ca.sign(missing) * rate * s.dt
        return {"position": ca.if_else(left > 0, lagging, limited)}

    def derivatives(s: Any) -> dict[str, Any]:
        rate = ca.if_else(s.rate_limit > 0, s.rate_limit, _ANY)
        wanted = (_saturated(s) - s.position) / ca.fmax(s.lag, _NONE)
        return {"position": ca.fmax(-rate, ca.fmin(rate, wanted))}

    def outputs(s: Any) -> dict[str, Any]:
        return {"y": s.position}


def _saturated(s: Any) -> Any:
    return ca.if_else(s.limit > 0, ca.fmax(-s.limit, ca.fmin(s.limit, s.u)), s.u)
