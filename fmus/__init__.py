"""Component -> FMU, and anybody's FMU -> instance: the only part of the product that knows the FMI standard."""

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
