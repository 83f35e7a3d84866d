"""In which order components step so that the fewest connections are a step old."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .system import System

EXACT = 12  # components; with more the order is a good one, not always the best


def computed_order(system: System) -> tuple[str, ...]:
    """Return the order with the fewest connections whose source steps after their target.

    Among equally good orders it is the one nearest to the system's own, component by component from the last.  Beyond
    12 components each takes the best place among those before it, in the system's order.
    """
    names = system.names
    at = {name: i for i, name in enumerate(names)}
    weights: dict[tuple[int, int], int] = {}
    for c in system.connections:
        edge = at[c.source.component], at[c.target.component]
        if edge[0] != edge[1]:
            weights[edge] = weights.get(edge, 0) + 1
    find = _best if len(names) <= EXACT else _good
    return tuple(names[i] for i in find(len(names), tuple(weights.items())))


@lru_cache(maxsize=64)
def _best(n: int, edges: tuple[tuple[tuple[int, int], int], ...]) -> tuple[int, ...]:
    """Return the best order by dynamic programming over the sets of those who have stepped."""
    weights = dict(edges)
    cost, last = {0: 0}, {0: -1}
    for done in range(1, 1 << n):
        members = [i for i in range(n) if done >> i & 1]
        choices = [(cost[done ^ 1 << i] + sum(weights.get((i, j), 0) for j in members if j != i), -i) for i in members]
        least, i = min(choices)
        cost[done], last[done] = least, -i
    order, done = [], (1 << n) - 1
    while done:
        order.append(last[done])
        done ^= 1 << last[done]
    return tuple(reversed(order))


@lru_cache(maxsize=64)
def _good(n: int, edges: tuple[tuple[tuple[int, int], int], ...]) -> tuple[int, ...]:
    """Return an order by insertion: one after the other where it adds the fewest delayed connections."""
    weights = dict(edges)
    order: list[int] = []
    for i in range(n):
        costs = [
            sum(weights.get((i, j), 0) for j in order[:k]) + sum(weights.get((j, i), 0) for j in order[k:])
            for k in range(len(order) + 1)
        ]
        order.insert(max(k for k, c in enumerate(costs) if c == min(costs)), i)
    return tuple(order)
