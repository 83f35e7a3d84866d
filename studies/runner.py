"""Run a scenario: assemble, build and load the FMUs, co-simulate, record, judge."""

from __future__ import annotations

import platform
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib.metadata import PackageNotFoundError, version
from threading import Lock
from time import perf_counter
from types import MappingProxyType
from typing import Any

import numpy as np

import fmus
from cosim import Component, CosimError
from cosim.algorithms import Algorithm
from cosim.clock import ticks
from cosim.instance import Instance
from cosim.master import run
from cosim.observer import Observer, Summary
from cosim.record import Record
from cosim.scenario import LinkSpec, Scenario
from cosim.system import Link, System
from logs.parts import by_parts
from plants import rover

from .assembly import Assembly, assemble
from .metrics import Metric, verdict

Progress = Callable[[str], None]
_BUILDING = Lock()  # of runs in several threads one builds, and the others find the FMUs that they share


@dataclass(repr=False)
class Result:
    """A finished (or failed) run: its scenario, its signals and the verdict on them."""

    assembly: Assembly
    record: Record
    metrics: list[Metric]
    summary: Summary | None
    error: CosimError | None = None
    seconds: dict[str, float] = field(default_factory=dict)  # wall time of building, starting, running
    provenance: dict[str, Any] = field(default_factory=dict)  # versions, FMU tokens, host

    @property
    def scenario(self) -> Scenario:
        """The scenario as it was run, overrides included."""
        return self.assembly.scenario

    def signal(self, name: str) -> np.ndarray | None:
        """Return a port's values (n, ...), or None if the run has no such port."""
        return by_parts(self.record.get)(name)

    def __repr__(self) -> str:
        name = f"{self.scenario.name} {self.scenario.variant}".strip()
        end = float(self.record.time[-1]) if len(self.record) else 0.0
        failed = f", failed: {self.error}" if self.error is not None else ""
        steps = max(len(self.record) - 1, 0)
        return f"<Result of {name}: {steps} steps to {end:g} s, {len(self.metrics)} figures{failed}>"

    def _repr_html_(self) -> str:
        from .show import result_html

        return result_html(self)


def instantiate(
    assembly: Assembly, say: Progress = lambda text: None, pool: fmus.Pool | None = None
) -> dict[str, Instance]:
    """Build (or find in the cache) and load one FMU per slot, from the *pool* if there is one; set its values."""
    source = pool or fmus
    instances: dict[str, Instance] = {}
    settings = assembly.scenario.run
    smooth = settings.extrapolate > 0
    try:
        for name, part in assembly.components.items():
            slot = assembly.scenario.slot(name)
            if isinstance(part, Component):
                say(f"FMU {type(part).__name__}")
                instances[name] = source.instantiate(
                    part, name, fmi=settings.fmi, isolated=slot.isolated, time_limit=slot.time_limit, smooth=smooth
                )
            else:
                say(f"FMU {part}")
                instances[name] = source.load(
                    part, name, isolated=slot.isolated, time_limit=slot.time_limit, retry=slot.retry, smooth=smooth
                )
        rover.apply(assembly.starts, instances)
    except BaseException:
        _give_back(instances, pool, failed=True)
        raise
    return instances


def _give_back(instances: Mapping[str, Instance], pool: fmus.Pool | None, *, failed: bool) -> None:
    if pool is not None:
        pool.release(instances.values(), failed=failed)
        return
    for instance in instances.values():
        instance.close()


def link(value: str | LinkSpec) -> str | Link:
    """Turn a connection of a scenario file into one of the system."""
    if isinstance(value, str):
        return value
    return Link(value.source, convert=value.convert, factor=value.factor, offset=value.offset)


def connect(assembly: Assembly, instances: dict[str, Instance]) -> System:
    """Wire the instances as the assembly says."""
    wires = assembly.wiring({name: instance.variables for name, instance in instances.items()})
    return System(instances, {t: link(s) for t, s in wires.items()}, every=assembly.every,
                  events=assembly.scenario.run.events)  # fmt: skip


def algorithm_of(assembly: Assembly) -> Algorithm:
    """Return the strategy object that the scenario names."""
    return assembly.scenario.run.strategy(assembly.order)


def obstacle_start(assembly: Assembly) -> float | None:
    """Return where the path of a wheel first leaves the level, in m, or None without a known ground or an obstacle."""
    if assembly.ground is None or assembly.robot is None:
        return None
    return assembly.ground.departure(assembly.robot.R)


def execute(
    scenario: Scenario,
    observers: Callable[[Assembly, dict[str, Instance], Record], Sequence[Observer]] = lambda *run: (),
    say: Progress = lambda text: None,
    *,
    parts: Mapping[str, Component] = MappingProxyType({}),
    pool: fmus.Pool | None = None,
) -> Result:
    """Run one variant of a scenario to its end, or to its failure: then ``error`` is set and what was computed is kept.

    *observers* makes the observers of this run beside the record; *parts* are components that stand in the slots they
    are named by, ``parts={"controller": MyLaw()}``; *pool* lends the instances and takes them back for
    the next run.  Raises CosimError for anything that is wrong before the first step.
    """
    clock = perf_counter()
    with _BUILDING:
        assembly = assemble(scenario, parts)
        instances = instantiate(assembly, say, pool)
    seconds = {"building": perf_counter() - clock}
    record, made_of = Record(), provenance(instances)
    system = connect(assembly, instances)
    summary: Summary | None = None
    failure: CosimError | None = None
    try:
        watching = [record, *observers(assembly, instances, record)]
        seconds["preparing"], clock = perf_counter() - clock - seconds["building"], perf_counter()
        summary = run(
            system,
            algorithm_of(assembly),
            step=ticks(scenario.run.step, "run.step"),
            stop=ticks(scenario.run.duration, "run.duration"),
            observers=watching,
            locate_events=scenario.run.locate_events,
            tolerance=scenario.run.tolerance,
            compiled=scenario.run.compiled,
            control=scenario.run.pace(),
        )
    except CosimError as error:
        if not len(record):
            raise
        failure = error
    finally:
        seconds["running"] = perf_counter() - clock
        _give_back(instances, pool, failed=summary is None)
    return Result(assembly, record, judge(assembly, record), summary, failure, seconds, made_of)


def judge(assembly: Assembly, record: Record) -> list[Metric]:
    """Return the verdict on what was recorded so far; empty before the first step."""
    if len(record) < 2:
        return []
    return verdict(record.time, by_parts(record.get), obstacle_start(assembly), assembly.scenario.verdict)


def provenance(instances: Mapping[str, Instance]) -> dict[str, Any]:
    """Return what is needed to run this again: versions, FMU tokens, host."""
    found = {"python": platform.python_version(), "platform": platform.platform()}
    for package in ("wmr-cosim", "casadi", "fmpy", "numpy", "rerun-sdk"):
        try:
            found[package.replace("-", "_")] = version(package)
        except PackageNotFoundError:
            found[package.replace("-", "_")] = "not installed"
    return {**found, **{f"token_{name}": _token(instance) for name, instance in instances.items()}}


def _token(instance: Instance) -> str:
    """Return the hash of the sources that an FMU carries; empty for what is none."""
    return str(getattr(getattr(instance, "archive", None), "token", ""))
