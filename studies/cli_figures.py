"""``wmr-cosim figures``: the figures and tables of the thesis computed again, and a report on what they claim."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.table import Table

from .places import run_folder
from .terminal import complain, listing, out, plain, print_json, progress

if TYPE_CHECKING:
    from .figures.build import Outcome


def figures(
    keys: Annotated[
        list[str] | None,
        typer.Argument(help='Figures, as "thesis 4.5" or "shock paper 4", or parts, as "chapter 5"; default: all.'),
    ] = None,
    list_: Annotated[bool, typer.Option("--list", help="Say what there is, and make nothing.")] = False,
    table: Annotated[bool, typer.Option("--table", help="Print the verdicts, and write nothing.")] = False,
    out_: Annotated[Path | None, typer.Option("--out", help="Folder to write to; default logs/runs/figures.")] = None,
    jobs: Annotated[int, typer.Option(min=1, help="Processes to work in.")] = 2,
    json: Annotated[bool, typer.Option("--json", help="Print one JSON document instead of tables.")] = False,
) -> None:
    """Compute the figures and tables of the thesis and its papers again, and judge what is said about them.

    Writes a picture (PNG) and the data (CSV) of each, the Rerun logs of those that move, and index.html: a report with
    the printed and the derived values, what had to be assumed, and the verdicts.  Exit code 1 if one failed.

    Example: wmr-cosim figures "thesis 4.4" "chapter 5" --out figures
    """
    from .figures.build import build
    from .figures.register import chosen

    entries = chosen(keys or ())
    if list_:
        titles = {e.key: e.title for e in entries}
        print_json(titles) if json else out().print(listing("figures and tables", titles))
        return
    folder = None if table else run_folder(out_ or run_folder() / "figures")
    with progress(json) as bar:
        outcomes = build(entries, folder, min(jobs, max(1, len(entries))), bar)
    _say(outcomes, folder, json=json)
    failed = [o for o in outcomes if o.error]
    for outcome in failed:
        complain(f"{outcome.key}: {outcome.error}")
    if failed:
        raise typer.Exit(1)


def _say(outcomes: list[Outcome], folder: Path | None, *, json: bool) -> None:
    from .errata.pages import register_html
    from .figures.page import write_page
    from .figures.summary import sentence

    page = write_page(outcomes, folder, register_html()) if folder else None
    if json:
        print_json({"page": str(page or ""), "figures": {o.key: asdict(o) for o in outcomes}})
        return
    shown = Table("figure", "printed", "derived", "verdict", box=None, padding=(0, 1))
    for o in outcomes:
        for k, c in enumerate(o.claims):
            shown.add_row(plain(o.key) if k == 0 else "", plain(c.text), plain(c.found), c.verdict)
    out().print(shown)
    out().print(plain(sentence(outcomes)), soft_wrap=True)
    if page:
        out().print(f"wrote {plain(str(page))}", soft_wrap=True)
