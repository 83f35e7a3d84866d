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
    """Return a section with the entries, what was found right and what only names something else; without scripts."""
    body = "\n".join(_row(e) for e in entries)
    right = ", ".join(escape(c.equation) for c in CONFIRMED)
    named = "\n".join(
        f"<tr><td>{escape(r.where)}</td><td>{escape(r.printed)}</td><td>{escape(r.meant)}</td></tr>" for r in REFERENCES
    )
    return f"""<section id="errata"><h2>Errors in print</h2>
<table><thead><tr><th>Equation</th><th>Printed, and right</th><th>Shown by, and consequence</th></tr></thead><tbody>
{body}
</tbody></table>
<p>Derived again and found right: {right}.</p>
<table><thead><tr><th>Where</th><th>Printed</th><th>Meant</th></tr></thead><tbody>
{named}
</tbody></table></section>"""


def _row(entry: Erratum) -> str:
    cells = (
        [f"<b>{escape(entry.key)}</b> {entry.kind}", escape(_also(entry).strip())],
        [_math(entry.printed, entry.latex.printed), _math(entry.right, entry.latex.right)],
        [escape(entry.shown), f"<i>{escape(entry.consequence)}</i>"],
    )
    return "<tr>" + "".join("<td>" + "".join(f"<p>{part}</p>" for part in cell) + "</td>" for cell in cells) + "</tr>"


def _math(form: str, tex: str) -> str:
    """Return a form as MathML with fractions in full size; words as they are."""
    return escape(form) if tree(form) is None else convert(tex).replace("<math ", '<math displaystyle="true" ', 1)


def _also(entry: Erratum) -> str:
    return f" (also {', '.join(entry.also)})" if entry.also else ""


def _cell(text: str) -> str:
    return text.replace("|", "\\vert " if "\\" in text else "\\|")
