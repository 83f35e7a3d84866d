"""What logs are written with does without pandas, which takes a third of a second to import; who asks for it has it."""

from __future__ import annotations

import subprocess
import sys

SPARED = """
import sys
from logs.start import spare_pandas

spare_pandas()
import numpy as np
import pyarrow as pa
import rerun as rr
import logs.recorder

pa.array(np.arange(3)), pa.scalar("text"), rr.AnyValues(number=1.0, words=["a"])
assert "pandas" not in sys.modules
assert pa.array([1.0, 2.0]).to_pandas().mean() == 1.5
import pandas
assert pa.array(pandas.Series([1.0, float("nan")])).null_count == 1  # and pyarrow knows its series as ever
"""


def test_pandas_is_imported_only_for_who_asks_for_it() -> None:
    """In a process of its own: here it may have been imported for another test."""
    done = subprocess.run([sys.executable, "-c", SPARED], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
