"""A process with one FMU in it: ``python -m fmus.worker``, started and told what to do by ``isolated.IsolatedFmu``."""

from __future__ import annotations

import os
import pickle
import select
import signal
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from cosim import CosimError
from cosim.instance import Advance

from .binding import Library, Log
from .channel import (
    CALL,
    DONE,
    FAILED,
    MESSAGE,
    NOWHERE,
    STEP_FORMAT,
    STEPPED,
    STEPPED_FORMAT,
    Channel,
    Memory,
)
from .instance import FmuInstance
from .loading import in_this_process

MOST_WORDS = 8192  # blocks of 512 bytes that may be written to the standard error, whose last line counts


class Worker:
    """An FMU and the snapshots taken of it, by number."""

    def __init__(self, instance: FmuInstance, memory: Memory) -> None:
        self.instance, self.memory = instance, memory
        instance.bind(memory.u, memory.y)
        self._snapshots: dict[int, Any] = {}
        self._taken, self.closed = 0, False

    def answer(self, kind: int, content: bytes) -> tuple[int, bytes]:
        """Do what the importer asks for and return the answer."""
        if kind == CALL:
            what, name, *arguments = pickle.loads(content)
            self.instance.name = name
            method = getattr(self, f"_{what}", None) or getattr(self.instance, what)
            return DONE, pickle.dumps((method(*arguments), self.instance.time), -1)
        start, end, early_return, pushed = STEP_FORMAT.unpack(content)
        if pushed:
            self.instance.push()
        advance = self.instance.step(start, end, early_return=early_return)
        if advance != Advance(end):
            return DONE, pickle.dumps((advance, self.instance.time), -1)
        try:
            self.instance.pull()  # it will be asked for next
        except CosimError:
            return STEPPED, STEPPED_FORMAT.pack(False)  # it is asked for again, and fails then
        return STEPPED, STEPPED_FORMAT.pack(True)

    def _close(self) -> None:
        self.closed = True
        self.instance.close()

    def _event(self, what: str, *arguments: Any) -> tuple[Any, frozenset[str]]:
        return getattr(self.instance, what)(*arguments), self.instance.active

    def _snapshot(self, forgotten: list[int]) -> int:
        for number in forgotten:
            self.instance.forget(self._snapshots.pop(number))
        return self._keep(self.instance.snapshot())

    def _deserialize(self, data: bytes) -> int:
        return self._keep(self.instance.deserialize(data))

    def _keep(self, snapshot: Any) -> int:
        self._taken += 1
        self._snapshots[self._taken] = snapshot
        return self._taken

    def _restore(self, number: int) -> None:
        self.instance.restore(self._snapshots[number])

    def _serialize(self, number: int) -> bytes:
        return self.instance.serialize(self._snapshots[number])


def _watch(descriptor: int, parent: int) -> None:
    """End this process and what it has started when the importer is gone, also in the midst of a call."""
    gone = select.poll()
    gone.register(descriptor, 0)  # nothing but the hang-up
    while not gone.poll(1000) and os.getppid() == parent:
        with suppress(OSError):  # an FMU may have closed it
            if os.fstat(sys.stderr.fileno()).st_blocks > MOST_WORDS:
                os.ftruncate(sys.stderr.fileno(), 0)
    os.killpg(0, signal.SIGKILL)


def _marked(memory: Memory) -> Callable[[str, Callable[..., Any]], Callable[..., Any]]:
    """Return what puts around a C function that its name stands in the memory while it is called."""
    running = NOWHERE  # an FMU may call back, and be called from there

    def around(name: str, function: Callable[..., Any]) -> Callable[..., Any]:
        label = name.encode().ljust(len(NOWHERE))

        def call(*arguments: Any) -> Any:
            nonlocal running
            outer, running = running, label
            memory.mark(label)
            result = function(*arguments)
            memory.mark(outer)
            running = outer
            return result

        return call

    return around


def _instance(channel: Channel, descriptor: int) -> Worker:
    archive, name, n_u, n_y = pickle.loads(channel.receive()[1])
    memory = Memory(descriptor, n_u, n_y)
    os.close(descriptor)
    Library.around = _marked(memory)
    # every message at once, so that those before a crash are not lost with it
    Log.told = lambda status, message: channel.tell(MESSAGE, status, message)
    return Worker(in_this_process(archive, name), memory)


def serve(channel: Channel, descriptor: int, parent: int) -> None:
    """Instantiate the FMU, then answer until it is closed or nobody asks any more."""
    threading.Thread(target=_watch, args=(channel.descriptor, parent), daemon=True).start()
    channel.tell(DONE, None, 0.0)  # started
    worker: Worker | None = None
    while True:
        try:
            if worker is None:
                worker = _instance(channel, descriptor)
                channel.tell(DONE, None, 0.0)
            channel.send(*worker.answer(*channel.receive()))
        except (EOFError, ConnectionError):
            return
        except CosimError as error:
            channel.tell(FAILED, error, worker.instance.time if worker else 0.0)
        except Exception as error:
            channel.tell(FAILED, RuntimeError(f"{type(error).__name__}: {error}"), 0.0)
        if worker is None or worker.closed:
            return


if __name__ == "__main__":
    serve(Channel(int(sys.argv[1])), int(sys.argv[2]), int(sys.argv[3]))
