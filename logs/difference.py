"""How two logs differ, signal by signal: the same bits, or how far apart and from when on."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .read import Signal, signals

# what a run writes about itself, which no other run repeats
CLOCKS = ("master.wall",)


@dataclass(frozen=True)
class Difference:
    """How a signal of one log differs from the same of another, over the times that both have."""

    port: str
    unit: str
    largest: float  # of |other - one| over all values
    rms: float
    since: float | None  # s, the first time at which a bit differs; None: nowhere
    only: str = (
        ""  # "one" or "other": the signal is in that log alone; "shape", "times": they cannot be set side by side
    )

    @property
    def identical(self) -> bool:
        """Whether both logs hold the same bits at the same times."""
        return self.since is None and not self.only


def differences(one: Path, other: Path, *, ignore: tuple[str, ...] = CLOCKS) -> list[Difference]:
    """Return the difference of every signal of two logs but those in *ignore*, in the order of their names."""
    a, b = signals(one), signals(other)
    names = sorted((set(a) | set(b)) - set(ignore))
    return [_difference(name, a.get(name), b.get(name)) for name in names]


def _difference(name: str, one: Signal | None, other: Signal | None) -> Difference:
    if one is None or other is None:
        left = one or other
        assert left is not None
        return Difference(name, left.unit, float("nan"), float("nan"), None, "other" if one is None else "one")
    if one.values.shape[1] != other.values.shape[1]:
        return Difference(name, one.unit, float("nan"), float("nan"), None, "shape")
    both, mine, theirs = np.intersect1d(one.ns, other.ns, return_indices=True)
    if not len(both):
        return Difference(name, one.unit, float("nan"), float("nan"), None, "times")
    a, b = one.values[mine], other.values[theirs]
    off = np.any(a != b, axis=1) & ~np.all(np.isnan(a) & np.isnan(b), axis=1)
    first = float(both[np.argmax(off)]) * 1e-9 if np.any(off) else None
    gone = sorted(set(one.ns.tolist()) ^ set(other.ns.tolist()))
    if gone and (first is None or gone[0] * 1e-9 < first):
        first = gone[0] * 1e-9  # a step that only one of them has
    apart = np.abs(b - a)
    return Difference(name, one.unit, float(np.max(apart)), float(np.sqrt(np.mean(apart**2))), first)
