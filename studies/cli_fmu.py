"""``wmr-cosim fmu build | check | info``."""

from __future__ import annotations

import json as jsonlib
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.table import Table

from cosim.errors import ExportError, nearest

app = typer.Typer(no_args_is_help=True, help="Build the components as FMUs, check any FMU, or say what one is.")
AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON document instead of tables.")]


@app.command()
def build(
    components: Annotated[
        list[str] | None, typer.Argument(help="Components to build; default: all of the catalog.")
    ] = None,
    fmi: Annotated[int | None, typer.Option(help="FMI version, 2 or 3; default: both.", min=2, max=3)] = None,
    platforms: Annotated[
        str | None,
        typer.Option(
            help="Comma-separated platforms, or 'all' for Linux x86_64 and aarch64, Windows and macOS (needs ziglang)."
        ),
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Copy the FMUs to this folder.")] = None,
    json: AsJson = False,
) -> None:
    """Build components of the catalog as FMI 2.0 and 3.0 co-simulation FMUs; nothing is rebuilt that did not change."""
    import shutil

    import fmus

    from .catalog import COMPONENTS
    from .places import run_folder

    chosen = components or list(COMPONENTS)
    wanted = tuple(fmus.PLATFORMS) if platforms == "all" else tuple(platforms.split(",")) if platforms else None
    rows: list[dict[str, Any]] = []
    for name in chosen:
        if name not in COMPONENTS:
            raise ExportError(f"there is no component {name!r}; {nearest(name, COMPONENTS)}")
        for version in (fmi,) if fmi else (3, 2):
            path = fmus.build(COMPONENTS[name](), fmi=version, platforms=wanted)
            if out is not None:
                path = Path(shutil.copy(path, run_folder(out) / f"{name}.fmi{version}.fmu"))
            rows.append({"component": name, "fmi": version, "path": str(path), "bytes": path.stat().st_size})
    if json:
        print(jsonlib.dumps(rows))
        return
    shown = Table("component", "FMI", "kB", "file")
    for row in rows:
        shown.add_row(row["component"], f"{row['fmi']}.0", f"{row['bytes'] / 1e3:.0f}", row["path"])
    Console().print(shown)


@app.command()
def check(
    files: Annotated[list[Path], typer.Argument(help="FMU files, anybody's.")],
    json: AsJson = False,
) -> None:
    """Check FMUs: description, archive, and a short run with rollback.  Exit code 1 if anything is wrong."""
    import fmus

    found = {str(path): fmus.check(path) for path in files}
    if json:
        print(jsonlib.dumps(found))
    else:
        for path, problems in found.items():
            Console().print(f"{path}: {'no problems found' if not problems else ''}", highlight=False)
            for problem in problems:
                Console().print(f"  - {problem}", highlight=False)
    if any(found.values()):
        raise typer.Exit(1)


@app.command()
def info(
    file: Annotated[Path, typer.Argument(help="An FMU file.")],
    json: AsJson = False,
) -> None:
    """Say what an FMU is: version, platforms, capabilities, every variable with unit, shape, start and meaning."""
    import fmus

    facts = fmus.info(file)
    if json:
        print(jsonlib.dumps(facts, default=str))
        return
    console = Console()
    for key, value in facts.items():
        if key != "variables":
            console.print(f"[bold]{key}[/bold]: {value}", highlight=False)
    shown = Table("variable", "causality", "type", "shape", "unit", "start", "meaning")
    for v in facts["variables"]:
        start = "" if v["start"] is None else str(v["start"])
        shown.add_row(v["name"], v["causality"], v["type"], "x".join(map(str, v["shape"])), v["unit"] or "",
                      start if len(start) < 24 else start[:20] + " ...", v["meaning"])  # fmt: skip
    console.print(shown)
