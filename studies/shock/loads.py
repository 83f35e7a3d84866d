"""The shock loads in time and frequency (thesis Figs 7.3, 8.6, 8.7, 8.8)."""

from __future__ import annotations

from math import pi

import numpy as np

from plants.pulses import SHAPES, Pulse
from plants.shock_fourier import PERIOD, TOP
from studies.figures.sheet import LINES, Sheet, panels

from .cases import LONG, SHORT


def pulses_figure() -> Sheet:
    """Return Fig 8.6 for all four shapes: unit pulses of 0.05 and 0.08 s."""
    t = np.linspace(-0.01, 0.1, 1101)
    figure, axes = panels("Unit pulses (Fig 8.6: the rectangular ones)", 1, 2, sharey=True)
    columns = {"time [s]": t}
    for axis, duration in zip(axes.flat, (SHORT, LONG), strict=True):
        for shape, colour in zip(SHAPES, LINES, strict=False):
            columns[f"{shape} {duration:g} s"] = Pulse(shape, duration).force(t)
            axis.plot(t, columns[f"{shape} {duration:g} s"], color=colour, label=shape)
        axis.set(title=f"{duration:g} s", xlabel="time / s")
    axes[0, 0].set_ylabel("force / peak")
    axes[0, 0].legend(frameon=False, fontsize=8)
    return Sheet("Shock pulses", columns, figure)


def integral_figure() -> Sheet:
    """Return Fig 7.3: the amplitudes of the series of a rectangular pulse of period 3 s beside its Fourier integral."""
    pulse = Pulse("rectangular", SHORT)
    series = pulse.series(PERIOD, 100.0)
    frequency = series.p / (2 * pi)
    bars, curve = np.hypot(series.a, series.b), 2 / PERIOD * np.abs(pulse.transform(series.p))
    figure, axes = panels("Series of period 3 s (bars) and Fourier integral (curve) of a 0.05 s pulse (Fig 7.3)")
    axes[0, 0].bar(frequency, bars, width=0.25, color=LINES[0])
    axes[0, 0].plot(frequency, curve, color=LINES[1], linewidth=1)
    axes[0, 0].set(xlabel="frequency / Hz", ylabel="amplitude / peak of the pulse")
    columns = {"frequency [Hz]": frequency, "series": bars, "2/period |F|": curve}
    note = "a series samples the integral exactly, whatever the period: what it loses lies above its last harmonic"
    return Sheet("Series and integral", columns, figure, (note,))


def coefficients_figure() -> Sheet:
    """Return Figs 8.7 and 8.8: the coefficients of both rectangular pulses up to 200 Hz."""
    figure, axes = panels("Fourier coefficients of rectangular pulses, period 3 s (Figs 8.7, 8.8)", 2, 1, sharex=True)
    columns: dict[str, np.ndarray] = {}
    for duration, colour in ((SHORT, LINES[0]), (LONG, LINES[1])):
        series = Pulse("rectangular", duration).series(PERIOD, TOP)
        columns["frequency [rad/s]"] = series.p
        for axis, name, values in zip(axes.flat, ("sine", "cosine"), (series.b, series.a), strict=True):
            columns[f"{name} {duration:g} s"] = values
            axis.plot(series.p, values, color=colour, linewidth=0.8, label=f"{duration:g} s")
            axis.set_ylabel(f"{name} / peak of the pulse")
    axes[0, 0].legend(frameon=False)
    axes[1, 0].set_xlabel("frequency / (rad/s)")
    means = " and ".join(f"{Pulse('rectangular', d).series(PERIOD, TOP).mean:.4f}" for d in (SHORT, LONG))
    return Sheet("Fourier coefficients", columns, figure, (f"the means, {means}, are missing in 7.20 and 8.1",))
