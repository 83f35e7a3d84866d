"""Does the full-order robot become the analytical ones where their assumptions hold?

    python benchmarks/full_order_limits.py

Largest differences over a run, forces of the front axle smoothed over 1 ms, relative to the largest.
"""

from __future__ import annotations

from itertools import pairwise
from math import log

from studies.full_order_limits import (
    Difference,
    Ring,
    difference,
    predicted,
    ring_on_ramp,
    spring_on_ramp,
    towards_rigid,
)

LIMIT = [Ring(0.1, 1e4, 1.0), Ring(0.03, 1e4, 8.0), Ring(0.01, 1e4, 64.0), Ring(0.01, 1e4, 512.0)]
WITHOUT = [Ring(1.0, 1e4, 512.0), Ring(0.01, 1.0, 512.0), Ring(0.01, 1e4, 1.0)]  # one of the three
HARD = 1e8  # a factor of k_contact that leaves nothing of the contact but the corner
WHEELS = [(1e5, Ring(0.3, 1e4)), (3e5, Ring(0.3, 1e4)), (1e6, Ring(0.1, 1e4))]  # N/m
# what has to come along: bending, points, mass; and where points and mass stop this limit
OTHERS = [(1e6, Ring(0.3, 1.0)), (1e6, Ring(0.3, 1e4, points=128)), (1e6, Ring(1.0, 1e4)), (3e6, Ring(0.3, 1e4))]


def _ramp(ring: Ring) -> Difference:
    """Print a ring on the ramp, and how far it is from what is predicted; return what is left to WheelDeformation."""
    run, spring, round_wheel = ring_on_ramp(ring), spring_on_ramp(), predicted(ring.contact)
    left, said = (difference(one, spring) for one in (run, (round_wheel.force, round_wheel.speed)))
    off = difference(run, (round_wheel.force, round_wheel.speed))
    print(f"{ring.mass:6g} {ring.bending:8g} {ring.contact:8g} {100 * left.force:8.2f}% {left.speed:8.4f}   "
          f"{100 * said.force:8.2f}% {said.speed:8.4f}   {100 * off.force:8.2f}%", flush=True)  # fmt: skip
    return left


def _hump(k_w: float, ring: Ring) -> Difference:
    left = towards_rigid(k_w, ring)
    print(
        f"{k_w:9g} {ring.mass:6g} {ring.bending:8g} {ring.points:6d} {100 * left.force:7.2f}% {left.speed:9.5f}",
        flush=True,
    )
    return left


def _orders(of: list[float], left: list[Difference]) -> None:
    """Print the orders of force and speed in one over *of*, from each member of a limit to the next."""
    for name in ("force", "speed"):
        steps = pairwise(zip(of, (getattr(d, name) for d in left), strict=True))
        print(f"  order of {name}: " + ", ".join(f"{log(a[1] / b[1]) / log(b[0] / a[0]):.2f}" for a, b in steps))


def main() -> None:
    """Print all tables."""
    print("to WheelDeformation, sharp ramp of 0.3 rad at 2 m/s, 1e5 N/m per wheel, no damping, no friction, 60 ms")
    print("                           left                 predicted             ring to predicted")
    print(f"{'mass':>6} {'bending':>8} {'contact':>8} {'force':>9} {'m/s':>8}   {'force':>9} {'m/s':>8}   {'force':>9}")
    left = [_ramp(ring) for ring in LIMIT]
    _orders([ring.contact for ring in LIMIT], left)
    print("without one of the three")
    for ring in WITHOUT:
        _ramp(ring)
    hard = predicted(HARD)
    corner = difference((hard.force, hard.speed), spring_on_ramp())
    print(f"a round wheel that may press both faces, without compliance of the contact: {100 * corner.force:.2f} % and "
          f"{corner.speed:.1e} m/s from WheelDeformation, on both for {1e3 * hard.both:.1f} ms")  # fmt: skip
    print("to RigidContact, smooth hump of 2 cm over 1 m at 2 m/s, zeta = 0.3, no friction, 0.2 s")
    print(f"{'k_w, N/m':>9} {'mass':>6} {'bending':>8} {'points':>6} {'force':>8} {'m/s':>9}")
    _orders([k_w for k_w, _ in WHEELS], [_hump(*wheel) for wheel in WHEELS])
    print(
        "rings that bend, of few points, that are heavy; and harder ones than these points and this mass are good for"
    )
    for wheel in OTHERS:
        _hump(*wheel)


if __name__ == "__main__":
    main()
