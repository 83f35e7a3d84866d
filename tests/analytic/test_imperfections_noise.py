"""The noise generator against exact integer arithmetic and published constants, and its numbers against normal ones."""

import casadi as ca
import numpy as np
import pytest
from scipy import stats

from controllers.noise import Generator, seeded
from controllers.sensor import Sensor

N = 100_000
MODULI = (2147483563, 2147483399)
# 40014^(2^w) and 40692^(2^w): L'Ecuyer and Cote, ACM TOMS 17 (1991), also in RANLIB, for w = 30 (a block) and 50.
BLOCK, LONG = (1033780774, 1494757890), (2082007225, 784306273)
RARE = 5.0  # standard deviations: a good generator is beyond them once in 1.7e6 tries


def start(seed: int, columns: int) -> np.ndarray:
    """Return s1 and s2 of a row of generators, (2, columns)."""
    symbol = ca.SX.sym("seed")
    found = seeded(symbol, (1, columns))
    return np.array(ca.Function("start", [symbol], [ca.vertcat(found.s1, found.s2)])(seed))


def draws(seed: int, columns: int, n: int = N) -> np.ndarray:
    """Return *n* normal numbers of each of a row of generators, (n, columns)."""
    s = ca.SX.sym("s", 2, columns)
    normal, later = Generator(s[0, :], s[1, :]).normal()
    step = ca.Function("step", [s], [ca.vertcat(later.s1, later.s2), normal])
    return np.array(step.mapaccum(n)(start(seed, columns))[1]).reshape(n, columns)


@pytest.fixture(scope="module")
def signals() -> np.ndarray:
    """Eight streams: four elements for each of two neighbouring seeds."""
    return np.hstack([draws(0, 4), draws(1, 4)])


def test_the_states_are_those_of_exact_integer_arithmetic() -> None:
    s1, s2 = (int(v) for v in start(77, 1).ravel())
    symbol = ca.SX.sym("s", 2)
    uniform, later = Generator(symbol[0], symbol[1]).uniform()
    step = ca.Function("step", [symbol], [ca.vertcat(later.s1, later.s2, uniform)])
    doubles = np.array([s1, s2], float)
    for _ in range(2000):
        s1, s2 = 40014 * s1 % MODULI[0], 40692 * s2 % MODULI[1]
        *doubles, uniform = np.array(step(doubles)).ravel()
        z = s1 - s2 if s1 - s2 >= 1 else s1 - s2 + MODULI[0] - 1
        assert (int(doubles[0]), int(doubles[1]), uniform) == (s1, s2, z / MODULI[0])


def test_streams_begin_where_the_published_jumps_lead() -> None:
    first = start(0, 3).astype(object)
    for row, (block, m) in enumerate(zip(BLOCK, MODULI, strict=True)):
        assert [int(v) for v in first[row]] == [12345 * pow(block, k, m) % m for k in range(3)]
    far = start(2**10, 1)  # seeds are 2^40 apart
    assert [int(v) for v in far.ravel()] == [12345 * a % m for a, m in zip(LONG, MODULI, strict=True)]


def test_the_last_seed_is_exact_too() -> None:
    for found, a, m in zip(start(2**20 - 1, 1).ravel(), (40014, 40692), MODULI, strict=True):
        assert int(found) == 12345 * pow(a, 2**40 * (2**20 - 1), m) % m


def test_a_sensor_adds_these_numbers() -> None:
    instance = Sensor(shape=[3], noise=2.0, seed=1).instance()
    instance.enter_initialization()
    instance.exit_initialization()
    instance.u[:] = 10.0
    instance.push()
    for k, row in enumerate(draws(1, 3, 5)):
        instance.step(k * 1_000_000, (k + 1) * 1_000_000)
        instance.pull()
        np.testing.assert_array_equal(instance.y, 10.0 + 2.0 * row)


def test_mean_and_standard_deviation(signals: np.ndarray) -> None:
    """Of N independent normal numbers they have the standard deviations 1/sqrt(N) and 1/sqrt(2 N)."""
    assert np.max(np.abs(signals.mean(axis=0))) < RARE / np.sqrt(N)
    assert np.max(np.abs(signals.std(axis=0) - 1)) < RARE / np.sqrt(2 * N)


def test_the_distribution_is_normal(signals: np.ndarray) -> None:
    for column in signals.T:  # a p-value below 1e-5 is as rare as that
        assert stats.kstest(column, "norm").pvalue > 1e-5
        # ... also in the tails, which Kolmogorov and Smirnov hardly see: beyond 3 there are 2.7e-3, beyond 4 6.3e-5
        for edge in (3.0, 4.0):
            p = 2 * stats.norm.sf(edge)
            assert abs(np.sum(np.abs(column) > edge) - N * p) < RARE * np.sqrt(N * p)


def test_samples_elements_and_seeds_are_independent(signals: np.ndarray) -> None:
    """Every correlation of two streams, and of one with itself later, has the standard deviation 1/sqrt(N)."""
    spectra = np.fft.rfft(signals, 2 * N, axis=0)
    for i in range(8):
        for j in range(i, 8):
            correlation = np.fft.irfft(spectra[:, i].conj() * spectra[:, j])[:200] / N
            if i == j:
                assert correlation[0] == pytest.approx(1, abs=RARE * np.sqrt(2 / N))
                correlation = correlation[1:]
            assert np.max(np.abs(correlation)) < RARE / np.sqrt(N)


def test_magnitudes_are_independent_too(signals: np.ndarray) -> None:
    """What linear correlation misses: the squares of neighbours, of variance 2, correlate like 1/sqrt(N)."""
    squares = (signals**2 - 1) / np.sqrt(2)
    pairs = [(squares[:-1, i], squares[1:, i]) for i in range(8)] + [(squares[:, 0], squares[:, i]) for i in (1, 4, 7)]
    for a, b in pairs:
        assert abs(np.mean(a * b)) < RARE / np.sqrt(N)
