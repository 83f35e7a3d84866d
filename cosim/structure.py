"""Who needs whom: what feeds through at once, what is connected, and where that closes an algebraic loop.

Read from the descriptions alone, nothing is evaluated.  An output that declares no dependencies is assumed to need all
connected inputs of its component, as the standard says.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from graphlib import CycleError, TopologicalSorter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .system import System
    from .wiring import Connection

Port = tuple[str, str]  # component, variable


@dataclass(frozen=True)
class Loop:
    """Ports that all need one another at once; ``path`` is one way round, from an input back to it."""

    ports: tuple[Port, ...]
    path: tuple[Port, ...]
    assumed: tuple[Port, ...] = ()  # its outputs that declare no dependencies

    @property
    def components(self) -> tuple[str, ...]:
        """The components it passes through, in the order of the ports."""
        return tuple(dict.fromkeys(component for component, _ in self.ports))

    def __str__(self) -> str:
        text = " -> ".join(map(spelt, self.path))
        others = len(self.ports) - len(set(self.path))
        text += f" (and {others} more port{'s' * (others > 1)} that depend on it and it on them)" if others else ""
        if self.assumed:
            text += (
                f" ({', '.join(map(spelt, self.assumed))}: dependencies not declared, "
                f"so all inputs are assumed to feed through)"
            )
        return text


def spelt(port: Port) -> str:
    """Return a port as it is written in scenarios: ``component.variable``."""
    return ".".join(port)


def feedthrough_graph(
    system: System, among: Collection[str] | None = None, *, numeric: bool = False
) -> dict[Port, set[Port]]:
    """Return what each port needs at once: an input its source, an output the connected inputs that feed through.

    *among* leaves out the other components: their outputs are taken as they are.  *numeric* leaves out the connections
    that are not Float64, and those to inputs that can be set at events only.
    """
    present = system.names if among is None else among
    needs: dict[Port, set[Port]] = {}
    for c in system.connections:
        waits = c.target.variable.name in system.instances[c.target.component].discrete
        if c.target.component in present and not (numeric and (waits or not c.numeric)):
            sources = needs.setdefault((c.target.component, c.target.variable.name), set())
            if c.source.component in present:
                sources.add((c.source.component, c.source.variable.name))
    driven = set(needs)
    for name in present:
        inputs = [port for component, port in driven if component == name]
        for v in system.instances[name].variables.values():
            if v.causality == "output":
                needs[name, v.name] = {(name, p) for p in inputs if v.depends_on is None or p in v.depends_on}
    return needs


def connection_graph(system: System) -> dict[str, dict[str, list[Connection]]]:
    """Return for each component those it is fed by, each with the connections that do it."""
    found: dict[str, dict[str, list[Connection]]] = {name: {} for name in system.names}
    for c in system.connections:
        found[c.target.component].setdefault(c.source.component, []).append(c)
    return found


def fed_through(system: System) -> dict[str, set[str]]:
    """Return for each component those whose values show in its own outputs at once, without a step of it.

    A component that steps before one of these shows values that are a step older than need be.
    """
    needs = feedthrough_graph(system)
    at_once = {port for sources in needs.values() for port in sources}
    found: dict[str, set[str]] = {name: set() for name in system.names}
    for c in system.connections:
        if (c.target.component, c.target.variable.name) in at_once:
            found[c.target.component].add(c.source.component)
    return found


def stages(needs: Mapping[Port, set[Port]]) -> list[list[tuple[Port, ...]]]:
    """Return groups of ports, stage by stage: each needs earlier stages only, and a loop is one group of its ports."""
    label: Mapping[Port, int] = {port: i for i, port in enumerate(needs)}
    try:
        TopologicalSorter(needs).prepare()
    except CycleError:
        label = _strong(needs)
    members: dict[int, list[Port]] = {}
    for port, at in label.items():
        members.setdefault(at, []).append(port)
    sorter = TopologicalSorter(
        {at: {label[n] for p in ports for n in needs[p]} - {at} for at, ports in members.items()}
    )
    sorter.prepare()
    found = []
    while sorter.is_active():
        ready = sorter.get_ready()
        found.append([tuple(members[at]) for at in ready])
        sorter.done(*ready)
    return found


def loops(system: System) -> list[Loop]:
    """Return the algebraic loops of a system in the order in which they are to be solved; none is the usual case."""
    needs = feedthrough_graph(system)
    return [loop_of(system, needs, group) for stage in stages(needs) for group in stage if len(group) > 1]


def loop_of(system: System, needs: Mapping[Port, set[Port]], ports: tuple[Port, ...]) -> Loop:
    """Return the loop that a group of more than one port is."""
    assumed = []
    for component, name in ports:
        v = system.instances[component].variable(name)
        if v.causality == "output" and v.depends_on is None:
            assumed.append((component, name))
    return Loop(ports, _way_round(needs, ports), tuple(assumed))


def _strong(needs: Mapping[Port, set[Port]]) -> dict[Port, int]:
    """Return for each port the number of its strongly connected component."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    at = {port: i for i, port in enumerate(needs)}
    pairs = [(at[port], at[n]) for port, found in needs.items() for n in found]
    rows, columns = zip(*pairs, strict=True)
    graph = csr_array(([1] * len(pairs), (rows, columns)), shape=(len(at), len(at)))
    _, labels = connected_components(graph, directed=True, connection="strong")
    return {port: int(labels[i]) for port, i in at.items()}


def _way_round(needs: Mapping[Port, set[Port]], ports: tuple[Port, ...]) -> tuple[Port, ...]:
    """Return the shortest way from the first of the *ports* along the wires back to it."""
    first, inside = ports[0], set(ports)
    feeds: dict[Port, list[Port]] = {port: [] for port in ports}
    for port in ports:
        for n in needs[port]:
            if n in inside:
                feeds[n].append(port)
    came: dict[Port, Port] = {}
    queue = deque([first])
    while first not in came:
        port = queue.popleft()
        for after in feeds[port]:
            if after not in came:
                came[after] = port
                queue.append(after)
    way = [first, came[first]]
    while way[-1] != first:
        way.append(came[way[-1]])
    return tuple(reversed(way))
