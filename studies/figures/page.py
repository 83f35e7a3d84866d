"""The report on all figures as one HTML page, which lies beside the pictures, data and logs it shows."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.resources import files
from itertools import groupby
from pathlib import Path

import jinja2

from cosim.errors import ScenarioError

from . import summary
from .build import Outcome
from .parts import PARTS

PAGE = "index.html"


def write_page(outcomes: Sequence[Outcome], folder: Path, errata: str = "") -> Path:
    """Write the page on *outcomes* and return its path.

    *errata* is the section on the errors in print, as HTML.  Raises ScenarioError if the file cannot be written.
    """
    environment = jinja2.Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True)
    template = environment.from_string(files("studies.figures").joinpath("page.html.j2").read_text(encoding="utf-8"))
    text = template.render(
        sentence=summary.sentence(outcomes),
        verdicts=summary.VERDICTS,
        rows=summary.by_part(outcomes),
        listed=[(v, summary.with_verdict(outcomes, v)) for v in summary.VERDICTS],
        grouped=[(part, list(found)) for part, found in groupby(outcomes, key=lambda o: o.part)],
        parts=PARTS,
        errata=errata,
    )
    path = folder / PAGE
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise ScenarioError(f"cannot write the page {path}: {error.strerror}") from None
    return path
