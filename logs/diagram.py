"""The system as a block diagram: components in the order they step, what flows between them, in which unit, how late.

Wires with the same ends and the same delay are one bundle; a bundle is a node of the graph that lists its ports.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import rerun as rr

from cosim.algorithms import Algorithm
from cosim.system import System

from .drawing import Drawing
from .style import Colour

BLOCK, NOW, LATE = (31, 120, 209), (42, 157, 74), (240, 128, 32)
LISTED = 7  # ports of a bundle; the table has them all
APART, BETWEEN = 300.0, 175.0  # px between blocks, and from a block to a bundle across
Bundle = dict[tuple[str, str, int], list[str]]


class Diagram(Drawing):
    """Draws the wires of a system as *algorithm* couples it: ``/diagram`` a graph, ``/wires`` a table."""

    def __init__(self, algorithm: Algorithm) -> None:
        self.algorithm = algorithm

    def started(self, recording: Any, system: System) -> None:
        """Draw it; it does not change."""
        order, delays = self.algorithm.sequence(system), system.delays(self.algorithm)
        bundles: Bundle = {}
        rows = ["| from | to | unit | late |", "| --- | --- | --- | --- |"]
        for c in system.connections:
            late, unit = delays[c.target.port], c.source.variable.unit or "1"
            ends = (c.source.component, c.target.component, late)
            text = f"{c.target.port.partition('.')[2]} [{unit}]"
            bundles.setdefault(ends, []).append(text)
            rows.append(f"| {c.source.port} | {c.target.port} | {unit} | {late} |")
        table = "\n".join(["Late by 0 steps: the newest value; by 1: the one of the start of the step.", "", *rows])
        recording.log("wires", rr.TextDocument(table, media_type="text/markdown"), static=True)
        recording.log("diagram", *graph(order, bundles), static=True)


def graph(order: tuple[str, ...], bundles: Bundle) -> tuple[rr.GraphNodes, rr.GraphEdges]:
    """Return the blocks in a column, in the *order* they step; bundles to the right are new, those to the left late."""
    names: list[str] = list(order)
    places = [np.array([0.0, APART / 2 * i]) for i in range(len(order))]
    labels = [f"{i + 1}. {name}" for i, name in enumerate(order)]
    colours: list[Colour] = [BLOCK] * len(order)
    edges: list[tuple[str, str]] = []
    for number, ((source, target, late), ports) in enumerate(bundles.items()):
        node = f"{source} to {target} {late}"
        i, j = order.index(source), order.index(target)
        side = (-1 if late else 1) * (abs(i - j))
        shown = ports if len(ports) <= LISTED + 1 else [*ports[:LISTED], f"and {len(ports) - LISTED} more"]
        delay = f"{late} step late:" if late else "no delay:"
        names.append(node)
        places.append(np.array([side * BETWEEN, APART / 4 * (i + j) + 8 * (number % 2)]))
        labels.append("\n".join([delay, *shown]))
        colours.append(LATE if late else NOW)
        edges += [(source, node), (node, target)]
    nodes = rr.GraphNodes(names, positions=places, labels=labels, colors=colours, show_labels=True)
    return nodes, rr.GraphEdges(edges, graph_type="directed")
