"""What is checked before a run: who can be taken back, whose steps may vary, whose sample periods fit."""

from __future__ import annotations

from .clock import seconds, ticks
from .errors import CouplingError
from .instance import Instance
from .observer import RunInfo
from .system import System


def rewound(system: System, sequence: tuple[str, ...]) -> tuple[str, ...]:
    """Return who must be taken back when a component returns early: those up to the last that may, in stepping order.

    Raises CouplingError for one that cannot go back, and for one with events inside a step over several macro steps.
    """
    early = [name for name in sequence if system.instances[name].can.early_return]
    if not early:
        return ()
    for name in early:
        if system.every[name] > 1:
            raise CouplingError(
                f"{name} announces events and cannot step every {system.every[name]} macro steps, since the others "
                f"would have passed them; let it step every one, or run with locate_events=False"
            )
    names = sequence[: sequence.index(early[-1]) + 1]
    for name in names:
        if not system.instances[name].can.rollback:
            cure = "" if name in early else f"let {name} step after {early[-1]} in GaussSeidel, or "
            raise CouplingError(
                f"{name} cannot be taken back to an earlier state, which the events of {early[-1]} ask for; "
                f"{cure}run with locate_events=False"
            )
    return names


def check_steps(system: System, info: RunInfo, *, locating: bool) -> None:
    """Refuse steps of varying length for a component that declares it cannot make them."""
    for name, instance in system.instances.items():
        own = info.step_ns * system.every[name]
        if not instance.can.variable_step and (locating or (info.stop_ns - info.start_ns) % own):
            why, cure = ("events are located", "run with locate_events=False")
            if not locating:
                why, cure = "the run is no whole number of them", f"choose a stop time in steps of {seconds(own):g} s"
            raise CouplingError(f"{name} needs steps of equal length, but {why}; {cure}")


def sample_period(instance: Instance) -> float | None:
    """Return the sample period of an instance in s, or None if it has none: a parameter ``period`` in s."""
    variable = instance.variables.get("period")
    if variable is None or variable.causality != "parameter" or variable.unit != "s":
        return None
    return float(instance.get("period"))


def check_periods(system: System, step: int) -> None:
    """Refuse a sample period whose ticks are no communication points and that does not divide the step either."""
    for name, instance in system.instances.items():
        sampled = sample_period(instance)
        if sampled is None:
            continue
        period, own = ticks(sampled, f"the period of {name}"), step * system.every[name]
        if period % own and own % period:
            raise CouplingError(
                f"{name} has a period of {seconds(period):g} s, which is neither a multiple nor a whole fraction of "
                f"its step of {seconds(own):g} s; choose a step that divides the period"
            )
