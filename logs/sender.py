"""Two chunks in turn: one is filled by the run while a thread sends the other."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from threading import Event

from .ports import Chunk


class Sender:
    """Hands full chunks to *send*, in a thread of its own, where no interrupt can have rows sent twice or never."""

    def __init__(self, send: Callable[[Chunk], None]) -> None:
        self.chunk: Chunk | None = None  # being filled; None: before the run
        self._other: Chunk | None = None  # being sent, or empty
        self._send = send
        self._wrong: BaseException | None = None  # what went wrong while a chunk was sent
        self._thread = ThreadPoolExecutor(1)
        self._thread.submit(int).result()  # starts it: an interrupt while it starts would start a second one

    def begin(self, chunk: Chunk) -> None:
        """Fill *chunk* first."""
        self.chunk, self._other = chunk, chunk.another()

    def turn(self) -> None:
        """Fill the other chunk from here on, and have this one sent; the one before must be through: ``drain``."""
        turned = Event()
        self._thread.submit(self._turn, turned)
        turned.wait()

    def _turn(self, turned: Event) -> None:
        full = self.chunk
        assert full is not None
        self.chunk, self._other = self._other, full
        assert self.chunk is not None
        self.chunk.follow(full)
        turned.set()
        try:
            self._send(full)
        except BaseException as error:
            self._wrong = error
        finally:
            full.clear()

    def drain(self) -> None:
        """Wait until no chunk is under way; raises what went wrong with the last one."""
        self._thread.submit(int).result()
        wrong, self._wrong = self._wrong, None
        if wrong is not None:
            raise wrong

    def close(self) -> None:
        """End the thread, when nothing is under way any more."""
        self._thread.shutdown()
