"""Algebraic loops between an FMU of ours and one of another tool: Python code packed by pythonfmu and pythonfmu3."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from toys import Gain

import fmus
from cosim import Algorithm, CouplingError, Jacobi, Link, Record, System, run
from cosim.consistent import Consistent
from cosim.structure import loops

MS = 1_000_000  # ns
LINE = {
    2: """
from pythonfmu import Fmi2Causality, Fmi2Slave, Real


class Line(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.u, self.t = 0.0, 0.0
        self.register_variable(Real("u", causality=Fmi2Causality.input))
        self.register_variable(Real("y", causality=Fmi2Causality.output, getter=lambda: 1 + self.t - 2 * self.u))

    def do_step(self, time, step):
        self.t = time + step
        return True
""",
    3: """
from pythonfmu3 import Float64, Fmi3Causality, Fmi3Slave, Fmi3Variability

moving = {"variability": Fmi3Variability.continuous}


class Line(Fmi3Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.u, self.t, self.time = 0.0, 0.0, 0.0
        self.register_variable(Float64("time", causality=Fmi3Causality.independent, **moving))
        self.register_variable(Float64("u", causality=Fmi3Causality.input, **moving))
        y = Float64("y", causality=Fmi3Causality.output, getter=lambda: 1 + self.t - 2 * self.u, **moving)
        self.register_variable(y)

    def do_step(self, time, step):
        self.t = time + step
        return True
""",
}


def line(folder: Path, fmi: int) -> Path:
    """Build an FMU with y = 1 + t - 2 u and return its file."""
    script = folder / "line.py"
    script.write_text(LINE[fmi])
    if fmi == 2:
        from pythonfmu.builder import FmuBuilder
    else:
        from pythonfmu3.builder import FmuBuilder
    return Path(FmuBuilder.build_FMU(script, dest=folder))


def recorded(path: Path, algorithm: Algorithm) -> Record:
    """Return the record of the line with a gain of 3 of ours around it: u = 3 (1 + t - 2 u)."""
    record = Record()
    with pytest.MonkeyPatch.context() as patch:  # each build is another FMU: the cache need not remember it
        patch.setenv("WMR_COSIM_CACHE", str(path.parent))
        parts = {"line": fmus.load(path, "line")}
    parts |= {"gain": fmus.instantiate(Gain(k=3.0), "gain")}
    with System(parts, {"line.u": Link("gain.y", factor=1.0), "gain.u": Link("line.y", factor=1.0)}) as system:
        (loop,) = loops(system)
        assert loop.path[0] == loop.path[-1] == ("line", "u")
        run(system, algorithm, step=100 * MS, stop=1000 * MS, observers=[record])
    return record


def test_a_loop_through_another_tools_fmu_is_solved(tmp_path: Path, fmi: int) -> None:
    path = line(tmp_path, fmi)
    record = recorded(path, Consistent(Jacobi(), trusted=("line",)))
    np.testing.assert_allclose(record["line.u"], 3 * (1 + record.time) / 7, rtol=1e-14)
    np.testing.assert_allclose(
        record["line.y"], (1 + record.time) / 7, rtol=1e-13
    )  # a difference of numbers 13 times it
    left = recorded(path, Jacobi())
    assert left["line.u"][0] == pytest.approx(3 / 7, rel=1e-14)  # at the start it is solved without being asked for
    assert np.max(np.abs(left["line.u"])) > 10  # then a factor of -6 for each time around, which takes two steps


def test_fmi_2_is_not_read_between_steps_unless_it_is_trusted(tmp_path: Path) -> None:
    with pytest.raises(CouplingError, match="line does not promise outputs for inputs that are set between steps"):
        recorded(line(tmp_path, 2), Consistent(Jacobi()))
