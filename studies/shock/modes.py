"""Natural frequencies and shapes of the chassis (thesis Figs 8.2 to 8.5)."""

from __future__ import annotations

import numpy as np

from plants.chassis_modes import ModalData
from studies.figures.sheet import LINES, Sheet, panels

from .cases import STATIONS

# Hz: printed in section 8.2, and 2 pi times Table 1 of the shock paper where the thesis leaves them out (4, 8, 10)
THESIS = np.array([24.0, 26.39, 54.48, 66.54, 68.74, 80.30, 95.06, 112.22, 140.18, 152.68])


def frequencies_figure(data: ModalData) -> Sheet:
    """Return Fig 8.2: natural frequencies over the number of the mode, with those that are printed."""
    number = np.arange(1, len(data.frequency) + 1)
    figure, axes = panels("Natural frequencies (Fig 8.2)")
    axes[0, 0].plot(number, data.frequency, "o-", color=LINES[0], markersize=4, label="fitted plate with boxes")
    axes[0, 0].plot(number[:10], THESIS, "x", color=LINES[1], label="printed")
    axes[0, 0].set(xlabel="mode", ylabel="frequency / Hz")
    axes[0, 0].legend(frameon=False)
    printed = np.full(len(number), np.nan)
    printed[: min(10, len(number))] = THESIS[: len(number)]
    columns = {"mode": number, "frequency [Hz]": data.frequency, "printed [Hz]": printed}
    note = "printed frequencies 4, 8 and 10 are 2 pi times those of the shock paper, as all others are to three digits"
    return Sheet("Natural frequencies", columns, figure, (note,))


def shapes_figure(data: ModalData) -> Sheet:
    """Return Figs 8.3 to 8.5: the vertical shapes of the first twelve modes at the stations."""
    figure, axes = panels("Modes 1 to 12 (Figs 8.3 to 8.5), front on top", 3, 4, figsize=(11, 8))
    columns = {"station": STATIONS}
    for k, axis in enumerate(axes.flat[: len(data.frequency)]):
        shape = data.station_shape[:, k]
        limit = np.max(np.abs(shape))
        axis.imshow(shape.reshape(5, 4), cmap="coolwarm", vmin=-limit, vmax=limit, interpolation="bilinear", aspect=1.2)
        axis.set_title(f"{k + 1}: {data.frequency[k]:.1f} Hz", fontsize=9)
        axis.set(xticks=[], yticks=[])
        columns[f"mode {k + 1} [kg^-1/2]"] = shape
    return Sheet("Mode shapes", columns, figure, ("mass-normalised; station 1 moves up",))
