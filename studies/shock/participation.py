"""Modal participation under the three cases of excitation (thesis Figs 8.13 and 8.15)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from plants.chassis_modes import ModalData
from plants.shock_loads import excited, participation, wheel_load
from studies.figures.sheet import LINES, Sheet, panels

from .cases import FORCE


def participation_figure(data: ModalData, cases: Sequence[str]) -> Sheet:
    """Return gamma = phi^T R of each mode for some *cases*, 1000 N in all and 1000 N on each wheel."""
    number = np.arange(1, len(data.frequency) + 1)
    figure, axes = panels(f"Modal participation: {' and '.join(cases)}", 1, 2, sharex=True)
    columns = {"mode": number, "frequency [Hz]": data.frequency}
    loads = {"1000 N in all": FORCE, "1000 N per wheel": None}
    for axis, (what, total) in zip(axes.flat, loads.items(), strict=True):
        for k, case in enumerate(cases):
            load = FORCE * wheel_load(case) if total is None else wheel_load(case, total=total)
            gamma = np.abs(participation(data, load))
            columns[f"{case}, {what} [N/kg^1/2]"] = gamma
            axis.bar(number + 0.4 * k - 0.2, gamma, width=0.4, color=LINES[k], label=case)
        axis.set(title=what, xlabel="mode", ylabel="|phi^T R| / (N/kg^1/2)")
    axes[0, 0].legend(frameon=False)
    counts = ", ".join(
        f"{case} {np.count_nonzero(excited(participation(data, wheel_load(case))))} of {len(number)}" for case in cases
    )
    return Sheet("Modal participation", columns, figure, (f"modes excited: {counts}",))
