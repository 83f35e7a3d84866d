"""What all verdicts come to: counts, and what a reader may trust, part by part."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from .build import Outcome
from .claim import CONTRADICTED, REPRODUCED, TREND, UNKNOWN, Claim

VERDICTS = (REPRODUCED, TREND, CONTRADICTED, UNKNOWN)


@dataclass(frozen=True)
class Row:
    """The counts (in the order of VERDICTS) of a part."""

    part: str
    counts: tuple[int, ...]
    figures: int


def counts(claims: Iterable[Claim]) -> tuple[int, ...]:
    """Return how many claims have each of VERDICTS."""
    found = Counter(c.verdict for c in claims)
    return tuple(found[v] for v in VERDICTS)


def by_part(outcomes: Sequence[Outcome]) -> list[Row]:
    """Return a row for each part, in the order of *outcomes*."""
    parts = dict.fromkeys(o.part for o in outcomes)
    return [
        Row(p, counts(c for o in outcomes if o.part == p for c in o.claims), sum(o.part == p for o in outcomes))
        for p in parts
    ]


def sentence(outcomes: Sequence[Outcome]) -> str:
    """Return the verdict on everything in one sentence."""
    found = counts(c for o in outcomes for c in o.claims)
    words = ", ".join(f"{n} {v}" for n, v in zip(found, VERDICTS, strict=True))
    failed = sum(bool(o.error) for o in outcomes)
    lost = f"; {failed} of them failed" if failed else ""
    return f"Of {sum(found)} claims about {len(outcomes)} figures and tables: {words}{lost}."


def with_verdict(outcomes: Sequence[Outcome], verdict: str) -> list[tuple[Outcome, Claim]]:
    """Return the claims of a *verdict* and where they are."""
    return [(o, c) for o in outcomes for c in o.claims if c.verdict == verdict]
