"""The process that an FMU has for itself, as its importer sees it: started, talked to, and how it ended."""

from __future__ import annotations

import os
import pickle
import select
import signal
import socket
import subprocess
import sys
import tempfile
from contextlib import ExitStack, suppress
from time import monotonic
from typing import NoReturn

from cosim import ExportError

from .binding import Log
from .channel import MESSAGE, Channel, Memory

WORDS = 2000  # bytes of what it wrote to its standard error that are looked at


class Gone(Exception):  # noqa: N818  (what it says becomes a StepError's reason)
    """The process is gone; the text says how it ended."""


class Process:
    """A process for the FMU in *file*, with memory for *n_u* inputs and *n_y* outputs; it belongs to who started it.

    *log* gets the FMU's messages.  Raises ExportError if it cannot be started.
    """

    def __init__(self, file: str, n_u: int, n_y: int, log: Log) -> None:
        self._file, self.log = file, log
        self._why, self._busy, self._owner, self._written = "", False, os.getpid(), ""
        try:
            with ExitStack() as held:
                self._start(n_u, n_y, held)
                held.pop_all()
        except OSError as error:
            raise ExportError(f"{file} cannot be given a process of its own: {error.strerror}") from None

    def _start(self, n_u: int, n_y: int, held: ExitStack) -> None:
        self._last_words = held.enter_context(tempfile.TemporaryFile())  # noqa: SIM115  (held)
        self._socket, theirs = map(held.enter_context, socket.socketpair())
        self._channel = Channel(self._socket.fileno())
        with theirs, tempfile.TemporaryFile() as file:
            self.memory = Memory(file.fileno(), n_u, n_y)
            held.callback(self.memory.close)
            descriptors = (theirs.fileno(), file.fileno())
            # -P: modules that happen to lie in the working folder are not ours
            command = [sys.executable, "-P", "-m", "fmus.worker", *map(str, descriptors), str(os.getpid())]
            environment = {**os.environ, "PYTHONPATH": os.pathsep.join(p or os.getcwd() for p in sys.path)}
            self._process = subprocess.Popen(
                command, pass_fds=descriptors, env=environment, stdin=subprocess.DEVNULL, stderr=self._last_words,
                process_group=0,  # Ctrl-C is for the importer; and what the FMU starts ends with it
            )  # fmt: skip
        self._arrived = select.poll()
        self._arrived.register(self._socket.fileno(), select.POLLIN)

    @property
    def pid(self) -> int:
        """Number of the process."""
        return self._process.pid

    @property
    def unusable(self) -> str:
        """Why nothing can be asked of it, as a predicate; empty if it can."""
        if self._why:
            return self._why
        if os.getpid() != self._owner:  # a fork has the importer's end of the socket, too
            return "belongs to the process that loaded it"
        return "was interrupted in the midst of a call" if self._busy else ""

    # talking

    def send(self, kind: int, content: bytes) -> None:
        """Ask for something; raises Gone."""
        self._busy = True  # until it is answered: else that answer would be taken for the next one
        try:
            self._channel.send(kind, content)
        except OSError:
            self._died()

    def answer(self, limit: float | None) -> tuple[int, bytes]:
        """Wait for an answer, for at most *limit* s, and return its kind and content; raises Gone."""
        until = None if limit is None else monotonic() + limit
        while True:
            left = None if until is None else 1000 * max(0.0, until - monotonic())
            if not self._channel.waiting and not self._arrived.poll(left):
                self._hangs(limit)
            try:
                kind, content = self._channel.receive()
            except (EOFError, OSError):
                self._died()
            if kind != MESSAGE:
                self._busy = False
                return kind, content
            self.log.add(*pickle.loads(content))
            if until is not None and monotonic() > until:  # it talks all the time, and does not return
                self._hangs(limit)

    # the end

    def end(self, why: str) -> None:
        """End the process and what it has started; *why* nobody can use it any more.  A second time nothing happens."""
        if self._why:
            return
        mine, self._why = os.getpid() == self._owner, why
        if mine:
            with suppress(ProcessLookupError, PermissionError):  # macOS: not permitted once all are gone
                os.killpg(self.pid, signal.SIGKILL)  # how a process ends that has begun to is not changed by that
            self._process.wait()
        self._socket.close()
        self.memory.close()
        words = self._last_words.fileno()
        last = os.pread(words, WORDS, max(0, os.fstat(words).st_size - WORDS))
        self._written = last.decode(errors="replace").strip("\0\n ")
        self._last_words.close()

    def finish(self, limit: float) -> None:
        """Wait for at most *limit* s until the process ends by itself, as it does once it was told to; raises Gone.

        What the FMU has started may go on then: a tool may have work to save.
        """
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(limit)
        if self._process.returncode is None:
            self._hangs(limit)
        if self._process.returncode != 0:
            self._died()
        self.end("was closed")

    def _died(self) -> NoReturn:
        """Say how the process ended."""
        function = self.memory.function
        self.end("has lost its process")
        where, code = f" in {function}" if function else "", self._process.returncode
        if code < 0:
            name = {number.value: number.name for number in signal.Signals}.get(-code, f"signal {-code}")
            what = f"it crashed{where}: {name} ({(signal.strsignal(-code) or name).lower()})"
        else:
            what = f"it ended its own process{where} with exit code {code}"
        raise Gone(
            f"{what}{self._said()}; only its own process is gone: look at the inputs it was given last, or ask who "
            f"made {self._file}"
        )

    def _hangs(self, limit: float | None) -> NoReturn:
        function = self.memory.function or "its process"
        self.end("has lost its process")
        raise Gone(
            f"{function} did not return within the time limit of {limit:g} s and was ended{self._said()}; if it only "
            f"needs longer, raise time_limit, else look at the inputs it was given last"
        )

    def _said(self) -> str:
        """Return the FMU's last serious messages and the last line it wrote to its standard error, as a clause."""
        serious = [text for status, text in self.log.entries if text][-3:]
        said = "; ".join(dict.fromkeys([*serious, *self._written.splitlines()[-1:]]))
        return f"; before, it said: {said}" if said else ""
