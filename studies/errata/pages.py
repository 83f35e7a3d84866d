"""The register as Markdown and as a piece of HTML: formulas in LaTeX and in MathML, which browsers draw."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from latex2mathml.converter import convert

from . import CONFIRMED, REFERENCES, REGISTER
from .erratum import Erratum
from .notation import tree

_COLUMNS = ("Equation", "Kind", "Printed", "Right", "Shown by", "Consequence")


def markdown(entries: Sequence[Erratum] = REGISTER) -> str:
    """Return a table of the entries, formulas between dollar signs."""
    rows = [
        [f"{_cell(e.key)}{_also(e)}", e.kind, *(f"${_cell(form)}$" for form in e.latex), _cell(e.shown),
         _cell(e.consequence)]
        for e in entries
    ]  # fmt: skip
    return "\n".join(f"| {' | '.join(row)} |" for row in [_COLUMNS, ["---"] * len(_COLUMNS), *rows])


def register_html(entries: Sequence[Erratum] = REGISTER) -> str:
    """Return a section with the entries, what was found right and what only names something else."""
    head = "".join(f"<th>{name}</th>" for name in _COLUMNS)
    body = "\n".join(_row(e) for e in entries)
    right = ", ".join(escape(c.equation) for c in CONFIRMED)
    named = "\n".join(
        f"<tr><td>{escape(r.where)}</td><td>{escape(r.printed)}</td><td>{escape(r.meant)}</td></tr>" for r in REFERENCES
    )
    return f"""<section id="errata"><h2>Errors in print</h2>
<table><thead><tr>{head}</tr></thead><tbody>
{body}
</tbody></table>
<p>Derived again and found right: {right}.</p>
<table><thead><tr><th>Where</th><th>Printed</th><th>Meant</th></tr></thead><tbody>
{named}
</tbody></table></section>"""


def _row(entry: Erratum) -> str:
    cells = [
        f"<b>{escape(entry.key)}</b>{escape(_also(entry))}", escape(entry.kind),
        _math(entry, entry.printed, entry.latex.printed), _math(entry, entry.right, entry.latex.right),
        escape(entry.shown), escape(entry.consequence),
    ]  # fmt: skip
    return "<tr>" + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>"


def _math(entry: Erratum, form: str, tex: str) -> str:
    return escape(form) if tree(form) is None else convert(tex)


def _also(entry: Erratum) -> str:
    return f" (also {', '.join(entry.also)})" if entry.also else ""


def _cell(text: str) -> str:
    return text.replace("|", "\\vert " if "\\" in text else "\\|")
