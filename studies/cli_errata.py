"""``wmr-cosim errata``: what is wrong in print, what is right, and how that is shown."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated

import typer
from rich.table import Table

from cosim.errors import ScenarioError

from .terminal import note, out, plain, print_json, progress

if TYPE_CHECKING:
    from .errata import Erratum


def errata(
    equation: Annotated[
        str | None, typer.Argument(help="Show one equation in full, e.g. 4.44 or 'B phi'; default: all in one table.")
    ] = None,
    chapter: Annotated[str | None, typer.Option(help="Only those of a chapter: 3 to 8, A, B, C or papers.")] = None,
    check: Annotated[
        bool, typer.Option("--check", help="Derive every right form again and say whether it is confirmed.")
    ] = False,
    markdown: Annotated[bool, typer.Option("--markdown", help="Print a Markdown table, formulas in LaTeX.")] = False,
    json: Annotated[bool, typer.Option("--json", help="Print one JSON document, formulas as text and LaTeX.")] = False,
) -> None:
    """List the errors in the printed equations of the thesis and its papers, with the right forms that we use.

    --check derives each of them again from first principles, in some 15 s; exit code 1 if one is not confirmed.

    Example: wmr-cosim errata --chapter 6

    Example: wmr-cosim errata 4.54 --check
    """
    from .errata import REGISTER, find, of_chapter

    if equation and chapter:
        raise ScenarioError("errata shows one equation or one chapter: leave out --chapter or the equation")
    entries = find(equation) if equation else of_chapter(chapter) if chapter else list(REGISTER)
    if markdown:
        from .errata.pages import markdown as as_markdown

        print(as_markdown(entries))
        return
    shown = _checked(entries, json) if check else {}
    if json:
        print_json([_facts(e) | shown.get(e.key, {}) for e in entries])
    elif equation:
        for entry in entries:
            _in_full(entry, shown.get(entry.key))
    else:
        _table(entries, shown)
    refuted = [key for key, found in shown.items() if not found["confirmed"]]
    if refuted:
        note(f"not confirmed: {', '.join(refuted)}")
        raise typer.Exit(1)


def _checked(entries: Sequence[Erratum], quiet: bool) -> dict[str, dict]:
    found = {}
    with progress(quiet) as bar:
        for k, entry in enumerate(entries):
            bar(entry.key, k / len(entries))
            start = time.perf_counter()
            gap = entry.check()
            seconds = time.perf_counter() - start
            found[entry.key] = {
                "confirmed": gap.shown, "right_off": gap.right, "printed_off": gap.printed, "seconds": seconds,
            }  # fmt: skip
    return found


def _facts(entry: Erratum) -> dict:
    texts, tex = entry.text, entry.latex
    return {
        "equation": entry.key, "chapter": entry.chapter, "where": entry.where, "source": entry.source,
        "kind": entry.kind, "printed": texts[0], "right": texts[1], "printed_latex": tex.printed,
        "right_latex": tex.right, "shown": entry.shown, "consequence": entry.consequence, "also": entry.also,
    }  # fmt: skip


def _table(entries: Sequence[Erratum], shown: dict[str, dict]) -> None:
    from .errata import CONFIRMED, REFERENCES, RIGHT

    table = Table(box=None, padding=(0, 1), show_lines=False)
    for name, share in (("equation", 2), ("printed", 5), ("right", 5), ("consequence", 4)):
        table.add_column(name, ratio=share, overflow="fold")
    if shown:
        table.add_column("derived", no_wrap=True)
    for entry in entries:
        printed, right = entry.text
        cells = [plain(text) for text in (entry.key, printed, right, entry.consequence)]
        table.add_row(*cells, *([_verdict(shown[entry.key])] if shown else []))
    console = out()
    console.print(table)
    console.print(
        f"errors: {len(entries)}; {len(CONFIRMED)} equations derived likewise are right, and {len(REFERENCES)} "
        "references in print name another number. One in full, with how it is shown: wmr-cosim errata EQUATION"
    )
    if shown:
        found = sum(equation.gap() < RIGHT for equation in CONFIRMED)
        console.print(f"derived again: {found} of the {len(CONFIRMED)} are right")


def _verdict(found: dict) -> str:
    return "[green]confirmed[/green]" if found["confirmed"] else "[red]not confirmed[/red]"


def _in_full(entry: Erratum, found: dict | None) -> None:
    printed, right = entry.text
    lines = {
        "where": f"{entry.source}, section {entry.where}" if entry.where[0].isdigit() else f"{entry.source}, "
        "{entry.where}",
        "kind": entry.kind, "printed": printed, "right": right, "shown by": entry.shown,
        "consequence": entry.consequence, "also in": ", ".join(entry.also),
    }  # fmt: skip
    if found:
        lines["derived"] = (
            f"{'confirmed' if found['confirmed'] else 'NOT confirmed'}: the right form is off by "
            f"{found['right_off']:.1g}, the printed one by {found['printed_off']:.2g} of what is derived"
        )
    table = Table(title=plain(entry.key), title_justify="left", title_style="bold", show_header=False, box=None)
    table.add_column(no_wrap=True)
    table.add_column()
    for name, text in lines.items():
        if text:
            table.add_row(name, plain(text))
    out().print(table)
