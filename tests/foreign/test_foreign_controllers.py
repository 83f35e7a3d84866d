"""A controller made by other tools drives our plants: the run is that of the same law as a component of ours."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import numpy as np

from cosim import Component, input, output, parameter, state
from fmus.importer import read
from studies.catalog import find_scenario
from studies.runner import Result, execute

K, D = 1e6, 2e3  # N/m, N.s/m: as rough as the law may be, the runs must be the same


class Law(Component):
    """Traction by the deformation of each wheel and its rate, sampled."""

    period = parameter(1e-4, "s", "sample period")
    deformation = input("m", "deformation of each wheel", shape=4)
    deformation_rate = input("m/s", "its rate", shape=4)
    held = state([0.0] * 4, "N", "demand held between samples")
    traction_demand = output("N", "traction asked of each wheel", shape=4)

    def sync(s: Any) -> dict[str, Any]:
        return dict(held=-(K * s.deformation + D * s.deformation_rate))

    def outputs(s: Any) -> dict[str, Any]:
        return dict(traction_demand=s.held)


HEADS = {
    2: """
from pythonfmu import Fmi2Causality as Causality, Fmi2Slave, Real as Number

KIND = {}
""",
    3: """
from pythonfmu3 import Float64 as Number, Fmi3Causality as Causality, Fmi3Slave, Fmi3Variability

KIND = {"variability": Fmi3Variability.continuous}
""",
}
# A step that is cut at an event begins between two samples; the law is a sampled one, so it acts at those only.
LAW = f"""

class Law(SLAVE):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        if KIND:
            self.time = 0.0
            self.register_variable(Number("time", causality=Causality.independent, **KIND))
        for name in ("deformation", "deformation_rate", "traction_demand"):
            causality = Causality.output if name == "traction_demand" else Causality.input
            for i in range(1, 5):
                setattr(self, f"{{name}}_{{i}}", 0.0)
                self.register_variable(Number(f"{{name}}_{{i}}", causality=causality, **KIND))

    def do_step(self, time, step):
        if abs(time / 1e-4 - round(time / 1e-4)) < 1e-6:
            for i in range(1, 5):
                z, rate = getattr(self, f"deformation_{{i}}"), getattr(self, f"deformation_rate_{{i}}")
                setattr(self, f"traction_demand_{{i}}", -({K!r} * z + {D!r} * rate))
        return True
"""
NUMBERS = [(name, i) for name in ("deformation", "deformation_rate") for i in range(1, 5)]


def driven(controller: dict[str, Any] | None, fmi: int) -> Result:
    """Run 20 ms of the ramp impact, whose edge is met at 7.4 ms, under a foreign controller or under ours."""
    changes: dict[str, Any] = {"run": {"duration": 0.02, "fmi": fmi}}
    if controller is not None:
        # neither tool writes units, so that they are taken for those of the other end
        wires = {f"controller.{name}_{i}": f"wheels.{name}[{i}]" for name, i in NUMBERS}
        wires |= {f"wheels.traction_demand[{i}]": f"controller.traction_demand_{i}" for i in range(1, 5)}
        changes["connections"] = {target: {"source": source, "factor": 1.0} for target, source in wires.items()}
        changes["components"] = {"controller": controller}
    scenario = find_scenario("ramp-impact").load("uncontrolled", [changes])
    return execute(scenario, parts={} if controller else {"controller": Law()})


def test_a_controller_of_another_tool_drives_the_rover(fmi: int, tmp_path: Path) -> None:
    """The same products and sums of the same doubles, so the runs are the same to the bit."""
    if fmi == 2:
        from pythonfmu.builder import FmuBuilder
    else:
        from pythonfmu3.builder import FmuBuilder
    script = tmp_path / "law.py"
    script.write_text(HEADS[fmi] + LAW.replace("SLAVE", f"Fmi{fmi}Slave"))
    can = {"canGetAndSetFMUState": True, "canHandleVariableCommunicationStepSize": True} if fmi == 3 else {}
    path = Path(FmuBuilder.build_FMU(script, dest=tmp_path, **can))
    try:
        theirs, ours = driven({"fmu": str(path)}, fmi), driven(None, fmi)
    finally:
        shutil.rmtree(read(path).folder)  # each build is another FMU: the cache need not remember it
    assert theirs.error is None
    assert theirs.summary is not None
    # the foot of the ramp, for which the controller is taken back; in FMI 2.0 the body cannot announce it
    assert theirs.summary.events == (1 if fmi == 3 else 0)
    assert np.array_equal(theirs.record.time_ns, ours.record.time_ns)
    assert np.abs(ours.record["wheels.traction_demand"]).max() > 1e3
    for port in (port for port in ours.record.ports() if not port.startswith("controller.")):
        np.testing.assert_array_equal(theirs.record[port], ours.record[port], err_msg=port)
