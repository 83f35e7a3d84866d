"""How two logs differ, signal by signal: the same bits, or how far apart and from when on."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from .read import Signal, others, signals

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


def differences(
    one: Path, other: Path, *, ignore: tuple[str, ...] = CLOCKS, unfinished: bool = False
) -> list[Difference]:
    """Return the difference of every signal of two logs but those in *ignore*, in the order of their names.

    A port that is not Float64 and no number either (a string) counts as well; its distance is not a number.
    *unfinished*: *one* breaks off, and what *other* has after its end is no difference.
    """
    a, b = signals(one), signals(other)
    names = sorted((set(a) | set(b)) - set(ignore))
    found = [_difference(name, a.get(name), b.get(name), unfinished) for name in names]
    told, again = others(one), others(other)
    for name in sorted((told.keys() | again.keys()) - set(names)):
        found.append(_words(name, told.get(name), again.get(name), unfinished))
    return found


def _unlike(port: str, unit: str, only: str) -> Difference:
    return Difference(port, unit, float("nan"), float("nan"), None, only)


def _difference(name: str, one: Signal | None, other: Signal | None, unfinished: bool) -> Difference:
    if one is None or other is None:
        left = one or other
        assert left is not None
        return _unlike(name, left.unit, "other" if one is None else "one")
    if one.values.shape[1] != other.values.shape[1]:
        return _unlike(name, one.unit, "shape")
    both, mine, theirs = np.intersect1d(one.ns, other.ns, return_indices=True)
    if not len(both):
        return _unlike(name, one.unit, "times")
    a, b = one.values[mine], other.values[theirs]
    off = np.any(_bits(a) != _bits(b), axis=1)
    first = _first(both[off], one.ns, other.ns, unfinished)
    apart = np.where(np.isnan(a) & np.isnan(b), 0.0, np.abs(b - a))
    return Difference(name, one.unit, float(np.max(apart)), float(np.sqrt(np.mean(apart**2))), first)


def _bits(values: np.ndarray) -> np.ndarray:
    """Return the bits of Float64 values as integers: -0.0 is not 0.0, and not a number is itself."""
    return np.ascontiguousarray(values, dtype=np.float64).view(np.int64)


def _first(off: np.ndarray, one: np.ndarray, other: np.ndarray, unfinished: bool) -> float | None:
    """Return the first time in s at which values are *off*, or which one of the logs lacks; None: nowhere."""
    theirs = other[other <= one[-1]] if unfinished else other
    times = np.concatenate([off, np.setxor1d(one, theirs)])
    return float(times.min()) * 1e-9 if len(times) else None


def _words(name: str, one: tuple[np.ndarray, list[Any]] | None, other: tuple[np.ndarray, list[Any]] | None,
           unfinished: bool) -> Difference:  # fmt: skip
    if one is None or other is None:
        return _unlike(name, "1", "other" if one is None else "one")
    there = dict(zip(other[0].tolist(), other[1], strict=True))
    off = [t for t, value in zip(one[0].tolist(), one[1], strict=True) if t in there and there[t] != value]
    first = _first(np.array(off, np.int64), one[0], other[0], unfinished)
    return Difference(name, "1", float("nan"), float("nan"), first)
