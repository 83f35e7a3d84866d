"""Component -> FMU, and anybody's FMU -> instance: the only part of the product that knows the FMI standard.

``build`` makes an FMU of a component, ``load`` an instance of any FMU, ``instantiate`` both; a ``Pool`` lends instances
for run after run.  An FMU that may crash or hang is loaded with ``isolated=True`` or a ``time_limit``.
"""

from cosim.cache import cache_folder

from .compile import PLATFORMS
from .inspection import check, info
from .instance import FmuInstance
from .isolated import IsolatedFmu
from .loading import instantiate, load
from .package import build
from .pool import Pool

__all__ = [
    "PLATFORMS",
    "FmuInstance",
    "IsolatedFmu",
    "Pool",
    "build",
    "cache_folder",
    "check",
    "info",
    "instantiate",
    "load",
]
