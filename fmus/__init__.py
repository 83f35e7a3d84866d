"""Component -> FMU, and anybody's FMU -> instance: the only part of the product that knows the FMI standard."""

from .cache import cache_folder
from .compile import PLATFORMS
from .inspection import check, info
from .instance import FmuInstance
from .loading import instantiate, load
from .package import build

__all__ = ["PLATFORMS", "FmuInstance", "build", "cache_folder", "check", "info", "instantiate", "load"]
