"""Claims about the method (thesis 7.4, 7.5) and those of the shock paper."""

from __future__ import annotations

import numpy as np

from plants.chassis_modes import ModalData
from plants.pulses import Pulse
from plants.shock import peaks
from plants.shock_fourier import PERIOD
from plants.shock_loads import load_factor
from studies.figures.claim import Claim, graded

from .cases import acceleration, platform
from .paper import DURATION, FACTORS, FIRST, PEAK, REPEATED, single_pulse_factor
from .responses import CUT_OFFS, cutoff_peaks


def few_modes_suffice(data: ModalData) -> Claim:
    """7.4: a few frequencies and shapes are enough."""
    many = data if len(data.frequency) >= CUT_OFFS[-1] else platform(CUT_OFFS[-1])
    jump, smooth = (cutoff_peaks(many, shape)[:, 0] for shape in ("rectangular", "versed-sine"))
    by_modes = ", ".join(f"{n}: {p:.3g}" for n, p in zip(CUT_OFFS, jump, strict=True))
    return Claim(
        "7.4",
        "a few modes give a reasonably accurate response",
        f"peaks at station 1 under a rectangular pulse, g by modes: {by_modes}: no limit; under a versed sine "
        f"{smooth[0]:.2f} to {smooth[-1]:.2f} g",
        graded(bool(jump[-1] < 1.1 * jump[2]), bool(smooth[-1] < 1.1 * smooth[0])),
        {f"{n} modes": float(p) for n, p in zip(CUT_OFFS, jump, strict=True)},
    )


def transient_dies_out(data: ModalData) -> Claim:
    """7.5: why a period of 3 s will do."""
    constant = float(1 / (data.damping[0] * 2 * np.pi * data.frequency[0]))
    left = float(np.exp(-PERIOD / constant))
    return Claim(
        "7.5",
        "with a period of 3 s the transient has died out before the next pulse",
        f"after 3 s mode 1 keeps {100 * left:.1f} % of its amplitude (time constant {constant:.0f} s); harmless, since "
        f"the response starts from rest and is used within one period",
        graded(left < 0.05),
        {"left": left},
    )


def load_factors(data: ModalData) -> Claim:
    """Shock paper, Fig 4."""
    found = {s: load_factor(Pulse(s, DURATION), REPEATED, FIRST) for s in FACTORS}
    once = [single_pulse_factor(s) for s in FACTORS]
    return Claim(
        "shock paper",
        "dynamic loads of 7.1, 6.3 and 5.2 times the peak: rectangular, half-sine, triangular",
        f"{' / '.join(f'{v:.2f}' for v in found.values())}, a resonance with the chosen rate of repetition; one pulse "
        f"gives {' / '.join(f'{v:.2f}' for v in once)}",
        graded(all(round(found[s], 1) == FACTORS[s] for s in FACTORS)),
        found,
    )


def rectangular_is_worst(data: ModalData) -> Claim:
    """Shock paper, Fig 5: accelerations at station 1."""
    found = {s: float(peaks(acceleration(data, "single", DURATION, total=PEAK, shape=s))[0]) for s in FACTORS}
    rectangular, sine, triangle = found.values()
    return Claim(
        "shock paper",
        "the rectangular pulse accelerates most, then the half-sine, then the triangle",
        ", ".join(f"{s} {v:.2f} g" for s, v in found.items()),
        graded(rectangular > sine > triangle, rectangular > max(sine, triangle)),
        found,
    )
