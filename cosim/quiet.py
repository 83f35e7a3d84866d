"""Warnings that are expected, left out, in several threads at once as well.

Python has one list of filters for all threads: two that change and restore it at the same time leave the filter of one
in place for good, or take the other's away before its warning comes.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from threading import RLock

_ONE_AT_A_TIME = RLock()


@contextmanager
def without(category: type[Warning], message: str = "") -> Iterator[None]:
    """Show no warnings of a *category* whose text begins with *message*, a regular expression."""
    with _ONE_AT_A_TIME, warnings.catch_warnings():
        warnings.filterwarnings("ignore", message, category)
        yield
