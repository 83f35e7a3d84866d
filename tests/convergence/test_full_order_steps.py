"""The full-order robot's impact on a ramp converges with the micro step and with the nodes of its rings."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from benchmarks.full_order_convergence import impact, material, rover
from plants.full_order import FullOrderRover

DURATION = 0.03  # s: 23 ms of the first contact
SOFT, DAMPED = (1e5, 0.0), (1e5, 1322.8)  # N/m, N.s/m: zeta 0 and 0.3


@pytest.mark.parametrize(("wheel", "order"), [(SOFT, 2), (DAMPED, 1)])
def test_the_micro_step_has_the_order_of_the_scheme(wheel: tuple[float, float], order: int) -> None:
    """Position Verlet is of second order; dampers act on the velocity before the kick, which is of first."""
    ring = material(*wheel)
    runs = [impact(rover(16, ring, 2.5e-5 / n), DURATION).force for n in (1, 2, 4)]
    coarse, fine = (float(np.linalg.norm(a - b)) for a, b in pairwise(runs))
    # points that touch or slide a step earlier or later spoil single steps of the undamped one: 2 is 1.6 at least
    assert coarse / fine == pytest.approx(2**order, rel=0.3)


def test_the_nodes_converge() -> None:
    """Force of the front axle with 8, 16 and 32 nodes.

    A polygon misses its circle by (pi / N)^2 / 2 of R, a quarter each time; that a point takes up the force of its
    stretch of ring is of first order only.
    """
    ring = material(*DAMPED)
    sizes = ({"nodes": 8, "points": 16, "seen": 8}, {"nodes": 16, "points": 64}, {"nodes": 32, "points": 128})
    ground = {name: rover(16, ring, 2.5e-5).values[name] for name in ("ground_left", "ground_right")}
    runs = [impact(FullOrderRover(micro_step=2.5e-5, **size, **ground, **ring), DURATION).force for size in sizes]
    coarse, fine = (float(np.linalg.norm(a - b) / np.linalg.norm(b)) for a, b in pairwise(runs))
    assert fine < coarse / 2
    # what is left is the polygon's error in the depth, (pi/16)^2/2 R = 1.9 mm of the 16 mm that the wheel is pressed
    assert fine < (np.pi / 16) ** 2 / 2 * 0.1 / 0.016
