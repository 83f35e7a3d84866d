"""Common to all tests: floating-point accidents in NumPy are errors, not warnings.

pytest puts this folder on the path, so that ``from toys import Mass`` works in every test.
"""

from collections.abc import Iterator

import numpy as np
import pytest


@pytest.fixture(autouse=True)
def _numpy_raises() -> Iterator[None]:
    with np.errstate(divide="raise", invalid="raise"):
        yield
