"""What does an exact shock response cost, against a library and against the thesis' Fourier series?

25 modes, 20 stations, 1 s at 10 kHz, one wheel under a rectangular pulse of 0.05 s; station accelerations included, the
best of runs in turn.  Errors are rms over all stations, against the closed form.  The series is timed as the thesis has
it (200 Hz) and with as many harmonics as it takes to come within 2 %; it never comes to the others' accuracy.  The FMU
is the chassis of the rover, set, stepped and read 10 000 times through FMI.

    python benchmarks/shock_speed.py
"""

from __future__ import annotations

import json
from collections.abc import Callable
from time import perf_counter

import numpy as np
from pyyeti.ode import SolveUnc
from rich.console import Console
from rich.table import Table

import fmus
from cosim.clock import NS
from plants.pulses import Pulse
from plants.shock import held_response, pulse_response
from plants.shock_fourier import fourier_response
from studies.shock.cases import FORCE, RATE, SHORT, platform, times

REPEATS, NEAR = 5, 0.02
DATA, T, PULSE = platform(), times(), Pulse("rectangular", SHORT)
GAMMA = FORCE * DATA.wheel_shape[0]
Way = Callable[[], np.ndarray]


def library() -> np.ndarray:
    """Return station accelerations by pyyeti, with its set-up."""
    w = 2 * np.pi * DATA.frequency
    solver = SolveUnc(np.ones(len(w)), 2 * DATA.damping * w, w**2, 1 / RATE, order=0)
    return np.asarray((DATA.station_shape @ solver.tsolve(np.outer(GAMMA, PULSE.force(T))).a).T)


def recursion() -> np.ndarray:
    """Return station accelerations by the exact recursion, every mode on its own force as the library has it."""
    force = np.outer(GAMMA, PULSE.force(T))
    return held_response(DATA.frequency, DATA.damping, T, force).at_stations(DATA)


def closed() -> np.ndarray:
    """Return station accelerations by the closed form."""
    return pulse_response(DATA.frequency, DATA.damping, PULSE, T).at_stations(DATA, GAMMA)


def series(top: float) -> Way:
    """Return the thesis' series to *top* Hz."""
    return lambda: fourier_response(DATA.frequency, DATA.damping, PULSE, T, top=top).at_stations(DATA, GAMMA)


def stepped() -> tuple[Way, Callable[[], None]]:
    """Return 10 000 steps of the chassis FMU, and what closes it."""
    chassis = fmus.instantiate(DATA.component(), "chassis", fmi=3)
    chassis.enter_initialization(0)
    chassis.exit_initialization()
    rest = chassis.snapshot()
    force, out = np.zeros((len(T), 4)), np.zeros((len(T), len(DATA.station_shape)))
    force[:, 0] = FORCE * PULSE.force(T)
    ticks = np.round(T * NS).astype(int).tolist()

    def way() -> np.ndarray:
        chassis.restore(rest)
        for k in range(len(T)):
            chassis.set("wheel_force", force[k])
            out[k] = chassis.get("acceleration")
            if k + 1 < len(T):
                chassis.step(ticks[k], ticks[k + 1])
        return out

    return way, chassis.close


def needed(exact: np.ndarray) -> float:
    """Return the top frequency in Hz, from 200 and doubled, at which the series comes within 2 % rms."""
    top = 200.0
    while error(series(top)(), exact) > NEAR:
        top *= 2
    return top


def error(found: np.ndarray, exact: np.ndarray) -> float:
    """Return the rms error over all stations and times."""
    return float(np.sqrt(np.mean((found - exact) ** 2) / np.mean(exact**2)))


def main() -> None:
    """Time all ways in turn, print the table and a line of JSON."""
    exact = closed()
    top = needed(exact)
    fmu, close = stepped()
    ways: dict[str, Way] = {
        "exact recursion": recursion,
        "closed form": closed,
        "chassis FMU, 10 000 steps": fmu,
        "pyyeti SolveUnc, order 0": library,
        "series to 200 Hz": series(200.0),
        f"series to {top:g} Hz": series(top),
    }
    seconds, errors = dict.fromkeys(ways, np.inf), {}
    for repeat in range(REPEATS):
        for name, way in ways.items():
            if name.startswith("series") and repeat > 0:
                continue  # they take longest, and differ by far more than any noise
            began = perf_counter()
            found = way()
            seconds[name] = min(seconds[name], perf_counter() - began)
            errors[name] = error(found, exact)
    close()
    table = Table("way", "ms", "times the recursion", "rms error")
    ratio = {name: s / seconds["exact recursion"] for name, s in seconds.items()}
    for name, s in seconds.items():
        table.add_row(name, f"{1e3 * s:.1f}", f"{ratio[name]:.2f}", f"{errors[name]:.1e}")
    Console().print(table)
    print(json.dumps({"ms": {n: 1e3 * s for n, s in seconds.items()}, "ratio": ratio, "error": errors}))


if __name__ == "__main__":
    main()
