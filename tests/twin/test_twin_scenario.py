"""A component in its scenario does the same as a Python instance and as an FMU, of either version, to rounding."""

from __future__ import annotations

import numpy as np
import pytest

import fmus
from cosim import Component, Record, run
from cosim.clock import ticks
from plants import rover
from studies.assembly import Assembly, assemble
from studies.catalog import CONTROLLERS, ELEMENTS, find_scenario, scenario_files
from studies.full_order import is_whole
from studies.runner import algorithm_of, connect

STEPS = {"JerkTraction": 2500, "WheelDrive": 2500}  # macro steps: 0.5 s, until the hump is met
USUAL = 400
# Everything but the drive came out the same to the bit here; libms differ in last bits, and contacts
# amplify by at most exp(rate x time) = exp(250/s x 0.04 s) = 2e4.  The drive is integrated by two methods, each to
# a relative 1e-8 a step; whole steps are held to 100 times that, and 2500 of them may add up.
ROUNDING, INTEGRATED = 1e-11, 1e-6 * 2500**0.5
INTEGRATING = ("WheelDrive",)
CONSTANT = ("Uncontrolled", "OpenLoopTorque")  # of the others some output changes, or nothing would be compared


def cases() -> dict[str, tuple[str, str, str]]:
    """Return (scenario, variant, slot) by kind: the first use of each controller, drive and element."""
    found: dict[str, tuple[str, str, str]] = {}
    for name in scenario_files():
        file = find_scenario(name)
        for variant in file.variants or {"": {}}:
            scenario = file.load(variant or None)
            if is_whole(scenario):  # the same controllers meet their obstacles sooner on the analytical robot
                continue
            slots = {**scenario.components, **{e.name: e.slot for e in scenario.elements()}}
            for slot, spec in slots.items():
                if slot not in ("wheels", "body", "chassis") and spec.type is not None:
                    found.setdefault(spec.type, (name, variant, slot))
    return found


CASES = cases()


def recorded(assembly: Assembly, python_slot: str | None, fmi: int, steps: int) -> Record:
    """Run an assembly with every slot as an FMU but one."""
    instances = {}
    for name, part in assembly.components.items():
        assert isinstance(part, Component)
        instances[name] = part.instance(name) if name == python_slot else fmus.instantiate(part, name, fmi=fmi)
    rover.apply(assembly.starts, instances)
    record = Record()
    with connect(assembly, instances) as system:
        step = ticks(assembly.scenario.run.step, "step")
        run(system, algorithm_of(assembly), step=step, stop=steps * step, observers=[record])
    return record


def test_every_kind_is_among_the_cases() -> None:
    assert set(CASES) == {*CONTROLLERS, *ELEMENTS, *INTEGRATING}


@pytest.mark.parametrize("kind", CASES)
def test_the_run_is_the_same(kind: str, fmi: int) -> None:
    scenario, variant, slot = CASES[kind]
    assembly = assemble(find_scenario(scenario).load(variant or None))
    assert type(assembly.components[slot]).__name__ == kind
    steps = STEPS.get(kind, USUAL)
    compiled, python = (recorded(assembly, chosen, fmi, steps) for chosen in (None, slot))
    assert len(compiled) == len(python)
    outputs = {v.name for v in assembly.components[slot].variables.values() if v.causality == "output"}
    changing = [name for name in outputs if np.ptp(compiled[f"{slot}.{name}"], axis=0).any()]
    assert bool(changing) != (kind in CONSTANT)
    for port in compiled.ports():
        a, b = compiled[port], python[port]
        bound = (INTEGRATED if kind in INTEGRATING else ROUNDING) * max(float(np.max(np.abs(a))), 1.0)
        assert np.max(np.abs(a - b)) <= bound, port
