"""``wmr-cosim explain``: how a coupled system will be run, and why, before it runs."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from rich.console import Console
from rich.table import Table

from cosim.errors import ScenarioError

from .terminal import listing, out, plain, print_json, progress

WIDEST = 100  # columns: a page, a mail and a narrow terminal hold as many
ABILITIES = {  # heading: key of the facts, what it is for
    "go back": ("rollback", "take a step back and make it again: events located, iteration, step control"),
    "to bytes": ("serialize", "its state can be stored and read back, in another process, too"),
    "early return": ("early_return", "a step may end at an event inside it"),
    "event mode": ("event_mode", "events are handled between steps; discrete ports change there"),
    "deriv.": ("directional_derivatives", "exact derivatives: Newton on loops, linearisation"),
    "any step": ("variable_step", "steps of varying length: the last one, those that end at events"),
    "set, get": ("get_after_set", "outputs follow new inputs without a step: loops at communication points"),
    "input deriv.": ("input_derivatives", "highest order of input derivatives it takes: smoother inputs inside a step"),
    "reset": ("reset", "can start anew without being loaded again; tried before it is relied on"),
}


def explain(
    what: Annotated[list[str], typer.Argument(help="A scenario's name, a TOML file, or one or more FMU files.")],
    variant: Annotated[str | None, typer.Option(help="Which variant; default: the first of the file.")] = None,
    set_: Annotated[
        list[str] | None, typer.Option("--set", help="Change one value of the file, as in run. Repeatable.")
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON document (SI units) instead of tables.")
    ] = False,
) -> None:
    """Say how a system will be run: the order of stepping, the delay and unit of each connection, loops, capabilities.

    Nothing is stepped.  For FMU files: what each can do, and which of its inputs reach which outputs at once.

    Example: wmr-cosim explain ramp-impact --variant pd --set run.algorithm=jacobi

    Example: wmr-cosim explain mine.fmu yours.fmu
    """
    from . import explanation

    files = [Path(name) for name in what if name.endswith(".fmu")]
    if len(what) > 1 and len(files) < len(what):
        raise ScenarioError(f"explain takes one scenario, or FMU files only, not {', '.join(what)}")
    if files and (variant or set_):
        raise ScenarioError("FMU files have no variants and no values to set; leave out --variant and --set")
    with progress(as_json) as bar:
        bar("loading the FMUs")
        facts = explanation.file_facts(files) if files else explanation.scenario_facts(what[0], variant, set_ or ())
    if as_json:
        print_json(facts)
    elif files:
        show_components(_console(), facts["components"])
        show_feedthrough(_console(), facts["components"])
    else:
        show_system(_console(), facts)


def _console() -> Console:
    console = out()
    console.width = min(console.width, WIDEST)
    return console


def show_system(console: Console, facts: dict[str, Any]) -> None:
    """Print all there is to know about a scenario."""
    variant = f"  variant {facts['variant']}" if facts["variant"] else ""
    console.print(f"[bold]{plain(facts['title'])}[/bold]{plain(variant)}")
    for text in facts["notes"]:
        console.print(f"note: {plain(text)}")
    show_order(console, facts)
    show_connections(console, facts)
    show_loops(console, facts["loops"])
    show_unconnected(console, facts["unconnected"])
    show_components(console, facts["components"])
    show_allowed(console, facts["allows"])


def show_order(console: Console, facts: dict[str, Any]) -> None:
    """Print who steps when, and on whose values."""
    how = f"{facts['algorithm']}, macro steps of {_time(facts['step'])} for {facts['duration']:g} s."
    _title(console, "Order", f"{how} In each macro step the components step in this order, each on values that are new "
           "(at the end of the step already) or old (from its beginning).")  # fmt: skip
    table = _table("", "component", "is", "step", "sampled", "steps on the values of",
                   kept=("component", "is", "step", "sampled"))  # fmt: skip
    for i, c in enumerate(facts["order"], 1):
        sampled = _time(c["period"]) if c["period"] is not None else "-"
        sources = [f"{n} (new)" for n in c["steps_on_new"]] + [f"{n} (old)" for n in c["steps_on_old"]]
        table.add_row(str(i), plain(c["component"]), c["is"], _time(c["step"]), sampled, _names(sources))
    console.print(table)
    circular = {name for loop in facts["loops"] for name in loop["components"]}
    for c in facts["order"]:
        name = plain(c["component"])
        if c["period"] is not None and c["period"] != c["step"]:
            console.print(f"{name} acts at the multiples of its period of {_time(c['period'])}, not at every step.")
        if c["late"]:
            cure = "Set" if c["component"] in circular else "Let it step behind, or set"
            console.print(
                f"{name} shows at once what comes from {_names(c['late'])}, but does not see it before the next step: "
                f"these outputs are a step late. {cure} run.solve_loops = true."
            )


def show_connections(console: Console, facts: dict[str, Any]) -> None:
    """Print every connection with its unit and how old its values are."""
    _title(console, "Connections", "Over its step a target holds one value of its source: the one that the source has "
           "at the end of the step (delay none) or at its beginning (delay 1 step).")  # fmt: skip
    found = facts["connections"]
    converted = any(_conversion(c) for c in found)
    held = any(c["held"] > 1 for c in found)
    table = _table("source", "target", "unit", "values", "delay", *["conversion"] * converted, *["held"] * held,
                   kept=("unit", "delay"))  # fmt: skip
    for c in found:
        delay = f"{c['delay']} step ({_time(c['delay_s'])})" if c["delay"] else "none"
        more = [_conversion(c)] * converted + [f"{c['held']} steps" if c["held"] > 1 else ""] * held
        table.add_row(plain(c["source"]), plain(c["target"]), plain(_unit(c["unit"])), str(c["values"]), delay, *more)
    console.print(table)


def show_loops(console: Console, loops: list[dict[str, Any]]) -> None:
    """Print the algebraic loops, and how they are handled."""
    _title(
        console, "Algebraic loops", "Outputs that inputs reach at once, in a circle: values that must be solved for."
    )
    if not loops:
        console.print("None: each value follows from what is known before it.")
    for loop in loops:
        console.print(plain(" -> ".join(loop["path"])))
        more = [p for p in loop["ports"] if p not in loop["path"]]
        entries = {"with": ", ".join(more)} if more else {}
        if loop["assumed"]:
            entries["assumed"] = f"{', '.join(loop['assumed'])} declare no dependencies, so all inputs count"
        entries |= {
            "equations": str(loop["equations"]), "at the start": loop["at_start"], "at each point": loop["at_points"],
        }  # fmt: skip
        console.print(listing("", entries))


def show_unconnected(console: Console, inputs: list[dict[str, Any]]) -> None:
    """Print the inputs that nobody drives."""
    _title(console, "Unconnected inputs", "They keep their start values." if inputs else "None.")
    if not inputs:
        return
    table = _table("input", "value", "unit", "meaning", kept=("input", "unit"))
    for i in inputs:
        table.add_row(plain(i["port"]), _value(i["value"]), plain(_unit(i["unit"])), plain(i["meaning"]))
    console.print(table)


def show_components(console: Console, components: dict[str, dict[str, Any]]) -> None:
    """Print what each component declares it can do."""
    _title(console, "Capabilities", "What each component declares it can do.")
    table = _table("component", "kind", *ABILITIES, kept=("component", "kind"))
    for name, facts in components.items():
        table.add_row(
            plain(name), facts["kind"].removesuffix(" FMU"), *(_able(facts[key]) for key, _ in ABILITIES.values())
        )
    console.print(table)
    console.print()
    console.print(listing("", {heading: text for heading, (_, text) in ABILITIES.items()}))


def show_feedthrough(console: Console, components: dict[str, dict[str, Any]]) -> None:
    """Print which inputs reach which outputs at once."""
    _title(console, "Direct feedthrough", "Outputs that an input reaches at once, without a step.")
    table = _table("output", "reached by")
    for name, facts in components.items():
        for port, found in facts["feeds_through"].items():
            table.add_row(plain(f"{name}.{port}"), plain(", ".join(found)))
        if not facts["dependencies_declared"]:
            console.print(f"{plain(name)} declares no dependencies for some outputs: all inputs count for these.")
    console.print(table if table.row_count else "None: every output comes from a state.")


def show_allowed(console: Console, allowed: list[dict[str, Any]]) -> None:
    """Print what the capabilities allow the whole system to do."""
    _title(console, "What that allows", "A system can do what all who are concerned can do.")
    table = _table("", "what", "why")
    for a in allowed:
        table.add_row("yes" if a["possible"] else "no", plain(a["what"]), plain(a["why"]))
    console.print(table)


def _title(console: Console, title: str, sentence: str) -> None:
    console.print(f"\n[bold]{title}[/bold]")
    console.print(plain(sentence))


def _table(*headings: str, kept: Sequence[str] = ()) -> Table:
    """Return an empty table; the columns *kept* are never broken into lines."""
    table = Table(box=None, padding=(0, 1), header_style="bold", pad_edge=False)
    for heading in headings:
        word = max(map(len, heading.split()), default=3)
        table.add_column(heading, no_wrap=heading in kept, overflow="fold", min_width=word,
                         justify="right" if heading == "values" else "left")  # fmt: skip
    return table


def _names(names: Sequence[str]) -> str:
    return plain(", ".join(names)) or "-"


def _able(ability: bool | int) -> str:
    if isinstance(ability, bool):
        return "yes" if ability else "-"
    return f"order {ability}" if ability else "-"


def _time(seconds: float) -> str:
    for factor, unit in ((1.0, "s"), (1e3, "ms"), (1e6, "us")):
        if seconds * factor >= 1:
            return f"{seconds * factor:g} {unit}"
    return f"{seconds * 1e9:g} ns"


def _unit(unit: str | None) -> str:
    return unit if unit is not None else "none"


def _conversion(c: dict[str, Any]) -> str:
    scaled = f"x {c['factor']:.6g}" if c["factor"] != 1 else ""
    shifted = f"{scaled} {c['offset']:+.6g}".strip() if c["offset"] else scaled
    return f"{shifted} -> {c['target_unit']}" if shifted and c["target_unit"] != c["unit"] else shifted


def _value(value: Any) -> str:
    try:
        array = np.asarray(value, float)
    except (TypeError, ValueError):
        return plain(str(value))
    if array.size and np.all(array == array.flat[0]):
        return f"{array.flat[0]:g}" + (f" ({array.size} times)" if array.size > 1 else "")
    return plain(f"{array.tolist()}") if array.size <= 4 else f"{array.size} values"
