"""A claim or a number of the thesis or its papers, with what was found and the verdict on it.

| verdict | meaning |
| --- | --- |
| reproduced | what is said is found |
| trend only | the order or the tendency is found, the value or the generality is not |
| contradicted | it is not found |
| not identifiable | what the source gives does not determine it |
"""

from __future__ import annotations

from dataclasses import dataclass, field

REPRODUCED, TREND, CONTRADICTED, UNKNOWN = "reproduced", "trend only", "contradicted", "not identifiable"
EQUAL = 1e-6  # of the largest: what the eigensolver leaves of a symmetry


@dataclass(frozen=True)
class Claim:
    """A sentence of the source, what was computed for it, and whether it holds; *numbers* are those of *found*.

    *as_printed* is what the equations give as they are printed, where that means something; *assumption* what had to be
    assumed to compute anything at all.
    """

    where: str
    text: str
    found: str
    verdict: str
    numbers: dict[str, float] = field(default_factory=dict)
    as_printed: str = ""
    assumption: str = ""


def graded(good: bool, partly: bool = False) -> str:
    """Return the verdict: reproduced if *good*, trend only if *partly*, else contradicted."""
    return REPRODUCED if good else TREND if partly else CONTRADICTED
