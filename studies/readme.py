"""The tables of README.md, made from fresh runs: ``python -m studies.readme`` writes them anew.

A table stands between ``<!-- table NAME -->`` and ``<!-- end -->``; a test compares its figures with those of a run.
"""

from __future__ import annotations

import re
from pathlib import Path

from .catalog import find_scenario
from .metrics import as_mapping
from .runner import Result, execute
from .verdicts import number

README = Path(__file__).resolve().parent.parent / "README.md"

# key of the metric: how the README calls it
COLUMNS = {
    "front_off": "front off the ground, ms",
    "front_rebounds": "front rebounds",
    "rear_off": "rear off, ms",
    "front_normal_peak": "peak front axle force, N",
    "demand_peak": "largest demand per wheel, N",
    "friction_needed": "traction / normal force",
    "speed_min": "lowest speed, m/s",
    "speed_max": "highest speed, m/s",
}
TABLES = ("ramp-impact", "ramp-impact-realistic")


def results(name: str) -> list[Result]:
    """Run all variants of a scenario."""
    file = find_scenario(name)
    return [execute(file.load(variant)) for variant in file.variants]


def table(runs: list[Result]) -> str:
    """Return the verdicts on *runs* as a Markdown table, a row per variant and a column per metric."""
    lines = ["| | " + " | ".join(COLUMNS.values()) + " |", "| --- |" + " ---: |" * len(COLUMNS)]
    for run in runs:
        values = as_mapping(run.metrics)
        lines.append(f"| {run.scenario.variant} | " + " | ".join(number(values[key]) for key in COLUMNS) + " |")
    return "\n".join(lines)


def block(name: str) -> re.Pattern[str]:
    """Return the pattern of a table in the README: its group 1 is the table."""
    return re.compile(rf"<!-- table {re.escape(name)} -->\n(.*?)<!-- end -->", re.DOTALL)


def main() -> None:
    """Write the tables into the README."""
    text = README.read_text(encoding="utf-8")
    for name in TABLES:
        text = block(name).sub(f"<!-- table {name} -->\n{table(results(name))}\n<!-- end -->", text)
    README.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
