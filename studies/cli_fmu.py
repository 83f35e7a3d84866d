"""``wmr-cosim fmu build | check | info``."""

from __future__ import annotations

import os
import shutil
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.table import Table

from cosim.errors import ExportError, nearest

from .terminal import out as console
from .terminal import plain, print_json, progress

app = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode="markdown",
    help="Build the components as FMUs, check any FMU, or say what one is.",
)
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
    """Build components of the catalog as FMI 2.0 and 3.0 co-simulation FMUs; nothing is rebuilt that did not change.

    Example: wmr-cosim fmu build RigidBody WheelDeformation --fmi 2 --out fmus-for-a-friend
    """
    import fmus

    from .catalog import COMPONENTS

    chosen = components or list(COMPONENTS)
    for name in chosen:
        if name not in COMPONENTS:
            raise ExportError(f"there is no component {name!r}; {nearest(name, COMPONENTS)}")
    wanted = tuple(fmus.PLATFORMS) if platforms == "all" else tuple(platforms.split(",")) if platforms else None
    rows = _built([(name, v) for name in chosen for v in ((fmi,) if fmi else (3, 2))], wanted, out, quiet=json)
    if json:
        print_json(rows)
        return
    shown = Table("component", "FMI", "kB", "file", box=None, padding=(0, 1), header_style="bold")
    for row in rows:
        shown.add_row(row["component"], f"{row['fmi']}.0", f"{row['bytes'] / 1e3:.0f}", plain(row["path"]))
    console().print(shown)


def _built(
    jobs: list[tuple[str, int]], platforms: tuple[str, ...] | None, out: Path | None, *, quiet: bool
) -> list[dict[str, Any]]:
    """Build each component and FMI version of *jobs*, copy them to *out* if it is given, and return what was built."""
    import fmus

    from .catalog import COMPONENTS
    from .places import run_folder

    folder = run_folder(out) if out is not None else None
    rows: list[dict[str, Any]] = []
    with progress(quiet) as bar:
        for done, (name, version) in enumerate(jobs):
            bar(f"building {name}, FMI {version}.0", done / len(jobs))
            path = fmus.build(COMPONENTS[name](), fmi=version, platforms=platforms)
            if folder is not None:
                path = Path(shutil.copy(path, folder / f"{name}.fmi{version}.fmu"))
            rows.append({"component": name, "fmi": version, "path": str(path), "bytes": path.stat().st_size})
    return rows


@app.command()
def check(
    files: Annotated[list[Path], typer.Argument(help="FMU files, anybody's.")],
    json: AsJson = False,
) -> None:
    """Check FMUs: description, archive, and a short run with rollback.  Exit code 1 if anything is wrong.

    Example: wmr-cosim fmu check mine.fmu yours.fmu
    """
    import fmus

    found: dict[str, list[str]] = {}
    with progress(json) as bar:
        for done, path in enumerate(files):
            bar(f"checking {path}", done / len(files))
            found[str(path)] = fmus.check(path, isolated=os.name == "posix" or None)
    if json:
        print_json(found)
    else:
        for file, problems in found.items():
            console().print(
                f"{plain(file)}: {f'{len(problems)} found' if problems else 'no problems found'}", soft_wrap=True
            )
            for problem in problems:
                console().print(f"  - {plain(problem)}", soft_wrap=True)
    if any(found.values()):
        raise typer.Exit(1)


@app.command()
def info(
    file: Annotated[Path, typer.Argument(help="An FMU file.")],
    json: AsJson = False,
) -> None:
    """Say what an FMU is: version, platforms, capabilities, every variable with unit, shape, start and meaning.

    Example: wmr-cosim fmu info "$(wmr-cosim fmu build WheelDeformation --fmi 3 --json | jq -r '.[0].path')"
    """
    import fmus

    facts = fmus.info(file)
    if json:
        print_json(facts)
        return
    for key, value in facts.items():
        if key != "variables":
            console().print(f"[bold]{key}[/bold]: {plain(_spelt(value))}", soft_wrap=True)
    shown = Table(box=None, padding=(0, 1), header_style="bold")
    for name in ("variable", "causality", "type", "shape", "unit", "start"):
        shown.add_column(name, no_wrap=True)
    shown.add_column("meaning")
    for v in facts["variables"]:
        start = "" if v["start"] is None else str(v["start"])
        shown.add_row(v["name"], v["causality"], v["type"], "x".join(map(str, v["shape"])), v["unit"] or "",
                      plain(start if len(start) < 24 else start[:20] + " ..."), plain(v["meaning"]))  # fmt: skip
    console().print(shown)


def _spelt(value: Any) -> str:
    if isinstance(value, dict):
        return ", ".join(k for k, has in value.items() if has) or "none"
    return ", ".join(map(str, value)) if isinstance(value, list) else str(value)
