"""The command line: ``wmr-cosim list | run | compare | inspect | fmu``."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from cosim.errors import CosimError

from . import cli_fmu, cli_inspect, present

app = typer.Typer(
    name="wmr-cosim",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
    help="""Co-simulate a four-wheeled mobile robot that crosses an obstacle, and set its controllers side by side.

    The robot is three plants (rigid body, wheel deformation, flexible chassis), each a real FMU, stepped by a master
    together with a controller.  Every step of every port goes into a Rerun file.

    [bold]Start here[/bold]: wmr-cosim compare ramp-impact-realistic""",
)
app.add_typer(cli_fmu.app, name="fmu")
app.command("inspect")(cli_inspect.inspect)

ScenarioName = Annotated[
    str, typer.Argument(help="A scenario's name (see [bold]wmr-cosim list[/bold]) or a TOML file.")
]
Set = Annotated[
    list[str] | None,
    typer.Option("--set", help="Change one value, e.g. wheels.k_w=2e5, controller.h0=900, robot.m=200. Repeatable."),
]
Step = Annotated[float | None, typer.Option(help="Macro step in s, e.g. 1e-4.")]
Duration = Annotated[float | None, typer.Option(help="Simulated time in s.")]
Out = Annotated[Path | None, typer.Option(help="Folder for logs and pictures; default logs/runs, installed ./runs.")]
AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON document (SI units) instead of tables.")]


@app.command("list")
def list_everything(json: AsJson = False) -> None:
    """Show the scenarios, components, controllers, robots and grounds that can be named, one line each."""
    present.show_catalog(json)


@app.command()
def run(
    scenario: ScenarioName,
    variant: Annotated[str | None, typer.Option(help="Which variant; default: the first of the file.")] = None,
    set_: Set = None,
    step: Step = None,
    duration: Duration = None,
    out: Out = None,
    view: Annotated[
        bool, typer.Option("--view", help="Open the Rerun viewer on the log when the run is done.")
    ] = False,
    no_log: Annotated[bool, typer.Option("--no-log", help="Write no Rerun file.")] = False,
    json: AsJson = False,
) -> None:
    """Run one variant of a scenario, log every step of every port to a Rerun file, and print the verdict.

    Example: wmr-cosim run ramp-impact --variant pd --set wheels.mu=0.6 --step 1e-4
    """
    from . import session

    done = session.run_one(scenario, variant, _changes(set_, step, duration), out, log=not no_log, quiet=json)
    present.show_run(done, json)
    if view and done.log:
        present.open_viewer(done.log)
    _finish([done])


@app.command()
def compare(
    scenario: ScenarioName,
    variants: Annotated[str | None, typer.Option(help="Comma-separated variants; default: all of the file.")] = None,
    set_: Set = None,
    step: Step = None,
    duration: Duration = None,
    out: Out = None,
    view: Annotated[bool, typer.Option("--view", help="Open the Rerun viewer on the combined log.")] = False,
    no_log: Annotated[bool, typer.Option("--no-log", help="Write no Rerun files.")] = False,
    json: AsJson = False,
) -> None:
    """Run all variants on the same ground and put the verdicts in one table, the best of each row marked.

    Writes one Rerun file per variant, one with all of them overlaid and their differences, and a picture.

    Example: wmr-cosim compare ramp-impact-realistic --variants uncontrolled,pd
    """
    from . import session

    names = tuple(v.strip() for v in variants.split(",")) if variants else None
    done = session.compare(scenario, names, _changes(set_, step, duration), out, log=not no_log, quiet=json)
    present.show_comparison(done, json)
    if view and done.combined:
        present.open_viewer(done.combined)
    _finish(done.runs)


def _changes(texts: list[str] | None, step: float | None, duration: float | None) -> list[str]:
    found = list(texts or [])
    found += [f"run.step={step!r}"] if step is not None else []
    found += [f"run.duration={duration!r}"] if duration is not None else []
    return found


def _finish(runs: list) -> None:
    failed = [r for r in runs if r.result.error is not None]
    for r in failed:
        kept = f"; the log up to there is {r.log}" if r.log else ""
        present.complain(f"{r.result.scenario.name} {r.result.scenario.variant}: {r.result.error}{kept}")
    if failed:
        raise typer.Exit(1)


def main() -> None:
    """Run the command line; a user's mistake ends with one sentence and exit code 1, never with a traceback."""
    try:
        app()
    except CosimError as error:
        present.complain(str(error))
        sys.exit(1)
    except KeyboardInterrupt:
        present.complain("interrupted; what was logged up to here is kept")
        sys.exit(130)


if __name__ == "__main__":
    main()
