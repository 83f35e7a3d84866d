"""Random numbers that come again: in Python, in an FMU of any compiler, on any machine, after a rollback.

L'Ecuyer's combined generator (Communications of the ACM 31, 1988): two multiplicative congruential ones,

    s1' = 40014 s1 mod 2147483563,   s2' = 40692 s2 mod 2147483399,   u = ((s1' - s2') mod 2147483562) / 2147483563

with a common period of 2.3e18.  All products stay below 2^53, so that doubles hold them exactly and u is the same bits
everywhere; normal numbers differ where the log and cos of two machines do, in their last digit.  The period is cut into
streams 2^30 draws long: one for each element of a signal, 2^10 of them for each seed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca

MODULI, MULTIPLIERS = (2147483563, 2147483399), (40014, 40692)
STREAM = 30  # bits: draws in a stream
STREAMS = 10  # bits: streams of a seed
SEEDS = 20  # bits: seeds
_HALF = 2.0**16


@dataclass(frozen=True)
class Generator:
    """The two states of one generator per element of a signal, whole numbers; any shape."""

    s1: Any
    s2: Any

    def uniform(self) -> tuple[Any, Generator]:
        """Return numbers in (0, 1), and the generators one draw later."""
        pair = zip((self.s1, self.s2), MULTIPLIERS, MODULI, strict=True)
        s1, s2 = (ca.fmod(a * s, m) for s, a, m in pair)
        difference = s1 - s2
        z = ca.if_else(difference < 1, difference + (MODULI[0] - 1), difference)
        return z / MODULI[0], Generator(s1, s2)

    def normal(self) -> tuple[Any, Generator]:
        """Return numbers of mean 0 and standard deviation 1, at most 6.6 (Box and Muller), and the generators then."""
        radius, later = self.uniform()
        angle, last = later.uniform()
        return ca.sqrt(-2 * ca.log(radius)) * ca.cos(2 * ca.pi * angle), last


def seeded(seed: Any, shape: tuple[int, int]) -> Generator:
    """Return the generators of a signal of *shape* (rows, columns), each at the start of the stream of its own.

    *seed* is a whole number from 0 to 2^20 - 1.
    """
    states = []
    for a, m in zip(MULTIPLIERS, MODULI, strict=True):
        first: Any = 12345.0
        for bit in range(SEEDS):
            odd = ca.fmod(ca.floor(seed / 2**bit), 2) > 0
            first = ca.if_else(odd, _product(pow(a, 2 ** (STREAM + STREAMS + bit), m), first, m), first)
        rows, columns = shape
        streams = [[_product(pow(a, 2**STREAM * (i * columns + j), m), first, m) for j in range(columns)]
                   for i in range(rows)]  # fmt: skip
        states.append(ca.vertcat(*(ca.horzcat(*row) for row in streams)))
    return Generator(*states)


def _product(a: int, s: Any, m: int) -> Any:
    """Return a s mod m, exactly: in halves of 16 bits, so that nothing exceeds 2^53."""
    high = ca.floor(s / _HALF)
    return ca.fmod(ca.fmod(a * high, m) * _HALF + a * (s - high * _HALF), m)
