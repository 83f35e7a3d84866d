"""The command line as a user meets it: the real entry point, what it prints where, and its exit code."""

from __future__ import annotations

import signal
import sys
from collections.abc import Iterator

import pytest
from commandline import Command, Said

from studies.cli import main


@pytest.fixture
def wmr(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Iterator[Command]:
    """Return a function that runs ``wmr-cosim`` with these arguments, in this process."""
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    monkeypatch.delenv("COLUMNS", raising=False)

    def command(*arguments: object) -> Said:
        monkeypatch.setattr(sys, "argv", ["wmr-cosim", *map(str, arguments)])
        capsys.readouterr()
        code = 0
        try:
            main()
        except SystemExit as end:
            code = 0 if end.code is None else int(end.code)
        said = capsys.readouterr()
        return Said(code, said.out, said.err)

    yield command
    for number, handler in before.items():
        signal.signal(number, handler)
