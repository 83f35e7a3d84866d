"""Events of an instance that announces none: located by going back and stepping again, to the nanosecond.

An indicator is an output that tells of an event by what it does:

| it does | an event is |
| --- | --- |
| ``rising`` | a change from below zero to zero or above |
| ``falling`` | a change from zero or above to below |
| ``crossing`` | either |
| ``change`` | any change of its value, as of a counter or a flag |

An indicator that changes twice within one step has done nothing: a step must be shorter than what is looked for.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from .errors import WiringError, nearest
from .instance import Advance, Instance
from .variable import FLOAT

KINDS = ("rising", "falling", "crossing", "change")


def located(instances: Mapping[str, Instance], events: Mapping[str, str]) -> dict[str, Instance]:
    """Return the instances, those with indicators in *events* (port: kind) made to return early there.

    Raises WiringError for an indicator that is none.
    """
    chosen: dict[str, dict[str, str]] = {}
    for port, kind in events.items():
        component, _, name = port.partition(".")
        if component not in instances:
            raise WiringError(f"the event indicator {port!r} names no component; {nearest(component, instances)}")
        outputs = {n: v for n, v in instances[component].variables.items() if v.causality == "output"}
        if name not in outputs:
            raise WiringError(f"the event indicator {port!r} is no output of {component}; {nearest(name, outputs)}")
        if kind not in KINDS:
            raise WiringError(f"the event indicator {port} cannot be {kind!r}; {nearest(kind, KINDS)}")
        if kind != "change" and outputs[name].type != FLOAT:
            raise WiringError(
                f"the event indicator {port} is a {outputs[name].type}; only its 'change' can be an event"
            )
        if instances[component].can.event_mode:
            raise WiringError(f"the event indicator {port} is not needed: {component} has an event mode of its own")
        chosen.setdefault(component, {})[name] = kind
    return {n: Located(i, chosen[n]) if n in chosen else i for n, i in instances.items()}


class Located(Instance):
    """An instance whose steps return early at the changes of its *indicators* (output: kind)."""

    def __init__(self, instance: Instance, indicators: Mapping[str, str]) -> None:
        super().__init__(instance.name, instance.variables)
        self.instance, self.indicators = instance, dict(indicators)
        self.can = replace(instance.can, early_return=True)
        self.u, self.y = instance.u, instance.y
        self._met = -1  # ns, where the last event was located
        self._known: dict[int, np.ndarray] = {}  # what the indicators were where the last step began and ended
        self._derivatives: list[np.ndarray] = []

    @property
    def name(self) -> str:
        """The instance's own name."""
        return self.instance.name

    @name.setter
    def name(self, name: str) -> None:
        if hasattr(self, "instance"):
            self.instance.name = name

    # stepping

    def step(self, start: int, end: int, *, early_return: bool = False) -> Advance:
        """Advance to *end*, or if *early_return* to the first tick after an indicator changed."""
        if not early_return:
            return self._advance(start, end)
        before, saved = self._known[start], self.instance.snapshot()
        try:
            advance = self._advance(start, end, early_return=self.instance.can.early_return)
            if advance.discarded:  # what it shows now means nothing
                return advance
            met, now = advance.reached, self._shown()
            happened = met > start and self._happened(before, now)
            if happened:
                met, now = self._bisect(saved, start, met, before, now)
        finally:
            self.instance.forget(saved)
        self._known = {start: before, met: now}
        if not happened:
            return advance
        self._met = met
        return Advance(met, early=True, terminated=advance.terminated and met == advance.reached)

    def _bisect(
        self, saved: Any, start: int, high: int, before: np.ndarray, after: np.ndarray
    ) -> tuple[int, np.ndarray]:
        """Return the first tick at which it has happened and the values there, with the instance there, too.

        It has happened at *high*.  The Illinois method where the indicator is smooth; halving where that is slow, as
        at a jump.
        """
        low, at, width, slow = start, high, high - start, 0
        below, above = self._level(before), self._level(after)
        while high - low > 1:
            guess = low + int((high - low) * below / (below - above)) if below * above < 0 else (low + high) // 2
            if slow >= 2:
                guess, slow = (low + high) // 2, 0
            if high == self._met:
                guess = high - 1  # it was met there before, and only moved a little
            at = min(max(guess, low + 1), high - 1)
            self.instance.restore(saved)
            self._advance(start, at)
            now = self._shown()
            if self._happened(before, now):
                high, after, above, below = at, now, self._level(now), below / 2
            else:
                low, below, above = at, self._level(now), above / 2
            slow = slow + 1 if high - low > width // 2 else 0
            width = high - low
        if at != high:
            self.instance.restore(saved)
            self._advance(start, high)
            self.instance.pull()
        return high, after

    def _advance(self, start: int, end: int, *, early_return: bool = False) -> Advance:
        if self._derivatives:
            self.instance.set_input_derivatives(self._derivatives)
        return self.instance.step(start, end, early_return=early_return)

    def _shown(self) -> np.ndarray:
        """Return the values of the indicators where the instance is, one after the other."""
        self.instance.pull()
        return np.concatenate([np.ravel(np.asarray(self._value(n), float)) for n in self.indicators])

    def _value(self, name: str) -> Any:
        return self.y[self.y_at[name]] if name in self.y_at else self.instance.get(name)

    def _changes(self, before: np.ndarray, now: np.ndarray) -> np.ndarray:
        """Return for each value whether it did what makes an event."""
        kinds = np.repeat(list(self.indicators.values()), [self.variables[n].size for n in self.indicators])
        up, down = (before < 0) & (now >= 0), (before >= 0) & (now < 0)
        found = np.select(
            [kinds == "rising", kinds == "falling", kinds == "crossing"], [up, down, up | down], before != now
        )
        return np.asarray(found, bool)

    def _happened(self, before: np.ndarray, now: np.ndarray) -> bool:
        return bool(self._changes(before, now).any())

    def _level(self, values: np.ndarray) -> float:
        """Return the indicator if there is only one, for a secant; 0 stands for halving."""
        return float(values[0]) if len(values) == 1 and np.isfinite(values[0]) else 0.0

    # everything else is the instance's own business

    def bind(self, u: np.ndarray, y: np.ndarray) -> None:
        self.instance.bind(u, y)
        self.u, self.y = u, y

    def set(self, name: str, value: Any) -> None:
        self.instance.set(name, value)

    def get(self, name: str) -> Any:
        return self.instance.get(name)

    def move(self, name: str, value: Any) -> None:
        self.instance.move(name, value)

    def enter_initialization(self, start: int = 0, stop: int | None = None, tolerance: float | None = None) -> None:
        self.instance.enter_initialization(start, stop, tolerance)
        self._start = start

    def exit_initialization(self) -> None:
        self.instance.exit_initialization()
        self._known = {self._start: self._shown()}

    def push(self) -> None:
        self._derivatives = []
        self.instance.push()

    def pull(self) -> None:
        self.instance.pull()

    def set_input_derivatives(self, values: list[np.ndarray]) -> None:
        self.instance.set_input_derivatives(values)
        self._derivatives = values

    def snapshot(self) -> Any:
        return self.instance.snapshot()

    def restore(self, snapshot: Any) -> None:
        self.instance.restore(snapshot)

    def forget(self, snapshot: Any) -> None:
        self.instance.forget(snapshot)

    def serialize(self, snapshot: Any) -> bytes:
        return self.instance.serialize(snapshot)

    def deserialize(self, data: bytes) -> Any:
        return self.instance.deserialize(data)

    def directional_derivative(self, unknowns: list[str], knowns: list[str], seed: np.ndarray) -> np.ndarray:
        return self.instance.directional_derivative(unknowns, knowns, seed)

    def close(self) -> None:
        self.instance.close()
