"""A whole scenario near a point of its run as a linear system: one step of the master, as it is."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from cosim import Component
from cosim.errors import ScenarioError
from cosim.master import run
from cosim.scenario import Scenario
from cosim.step_map import step_map

from .assembly import assemble
from .runner import algorithm_of, connect, instantiate

if TYPE_CHECKING:
    import control

TOLERANCE = 1e-12  # of the components' integrators, since differences of their steps are taken


def linearize_scenario(
    scenario: Scenario,
    *,
    at: float = 0.0,
    inputs: Iterable[str] | None = None,
    outputs: Iterable[str] | None = None,
    states: Iterable[str] = ("*",),
    nominal: Mapping[str, float] | None = None,
) -> control.StateSpace:
    """Return what one step of *scenario* does near its state at the time *at* (s), for python-control.

    Its ``dt`` is the macro step, or with sampled components the shortest time after which all periods have come round;
    see `cosim.step_map.step_map` for states, names and the choices.

    Raises ScenarioError for a foreign FMU, whose states cannot be set.
    """
    assembly = assemble(scenario)
    for name, part in assembly.components.items():
        if not isinstance(part, Component):
            raise ScenarioError(
                f"{scenario.name}: {name} is a foreign FMU, whose states cannot be set once it runs; "
                "put a component of the catalog in its place to linearise the scenario"
            )
    algorithm, settings = algorithm_of(assembly), scenario.run
    with connect(assembly, instantiate(assembly)) as system:
        if at > 0:
            run(
                system, algorithm, step=settings.step, stop=at,
                locate_events=settings.locate_events, tolerance=TOLERANCE,
            )  # fmt: skip
        else:
            system.initialize(tolerance=TOLERANCE)
        found = step_map(
            system, algorithm, step=settings.step, inputs=inputs, outputs=outputs, states=states, nominal=nominal
        )
    return found.copy(name=scenario.name)
