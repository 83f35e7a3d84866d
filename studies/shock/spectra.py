"""Shock response spectra: the peak acceleration of a small oscillator mounted at a station, over its frequency.

Unlike the peak of the station itself this settles as more modes are kept: what is mounted filters the high ones out.
"""

from __future__ import annotations

import numpy as np

from plants.shock import GRAVITY

FREQUENCIES = np.geomspace(5.0, 500.0, 61)  # Hz
Q = 10.0  # amplification 1/(2 zeta) of what is mounted, usual for equipment


def response_spectrum(acceleration: np.ndarray, rate: float, frequencies: np.ndarray = FREQUENCIES) -> np.ndarray:
    """Return peaks (frequencies, stations) in g of oscillators on accelerations (n, stations) in m/s2 at *rate* Hz."""
    from pyyeti import srs  # takes a second to import

    found = srs.srs(acceleration, rate, frequencies, Q, ic="zero", stype="absacce", parallel="no")
    return np.asarray(found) / GRAVITY
