"""Macro steps without Python in them: the master's loop once more, in C, for systems of FMUs that allow it.

The readable loop (``master``, ``attempt``, ``algorithms``) is the specification: both make the same calls in the same
order and give the same bits.
"""

from .loop import CompiledLoop, compiled_loop, refusal
from .native import Native, What

__all__ = ["CompiledLoop", "Native", "What", "compiled_loop", "refusal"]
