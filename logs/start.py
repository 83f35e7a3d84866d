"""What a command sees to before Rerun is imported: that it need not wait for pandas, and that Rerun warns of no choice.

pyarrow imports pandas with its first array, only to ask whether that came from there.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from importlib.abc import MetaPathFinder
from types import ModuleType

import numpy as np
import pyarrow as pa


class _Without(MetaPathFinder):
    """Finds nothing but the one package that is to be missing."""

    def __init__(self, name: str) -> None:
        self.name = name

    def find_spec(self, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None) -> None:
        """Raise ModuleNotFoundError for that package; leave the others to who comes next."""
        if name == self.name:
            raise ModuleNotFoundError(f"{name} is not asked for yet", name=name)


def hush() -> None:
    """Have Rerun say nothing when a log is to have no index, unless RUST_LOG asks for it; before it is imported."""
    os.environ.setdefault("RUST_LOG", "warn,re_perf_telemetry=warn,re_log_encoding::rrd::file_sink=error")


def spare_pandas() -> None:
    """Have pyarrow make its first array while pandas is not to be found: a third of a second less to import.

    pyarrow looks once, and again where it is to give a pandas object; everybody else finds pandas as before.  A Series
    given to ``pa.array`` until then keeps its NaN, instead of nulls: this is for commands, not for a user's program.
    """
    if "pandas" in sys.modules:
        return
    missing = _Without("pandas")
    sys.meta_path.insert(0, missing)
    try:
        pa.array(np.zeros(1)), pa.scalar(0.0)
    finally:
        sys.meta_path.remove(missing)
