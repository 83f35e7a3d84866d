"""A claim of the thesis with the value found and the verdict on it.

| verdict | meaning |
| --- | --- |
| reproduced | what is said is found |
| trend only | the order or the tendency is found, the value or the generality is not |
| contradicted | it is not found |
"""

from __future__ import annotations

from dataclasses import dataclass, field

REPRODUCED, TREND, CONTRADICTED = "reproduced", "trend only", "contradicted"
EQUAL = 1e-6  # of the largest: what the eigensolver leaves of a symmetry


@dataclass(frozen=True)
class Claim:
    """A sentence of the source, what was computed for it, and whether it holds; *numbers* are those of *found*."""

    where: str
    text: str
    found: str
    verdict: str
    numbers: dict[str, float] = field(default_factory=dict)


def graded(good: bool, partly: bool = False) -> str:
    """Return the verdict: reproduced if *good*, trend only if *partly*, else contradicted."""
    return REPRODUCED if good else TREND if partly else CONTRADICTED
