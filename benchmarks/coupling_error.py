"""How large is the coupling error on the thesis' ramp impact, and what do the interface model and the located edge buy?

Worst error of the vertical speed against the same equations in one ODE (relative tolerance 1e-12), uncontrolled, hard
undamped wheels, the start shifted by 0.07 mm so that the edge falls inside a macro step.

    python benchmarks/coupling_error.py
"""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
from rich.console import Console
from rich.table import Table

from plants.ground import Ground, Ramp
from plants.tables import ROBOTS
from studies.coupling import Case, Coupling, worst_error

IMPACT = Case(ROBOTS["thesis_6_1"], Ground.same(Ramp(start=0.63, angle=0.3)), k_w=2.8e6, x=7e-5)
STEPS = (1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5)
WAYS: dict[str, tuple[Coupling, bool]] = {
    "reduced model, edge located": ("reduced", True),
    "reduced model, edge not located": ("reduced", False),
    "force/displacement, Gauss-Seidel": ("classical", True),
    "force/displacement, Jacobi": ("classical-jacobi", True),
    "reduced model, Jacobi": ("reduced-jacobi", True),
}


def main() -> None:
    """Measure and print."""
    found: dict[str, dict[str, list[float] | float]] = {}
    for duration in (0.3, 0.02):
        case = replace(IMPACT, duration=duration)
        shown = Table(
            "coupling",
            *(f"{h:g} s" for h in STEPS),
            "order",
            title=f"worst error of the vertical speed, m/s, over {duration:g} s",
        )
        for way, (coupling, locate) in WAYS.items():
            errors = [worst_error(case, h, coupling, locate=locate) for h in STEPS]
            order = float(np.polyfit(np.log(STEPS), np.log(errors), 1)[0])
            shown.add_row(way, *(f"{e:.2g}" for e in errors), f"{order:.2f}")
            found[f"{way}, {duration:g} s"] = {"errors": errors, "order": order}
        Console(width=130).print(shown)
    print(json.dumps({"steps": STEPS, "found": found}))


if __name__ == "__main__":
    main()
