"""One figure or table of the thesis or of a paper: how it is made and what it claims."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

from .claim import Claim
from .sheet import Sheet


def _nothing() -> list[Claim]:
    return []


@dataclass(frozen=True)
class Entry:
    """A figure by its *key*, as "thesis 6.5" or "shock paper 4"; nothing is computed before it is asked for.

    *run* names a scenario and a variant that shows the same moving, in Rerun.
    """

    key: str
    title: str
    make: Callable[[], Sheet]
    claims: Callable[[], list[Claim]] = _nothing
    run: tuple[str, str] | None = None

    @property
    def part(self) -> str:
        """The chapter or the paper it is of, as "chapter 6" or "shock paper"."""
        if chapter := re.match(r"thesis (?:table )?(\d+)", self.key):
            return f"chapter {chapter[1]}"
        return re.sub(r"(.+ paper|[^ ]+).*", r"\1", self.key)

    @property
    def stem(self) -> str:
        """The name of its files, without the ending."""
        return re.sub(r"[^a-z0-9]+", "_", self.key.lower())
