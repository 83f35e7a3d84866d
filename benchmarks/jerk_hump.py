"""What does traction against jerk buy on a smooth hump: the jerk a law sees, the true jerk, speed, friction?

Every variant of the scenario jerk-hump, co-simulated.  "ideal share" is the part of the time on the obstacle in which a
law has its ideal force; "times less" compares the RMS jerk of its definition there, traction held, with that under the
best constant force over the same stretch of road, sought without a floor to its speed.

    python benchmarks/jerk_hump.py
"""

from __future__ import annotations

import json

import numpy as np
from rich.console import Console
from rich.table import Table

from studies.catalog import find_scenario
from studies.jerk_stretch import best_rival, free_stretch, held_jerk, share
from studies.metrics import as_mapping
from studies.metrics.jerk import KINDS
from studies.runner import Result, execute

FILE = find_scenario("jerk-hump")
UNTIL = 2.8  # m, where all wheels are behind the hump


def compare(result: Result, definition: str) -> dict[str, float]:
    """Return how a law does against the best constant force where it is unlimited."""
    free = free_stretch(result)
    best = best_rival(result, definition, free, UNTIL)
    rival = execute(FILE.load(result.scenario.variant, [best.override()]))
    law, constant = held_jerk(result, definition, result, free), held_jerk(rival, definition, result, free)
    return {
        "share": share(result, free),
        "force": best.force,
        "law": law,
        "constant": constant,
        "times": constant / law,
    }


def crossing_time(result: Result) -> float | None:
    """Return when the centre of mass has passed the hump by the wheelbase, s."""
    x = result.record["body.position"][:, 0]
    return float(result.record.time[np.argmax(x > UNTIL)]) if x[-1] > UNTIL else None


def main() -> None:
    """Measure and print."""
    columns = ("held, m/s3", "true, m/s3", "ideal share", "times less", "crossed, s", "slowest, m/s", "lost, m/s", "mu")
    shown = Table("variant", *columns, title="RMS normal jerk on the hump, of the law's definition")
    found: dict[str, dict[str, float | None]] = {}
    for variant in FILE.variants:
        result = execute(FILE.load(variant))
        verdict = as_mapping(result.metrics)
        definition = variant if variant in KINDS else "body"
        row = {
            "held": verdict[f"jerk_held_{definition}"], "true": verdict[f"jerk_true_{definition}"],
            **(compare(result, definition) if result.signal("controller.unlimited") is not None else {}),
            "crossed": crossing_time(result), "slowest": verdict["speed_min"], "lost": verdict["speed_lost"],
            "friction": verdict["friction_needed"],
        }  # fmt: skip
        found[variant] = row
        names = ("held", "true", "share", "times", "crossed", "slowest", "lost", "friction")
        shown.add_row(variant, *("-" if row.get(name) is None else f"{row[name]:.3g}" for name in names))
    Console(width=150).print(shown)
    print(json.dumps(found))


if __name__ == "__main__":
    main()
