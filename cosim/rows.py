"""Rows of values that grow with a run: the newest in memory, the older ones of a long run in a temporary file."""

from __future__ import annotations

import os
import tempfile
from typing import IO

import numpy as np

from .errors import ScenarioError

CHUNK = 1024  # rows
NEAR = 32_000_000  # bytes in memory, where a file takes the rest
LIMIT = 256_000_000  # bytes in memory, where it does not


class Rows:
    """Rows of *width* values of 8 bytes, kept in chunks, so that what is there is never copied while it grows.

    Beyond ``NEAR`` bytes (or *limit*, if that is less) the oldest chunk goes to a temporary file, which the system
    deletes with this object or its process, and the newest takes its memory: fresh memory costs several times what
    writing does.  Where the file takes nothing, memory up to *limit* is used.  A chunk lies column by column: who reads
    a few columns of a long run reads nothing else.
    """

    def __init__(self, width: int, limit: int = LIMIT) -> None:
        self.width, self._limit = width, limit
        size = 8 * max(1, width) * CHUNK
        self._few, self._most = (max(1, room // size) for room in (min(NEAR, limit), limit))  # chunks in memory
        self._chunks = [np.empty((width, CHUNK))]
        self._used = 0  # rows of the last chunk
        self._stored = 0  # chunks in the file
        self._file: IO[bytes] | None = None

    def __len__(self) -> int:
        return (self._stored + len(self._chunks) - 1) * CHUNK + self._used

    def extend(self, rows: np.ndarray, more: np.ndarray) -> None:
        """Copy rows (n, width) of two parts that lie side by side; raises ScenarioError if there is no room."""
        at, first = 0, rows.shape[1]
        while at < len(rows):
            if self._used == CHUNK:
                self._grow()
            n = min(len(rows) - at, CHUNK - self._used)
            place = self._chunks[-1][:, self._used : self._used + n]
            place[:first], place[first:] = rows[at : at + n].T, more[at : at + n].T
            self._used += n
            at += n

    def columns(self, at: slice) -> np.ndarray:
        """Return the columns *at* of all rows, (n, columns), as a new array."""
        found = np.empty((len(self), at.stop - at.start))
        part = np.empty((at.stop - at.start, CHUNK))
        for k in range(self._stored):
            assert self._file is not None
            os.preadv(self._file.fileno(), [part.data], 8 * CHUNK * (k * self.width + at.start))
            found[k * CHUNK : (k + 1) * CHUNK] = part.T
        row = self._stored * CHUNK
        for chunk in self._chunks:
            n = min(CHUNK, len(found) - row)
            found[row : row + n] = chunk[at, :n].T
            row += n
        return found

    def _grow(self) -> None:
        if len(self._chunks) < self._few:
            self._chunks.append(np.empty((self.width, CHUNK)))
        else:
            try:
                self._store(self._chunks[0])
            except OSError as error:
                if len(self._chunks) >= self._most:
                    raise ScenarioError(
                        f"the record of the run fits neither into {self._limit / 1e6:g} MB of memory nor into "
                        f"{tempfile.gettempdir()} ({error.strerror}); set TMPDIR to a folder with more room"
                    ) from None
                self._chunks.append(np.empty((self.width, CHUNK)))
            else:
                self._chunks.append(self._chunks.pop(0))
        self._used = 0

    def _store(self, chunk: np.ndarray) -> None:
        """Write a chunk behind those in the file; raises OSError if not all of it fits, and it is not there then."""
        if self._file is None:
            self._file = tempfile.TemporaryFile(buffering=0)  # noqa: SIM115  (lives as long as this object)
        data, at = chunk.data.cast("B"), 8 * self.width * CHUNK * self._stored
        while len(data):
            written = os.pwrite(self._file.fileno(), data, at)
            data, at = data[written:], at + written
        self._stored += 1
