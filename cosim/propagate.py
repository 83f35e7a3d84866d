"""Values carried along the direct feedthroughs: each output after the inputs it depends on, loops solved on the way."""

from __future__ import annotations

from collections.abc import Callable, Collection
from functools import partial
from typing import TYPE_CHECKING

from .loops import LoopSolver, Wires
from .structure import Loop, Port, feedthrough_graph, loop_of, stages

if TYPE_CHECKING:
    from .system import System
    from .wiring import Connection

Action = Callable[[str], None]


class Propagation:
    """One pass over the ports of a system, made once and gone through as often as needed.

    *among* are the components that take part; the outputs of the others stand as they are.  *numeric* carries Float64
    only, which is all that may be set between two steps of an FMU with events.
    """

    def __init__(self, system: System, among: Collection[str] | None = None, *, numeric: bool = False) -> None:
        self.system, self.numeric = system, numeric
        self.loops: list[Loop] = []
        needs = feedthrough_graph(system, among, numeric=numeric)
        driven = {
            port for port, sources in needs.items() if system.instances[port[0]].variable(port[1]).causality == "input"
        }
        self._actions: list[Action] = []
        for groups in stages(needs):
            single = [group[0] for group in groups if len(group) == 1]
            for name in system.names:
                mine = [port for component, port in single if component == name]
                self._single(
                    name, [p for p in mine if (name, p) in driven], [p for p in mine if (name, p) not in driven]
                )
            for group in groups:
                if len(group) > 1:
                    self._loop(loop_of(system, needs, group))

    def run(self, when: str) -> None:
        """Go through it once; *when* is for the sentence of a CouplingError."""
        for action in self._actions:
            action(when)

    def _single(self, name: str, inputs: list[str], outputs: list[str]) -> None:
        if inputs:
            self._actions.append(self._numbers(name, inputs) if self.numeric else partial(self._feed, name, inputs))
        if outputs:
            self._actions.append(partial(self._collect, name))

    def _loop(self, loop: Loop) -> None:
        self.loops.append(loop)
        self._actions.append(LoopSolver(self.system, loop).solve)
        self._actions += [partial(self._collect, name) for name in loop.components]

    def _feed(self, name: str, ports: list[str], when: str) -> None:
        self.system.feed(name, ports)

    def _collect(self, name: str, when: str) -> None:
        self.system.collect(name)

    def _numbers(self, name: str, ports: list[str]) -> Action:
        """Return what feeds Float64 ports, indices made once."""
        wanted = {(name, port) for port in ports}
        row, push = self.system.row, self.system.instances[name].push
        wires = Wires(self.system, [c for c in self.system.connections if c.numeric and _target(c) in wanted])

        def feed(when: str) -> None:
            row[wires.targets] = wires.values(row)
            push()

        return feed


def _target(connection: Connection) -> Port:
    return connection.target.component, connection.target.variable.name
