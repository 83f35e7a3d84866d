"""Claims that a co-simulated collision decides (thesis 8.4 to 8.7, 9.1)."""

from __future__ import annotations

import numpy as np

from plants.shock_loads import TABLE_8_1, rigid_reaction, still_reaction
from plants.tables import robot
from studies.figures.claim import Claim, graded

from .cases import CORNERS, EDGES, INNER, at
from .collision import ONE, ONE_HARD, TWO, TWO_HARD, Impact, collide, row

_FIRST = 0.05  # s, of the first contact: a pulse of the thesis


def impulses(impact: Impact, until: float = _FIRST) -> np.ndarray:
    """Return the impulses (4,) in N.s of the wheels above their static forces, from the start to *until* s."""
    within = impact.time <= until
    return np.asarray(np.trapezoid((impact.force - impact.force[0])[within], impact.time[within], axis=0))


def reaction_of_the_diagonal() -> Claim:
    """8.5: who answers a single struck wheel."""
    found = {v: impulses(collide(v)) / impulses(collide(v))[0] for v in (ONE, ONE_HARD)}
    alone = all(shares[3] > 0 and max(shares[1], shares[2]) < 0 for shares in found.values())
    ratio = still_reaction("diagonal", TABLE_8_1)
    close = all(abs(shares[3] - ratio) < 0.2 for shares in found.values())
    words = [f"{v} fr {s[1]:.2f}, rl {s[2]:.2f}, rr {s[3]:.2f}" for v, s in found.items()]
    return Claim(
        "8.5",
        f"a wheel that hits an obstacle makes the diagonally opposite one react, {ratio:.2f} times as strongly (8.5)",
        f"only that one is pressed down, by less; impulses of 50 ms over that of the struck wheel: {'; '.join(words)}",
        graded(alone and close, alone),
        {v: float(shares[3]) for v, shares in found.items()},
    )


def reaction_of_the_rear() -> Claim:
    """8.6: what the rear wheels do when both front ones are struck."""
    found = {v: float(impulses(collide(v))[2] / impulses(collide(v))[0]) for v in (TWO, TWO_HARD)}
    bot, ratio = robot("thesis_8_1"), still_reaction("four", TABLE_8_1)
    rigid = rigid_reaction("four", TABLE_8_1, bot.m, bot.I_x, bot.I_y)
    words = ", ".join(f"{v} {share:.2f}" for v, share in found.items())
    return Claim(
        "8.6",
        f"both front wheels on an obstacle make the rear ones react, {ratio:.2f} times as strongly (8.11)",
        f"impulse of a rear wheel over that of a front one in 50 ms: {words}; {rigid:.2f} if they were rigid",
        graded(all(abs(share - ratio) < 0.2 for share in found.values()), all(share > 0.1 for share in found.values())),
        {**found, "rigid": rigid},
    )


def faced() -> Claim:
    """8.7, 9.1: the advice to hit an obstacle with both wheels."""
    more = {one: int(np.sum(row(two).peak > row(one).peak)) for one, two in ((ONE, TWO), (ONE_HARD, TWO_HARD))}
    return Claim(
        "8.7",
        "steer for a full frontal collision: both wheels at once respond less than one alone",
        f"at the same speed both wheels give the larger peak at {more[ONE]} of 20 stations on soft damped wheels and "
        f"at {more[ONE_HARD]} on hard ones: twice the force comes in",
        graded(all(n == 0 for n in more.values()), any(n < 10 for n in more.values())),
        {k: float(v) for k, v in more.items()},
    )


def zones() -> Claim:
    """8.4, 9.1: where risk is high."""
    found = {v: row(v).peak for v in (ONE, TWO, ONE_HARD, TWO_HARD)}
    strict = [at(p, CORNERS).min() > at(p, EDGES).max() > at(p, INNER).max() for p in found.values()]
    means = [at(p, CORNERS).mean() > at(p, EDGES).mean() > at(p, INNER).mean() for p in found.values()]
    words = "; ".join(
        f"{v} {at(p, CORNERS).mean():.0f}, {at(p, EDGES).mean():.0f}, {at(p, INNER).mean():.0f} g"
        for v, p in found.items()
    )
    return Claim(
        "9.1",
        "corners and edges of the platform are the zones of high risk",
        f"means of corners, edges, inside: {words}; every corner above every edge in {sum(strict)} of {len(strict)}",
        graded(all(means)),
        {v: float(at(p, CORNERS).mean() / at(p, INNER).mean()) for v, p in found.items()},
    )


def soft_wheels() -> Claim:
    """8.4, 9.1: softer wheels shake the platform less."""
    pairs = ((ONE, ONE_HARD), (TWO, TWO_HARD))
    ratio = {soft: float(np.max(row(hard).peak) / np.max(row(soft).peak)) for soft, hard in pairs}
    return Claim(
        "9.1",
        "soft wheels give a milder response than rigid ones",
        f"wheels 28 times as stiff, undamped: the worst peak is {ratio[ONE]:.1f} times as high with one wheel, "
        f"{ratio[TWO]:.1f} times with both",
        graded(min(ratio.values()) > 1),
        ratio,
    )
