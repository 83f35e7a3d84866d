"""What an FMU's own process and its importer share: a socket for calls, and memory for the values of every step.

The memory holds the name of the FMI function that is being called, then the buffers ``u`` and ``y``.  Who finds the
other process dead reads there in which function it died.
"""

from __future__ import annotations

import mmap
import os
import pickle
import struct
from threading import Lock
from typing import Any

import numpy as np

# what is sent: a call, and a step, which is packed since there are many; a message of the FMU, what came of a call, of
# a step that is as it should be, and an error
CALL, STEP, MESSAGE, DONE, STEPPED, FAILED = range(6)
STEP_FORMAT = struct.Struct("<qq??")  # start, end in ns, early return is welcome, u is to be pushed before
STEPPED_FORMAT = struct.Struct("<?")  # whether y was pulled after it

_NAME = 64  # bytes for the name of a function
NOWHERE = b"".ljust(_NAME)
_HEAD = struct.Struct("<IB")  # length of what follows, kind


class Memory:
    """Memory that two processes share, in an unnamed file of which each has a descriptor."""

    def __init__(self, descriptor: int, n_u: int, n_y: int) -> None:
        size = _NAME + 8 * (n_u + n_y + 1)
        if os.fstat(descriptor).st_size < size:
            os.ftruncate(descriptor, size)
        self._map = mmap.mmap(descriptor, size)
        self.u = np.ndarray((n_u,), float, self._map, _NAME)
        self.y = np.ndarray((n_y,), float, self._map, _NAME + 8 * n_u)

    def close(self) -> None:
        """Give the memory back; a second time nothing happens."""
        if not self._map.closed:
            del self.u, self.y
            self._map.close()

    @property
    def function(self) -> str:
        """Name of the FMI function that is being called, empty if none is."""
        return self._map[:_NAME].decode().strip()

    def mark(self, name: bytes) -> None:
        """Write which function is being called: its name, filled up to the length of ``NOWHERE``."""
        self._map[:_NAME] = name


class Channel:
    """One end of a stream socket; each message has a kind."""

    def __init__(self, descriptor: int) -> None:
        self.descriptor = descriptor
        self._read = b""
        self._sending = Lock()  # an FMU may send messages from threads of its own

    def send(self, kind: int, content: bytes) -> None:
        """Send a message; raises OSError if the other process is gone."""
        data = _HEAD.pack(len(content), kind) + content
        with self._sending:
            while data:
                data = data[os.write(self.descriptor, data) :]

    def tell(self, kind: int, *content: Any) -> None:
        """Send a message whose content is a tuple."""
        self.send(kind, pickle.dumps(content, -1))

    @property
    def waiting(self) -> bool:
        """Whether a message, or the beginning of one, was read already."""
        return bool(self._read)

    def receive(self) -> tuple[int, bytes]:
        """Wait for a message and return its kind and content; raises EOFError or OSError if the other is gone."""
        pieces, have, need = [self._read], len(self._read), _HEAD.size
        size = kind = -1
        while True:
            if size < 0 and have >= _HEAD.size:
                pieces = [b"".join(pieces)]
                size, kind = _HEAD.unpack_from(pieces[0])
                need = _HEAD.size + size
            if have >= need:
                break
            piece = os.read(self.descriptor, 1 << 16)
            if not piece:
                raise EOFError
            pieces.append(piece)
            have += len(piece)
        data = b"".join(pieces)
        self._read = data[need:]
        return kind, data[_HEAD.size : need]
