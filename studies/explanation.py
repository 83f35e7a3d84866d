"""What a coupled system is before it runs: who steps when, how old each value is, which loops there are, who can what.

Facts for ``wmr-cosim explain``, as one JSON-able document; nothing is stepped.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

import fmus
from cosim import Component, CosimError, Instance
from cosim.algorithms import Algorithm
from cosim.clock import seconds, ticks
from cosim.compiled import refusal
from cosim.consistent import Consistent
from cosim.master import rewound
from cosim.observer import RunInfo
from cosim.scenario import RunSettings
from cosim.structure import Loop, fed_through, loops, spelt
from cosim.system import System
from cosim.wiring import Connection, find

from .assembly import Assembly, assemble
from .catalog import find_scenario
from .runner import algorithm_of, connect, instantiate

Facts = dict[str, Any]


def scenario_facts(name: str, variant: str | None = None, changes: Sequence[str] = ()) -> Facts:
    """Return what there is to know about one variant of a scenario; *changes* are ``--set`` texts."""
    file = find_scenario(name)
    assembly = assemble(file.load(variant, file.overrides(changes)))
    scenario = assembly.scenario
    algorithm, settings = algorithm_of(assembly), scenario.run
    info = RunInfo(ticks(settings.step, "run.step"), ticks(settings.duration, "run.duration"), 0, repr(algorithm))
    with connect(assembly, instantiate(assembly)) as system:
        return {
            "scenario": scenario.name, "variant": scenario.variant, "title": scenario.title,
            "algorithm": info.algorithm, "step": seconds(info.step_ns), "duration": seconds(info.stop_ns),
            **system_facts(system, algorithm, info, assembly=assembly, settings=settings),
            "notes": list(assembly.notes),
        }  # fmt: skip


def system_facts(
    system: System,
    algorithm: Algorithm,
    info: RunInfo,
    *,
    assembly: Assembly | None = None,
    settings: RunSettings | None = None,
) -> Facts:
    """Return order, delays, loops, unconnected inputs, capabilities and what they allow."""
    return {
        "order": order_facts(system, algorithm, info, assembly),
        "connections": connection_facts(system, algorithm, info),
        "loops": [loop_facts(system, algorithm, loop) for loop in loops(system)],
        "unconnected": unconnected_facts(system),
        "components": {name: component_facts(instance) for name, instance in system.instances.items()},
        "allows": allowed(system, algorithm, info, settings),
    }


def order_facts(system: System, algorithm: Algorithm, info: RunInfo, assembly: Assembly | None) -> list[Facts]:
    """Return the components in the order they step: how often, and whose new and old values each steps on.

    ``passes_on`` are those whose values show in its own outputs at once, without a step of it; ``late`` are those of
    them that step behind it, so that what it shows of them is a step older than need be.
    """
    sources = {name: {c.source.component for c in system.connections if c.target.component == name}
               for name in system.names}  # fmt: skip
    passed = fed_through(system)
    parts = assembly.components if assembly else {}
    found = []
    for name in algorithm.sequence(system):
        fresh = {s for s in sources[name] if not algorithm.delay(system, s, name)}
        period = _period(parts.get(name), system.instances[name])
        found.append({
            "component": name, "is": _is(parts.get(name), system.instances[name]), "every": system.every[name],
            "step": seconds(info.step_ns) * system.every[name], "period": period,
            "steps_on_new": _ordered(system, fresh), "steps_on_old": _ordered(system, sources[name] - fresh),
            "passes_on": _ordered(system, passed[name]),
            "late": [] if isinstance(algorithm, Consistent) else _ordered(system, passed[name] - fresh),
        })  # fmt: skip
    return found


def _ordered(system: System, names: set[str]) -> list[str]:
    return [name for name in system.names if name in names]


def _is(part: Component | str | None, instance: Instance) -> str:
    return type(part).__name__ if isinstance(part, Component) else str(getattr(_archive(instance), "model", "Python"))


def _period(part: Component | str | None, instance: Instance) -> float | None:
    """Return the sample period in s: a parameter ``period``."""
    if isinstance(part, Component):
        return float(part.values["period"]) if "period" in part.values else None
    v = instance.variables.get("period")
    known = v is not None and v.causality == "parameter" and v.unit == "s" and v.start is not None
    return float(np.ravel(v.start)[0]) if known and v is not None else None


def connection_facts(system: System, algorithm: Algorithm, info: RunInfo) -> list[Facts]:
    """Return every connection with its unit and its delay, in macro steps and in s."""
    delays = system.delays(algorithm)
    return [
        {
            "source": c.source.port, "target": c.target.port, "type": c.target.variable.type,
            "values": int(np.prod(c.target.shape)), "unit": c.source.variable.unit,
            "target_unit": c.target.variable.unit, "factor": c.factor, "offset": c.offset,
            "delay": delays[c.target.port], "delay_s": delays[c.target.port] * seconds(info.step_ns),
            "held": system.every[c.source.component],
        }
        for c in system.connections
    ]  # fmt: skip


def loop_facts(system: System, algorithm: Algorithm, loop: Loop) -> Facts:
    """Return a loop with its path, its equations, and how it is handled at the start and at communication points."""
    ports = set(loop.ports)
    inside = [c for c in system.connections if _ends(c) <= ports]
    instances = [system.instances[name] for name in loop.components]
    plain = [i.name for i in instances if not i.can.directional_derivatives]
    numeric = all(c.numeric for c in inside)
    derivatives = f"finite differences for {', '.join(plain)}" if plain else "the components' own derivatives"
    points = "solved in the same way" if numeric else "Float64 connections solved in the same way, others delayed"
    if not isinstance(algorithm, Consistent):
        points = "not solved: each connection is as old as its delay says (run.solve_loops = true solves it there, too)"
    return {
        "path": [spelt(port) for port in loop.path], "ports": [spelt(port) for port in loop.ports],
        "assumed": [spelt(port) for port in loop.assumed], "components": list(loop.components),
        "equations": sum(int(np.prod(c.target.shape)) for c in inside),
        "at_start": f"solved by Newton's method with {derivatives}", "at_points": points,
    }  # fmt: skip


def _ends(c: Connection) -> set[tuple[str, str]]:
    return {(c.target.component, c.target.variable.name), (c.source.component, c.source.variable.name)}


def unconnected_facts(system: System) -> list[Facts]:
    """Return the inputs that nobody drives, and the values they keep."""
    found = []
    for port in system.unconnected:
        end = find(system.instances, port, "input")
        value = end.variable.start
        instance = system.instances[end.component]
        if end.variable.name in instance.u_at:
            value = instance.u[end.positions(instance.u_at[end.variable.name])]
            value = float(value[0]) if not end.shape else value
        found.append({"port": port, "unit": end.variable.unit, "value": value, "meaning": end.variable.meaning})
    return found


def component_facts(instance: Instance) -> Facts:
    """Return what a component is and declares it can do; ``feeds_through`` are its outputs and what reaches them."""
    archive = _archive(instance)
    outputs = [v for v in instance.variables.values() if v.causality == "output"]
    inputs = [v.name for v in instance.variables.values() if v.causality == "input"]
    through = {v.name: inputs if v.depends_on is None else list(v.depends_on) for v in outputs}
    return {
        "kind": f"FMI {archive.fmi}.0 FMU" if archive else "Python", "tool": getattr(archive, "tool", ""),
        "meaning": getattr(archive, "meaning", ""),
        **asdict(instance.can), "reset": archive is not None,  # every FMU must have it; whether it works is tried
        "inputs": len(inputs), "outputs": len(outputs),
        "feeds_through": {name: found for name, found in through.items() if found},
        "dependencies_declared": all(v.depends_on is not None for v in outputs),
    }  # fmt: skip


def _archive(instance: Instance) -> Any:
    return getattr(instance, "archive", None)


def allowed(system: System, algorithm: Algorithm, info: RunInfo, settings: RunSettings | None = None) -> list[Facts]:
    """Return what the capabilities allow the whole system to do: what, whether, and why or why not."""
    can = {name: i.can for name, i in system.instances.items()}
    trusted = algorithm.trusted if isinstance(algorithm, Consistent) else ()

    def lacking(ability: str) -> list[str]:
        return [name for name, c in can.items() if not getattr(c, ability)]

    unread = [name for name in lacking("get_after_set") if name not in trusted]
    return [
        _events(system, algorithm, locate_events=settings is None or settings.locate_events),
        _all("step control with error estimate, iterated coupling", lacking("rollback"),
             "every component can be taken back to the start of a step", "cannot be taken back to the start of a step",
             "steps stay fixed; the other algorithms remain"),
        _all("macro steps of any length", lacking("variable_step"),
             "every component takes steps of varying length", "needs steps of equal length",
             "steps stay fixed and the run a whole number of them"),
        _all("algebraic loops solved at communication points", unread,
             "inputs may be set and outputs read without a step", "does not promise outputs between steps (FMI 2.0)",
             "name it in run.trusted to have it tried"),
        _all("exact Jacobians (interface Newton, linearisation)", lacking("directional_derivatives"),
             "every component gives directional derivatives", "gives no directional derivatives",
             "finite differences stand in"),
        _all("the state of everything saved to bytes", lacking("serialize"),
             "every component's state can be turned into bytes and back", "cannot", "a run starts at its beginning"),
        _compiled(system, algorithm, info, wanted=None if settings is None else settings.compiled),
    ]  # fmt: skip


def _all(what: str, lacking: list[str], why: str, why_not: str, instead: str) -> Facts:
    if lacking:
        return {"what": what, "possible": False, "why": f"{', '.join(lacking)} {why_not}; {instead}"}
    return {"what": what, "possible": True, "why": why}


def _events(system: System, algorithm: Algorithm, *, locate_events: bool) -> Facts:
    what = "events located, everybody brought to the instant"
    sequence = algorithm.sequence(system)
    early = [name for name in sequence if system.instances[name].can.early_return]
    if not early:
        return {"what": what, "possible": False, "why": "no component announces events, so there are none to locate"}
    if not locate_events:
        return {"what": what, "possible": False, "why": "switched off: run.locate_events = false"}
    try:
        back = rewound(system, sequence)
    except CosimError as error:
        return {"what": what, "possible": False, "why": str(error)}
    return {
        "what": what,
        "possible": True,
        "why": f"{', '.join(early)} may return early; {', '.join(back)} go back then",
    }


def _compiled(system: System, algorithm: Algorithm, info: RunInfo, *, wanted: bool | None) -> Facts:
    what = "compiled loop, no Python per step"
    if wanted is False:
        return {"what": what, "possible": False, "why": "switched off: run.compiled = false"}
    if why := refusal(system, algorithm, info):
        instead = "the run is refused" if wanted else "the readable loop makes the same steps"
        return {"what": what, "possible": False, "why": f"{why}; {instead}"}
    return {"what": what, "possible": True, "why": "every component is an FMU; the bits are those of the readable loop"}


def file_facts(files: Sequence[Path]) -> Facts:
    """Return what there is to know about FMU files that are not connected."""
    instances: dict[str, Instance] = {}
    try:
        for path in files:
            name = path.stem if path.stem not in instances else f"{path.stem}_{len(instances) + 1}"
            instances[name.replace(".", "_")] = fmus.load(path, name)
        return {"components": {name: component_facts(instance) for name, instance in instances.items()}}
    finally:
        for instance in instances.values():
            instance.close()
