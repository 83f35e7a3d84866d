"""Make figures in several processes: their pictures, data, verdicts and logs.  One that fails loses no other."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, replace
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from time import perf_counter
from typing import Any

from studies.terminal import SILENT, Bar

from .claim import Claim
from .entry import Entry
from .sheet import Sheet

ROWS = 40  # data of up to so many rows are shown in the report
_Tasks = Mapping[str, Callable[[], Any]]


@dataclass(frozen=True)
class Outcome:
    """What became of an entry; its files are names in the folder they were written to."""

    key: str
    title: str
    part: str
    stem: str
    claims: tuple[Claim, ...] = ()
    notes: tuple[str, ...] = ()
    picture: str = ""
    data: str = ""
    log: str = ""
    table: tuple[tuple[str, ...], ...] = ()  # the data under their heads, if they are few
    seconds: float = 0.0
    error: str = ""


def build(entries: Sequence[Entry], folder: Path | None, jobs: int = 2, bar: Bar = SILENT) -> list[Outcome]:
    """Make all *entries* in *jobs* processes (1: in this one), with the logs of those that move, into *folder*.

    Without a folder only the verdicts are computed.  What other processes make is looked up in the register by key.
    """
    tasks: dict[str, Callable[[], Any]] = {}
    if folder is not None:
        tasks |= {_name(e.run): partial(_record, *e.run, folder) for e in entries if e.run}
    for e in entries:
        tasks[e.key] = partial(_produce, e, folder) if jobs == 1 else partial(_by_key, e.key, folder)
    found: dict[str, Any] = {}
    for name, value in _here(tasks) if jobs == 1 else _elsewhere(tasks, jobs):
        found[name] = value
        bar(name, len(found) / len(tasks))
    return [_outcome(entry, found) for entry in entries]


def _name(run: tuple[str, str]) -> str:
    return "run {} {}".format(*run)


def _outcome(entry: Entry, found: Mapping[str, Any]) -> Outcome:
    """Return what was *found* for an entry, and the log of its run."""
    made = found[entry.key]
    outcome = made if isinstance(made, Outcome) else _empty(entry)
    log = found.get(_name(entry.run), "") if entry.run else ""
    errors = [f"{type(e).__name__}: {e}" for e in (made, log) if isinstance(e, Exception)]
    return replace(outcome, log=log if isinstance(log, str) else "", error="; ".join(errors))


def _empty(entry: Entry) -> Outcome:
    return Outcome(entry.key, entry.title, entry.part, entry.stem)


def _produce(entry: Entry, folder: Path | None) -> Outcome:
    """Make one figure with its verdicts, and write its files to *folder*; None: the verdicts alone."""
    begun, outcome = perf_counter(), _empty(entry)
    if folder is not None:
        outcome = _written(outcome, entry.make(), folder)
    return replace(outcome, claims=tuple(entry.claims()), seconds=perf_counter() - begun)


def _by_key(key: str, folder: Path | None) -> Outcome:
    from .register import chosen

    return next(_produce(e, folder) for e in chosen([key]) if e.key == key)


def _written(outcome: Outcome, sheet: Sheet, folder: Path) -> Outcome:
    sheet.save(folder / outcome.stem)
    columns = sheet.columns
    rows = [tuple(columns), *zip(*(map(_cell, c) for c in columns.values()), strict=True)]
    table = tuple(rows) if len(rows) <= ROWS + 1 else ()
    picture, data = f"{outcome.stem}.png", f"{outcome.stem}.csv"
    return replace(outcome, notes=sheet.notes, picture=picture, data=data, table=table)


def _cell(value: Any) -> str:
    return value if isinstance(value, str) else f"{value:.5g}"


def _record(scenario: str, variant: str, folder: Path) -> str:
    """Run a variant of a scenario and return the name of its log in *folder*."""
    from studies.session import run_one

    done = run_one(scenario, variant, [], folder, quiet=True)
    if done.result.error is not None:
        raise done.result.error
    return done.log.name if done.log else ""


def _here(tasks: _Tasks) -> Iterator[tuple[str, Any]]:
    """Yield the names of *tasks* and what they return or, where one fails, its exception."""
    for name, task in tasks.items():
        try:
            yield name, task()
        except Exception as error:  # whatever it is: the others are worth having
            yield name, error


def _elsewhere(tasks: _Tasks, jobs: int) -> Iterator[tuple[str, Any]]:
    """The same in *jobs* processes; those that a crash of their process took along are done again, each by itself."""
    pool = ProcessPoolExecutor(jobs, mp_context=get_context("spawn"))
    lost = []
    try:
        names = {pool.submit(task): name for name, task in tasks.items()}
        for future in as_completed(names):
            error = future.exception()
            if isinstance(error, BrokenProcessPool) and len(tasks) > 1:
                lost.append(names[future])
            else:
                yield names[future], error or future.result()
    finally:
        pool.shutdown(cancel_futures=True)
    for name in lost:
        yield from _elsewhere({name: tasks[name]}, 1)
