"""Are the closed-loop poles of the impact controllers where they were placed, on the co-simulated rover?

Identified over 60 ms from differences of co-simulated runs (one disturbed by heave, one by pitch, unless it says a
single pair), the front wheels 0.1 m up the 0.3 rad ramp, friction unlimited.  Hard wheels (5.6e6 N/m per axle, 227 and
254 rad/s without control) unless said otherwise.  The last rows are where it goes wrong, and what for.

    python benchmarks/pole_identification.py
"""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from controllers.state_space import closed_loop_poles, conjugate_poles, impact_model
from cosim.errors import CouplingError
from plants.planar import Bicycle
from plants.tables import ROBOTS
from studies.pole_identification import HARD, Bench, Finding, examine, simulate

POLES = conjugate_poles([150.0, 200.0], 0.7)
WHEEL_POLES = conjugate_poles([150.0, 170.0, 200.0, 230.0], 0.7)
OBSERVER_POLES = conjugate_poles([500.0, 700.0], 0.8)
THESIS = np.repeat(np.roots([1.0, 70.0, 1500.0]), 2)  # h0 = 1500, h1 = 70 on both axles
UNLIMITED = {"limits": "motor", "F_max": 1e9}


def pairs(poles: np.ndarray) -> list[list[float]]:
    """Write poles as a scenario file does."""
    return [[float(s.real), float(s.imag)] for s in poles]


def placed(poles: np.ndarray, bench: Bench, at_hand: bool = True, **more: Any) -> Bench:
    """Put a pole placement on a bench, designed for how the rover stands, or for the default posture."""
    posture = {"posture": {"front": 0.3, "pitch": bench.posture().pitch}} if at_hand else {}
    return replace(bench, controller={"type": "PolePlacement", "poles": pairs(poles), **UNLIMITED, **posture, **more})


def cases() -> dict[str, tuple[Bench, np.ndarray, dict[str, Any]]]:
    """Return the rows of the table: bench, poles asked, how to identify."""
    stand = Bench({"type": "Uncontrolled"})
    soft = replace(stand, k_axle=2e5)
    slow = POLES * np.sqrt(soft.k_axle / HARD)  # as fast against the wheels as on hard ones
    free = replace(stand, wheels=True, C_alpha=1e-9)
    observed = placed(POLES, replace(stand, period=1e-4), feedback="observer", observer_poles=pairs(OBSERVER_POLES))
    pd = {"type": "PdImpact", "h0": 1500.0, "h1": 70.0, **UNLIMITED}
    return {
        **{f"period {T:g} s": (placed(POLES, replace(stand, period=T)), POLES, {}) for T in (1e-4, 5e-4, 1e-3)},
        "period 0.001 s, a single pair of runs": (placed(POLES, stand), POLES, {"together": True}),
        "four wheels, no side grip": (placed(WHEEL_POLES, free, model="wheels"), WHEEL_POLES, {}),
        "observer error, period 0.0001 s": (observed, OBSERVER_POLES, {"of": "error"}),
        "four wheels on tyres that grip sideways": (
            placed(WHEEL_POLES, replace(free, C_alpha=5e3), model="wheels"),
            WHEEL_POLES,
            {},
        ),
        "at 0.5 m/s": (placed(POLES, replace(stand, speed=0.5)), POLES, {}),
        "k_w 2e5 per axle, poles in proportion": (placed(slow, soft), slow, {}),
        "at 0.5 m/s, a single pair of runs": (placed(POLES, replace(stand, speed=0.5)), POLES, {"together": True}),
        "k_w 2e5 per axle, a single pair of runs": (placed(slow, soft), slow, {"together": True}),
        "designed for pitch 0": (placed(POLES, stand, at_hand=False), POLES, {}),
        "h0 = 1500, h1 = 70 placed": (placed(THESIS, stand), THESIS, {}),
        "h0 = 1500, h1 = 70 by the PD law, period 0.0001 s": (replace(stand, controller=pd, period=1e-4), THESIS, {}),
        "h0 = 1500, h1 = 70 by the PD law, period 0.001 s": (replace(stand, controller=pd), THESIS, {}),
    }


def reason() -> dict[str, Any]:
    """Return what a law that cancels the spring is left with: the poles of h0 = 1500 if P is 1 % off, and drift."""
    stand = Bench({"type": "Uncontrolled"})
    side, at = Bicycle(ROBOTS[stand.table]), stand.posture()
    P, U = side.P(at), side.U(at)
    h0, h1 = 1500.0, 70.0
    K = np.linalg.solve(U, np.hstack([h0 * np.eye(2) - HARD * P, h1 * np.eye(2)]))
    found = {f"P {100 * e:+g} %": closed_loop_poles(impact_model(P * (1 + e), U, HARD), K, 1e-4) for e in (0.01, -0.01)}
    end = simulate(placed(THESIS, stand), {}).motion[-1]
    return {
        "open loop, rad/s": side.frequencies(at, HARD).tolist(),
        "share of the spring that is cancelled": float(1 - h0 / (HARD * P[1, 1])),
        "rolled in 60 ms with h0 = 1500, m": float(end[4] - stand.x),
        "damping added by sampling, (k P22 - h0) T / 2 at 1e-3 s, 1/s": float((HARD * P[1, 1] - h0) * 1e-3 / 2),
        **{name: [[s.real, s.imag] for s in poles] for name, poles in found.items()},
    }


def text(poles: np.ndarray) -> str:
    """Write each pair of poles once."""
    return ", ".join(f"{s.real:.1f}{s.imag:+.1f}j" for s in poles if s.imag >= 0)


def main() -> None:
    """Measure and print."""
    shown = Table("case", "asked, rad/s", "identified, rad/s", "worst, %", title="closed-loop poles, upper half plane")
    results: dict[str, dict[str, Any]] = {}
    for name, (bench, asked, how) in cases().items():
        try:
            found: Finding = examine(bench, asked, **how)
        except CouplingError as error:
            shown.add_row(name, text(asked), str(error).partition(":")[0], "-")
            results[name] = {"asked": pairs(asked), "error": str(error)}
            continue
        worst = 100 * float(np.max(found.errors))
        shown.add_row(name, text(found.asked), text(found.found), f"{worst:.2f}")
        results[name] = {"asked": pairs(found.asked), "found": pairs(found.found), "worst_percent": worst}
    console = Console(width=160)
    console.print(shown)
    why = reason()
    for name, value in why.items():
        console.print(f"{name}: {value if isinstance(value, float) else np.round(value, 2).tolist()}")
    print(json.dumps({"results": results, "reason": why}))


if __name__ == "__main__":
    main()
