"""Instances for many runs: an FMU is read once, and its instances are used again where that is known to be sound.

An instance is used again through the FMI's ``reset`` only if the FMU has shown that a reset instance cannot be told
from a new one: once per FMU file the first instance that comes back from a run is reset, initialised and stepped beside
a new one; all outputs, and all of the state where it can be had as bytes, must be the same to the bit.  Of any other
FMU every run gets a new instance.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from types import TracebackType
from weakref import WeakKeyDictionary

import numpy as np

from cosim import Component, CosimError, Instance
from cosim.clock import NS

from .importer import Archive, read
from .instance import FmuInstance
from .isolated import IsolatedFmu
from .loading import opened, with_values
from .package import build

Loaded = FmuInstance | IsolatedFmu
STEPS = 5  # that a reset instance is compared over
KEPT = 64  # instances that wait at most: those in processes of their own take memory

_sound: dict[Path, bool] = {}  # by the folder of an FMU, which is named by its content: whether its reset is sound


class Pool:
    """Instances that wait for their next run; ``close``, or ``with``, ends them.

    *step* in s is the communication step over which a reset is verified: that of the runs to come.
    """

    def __init__(self, step: float = 1e-3) -> None:
        self.step = round(step * NS)
        self._archives: dict[tuple[str, int, int], Archive] = {}
        self._waiting: dict[tuple[object, ...], list[Loaded]] = {}
        self._lent: WeakKeyDictionary[Instance, tuple[object, ...]] = WeakKeyDictionary()

    def load(
        self,
        path: str | os.PathLike[str],
        name: str = "",
        *,
        isolated: bool | None = None,
        time_limit: float | None = None,
        retry: bool = False,
        smooth: bool = False,
    ) -> Loaded:
        """Return an instance as ``fmus.load`` does, a waiting one if there is one; ``release`` it after the run."""
        archive = self._archive(path)
        key = (archive.folder, isolated, time_limit, retry, smooth)
        waiting = self._waiting.get(key)
        if waiting:
            instance = waiting.pop()
            instance.name = name or archive.model
        else:
            instance = opened(archive, name, isolated=isolated, time_limit=time_limit, retry=retry, smooth=smooth)
        self._lent[instance] = key
        return instance

    def instantiate(
        self,
        component: Component,
        name: str = "",
        *,
        fmi: int = 3,
        isolated: bool | None = None,
        time_limit: float | None = None,
        smooth: bool = False,
    ) -> Loaded:
        """Return an instance as ``fmus.instantiate`` does; ``release`` it after the run."""
        name = name or type(component).__name__
        path = build(component, fmi=fmi)
        instance = self.load(path, name, isolated=isolated, time_limit=time_limit, smooth=smooth)
        return with_values(instance, component)

    def release(self, instances: Iterable[Instance], *, failed: bool = False) -> None:
        """Take instances back after a run: they wait for the next one, or are closed, as after one that *failed*."""
        for instance in instances:
            key = self._lent.pop(instance, None)
            if failed or key is None or not isinstance(instance, Loaded) or not self._again(instance):
                instance.close()
            else:
                self._waiting.setdefault(key, []).append(instance)

    def close(self) -> None:
        """Close the instances that wait."""
        for waiting in self._waiting.values():
            for instance in waiting:
                instance.close()
        self._waiting.clear()

    def __enter__(self) -> Pool:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()

    def _archive(self, path: str | os.PathLike[str]) -> Archive:
        """Return the unpacked FMU, read again only if the file has changed."""
        try:
            status = os.stat(path)
        except OSError:
            return read(path)  # which says what is wrong
        key = (os.fspath(path), status.st_mtime_ns, status.st_size)
        if key not in self._archives:
            self._archives[key] = read(path)
        return self._archives[key]

    def _again(self, instance: Loaded) -> bool:
        """Reset an instance that was used; False if that failed, or may not be trusted."""
        folder = instance.archive.folder
        if not instance.alive or sum(map(len, self._waiting.values())) >= KEPT:
            return False
        if folder not in _sound:
            _sound[folder] = self._verified(instance)
        try:
            if _sound[folder]:
                instance.reset()
            return _sound[folder]
        except CosimError:
            return False

    def _verified(self, used: Loaded) -> bool:
        """Whether a used instance that is reset does the same as a new one."""
        new = opened(used.archive, used.name, isolated=isinstance(used, IsolatedFmu), time_limit=_limit(used))
        try:
            used.reset()
            return _trace(used, self.step) == _trace(new, self.step)
        except CosimError:
            return False
        finally:
            new.close()


def _limit(instance: Loaded) -> float | None:
    return instance.time_limit if isinstance(instance, IsolatedFmu) else None


def _trace(instance: Loaded, step: int) -> bytes:
    """Initialise, take some steps, and return all bits that were shown: outputs on the way, all values at the end."""
    instance.enter_initialization()
    instance.push()
    instance.exit_initialization()
    instance.pull()
    shown = [instance.y.tobytes()]
    for k in range(STEPS):
        instance.push()
        advance = instance.step(k * step, (k + 1) * step)
        instance.pull()
        shown.append(instance.y.tobytes())
        if advance.terminated:
            break
    if instance.can.serialize:
        saved = instance.snapshot()
        shown.append(instance.serialize(saved))
        instance.forget(saved)
    for name, variable in instance.variables.items():
        if variable.type != "Clock":
            shown.append(repr(np.asarray(instance.get(name)).tolist()).encode())
    return b"|".join(shown)
