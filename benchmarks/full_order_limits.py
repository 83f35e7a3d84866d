"""Does the full-order robot become the analytical ones where their assumptions hold?

    python benchmarks/full_order_limits.py

Largest differences over a run, forces of the front axle smoothed over 1 ms.
"""

from __future__ import annotations

from studies.full_order_limits import towards_deformation, towards_rigid

RINGS = [
    (1.0, 1.0),
    (0.3, 1.0),
    (0.1, 1.0),
    (0.3, 3.0),
    (0.3, 10.0),
    (0.3, 30.0),
    (0.1, 100.0),
]  # mass, bending and stretching
WHEELS = [(1e5, 128), (1e6, 128), (1e7, 128), (1e6, 512), (1e7, 512)]  # N/m, points of a ring


def main() -> None:
    """Print both tables."""
    print("to WheelDeformation, ramp of 0.3 rad at 2 m/s, 1e5 N/m per wheel, no damping, no friction, 60 ms")
    print(f"{'mass':>6} {'bending':>8} {'force':>8} {'speed, m/s':>11}")
    for (mass, stiff), left in zip(RINGS, towards_deformation(RINGS), strict=True):
        print(f"{mass:6g} {stiff:8g} {100 * left.force:7.1f}% {left.speed:11.4f}")
    print("to RigidContact, smooth hump of 2 cm over 1 m at 2 m/s, zeta = 0.3, no friction, 0.5 s")
    print(f"{'k_w, N/m':>9} {'points':>6} {'force':>8} {'speed, m/s':>11}")
    for (k_w, points), left in zip(WHEELS, towards_rigid(WHEELS), strict=True):
        print(f"{k_w:9g} {points:6d} {100 * left.force:7.1f}% {left.speed:11.4f}")


if __name__ == "__main__":
    main()
