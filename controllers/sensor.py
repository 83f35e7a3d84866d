"""A sensor between a signal and who reads it: sampled, noisy, quantised, late."""

from __future__ import annotations

from math import prod
from typing import Any

import casadi as ca
import numpy as np

from cosim import Component, DeclarationError, input, output, parameter, state, structural

from .noise import SEEDS, STREAMS, Generator, seeded


class Sensor(Component):
    """Sensor of a signal of any shape and unit: sampled, with Gaussian noise, quantisation and a delay.

    At each tick of ``period``, measured = quantum round((u + noise) / quantum); the output is what was measured
    ``delay`` ticks ago, held until the next tick.  Before there are so many, it is the first measurement; before the
    first tick, 0.  Every element has noise of its own; the same seed gives the same noise, on every machine.
    """

    unit = structural("1", "unit of the signal")
    shape = structural((), "shape of the signal")
    delay = structural(0, "age of the output in samples")

    period = parameter(1e-3, "s", "sample period")
    noise = parameter(0.0, "unit", "standard deviation of the noise, of all elements or of each", shape="shape")
    seed = parameter(0.0, "1", "which noise: a whole number, the same noise for the same one")
    quantum = parameter(0.0, "unit", "step between the values that it can show; 0: any value", shape="shape")

    u = input("unit", "signal", shape="shape")

    held = state(0.0, "unit", "output since the last tick", shape="shape")
    line = state(0.0, "unit", "measurements on their way, the oldest first", shape=("delay", "shape"))
    s1 = state(0.0, "1", "first part of the noise generator of each element", shape="shape", whole=True)
    s2 = state(0.0, "1", "second part of the noise generator of each element", shape="shape", whole=True)
    begun = state(0.0, "1", "1 once something was measured", whole=True)

    y = output("unit", "what the sensor shows", shape="shape")

    def __init__(self, **values: Any) -> None:
        super().__init__(**values)
        for name in ("noise", "quantum"):
            if (least := np.min(getattr(self, name), initial=0)) < 0:
                raise DeclarationError(f"Sensor.{name} is {least:g}; it must be 0 or positive")
        if self.seed != int(self.seed) or not 0 <= self.seed < 2**SEEDS:
            raise DeclarationError(f"Sensor.seed is {self.seed!r}; it must be a whole number from 0 to {2**SEEDS - 1}")
        if prod(self.shape) > 2**STREAMS:
            raise DeclarationError(f"Sensor.shape has {prod(self.shape)} elements; there is noise for {2**STREAMS}")

    def sync(s: Any) -> dict[str, Any]:
        begun = s.begun > 0.5
        fresh = seeded(s.seed, s.u.shape)
        now = Generator(ca.if_else(begun, s.s1, fresh.s1), ca.if_else(begun, s.s2, fresh.s2))
        normal, later = now.normal()
        measured = _quantised(s.u + s.noise * normal, s.quantum)
        found = {"held": measured, "s1": later.s1, "s2": later.s2, "begun": 1}
        if not s.delay:
            return found
        newest = ca.reshape(measured.T, 1, -1)
        line = ca.if_else(begun, s.line, ca.repmat(newest, s.delay, 1))
        oldest = ca.reshape(line[0, :], s.u.size2(), s.u.size1()).T
        return {**found, "held": oldest, "line": ca.vertcat(line[1:, :], newest)}

    def outputs(s: Any) -> dict[str, Any]:
        return {"y": s.held}


def _quantised(value: Any, quantum: Any) -> Any:
    """Return the multiple of *quantum* nearest to *value*, halves upwards."""
    some = quantum > 0
    return ca.if_else(some, quantum * ca.floor(value / ca.if_else(some, quantum, 1) + 0.5), value)
