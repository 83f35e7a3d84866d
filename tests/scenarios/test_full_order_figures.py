"""The figures that LS-DYNA made, on the full-order robot: what each entry is, and the verdicts on jerk."""

from __future__ import annotations

from studies.catalog import find_scenario
from studies.figures.claim import CONTRADICTED
from studies.figures.full_jerk import dymac_claims
from studies.figures.fullorder import ENTRIES


def test_every_entry_names_runs_that_there_are() -> None:
    assert len({entry.key for entry in ENTRIES}) == len(ENTRIES)
    for entry in ENTRIES:
        if entry.run is not None:
            scenario, variant = entry.run
            assert variant in find_scenario(scenario).variants


def test_the_ideal_traction_does_not_jerk_least() -> None:
    """It is between the two others, since jerk grows with traction; and friction does not pass on an excessive one."""
    least, excessive = dymac_claims()
    assert least.verdict == excessive.verdict == CONTRADICTED
    numbers = least.numbers
    assert 1.05 * numbers["insufficient"] < numbers["ideal"] < numbers["excessive"] / 1.05
    # two rear wheels of 300 N that slide pass on 0.3 of it, that stick 0.8
    assert 0.3 * 600 * 0.8 < excessive.numbers["passed"] < 0.8 * 600
