"""Time is a whole number of nanoseconds; floats are computed from it and never added up."""

from __future__ import annotations

from math import ceil

from .errors import ScenarioError

NS = 1_000_000_000  # ticks per second
NS_SLACK = 1e-3  # a float this fraction of a tick above a tick still means that tick


def ticks(seconds: float, what: str) -> int:
    """Return *seconds* in ns; raises ScenarioError naming *what* unless it is a positive whole number of them."""
    n = round(seconds * NS)
    if n <= 0 or abs(n - seconds * NS) > NS_SLACK:
        raise ScenarioError(f"{what} is {seconds!r} s, which is not a positive whole number of nanoseconds")
    return n


def seconds(ns: int) -> float:
    """Return the nearest float to *ns* nanoseconds, in seconds."""
    return ns / NS


def tick_at_or_after(time: float) -> int:
    """Return the first tick at or after *time* seconds: where everybody meets for an event located at *time*."""
    return ceil(time * NS - NS_SLACK)
