"""Rows of values that grow with a run: in memory up to a limit, and beyond it in a temporary file."""

from __future__ import annotations

import os
import tempfile
from typing import IO

import numpy as np

from .errors import ScenarioError

CHUNK = 4096  # rows
LIMIT = 256_000_000  # bytes in memory


class Rows:
    """Rows of *width* values of 8 bytes, kept in chunks, so that what is there is never copied while it grows.

    Beyond *limit* bytes the oldest chunks go to a temporary file, which the system deletes with this object or its
    process.  A chunk lies there column by column: who reads a few columns of a long run reads nothing else.
    """

    def __init__(self, width: int, limit: int = LIMIT, dtype: type = np.float64) -> None:
        self.width, self._limit, self._dtype = width, limit, dtype
        self._most = max(1, limit // max(1, 8 * width * CHUNK))  # chunks in memory
        self._chunks: list[np.ndarray] = [np.empty((CHUNK, width), dtype)]
        self._used = 0  # rows of the last chunk
        self._stored = 0  # chunks in the file
        self._file: IO[bytes] | None = None

    def __len__(self) -> int:
        return (self._stored + len(self._chunks) - 1) * CHUNK + self._used

    def append(self, row: np.ndarray | tuple[int, ...]) -> None:
        """Copy a row; raises ScenarioError if the temporary file takes no more."""
        if self._used == CHUNK:
            self._grow()
        self._chunks[-1][self._used] = row
        self._used += 1

    def extend(self, rows: np.ndarray) -> None:
        """Copy rows (n, width)."""
        at = 0
        while at < len(rows):
            if self._used == CHUNK:
                self._grow()
            n = min(len(rows) - at, CHUNK - self._used)
            self._chunks[-1][self._used : self._used + n] = rows[at : at + n]
            self._used += n
            at += n

    def columns(self, at: slice) -> np.ndarray:
        """Return the columns *at* of all rows, (n, columns), as a new array."""
        found = np.empty((len(self), at.stop - at.start), self._dtype)
        part = np.empty((at.stop - at.start, CHUNK), self._dtype)
        for k in range(self._stored):
            assert self._file is not None
            os.preadv(self._file.fileno(), [part.data], 8 * CHUNK * (k * self.width + at.start))
            found[k * CHUNK : (k + 1) * CHUNK] = part.T
        row = self._stored * CHUNK
        for chunk in self._chunks:
            n = min(CHUNK, len(found) - row)
            found[row : row + n] = chunk[:n, at]
            row += n
        return found

    def _grow(self) -> None:
        full = len(self._chunks) >= self._most
        self._chunks.append(self._store(self._chunks.pop(0)) if full else np.empty((CHUNK, self.width), self._dtype))
        self._used = 0

    def _store(self, chunk: np.ndarray) -> np.ndarray:
        """Move a chunk to the file; return it to be used again."""
        if self._file is None:
            self._file = tempfile.TemporaryFile(buffering=0)  # noqa: SIM115  (lives as long as this object)
        data = np.ascontiguousarray(chunk.T).data.cast("B")
        try:
            while len(data):
                data = data[self._file.write(data) :]
        except OSError as error:
            self._chunks.insert(0, chunk)  # nothing of it is lost
            raise ScenarioError(
                f"the record of the run fits neither into {self._limit / 1e6:g} MB of memory nor into "
                f"{tempfile.gettempdir()} ({error.strerror}); set TMPDIR to a folder with more room"
            ) from None
        self._stored += 1
        return chunk
