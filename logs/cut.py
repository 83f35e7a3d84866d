"""A log that ends in the midst of a message, since the process or the disk ended then: the whole messages before it.

Rerun's reader refuses such a file.  An RRD file is 12 bytes, then messages: 8 bytes kind, 8 bytes length, payload.
"""

from __future__ import annotations

import shutil
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

MAGIC, HEADER, BEFORE = b"RRF2", 12, 16


def whole(path: Path) -> Path:
    """Return a copy of a log, gone when the program ends, without what comes after its last whole message.

    The file itself is left alone: it may be still written to.  Raises ValueError for a file that is none.
    """
    size, at = path.stat().st_size, HEADER
    with path.open("rb") as stream:
        if stream.read(HEADER)[:4] != MAGIC:
            raise ValueError("it does not begin as one")
        while at + BEFORE <= size:
            stream.seek(at + 8)
            after = at + BEFORE + int.from_bytes(stream.read(8), "little")
            if after > size:
                break
            at = after
    copy = Path(_scratch().name) / f"{path.stem}-{at}.rrd"
    shutil.copyfile(path, copy)
    with copy.open("r+b") as stream:
        stream.truncate(at)
    return copy


@cache
def _scratch() -> TemporaryDirectory[str]:
    return TemporaryDirectory(prefix="wmr-cosim-")
