"""How components and systems show themselves in a notebook: a title, sentences and tables as HTML.

Jupyter asks the last object of a cell for ``_repr_html_``; each of ours returns what a function here or, for results,
in ``studies.show`` makes.  `html` is the only place that knows what a page looks like.
"""

from __future__ import annotations

import inspect
from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np

from .algorithms import Algorithm, GaussSeidel
from .instance import Capabilities

if TYPE_CHECKING:
    from .component import Component
    from .declaration import Declaration
    from .system import System

ROLES = ("structural", "parameter", "table", "input", "state", "output", "event")  # the order of a component's table
FEW = 4  # numbers that are shown one by one

_PAGE = """\
<div>
<b>{{ title }}</b>
{% for sentence in sentences %}
<br>{{ sentence }}
{% endfor %}
{% for grid in grids if grid.rows %}
<table style="margin: .5em 0; font-variant-numeric: tabular-nums">
{% if grid.caption %}
<caption style="text-align: left; white-space: nowrap">{{ grid.caption }}</caption>
{% endif %}
<thead><tr>
{% for name in grid.head %}
<th style="text-align: {{ grid.side(loop.index0) }}">{{ name }}</th>
{% endfor %}
</tr></thead>
<tbody>
{% for row in grid.rows %}
{% set i = loop.index0 %}
<tr>
{% for cell in row %}
<td style="text-align: {{ grid.side(loop.index0) }}">{% if (i, loop.index0) in grid.bold %}<b>{{ cell }}</b>
{% else %}{{ cell }}{% endif %}</td>
{% endfor %}
</tr>
{% endfor %}
</tbody>
</table>
{% endfor %}
{% if picture %}
<img alt="picture" style="max-width: 100%" src="data:image/png;base64,{{ picture }}">
{% endif %}
</div>
"""


@dataclass(frozen=True)
class Grid:
    """A table of texts: its head, its rows, which columns hold numbers, and which cells (row, column) are bold."""

    head: Sequence[str]
    rows: Sequence[Sequence[str]]
    caption: str = ""
    numbers: frozenset[int] = frozenset()
    bold: frozenset[tuple[int, int]] = frozenset()

    def side(self, column: int) -> str:
        """Return where the texts of a column stand: numbers on the right."""
        return "right" if column in self.numbers else "left"


def html(title: str, sentences: Sequence[str], grids: Sequence[Grid], picture: str = "") -> str:
    """Return HTML that needs nothing else: texts are escaped, *picture* is a PNG in base 64; empty tables are left out.

    It sets no colours, so that it can be read on light and on dark pages.
    """
    import jinja2  # only who shows something needs it

    template = jinja2.Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True).from_string(_PAGE)
    return template.render(title=title, sentences=sentences, grids=grids, picture=picture)


def component_html(component: Component) -> str:
    """Return what a component is: the first line of its docstring, and everything it declares, values as they are."""
    declared = [d for role in ROLES for d in component.declared(role).values()]
    rows = [
        (d.role, d.name, _shape(component, d), _unit(component, d), _start(component, d), _meaning(d)) for d in declared
    ]
    changed = {(i, 4) for i, d in enumerate(declared) if _changed(component, d)}
    sentences = [(inspect.getdoc(type(component)) or "").split("\n")[0]]
    if "period" in component.values:
        sentences.append(f"Sampled every {float(component.values['period']):g} s.")
    head = ("role", "name", "shape", "unit", "start", "meaning")
    caption = "bold: not the default" if changed else ""
    return html(type(component).__name__, sentences, [Grid(head, rows, caption, bold=frozenset(changed))])


def _shape(component: Component, d: Declaration) -> str:
    if d.role == "table":
        return " × ".join(map(str, component.values[d.name].shape))
    return " × ".join(map(str, component.shape_of(d)))


def _unit(component: Component, d: Declaration) -> str:
    return "" if d.role in ("structural", "table", "event") else component.unit_of(d)


def _meaning(d: Declaration) -> str:
    return d.meaning + (f" (one of {', '.join(d.choices)})" if d.choices else "")


def _changed(component: Component, d: Declaration) -> bool:
    if d.role == "structural":
        return component.structure[d.name] != d.start
    if d.name not in component.values:
        return False
    value, default = component.values[d.name], np.asarray(d.start, float)
    return not np.array_equal(value, default if d.role == "table" else np.broadcast_to(default, value.shape))


def _start(component: Component, d: Declaration) -> str:
    """Return the value at the start, of parameters the one they have; a range for many."""
    if d.role == "structural":
        return str(component.structure[d.name])
    if d.role in ("output", "event"):
        return ""
    return brief(component.values.get(d.name, d.start))


def brief(value: Any) -> str:
    """Return a number, a few numbers, or of many how many there are and between what they lie."""
    array = np.asarray(value, float)
    if not array.size:
        return "none"
    low, high = f"{array.min():.6g}", f"{array.max():.6g}"
    if low == high:
        return low
    if array.size <= FEW:
        return "[" + ", ".join(f"{v:.6g}" for v in array.ravel()) + "]"
    return f"{array.size} from {low} to {high}"


def system_html(system: System, algorithm: Algorithm | None = None) -> str:
    """Return who is in a system and can do what, what is connected, and how late values are under *algorithm*.

    Without one: Gauss-Seidel in the order of the components.
    """
    algorithm = algorithm or GaussSeidel()
    delays = system.delays(algorithm)
    abilities = [f.name for f in fields(Capabilities)]
    instances = [
        (name, type(instance).__name__, str(system.every[name]),
         *("yes" if getattr(instance.can, ability) else "-" for ability in abilities))
        for name, instance in system.instances.items()
    ]  # fmt: skip
    wires = [
        (c.source.port, c.target.port, c.source.variable.unit or "", str(delays[c.target.port]),
         _conversion(c.factor, c.offset))
        for c in system.connections
    ]  # fmt: skip
    idle = f"Unconnected inputs, at their start values: {', '.join(system.unconnected)}." if system.unconnected else ""
    order = ", ".join(algorithm.sequence(system))
    return html(
        f"System of {len(instances)} components and {len(wires)} connections",
        [f"{type(algorithm).__name__} steps them in the order {order}.", *([idle] if idle else [])],
        [
            Grid(("component", "is", "steps every", *(a.replace("_", " ") for a in abilities)), instances),
            Grid(("source", "target", "unit", "delay in steps", "conversion"), wires, numbers=frozenset({3})),
        ],
    )


def _conversion(factor: float, offset: float) -> str:
    scaled = f"× {factor:.6g}" if factor != 1 else ""
    return f"{scaled} {offset:+.6g}".strip() if offset else scaled
