"""Another master as a reference: FMUs of ours coupled by FMUContainer, in C, and by our algorithms give the same bits.

Its parallel mode hands every FMU the values from the start of the step, as Jacobi does, its sequential one the newest,
as Gauss-Seidel.  The container is an FMU itself, of either version, that our master steps.
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

import fmpy
import fmu_manipulation_toolbox
import numpy as np
import pytest
from fmu_manipulation_toolbox.assembly import AssemblyNode
from toys import Mass, Spring

import fmus
from cosim import Algorithm, GaussSeidel, Jacobi, Record, System, run

BINARIES = Path(fmu_manipulation_toolbox.__file__).parent / "resources" / fmpy.platform
PARTS = {"spring": Spring(k=4.0, d=0.3), "mass": Mass()}
WIRES = {"mass.F": "spring.F", "spring.x": "mass.pos", "spring.v": "mass.vel"}
OUTPUTS = {"pos": "mass.pos", "vel": "mass.vel", "F": "spring.F"}


def container(folder: Path, fmi: int, *, sequential: bool) -> Path:
    """Return an FMU that holds the spring and the mass and couples them in steps of 10 ms."""
    automatic = dict.fromkeys(("auto_link", "auto_input", "auto_output", "auto_parameter"), False)
    node = AssemblyNode("both.fmu", step_size=0.01, sequential=sequential, **automatic)
    for name, part in PARTS.items():
        shutil.copy(fmus.build(part, fmi=fmi), folder / f"{name}.fmu")
        node.add_fmu(f"{name}.fmu")
        for parameter, value in part.values.items():
            if parameter in ("k", "d"):
                node.add_start_value(f"{name}.fmu", parameter, repr(float(value)))
    for target, source in WIRES.items():
        (there, into), (here, out) = target.split("."), source.split(".")
        node.add_link(f"{here}.fmu", out, f"{there}.fmu", into)
    for name, source in OUTPUTS.items():
        here, out = source.split(".")
        node.add_output(f"{here}.fmu", out, name)
    node.make_fmu(folder, fmi_version=fmi)
    return folder / "both.fmu"


@pytest.mark.skipif(not BINARIES.is_dir(), reason=f"FMUContainer has no binary for {fmpy.platform} ({sys.platform})")
@pytest.mark.parametrize(
    ("algorithm", "sequential"), [(Jacobi(), False), (GaussSeidel(("spring", "mass")), True)], ids=["jacobi", "seidel"]
)
def test_another_master_gives_the_same_bits(algorithm: Algorithm, sequential: bool, fmi: int, tmp_path: Path) -> None:
    with pytest.MonkeyPatch.context() as patch:  # each build is another FMU: the cache need not remember it
        path = container(tmp_path, fmi, sequential=sequential)
        patch.setenv("WMR_COSIM_CACHE", str(tmp_path))
        theirs = fmus.load(path, "both")
    records = Record(), Record()
    with System({"both": theirs}, {}) as system:
        run(system, Jacobi(), step=0.01, stop=2.0, observers=[records[0]])
    with System({name: fmus.instantiate(part, name, fmi=fmi) for name, part in PARTS.items()}, WIRES) as system:
        run(system, algorithm, step=0.01, stop=2.0, observers=[records[1]])
    for name, source in OUTPUTS.items():
        np.testing.assert_array_equal(records[0][f"both.{name}"], records[1][source])
    assert np.ptp(records[1]["mass.pos"]) > 1.5  # it has swung from 1 to the other side
