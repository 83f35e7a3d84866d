"""An FMU for compilers without vectors, or for processors without wide registers, gives the same bits."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from test_twin_agreement import prepared

import fmus
from cosim.component import table_text
from plants.ground import Ground, Ramp
from plants.rigid_body import RigidBody

BODY = RigidBody(**Ground.same(Ramp(angle=0.3)).tables(R=0.1))
GIVEN = {
    "normal_force": [900.0, 430.0, 400.0, 390.0], "traction": [50.0, 60.0, 0.0, -20.0], "steer": [0.1, 0.1, 0.0, 0.0],
    "r": [0.37, 0.0, 0.498], "q": [1.0, 0.01, -0.02, 0.01], "v": [2.0, 0.05, -0.1],
}  # fmt: skip


def crossing(path: Path) -> bytes:
    """Return all outputs while the fronts meet the ramp: steps of both kinds, and events."""
    fmu = fmus.load(path)
    for track in ("left", "right"):
        fmu.set(track, table_text(BODY.values[track]))
    prepared(fmu, {name: np.array(value) for name, value in GIVEN.items()})
    found, now = [], 0
    for step in [100_000] * 40 + [5_000_000] * 40:
        fmu.step(now, now + step)
        fmu.pull()
        found.append(fmu.y.copy())
        now += step
    return np.array(found).tobytes()


@pytest.mark.parametrize("flag", ["WITHOUT_VECTORS", "WITHOUT_WIDE"])
def test_the_bits_are_the_same(flag: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    usual = fmus.build(BODY)
    monkeypatch.setenv("CC", f"cc -D{flag}")
    other = fmus.build(BODY, folder=tmp_path)
    assert usual.read_bytes() != other.read_bytes()
    assert crossing(other) == crossing(usual)
