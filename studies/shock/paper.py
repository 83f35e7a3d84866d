"""The shock paper: frequencies (Table 1), harmonics of three pulses (Fig 3), load factors (4), responses (5)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from plants.chassis_modes import ModalData
from plants.pulses import Pulse
from plants.shock import GRAVITY, poles, pulse_response
from plants.shock_loads import load_factor
from studies.figures.sheet import LINES, Sheet, panels

from .cases import acceleration, times
from .modes import THESIS

PRINTED = np.array([3.82, 4.20, 8.67, 10.59, 10.94, 12.78, 15.13, 17.86, 22.31, 24.30])  # Hz, Table 1
DURATION, REPEATED, FIRST = 0.15, 1 / 3.98, 3.82  # s, s, Hz
PEAK, SHOWN = 1500.0, 0.6  # N; s of the responses
FACTORS = {"rectangular": 7.1, "half-sine": 6.3, "triangular": 5.2}  # printed, of the peak of the pulse


def table_1(data: ModalData) -> Sheet:
    """Return Table 1: printed frequencies, 2 pi times these, the thesis' and those of *data*."""
    figure, axes = panels("Frequencies of the shock paper, times 2 pi, and of the thesis (Table 1)")
    number = np.arange(1, 11)
    columns = {
        "mode": number, "paper [Hz]": PRINTED, "2 pi paper [Hz]": 2 * np.pi * PRINTED, "thesis [Hz]": THESIS,
        "fitted plate [Hz]": data.frequency[:10],
    }  # fmt: skip
    for (name, values), mark in zip(list(columns.items())[1:], ("o", "s", "x", "+"), strict=True):
        axes[0, 0].plot(number, values, mark, label=name)
    axes[0, 0].set(xlabel="mode", ylabel="frequency / Hz", yscale="log")
    axes[0, 0].legend(frameon=False, fontsize=8)
    return Sheet("Table 1", columns, figure, ("one of the two has Hz and rad/s mixed up; the text cannot say which",))


def amplitudes_figure() -> Sheet:
    """Return Fig 3: amplitudes of the harmonics of the three pulses, per peak."""
    number = np.arange(1, 11)
    figure, axes = panels("Amplitudes of the harmonics, 0.15 s every 0.251 s (paper, Fig 3)")
    columns = {"harmonic": number, "frequency [Hz]": number / REPEATED}
    for k, shape in enumerate(FACTORS):
        series = Pulse(shape, DURATION).series(REPEATED, 10 / REPEATED)
        columns[shape] = np.hypot(series.a, series.b)
        axes[0, 0].bar(number + 0.27 * (k - 1), columns[shape], width=0.27, color=LINES[k], label=shape)
    axes[0, 0].set(xlabel="harmonic", ylabel="amplitude / peak")
    axes[0, 0].legend(frameon=False)
    return Sheet("Harmonics", columns, figure)


def single_pulse_factor(shape: str) -> float:
    """Return the largest displacement of an undamped 3.82 Hz mode under one pulse, over the static one."""
    t = np.linspace(0, DURATION + 1 / FIRST, 20_001)
    _, wd = poles(np.array([FIRST]), 0.0)
    q = pulse_response(np.array([FIRST]), 0.0, Pulse(shape, DURATION), t).q
    return float(np.max(np.abs(q)) * wd[0] ** 2)


def factors_figure() -> Sheet:
    """Return Fig 4: the load factors of the first four harmonics on mode 1, and what one pulse does."""
    figure, axes = panels("Load factors on mode 1 (paper, Fig 4)")
    columns = {"harmonic": np.arange(1, 5)}
    for k, shape in enumerate(FACTORS):
        pulse = Pulse(shape, DURATION)
        columns[shape] = np.array([load_factor(pulse, REPEATED, FIRST, j) for j in range(1, 5)])
        axes[0, 0].bar(columns["harmonic"] + 0.27 * (k - 1), columns[shape], width=0.27, color=LINES[k], label=shape)
    axes[0, 0].set(xlabel="harmonic", ylabel="force / peak of the pulse")
    axes[0, 0].legend(frameon=False)
    notes = [
        f"{s}: {columns[s][0]:.2f}, printed {FACTORS[s]}, single pulse {single_pulse_factor(s):.2f}" for s in FACTORS
    ]
    resonance = "a resonance of mode 1 with the rate of repetition that was chosen, 3.98 beside 3.82 Hz"
    return Sheet("Load factors", columns, figure, (*notes, resonance))


def station_figure(data: ModalData) -> Sheet:
    """Return Fig 5: station 1 under the three pulses, with the modes as they are and 2 pi times as slow."""
    t = times()
    columns = {"time [s]": t}
    figure, axes = panels("Station 1 under pulses of 1500 N and 0.15 s (paper, Fig 5)", 2, 2, sharex=True)
    notes = []
    slow = replace(data, frequency=data.frequency / (2 * np.pi))
    for row, (name, modes) in zip(axes, {"thesis": data, "paper": slow}.items(), strict=True):
        found = {s: acceleration(modes, "single", DURATION, total=PEAK, shape=s, t=t)[:, 0] / GRAVITY for s in FACTORS}
        top = ", ".join(f"{s} {np.max(np.abs(a)):.2f}" for s, a in found.items())
        notes.append(f"peaks with the frequencies of the {name}, g: {top}")
        columns |= {f"{s}, frequencies of the {name} [g]": a for s, a in found.items()}
        for axis, pair in zip(row, (("rectangular", "triangular"), ("half-sine", "triangular")), strict=True):
            for shape, colour in zip(pair, LINES, strict=False):
                axis.plot(t[t <= SHOWN], found[shape][t <= SHOWN], color=colour, linewidth=0.7, label=shape)
            axis.legend(frameon=False, fontsize=8, title=f"{modes.frequency[0]:.3g} Hz and up", title_fontsize=8)
        row[0].set_ylabel("acceleration / g")
    for axis in axes[1]:
        axis.set_xlabel("time / s")
    alone = (
        "by modes of the platform alone, since the paper leaves wheels and links out; its finite elements are not given"
    )
    return Sheet("Three pulses", columns, figure, (*notes, alone))
