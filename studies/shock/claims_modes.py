"""Claims about which modes take part (thesis 8.5 and 8.6): exact, as they follow from symmetry."""

from __future__ import annotations

import numpy as np

from plants.chassis_modes import ModalData
from plants.shock import peaks
from plants.shock_loads import TABLE_8_1, excited, participation, still_reaction, wheel_load
from studies.figures.claim import EQUAL, Claim, graded

from .cases import CASES, FORCE, acceleration, times


def similar_modes(data: ModalData) -> Claim:
    """8.5, Fig 8.13: equal participation of single and diagonal excitation."""
    single = np.abs(participation(data, FORCE * wheel_load("single")))
    in_all, per_wheel = (np.abs(participation(data, f * wheel_load("diagonal"))) for f in (FORCE / 2, FORCE))
    on = excited(in_all)
    off = float(np.max(np.abs(in_all - single)[on]) / single.max())
    ratio = float(np.mean(per_wheel[on] / single[on]))
    return Claim(
        "8.5",
        "single and diagonal excitation participate equally in most modes",
        f"equal in the {np.count_nonzero(on)} of {len(on)} modes that both excite if 1000 N act in all (off by "
        f"{off:.0e}); {ratio:.2f} times as much with 1000 N per wheel",
        graded(abs(ratio - 1) < EQUAL, bool(off < EQUAL and 2 * np.count_nonzero(on) > len(on))),
        {"off": off, "ratio": ratio},
    )


def single_excites_all(data: ModalData) -> Claim:
    """8.5, Fig 8.13."""
    counts = {c: int(np.count_nonzero(excited(participation(data, wheel_load(c))))) for c in CASES}
    least = float(np.min(np.abs(participation(data, FORCE * wheel_load("single")))))
    n = len(data.frequency)
    return Claim(
        "8.5",
        "a single wheel excites all 25 modes, a diagonal pair only some",
        f"{', '.join(f'{case} {count}' for case, count in counts.items())} of {n}; the smallest of a single wheel is "
        f"{least:.1f} N/kg^1/2",
        graded(counts["single"] == n and counts["diagonal"] < n),
        {**counts, "least": least},
    )


def four_wheels_spare_mode_2(data: ModalData) -> Claim:
    """8.6, Fig 8.15."""
    ratios = {"r3 = r1": 1.0, "Table 8.1 distances": still_reaction("four", TABLE_8_1)}
    alone = participation(data, wheel_load("single"))[1]
    left = {name: abs(float(participation(data, wheel_load("four", r))[1] / alone)) for name, r in ratios.items()}
    return Claim(
        "8.6",
        "under four-wheel excitation mode 2 has no participation",
        f"{'; '.join(f'{name}: {v:.0e} of that of a single wheel' for name, v in left.items())}: zero by symmetry",
        graded(max(left.values()) < EQUAL),
        left,
    )


def middle_row_alike(data: ModalData) -> Claim:
    """8.6: stations 9 to 12."""
    t, row = times(), slice(8, 12)
    even = [acceleration(data, case, total=FORCE, t=t)[:, row] for case in ("diagonal", "four")]
    full = [peaks(acceleration(data, case, t=t)[:, row]) for case in ("diagonal", "four")]
    off = float(np.max(np.abs(even[0] - even[1])) / np.max(np.abs(even[0])))
    ratio = float(np.mean(full[1] / full[0]))
    return Claim(
        "8.6",
        "stations 9 to 12 respond identically to four-wheel and diagonal excitation",
        f"identical if 1000 N act in all (off by {off:.0e}); with 1000 N per wheel four give {ratio:.2f} times as much",
        graded(abs(ratio - 1) < EQUAL and off < EQUAL, off < EQUAL),
        {"off": off, "ratio": ratio},
    )
