"""Which conclusions about controllers survive on the full-order robot?

    python benchmarks/full_order_ab.py [SCENARIO [VARIANT ...]]

The A/B of a scenario (ramp-impact-realistic; slip-start for slip control) on the analytical robot, and beside it on the
full-order one, with a rigid chassis and with one that bends: a table in Markdown.  A run of 1.2 s on the full-order
robot takes 4 s or more.
"""

from __future__ import annotations

import sys

from studies.catalog import find_scenario
from studies.metrics import as_mapping
from studies.runner import execute
from studies.verdicts import number

FULL = 'body.type="FullOrderRover"'
PLANTS: dict[str, list[str]] = {
    "analytical": [],
    "full order, rigid": [FULL, "body.chassis=false"],
    "full order": [FULL],
}
FIGURES = {"front_off": "front off, ms", "front_unloaded": "front unloaded, ms", "front_normal_peak": "front peak, N"}
SLIP = {"speed_max": "top speed, m/s", "slip_loss": "lost in slip, J", "actuator_energy": "motors, J"}


def rows(scenario: str, variants: list[str]) -> list[list[str]]:
    """Return the rows of the table, the head first."""
    file = find_scenario(scenario)
    figures = SLIP if "slip" in file.load().verdict else FIGURES
    found = [["", *(f"{label}, {plant}" for label in figures.values() for plant in PLANTS)]]
    for variant in variants or list(file.variants):
        verdicts = []
        for changes in PLANTS.values():
            result = execute(file.load(variant, file.overrides(changes)))
            verdicts.append({} if result.error is not None else as_mapping(result.metrics))
        found.append([variant, *(number(v.get(key)) for key in figures for v in verdicts)])
    return found


def main() -> None:
    """Print the table."""
    scenario, *variants = sys.argv[1:] or ["ramp-impact-realistic"]
    head, *rest = rows(scenario, variants)
    for row in (head, ["---"] * len(head), *rest):
        print("| " + " | ".join(row) + " |", flush=True)


if __name__ == "__main__":
    main()
