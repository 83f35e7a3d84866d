"""What is the same in every process, kept in files: equations and the sources of FMUs take seconds to derive.

What is derived from a component depends on its class, its structural values, and the sources that these use.  A package
whose components use nothing but itself and ``cosim`` says so by ``EQUATIONS_ARE_KEPT = True``; of others nothing is
kept.
"""

from __future__ import annotations

import os
import pickle
import sys
import tempfile
from collections.abc import Callable
from functools import cache
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from .cache import cache_folder

if TYPE_CHECKING:
    from .component import Component

T = TypeVar("T")
_UNREADABLE = (OSError, EOFError, pickle.UnpicklingError, AttributeError, ImportError, IndexError, RuntimeError)


def fingerprint(component: Component, *, values: bool = False) -> str | None:
    """Return a hash of what the equations of a component depend on, and of its *values*; None where it is not known."""
    known = of_class(type(component))
    if known is None:
        return None
    found = sha256(repr((known, sorted(component.structure.items()), version("casadi"))).encode())
    for name, value in component.values.items() if values else ():
        array = np.asarray(value)
        found.update(repr((name, array.shape, array.dtype)).encode() + array.tobytes())
    return found.hexdigest()


def of_class(kind: type) -> str | None:
    """Return a hash of a class: its name and the sources that it uses; None where these are not known."""
    package = sys.modules.get(kind.__module__.partition(".")[0])
    if not getattr(package, "EQUATIONS_ARE_KEPT", False) or package is None or package.__file__ is None:
        return None
    sources = digest(Path(package.__file__).parent), digest(Path(__file__).parent)
    return sha256(repr((kind.__module__, kind.__qualname__, sources)).encode()).hexdigest()


@cache
def digest(folder: Path) -> str:
    """Return a hash of the sources of a package; those that it built do not count."""
    found = sha256()
    for path in written(folder):
        if path.suffix in (".py", ".c", ".h"):
            found.update(f"{path.relative_to(folder)}\0".encode() + path.read_bytes())
    return found.hexdigest()


def written(folder: Path) -> list[Path]:
    """Return the files below a folder, but none of ``build``: what others build there comes and goes meanwhile.

    That is not even looked at: it may hold thousands of files.
    """
    paths: list[Path] = []
    for here, inside, names in os.walk(folder):
        inside[:] = [name for name in inside if name != "build"]
        paths += [Path(here, name) for name in names]
    return sorted(paths)


def kept(kind: str, key: str | None, make: Callable[[], T]) -> T:
    """Return what *make* makes, from a file of an earlier process if there is one; None as *key*: it is made anew."""
    if key is None:
        return make()
    path = cache_folder() / "kept" / f"{kind}-{key[:20]}.pickle"
    try:
        found: T = pickle.loads(path.read_bytes())
    except _UNREADABLE:  # not there, or cut off
        found = make()
        _keep(path, pickle.dumps(found))
    return found


def _keep(path: Path, data: bytes) -> None:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, work = tempfile.mkstemp(dir=path.parent, prefix=".kept-")
        with os.fdopen(handle, "wb") as file:
            file.write(data)
        os.replace(work, path)  # atomic: who keeps the same at the same time keeps either
    except OSError:  # a full disk, or a folder that may only be read: the next process derives it again
        pass
