"""What does the wheel of the full-order robot do as a tyre, and does it follow what is known of tyres?

python benchmarks/full_order_wheel.py
"""

from __future__ import annotations

import numpy as np

from plants.full_order import FullOrderRover
from plants.ring_press import calibrated, depth_under, press
from studies.full_order_wheel import free_rolling, slip_stiffness, tangential_stiffness

SIZE, LOAD, K_W = (32, 128), 417.0, 1e5


def main() -> None:
    """Print load and deflection, rolling resistance by damping, speed and stiffness, and the relaxation length."""
    ring = FullOrderRover(micro_step=1e-7).values
    ring = {**ring, **calibrated(ring, *SIZE, K_W, LOAD)}
    print("load, N  deflection, mm  secant, kN/m  contact, mm  chord, mm")
    for load in (100.0, 200.0, 417.0, 800.0, 1600.0):
        depth = depth_under(ring, *SIZE, load)
        chord = 2 * np.sqrt(2 * ring["R"] * depth)
        print(f"{load:7g} {1e3 * depth:15.2f} {load / depth / 1e3:13.1f} {1e3 * press(ring, *SIZE, depth).patch:12.1f} "
              f"{1e3 * chord:10.1f}")  # fmt: skip
    print("k_w, N/m  c_w, N.s/m  speed, m/s  rolling resistance  effective radius, mm")
    for k_w, c_w, speed in (
        (1e5, 0.0, 2.0), (1e5, 330.7, 2.0), (1e5, 661.4, 2.0), (1e5, 1322.8, 2.0), (1e5, 1322.8, 1.0),
        (2.8e6, 0.0, 2.0), (2.8e6, 1167.0, 2.0),
    ):  # fmt: skip
        found = free_rolling(k_w, c_w, speed)
        print(f"{k_w:8g} {c_w:11g} {speed:11g} {found.resistance:19.4f} {1e3 * found.radius:21.2f}")
    C = slip_stiffness(K_W, 1322.8)
    patch = press(ring, *SIZE, LOAD / K_W).patch
    K_x = tangential_stiffness(ring, patch)
    print(f"slip stiffness {C:.0f} N, tangential stiffness {K_x:.0f} N/m, relaxation length {1e3 * C / K_x:.1f} mm, "
          f"half of the contact {1e3 * patch / 2:.1f} mm")  # fmt: skip


if __name__ == "__main__":
    main()
