"""What chapters 7 and 8 and the shock paper show in their figures besides what the other claims are about."""

from __future__ import annotations

import numpy as np
from numpy.polynomial import legendre
from scipy.stats import spearmanr

from plants.chassis_modes import ModalData
from plants.pulses import Pulse
from plants.shock import peaks, pulse_response
from plants.shock_fourier import PERIOD, TOP, fourier_response
from studies.figures.claim import UNKNOWN, Claim, graded

from .cases import CORNERS, EDGES, FORCE, INNER, LONG, SHORT, acceleration, at
from .modes import THESIS
from .paper import DURATION, FACTORS, PRINTED, REPEATED

_FITTED = "a plate with nine boxes fitted to these frequencies: thickness, length and boxes are not given"
IN_THESIS = {1: 24.0, 2: 26.0, 3: 54.5, 5: 68.7, 6: 80.3, 7: 95.1, 9: 140.2}  # Hz by mode, as section 8.2 has them
# nodal lines across the length and across the width of the first nine modes, as section 8.2 describes them
_SHAPES = ((2, 0), (1, 1), (2, 1), (0, 2), (3, 0), (1, 2), (3, 1), (2, 2), (4, 0))


def series_samples_the_integral(data: ModalData) -> Claim:
    """7.4, Fig 7.3."""
    series = Pulse("rectangular", SHORT).series(PERIOD, 100.0)
    integral = 2 / PERIOD * np.abs(Pulse("rectangular", SHORT).transform(series.p))
    off = float(np.max(np.abs(np.hypot(series.a, series.b) - integral)) / integral.max())
    printed = np.abs(np.sin(series.p * SHORT) / series.p) * 2 / PERIOD
    ratio = float(np.max(np.abs(printed - integral)) / integral.max())
    return Claim(
        "7.4",
        "a series of period 3 s represents the spectrum of a single pulse reasonably",
        f"its amplitudes lie on the Fourier integral to {off:.0e}, as for every period",
        graded(off < 1e-6),
        {"off": off, "printed": ratio},
        f"|sin(wT)/w| of (7.17) is off by up to {100 * ratio:.0f} % of the largest: right is 2|sin(wT/2)|/w",
    )


def series_to_200_hz(data: ModalData) -> Claim:
    """7.5, 8.3: what the method of the thesis loses."""
    exact = acceleration(data)
    first, tenth = _off(exact, acceleration(data, method=fourier_response))
    t, pulse = np.linspace(0, 0.2, 20_001), Pulse("rectangular", SHORT)
    mode = (THESIS[:1], 5e-5, pulse, t)
    whole, mean, without = (
        float(np.max(np.abs(r.acceleration)))
        for r in (pulse_response(*mode), fourier_response(*mode), fourier_response(*mode, printed=True))
    )
    return Claim(
        "8.3",
        "harmonics up to 200 Hz of a series of period 3 s give the response to a rectangular pulse",
        f"rms off by {first:.0f} % at station 1 and {tenth:.0f} % at station 10; a mode at 24 Hz alone peaks at "
        f"{mean:.3f} of the force, exactly {whole:.3f}",
        graded(first < 5, abs(mean / whole - 1) < 0.05),
        {"station 1": first, "station 10": tenth, "mode": whole, "with mean": mean, "printed": without},
        f"{without:.3f} of the force: the mean of the pulse is missing in (7.20)",
    )


def _off(exact: np.ndarray, other: np.ndarray) -> tuple[float, float]:
    """Return the rms error in % at stations 1 and 10."""
    off = 100 * np.sqrt(np.mean((other - exact) ** 2, axis=0) / np.mean(exact**2, axis=0))
    return float(off[0]), float(off[9])


def frequencies(data: ModalData) -> Claim:
    """8.2, Fig 8.2."""
    off = data.frequency[:9] / THESIS[:9] - 1
    return Claim(
        "8.2",
        "25 bending modes from 24 to 430 Hz: 24, 26, 54.5, 68.7, 80.3, 95.1, 140.2 Hz",
        f"{', '.join(f'{f:.1f}' for f in data.frequency[:9])} Hz: {100 * np.sqrt(np.mean(off**2)):.1f} % rms off the "
        f"first nine; mode {len(data.frequency)} at {data.frequency[-1]:.0f} Hz",
        UNKNOWN,
        {"rms": float(np.sqrt(np.mean(off**2))), "last": float(data.frequency[-1])},
        assumption=_FITTED,
    )


def nodal_lines(data: ModalData, modes: int = len(_SHAPES)) -> list[tuple[int, int]]:
    """Return the dominant numbers of nodal lines across length and width of the first modes, from the 20 stations."""
    x, y = np.linspace(1, -1, 5), np.linspace(1, -1, 4)
    along, across = legendre.legvander(x, 4), legendre.legvander(y, 3)
    basis = np.einsum("im,jn->ijmn", along, across).reshape(20, 20)
    share = np.linalg.solve(basis, data.station_shape[:, :modes])
    found = np.argmax(np.abs(share), axis=0)
    return [(int(k) // 4, int(k) % 4) for k in found]


def shapes_in_order(data: ModalData) -> Claim:
    """8.2, Figs 8.3 to 8.5."""
    found = nodal_lines(data)
    same = sum(a == b for a, b in zip(found, _SHAPES, strict=True))
    words = ", ".join(f"({m}, {n})" for m, n in found)
    return Claim(
        "8.2",
        "the order of the shapes: bending along, twist, ... the ninth a third-order bending along",
        f"{same} of {len(_SHAPES)} are those described; nodal lines across length and width: {words}",
        graded(same == len(_SHAPES), same > 5),
        {"same": same},
        assumption=_FITTED,
    )


def signs_at_the_corners(data: ModalData) -> Claim:
    """8.2: which modes add up at a corner."""
    return Claim(
        "8.2",
        "at the front left corner all modes but 8, 10 and 12 are in phase, so that they add up",
        "the sign of a shape is arbitrary; under a force at this corner each mode moves it by phi^2, all the same way",
        UNKNOWN,
    )


def amplitudes_diminish(data: ModalData) -> Claim:
    """8.3, Figs 8.7 and 8.8."""
    falls = {}
    for duration in (SHORT, LONG):
        series = Pulse("rectangular", duration).series(PERIOD, TOP)
        size = np.hypot(series.a, series.b)
        lobe = round(PERIOD / duration)  # harmonics from one zero to the next
        tops = [float(size[k : k + lobe].max()) for k in range(0, len(size) - lobe, lobe)]
        falls[f"{duration:g} s"] = float(bool(np.all(np.diff(tops) < 0) and np.any(np.diff(size) > 0)))
    return Claim(
        "8.3",
        "the amplitudes diminish as the frequency grows, though not monotonously",
        "as 2|sin(wT/2)|/w: the largest of each lobe falls, as 1/w; the accelerations it causes in the modes do not: "
        "a mode answers a jump with the same amplitude at every frequency",
        graded(all(falls.values())),
        falls,
    )


def same_trend_for_the_longer_pulse(data: ModalData) -> Claim:
    """8.4, Fig 8.10."""
    found = {d: peaks(acceleration(data, "single", d)) for d in (SHORT, LONG)}
    means = {d: [float(at(p, group).mean()) for group in (CORNERS, EDGES, INNER)] for d, p in found.items()}
    return Claim(
        "8.4",
        "the distribution over the platform is the same for the pulse of 0.08 s",
        "; ".join(f"{d:g} s: corners {c:.1f}, edges {e:.1f}, inside {i:.1f} g" for d, (c, e, i) in means.items()),
        graded(all(c > e > i for c, e, i in means.values())),
        {f"{d:g} s": c / i for d, (c, _, i) in means.items()},
    )


def diagonal_is_like_single(data: ModalData) -> Claim:
    """8.5, Fig 8.12."""
    single = peaks(acceleration(data))
    wheel, even = peaks(acceleration(data, "diagonal")), peaks(acceleration(data, "diagonal", total=FORCE))
    rank = float(spearmanr(single, wheel).statistic)
    higher = [int(np.sum(single > p)) for p in (wheel, even)]
    return Claim(
        "8.5",
        "diagonal excitation responds like that of a single wheel, which gives the higher response",
        f"the stations rank alike (Spearman {rank:.2f}); a single wheel gives the higher peak at {higher[0]} of 20 "
        f"stations with 1000 N per wheel, at {higher[1]} with 1000 N in all",
        graded(rank > 0.7 and higher[0] == len(single), rank > 0.7),
        {"rank": rank, "higher per wheel": higher[0], "higher in all": higher[1]},
        assumption="the diagonal wheel reacts as strongly (Delta omega = 0, symmetric platform)",
    )


def paper_frequencies(data: ModalData) -> Claim:
    """Shock paper, Table 1."""
    ratio = np.array([f / PRINTED[mode - 1] for mode, f in IN_THESIS.items()])
    rounded = ratio[list(IN_THESIS).index(2)]
    sharp = np.delete(ratio, list(IN_THESIS).index(2))
    return Claim(
        "shock paper",
        "ten frequencies from 3.82 to 24.30 Hz",
        f"those of the thesis over these are {sharp.min():.3f} to {sharp.max():.3f}, 2 pi within what the digits say ("
        f"and 26 Hz, of two digits, {rounded:.2f}): one of the two takes rad/s for Hz",
        UNKNOWN,
        {"least": float(sharp.min()), "most": float(sharp.max())},
        assumption="frequencies 4, 8 and 10 are not in the thesis and are taken from here times 2 pi",
    )


def amplitudes_by_shape(data: ModalData) -> Claim:
    """Shock paper, Fig 3."""
    found = {}
    for shape in FACTORS:
        series = Pulse(shape, DURATION).series(REPEATED, 1.5 / REPEATED)
        found[shape] = float(np.hypot(series.a, series.b)[0])
    rectangular, sine, triangle = found.values()
    return Claim(
        "shock paper",
        "the rectangular pulse has the largest first harmonic, then the half-sine, then the triangle",
        ", ".join(f"{s} {c:.4f}" for s, c in found.items()) + " of the peak",
        graded(rectangular > sine > triangle),
        found,
        assumption="repeated at 3.98 Hz, the fundamental frequency that is printed: every 0.251 s",
    )
