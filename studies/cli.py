"""The command line: ``wmr-cosim list | run | compare | explain | inspect | logs | figures | errata | fmu``."""

from __future__ import annotations

import atexit
import gc
import signal
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from importlib.metadata import version
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, NoReturn

import typer

from cosim.errors import CosimError, ScenarioError

from . import cli_errata, cli_explain, cli_figures, cli_fmu, cli_inspect, cli_logs, present
from .terminal import complain, note

if TYPE_CHECKING:
    from logs.live import Viewer

    from .session import Done

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
Serve = Annotated[
    bool, typer.Option("--serve", help="The same in a browser: serve a web viewer to this machine, until Ctrl-C.")
]
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
    view: Annotated[bool, typer.Option("--view", help="Open the Rerun viewer and watch the run as it goes.")] = False,
    serve: Serve = False,
    pace: Annotated[
        float | None, typer.Option(help="Go no faster than so many times real time, e.g. 1.0, or 0.1 for an impact.")
    ] = None,
    no_log: Annotated[bool, typer.Option("--no-log", help="Write no Rerun file.")] = False,
    json: AsJson = False,
) -> None:
    """Run one variant of a scenario, log every step of every port to a Rerun file, and print the verdict.

    The log is SCENARIO-VARIANT.rrd in the folder --out; it replaces the one of an earlier run. Exit code 1 if the run
    did not reach its end: its log is kept up to there and says so.  With --view or --serve a viewer shows the run while
    it goes, beside the log; nobody but this machine can connect to it.

    Example: wmr-cosim run ramp-impact --variant pd --set wheels.mu=0.6 --step 1e-4
    """
    from . import session

    if pace is not None and pace <= 0:
        raise typer.BadParameter(f"--pace must be above 0, not {pace:g}")
    changes = _changes(set_, step, duration)
    if view or serve or not no_log:
        _prepare_logging()
    with _viewer(view=view, serve=serve) as shown:
        done = session.run_one(
            scenario, variant, changes, out, log=not no_log, quiet=json, viewer=shown.url if shown else "", pace=pace
        )
        present.show_run(done, json)
    _finish([done])


@app.command()
def compare(
    scenario: Annotated[
        list[str], typer.Argument(help="A scenario's name or a TOML file; with --logs the logs of two runs or more.")
    ],
    logs: Annotated[
        bool, typer.Option("--logs", help="Run nothing: compare the runs of old logs, as they are.")
    ] = False,
    baseline: Annotated[
        str | None, typer.Option(help="The variant that differences are taken to; default: the first.")
    ] = None,
    variants: Annotated[str | None, typer.Option(help="Comma-separated variants; default: all of the file.")] = None,
    set_: Set = None,
    step: Step = None,
    duration: Duration = None,
    out: Out = None,
    report: Annotated[Path | None, typer.Option(help="Write an HTML report to this file.")] = None,
    view: Annotated[bool, typer.Option("--view", help="Open the Rerun viewer on the combined log.")] = False,
    serve: Serve = False,
    no_log: Annotated[bool, typer.Option("--no-log", help="Write no Rerun files.")] = False,
    jobs: Annotated[
        int | None, typer.Option(min=1, help="How many variants run at once; default: as many as there are processors.")
    ] = None,
    full: Annotated[bool, typer.Option("--full", help="Print all figures, not only those that decide.")] = False,
    json: AsJson = False,
) -> None:
    """Run all variants on the same ground and put the verdicts in one table, the best of each figure marked.

    Writes to the folder --out: SCENARIO-VARIANT.rrd for each, SCENARIO-all.rrd with all of them overlaid and their
    differences to the baseline (B - A), and the picture SCENARIO.png.  With --logs nothing is run: the logs of runs of
    any age are set side by side, in SCENARIO-logs-all.rrd and SCENARIO-logs.png.

    Example: wmr-cosim compare ramp-impact-realistic --variants uncontrolled,pd --report report.html

    Example: wmr-cosim compare --logs a.rrd b.rrd --baseline pd
    """
    if (view or serve) and no_log:
        raise typer.BadParameter(f"--{'view' if view else 'serve'} needs the log that --no-log leaves out")
    changes = _changes(set_, step, duration)
    if logs:
        from .recall import compare_logs

        if changes or variants or no_log or jobs:
            left_out = "--set, --step, --duration, --variants, --jobs and --no-log"
            raise ScenarioError(f"--logs compares runs as they were: leave out {left_out}")
        done = compare_logs([Path(s) for s in scenario], out, baseline=baseline, report=report, quiet=json)
    else:
        from . import session

        if len(scenario) > 1:
            raise ScenarioError(f"compare runs one scenario, not {len(scenario)}; are these logs? then add --logs")
        if not no_log:
            _prepare_logging()
        names = tuple(filter(None, (v.strip() for v in variants.split(",")))) if variants else None
        done = session.compare(
            scenario[0], names, changes, out, log=not no_log, report=report, quiet=json, baseline=baseline, jobs=jobs
        )
    present.show_comparison(done, json, full)
    shown = done.combined or next((r.log for r in done.runs if r.log), None)
    if shown:
        with _viewer(shown, view=view, serve=serve):
            pass
    _finish(done.runs if not logs else [], done.failed)


app.command("explain")(cli_explain.explain)
app.command("inspect")(cli_inspect.inspect)
app.command("logs")(cli_logs.logs)
app.command("figures")(cli_figures.figures)
app.command("errata")(cli_errata.errata)
app.add_typer(cli_fmu.app, name="fmu")


@contextmanager
def _viewer(log: Path | None = None, *, view: bool, serve: bool) -> Iterator[Viewer | None]:
    """Show *log*, or what is sent to the viewer: a window stays when the command ends, a web page until Ctrl-C."""
    if not (view or serve):
        yield None
        return
    from logs import live

    shown = live.start(log, web=serve)
    try:
        if serve:
            note(f"look at it at {shown.page}")
        yield shown
    except BaseException:
        shown.close()
        raise
    if serve:
        shown.wait(lambda: note("the page is served until Ctrl-C"))


def _prepare_logging() -> None:
    """Import what logs are written with, before several threads do."""
    from logs.start import hush, spare_pandas

    hush()
    spare_pandas()


def _changes(texts: list[str] | None, step: float | None, duration: float | None) -> list[str]:
    found = list(texts or [])
    found += [f"run.step={step!r}"] if step is not None else []
    found += [f"run.duration={duration!r}"] if duration is not None else []
    return found


def _finish(runs: list[Done], before: Mapping[str, CosimError] = MappingProxyType({})) -> None:
    """Say which runs failed, those included that did not begin, by variant; then the exit code is 1."""
    for variant, error in before.items():
        complain(f"{variant}: {error}")
    failed = [r for r in runs if r.result.error is not None]
    for r in failed:
        kept = f"; the log up to there is {r.log}" if r.log and str(r.log) not in str(r.result.error) else ""
        complain(f"{r.result.scenario.name} {r.result.scenario.variant}".strip() + f": {r.result.error}{kept}")
    if failed or before:
        raise typer.Exit(1)


class _Stopped(SystemExit):
    """A signal from outside.  It ends the command as an exception does, so that the log is closed and says so."""


def _stop(number: int, frame: object) -> NoReturn:
    raise _Stopped(128 + number)


def main() -> None:
    """Run the command line; a user's mistake ends with one sentence and exit code 1, never with a traceback."""
    gc.set_threshold(100_000)  # what is imported stays; looking through it again and again is a tenth of the start
    atexit.register(gc.freeze)  # nor is it looked through for cycles when the process ends, which takes 0.3 s
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, _stop)
    try:
        app(prog_name="wmr-cosim")  # whoever called it, python -m included
    except CosimError as error:
        complain(str(error))
        sys.exit(1)
    except _Stopped:
        complain("stopped; a log that was begun holds what was computed up to here, and says so")
        raise


if __name__ == "__main__":
    main()
