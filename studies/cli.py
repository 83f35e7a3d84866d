"""The command line: ``wmr-cosim list | run | compare | inspect | logs | fmu``."""

from __future__ import annotations

import signal
import sys
from importlib.metadata import version
from pathlib import Path
from typing import Annotated, NoReturn

import typer

from cosim.errors import CosimError

from . import cli_fmu, cli_inspect, cli_logs, present
from .terminal import complain

app = typer.Typer(
    name="wmr-cosim",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
    help="""Co-simulate a four-wheeled mobile robot that crosses an obstacle, and set its controllers side by side.

    The robot is three plants (rigid body, wheel deformation, flexible chassis), each a real FMU, stepped by a master
    together with a controller.  Every step of every port goes into a Rerun file.

    **Start here**: wmr-cosim compare ramp-impact-realistic""",
)
ScenarioName = Annotated[str, typer.Argument(help="A scenario's name (see `wmr-cosim list`) or a TOML file.")]
Set = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        help="Change one value of the file, e.g. wheels.k_w=2e5, controller.period=2e-3, robot.m=200, "
        "ground.angle=0.2, run.fmi=2. Repeatable.",
    ),
]
Step = Annotated[float | None, typer.Option(help="Macro step in s, e.g. 1e-4.")]
Duration = Annotated[float | None, typer.Option(help="Simulated time in s.")]
Out = Annotated[Path | None, typer.Option(help="Folder for logs and pictures; default logs/runs, installed ./runs.")]
AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON document (SI units) instead of tables.")]


def _version(asked: bool) -> None:
    if asked:
        typer.echo(f"wmr-cosim {version('wmr-cosim')}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version and end.")
    ] = False,
) -> None:
    """Options of the command itself."""


@app.command("list")
def list_everything(json: AsJson = False) -> None:
    """Show the scenarios, components, controllers, robots and grounds that can be named, one line each.

    Example: wmr-cosim list
    """
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

    The log is SCENARIO-VARIANT.rrd in the folder --out; it replaces the one of an earlier run. Exit code 1 if the run
    did not reach its end: its log is kept up to there and says so.

    Example: wmr-cosim run ramp-impact --variant pd --set wheels.mu=0.6 --step 1e-4
    """
    from . import session

    if view and no_log:
        raise typer.BadParameter("--view needs the log that --no-log leaves out")
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
    report: Annotated[Path | None, typer.Option(help="Write an HTML report to this file.")] = None,
    view: Annotated[bool, typer.Option("--view", help="Open the Rerun viewer on the combined log.")] = False,
    no_log: Annotated[bool, typer.Option("--no-log", help="Write no Rerun files.")] = False,
    json: AsJson = False,
) -> None:
    """Run all variants on the same ground and put the verdicts in one table, the best of each row marked.

    Writes to the folder --out: SCENARIO-VARIANT.rrd for each, SCENARIO-all.rrd with all of them overlaid and their
    differences to the first (B - A), and the picture SCENARIO.png.

    Example: wmr-cosim compare ramp-impact-realistic --variants uncontrolled,pd --report report.html
    """
    from . import session

    if view and no_log:
        raise typer.BadParameter("--view needs the log that --no-log leaves out")
    names = tuple(filter(None, (v.strip() for v in variants.split(",")))) if variants else None
    changes = _changes(set_, step, duration)
    done = session.compare(scenario, names, changes, out, log=not no_log, report=report, quiet=json)
    present.show_comparison(done, json)
    shown = done.combined or next((r.log for r in done.runs if r.log), None)
    if view and shown:
        present.open_viewer(shown)
    _finish(done.runs)


app.command("inspect")(cli_inspect.inspect)
app.command("logs")(cli_logs.logs)
app.add_typer(cli_fmu.app, name="fmu")


def _changes(texts: list[str] | None, step: float | None, duration: float | None) -> list[str]:
    found = list(texts or [])
    found += [f"run.step={step!r}"] if step is not None else []
    found += [f"run.duration={duration!r}"] if duration is not None else []
    return found


def _finish(runs: list) -> None:
    failed = [r for r in runs if r.result.error is not None]
    for r in failed:
        kept = f"; the log up to there is {r.log}" if r.log else ""
        complain(f"{r.result.scenario.name} {r.result.scenario.variant}".strip() + f": {r.result.error}{kept}")
    if failed:
        raise typer.Exit(1)


class _Stopped(SystemExit):
    """A signal from outside.  It ends the command as an exception does, so that the log is closed and says so."""


def _stop(number: int, frame: object) -> NoReturn:
    raise _Stopped(128 + number)


def main() -> None:
    """Run the command line; a user's mistake ends with one sentence and exit code 1, never with a traceback."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, _stop)
    try:
        app()
    except CosimError as error:
        complain(str(error))
        sys.exit(1)
    except _Stopped:
        complain("stopped; a log that was begun holds what was computed up to here, and says so")
        raise


if __name__ == "__main__":
    main()
