"""Accelerations at the stations: maps, durations, methods, number of modes, spectra (thesis Figs 8.9 to 8.14)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from plants.chassis_modes import ModalData
from plants.shock import GRAVITY, peaks, pulse_response
from plants.shock_fourier import fourier_response
from studies.figures.sheet import LINES, Sheet, panels

from .cases import LONG, RATE, SHORT, STATIONS, acceleration, platform, times
from .spectra import FREQUENCIES, Q, response_spectrum

CUT_OFFS = (5, 10, 25, 50, 100, 200)
SHOWN = 0.3  # s of the maps
DIVERGING = (
    "peaks hold for this number of modes, this sampling and this window only: see the cut-off",
    "the mesh changes them too: with 8-node bricks station 1 has 23.0 g under one wheel, 27.4 g under diagonal ones, "
    "26.9 g under all, and diagonal ones are worse than all at 6 stations with 1000 N each; no verdict depends on it",
)


def map_figure(data: ModalData, cases: Sequence[str], duration: float) -> Sheet:
    """Return the accelerations at all 20 stations under one or two *cases*, laid out like the platform."""
    t = times()
    figure, axes = panels(
        f"Acceleration / g, {' (red: '.join(cases)}{')' * (len(cases) - 1)}, {duration:g} s, front on top",
        5, 4, figsize=(12, 9), sharex=True, sharey=True,
    )  # fmt: skip
    columns = {"time [s]": t}
    for k, case in enumerate(cases):
        a = acceleration(data, case, duration, t=t) / GRAVITY
        for station, axis in zip(STATIONS, axes.flat, strict=True):
            columns[f"{case}, station {station} [g]"] = a[:, station - 1]
            shown = t <= SHOWN
            axis.plot(t[shown], a[shown, station - 1], color=LINES[k], linewidth=0.5)
            axis.set_title(f"{station}: {np.max(np.abs(a[:, station - 1])):.1f} g", fontsize=8, loc="left")
    figure.supxlabel("time / s", fontsize=9)
    figure.supylabel("acceleration / g", fontsize=9)
    return Sheet("Map of accelerations", columns, figure, DIVERGING)


def durations_figure(data: ModalData) -> Sheet:
    """Return Fig 8.11: station 1 under pulses of 0.05 and 0.08 s."""
    t = times()
    figure, axes = panels("Station 1, single wheel, 0.05 and 0.08 s (Fig 8.11)")
    columns, notes = {"time [s]": t}, []
    for duration, colour in ((SHORT, LINES[0]), (LONG, LINES[1])):
        a = acceleration(data, "single", duration, t=t)[:, 0] / GRAVITY
        columns[f"{duration:g} s [g]"] = a
        axes[0, 0].plot(t[t <= SHOWN], a[t <= SHOWN], color=colour, linewidth=0.7, label=f"{duration:g} s")
        after = np.sqrt(np.mean(a[t > duration] ** 2))
        notes.append(f"{duration:g} s: peak {np.max(np.abs(a)):.1f} g, rms after the pulse {after:.2f} g")
    axes[0, 0].set(xlabel="time / s", ylabel="acceleration / g")
    axes[0, 0].legend(frameon=False)
    return Sheet("Two durations", columns, figure, (*notes, *DIVERGING))


def methods_figure(data: ModalData) -> Sheet:
    """Return the exact response and the thesis' series, corrected and as printed, at station 1."""
    t = times()
    methods = {
        "exact": pulse_response,
        "series to 200 Hz": fourier_response,
        "series as printed": lambda *given: fourier_response(*given, printed=True),
        "series to 2000 Hz": lambda *given: fourier_response(*given, top=2000.0),
    }
    figure, axes = panels("Station 1, single wheel, 0.05 s: exact and by Fourier series", 2, 1, sharex=True)
    columns, notes, shown = {"time [s]": t}, [], t <= 0.1
    exact = acceleration(data, t=t)
    for (name, method), colour in zip(methods.items(), LINES, strict=False):
        a = acceleration(data, t=t, method=method)
        columns[f"{name} [g]"] = a[:, 0] / GRAVITY
        axes[0, 0].plot(t[shown], a[shown, 0] / GRAVITY, color=colour, linewidth=0.8, label=name)
        axes[1, 0].plot(t[shown], (a - exact)[shown, 0] / GRAVITY, color=colour, linewidth=0.8)
        off = np.sqrt(np.mean((a - exact) ** 2, axis=0) / np.mean(exact**2, axis=0))
        notes.append(
            f"{name}: peak {peaks(a)[0]:.1f} g, rms off by {100 * off[0]:.3g} %, {100 * off[9]:.3g} % at station 10"
        )
    axes[0, 0].set_ylabel("acceleration / g")
    axes[1, 0].set(xlabel="time / s", ylabel="off the exact one / g")
    axes[0, 0].legend(frameon=False, fontsize=8)
    return Sheet("Methods", columns, figure, tuple(notes))


def cutoff_peaks(data: ModalData, shape: str = "rectangular", duration: float = SHORT) -> np.ndarray:
    """Return peaks (cut-offs, stations) in g, single wheel, with the first 5, 10, ... 200 modes of *data*."""
    kept = [n for n in CUT_OFFS if n <= len(data.frequency)]
    return np.array([peaks(acceleration(data.first(n), "single", duration, shape=shape)) for n in kept])


def cutoff_figure(data: ModalData) -> Sheet:
    """Return peaks over the number of modes, rectangular and versed-sine: the first do not converge, the second do."""
    many = data if len(data.frequency) >= CUT_OFFS[-1] else platform(CUT_OFFS[-1])
    figure, axes = panels("Peaks over the number of modes, single wheel, 0.05 s", 1, 2, sharex=True)
    columns = {"modes": np.array(CUT_OFFS), "highest [Hz]": many.frequency[np.array(CUT_OFFS) - 1]}
    for axis, shape in zip(axes.flat, ("rectangular", "versed-sine"), strict=True):
        found = cutoff_peaks(many, shape)
        for station, colour in zip((1, 4, 10), LINES, strict=False):
            columns[f"{shape}, station {station} [g]"] = found[:, station - 1]
            axis.loglog(CUT_OFFS, found[:, station - 1], "o-", color=colour, label=f"station {station}")
        axis.set(title=shape, xlabel="modes", ylabel="peak / g")
    axes[0, 0].legend(frameon=False)
    note = "a force that jumps leaves every mode an amplitude 2|sin(pi f T)| that does not fall with its frequency"
    return Sheet("Modal cut-off", columns, figure, (note,))


def spectra_figure(data: ModalData) -> Sheet:
    """Return shock response spectra at the corners, an edge and the middle, single wheel, 0.05 s."""
    found = response_spectrum(acceleration(data), RATE)
    figure, axes = panels(f"Shock response spectra, single wheel, 0.05 s, Q = {Q:g}")
    columns = {"frequency [Hz]": FREQUENCIES}
    for station in STATIONS:
        columns[f"station {station} [g]"] = found[:, station - 1]
    for shown, colour in zip((1, 4, 20, 9, 10), LINES, strict=False):
        axes[0, 0].loglog(FREQUENCIES, found[:, shown - 1], color=colour, label=f"station {shown}")
    axes[0, 0].set(xlabel="natural frequency of what is mounted / Hz", ylabel="its peak acceleration / g")
    axes[0, 0].legend(frameon=False, fontsize=8)
    return Sheet("Shock response spectra", columns, figure, ("elastic motion only, without the rigid body's",))
