"""The Python instance of a component: CasADi's own evaluation and SciPy's integrator, an independent twin of the FMU.

Same semantics as the compiled harness, other code: DOP853 with dense output instead of the harness' Dormand-Prince
5(4), events located on the dense output.  For tests and prototyping; it is some hundred times slower than the FMU.
"""

from __future__ import annotations

import pickle
from collections.abc import Callable
from dataclasses import replace
from math import ceil
from typing import Any

import numpy as np

from .clock import NS, seconds, tick_at_or_after
from .component import Component, table_rows, table_text
from .equations import Equations
from .errors import StepError, WiringError
from .instance import Advance, Capabilities, Instance
from .symbols import Block

AFTER_EVENT = 1e-6  # s, the first step after an event


class PythonInstance(Instance):
    """A component with values, evaluated in Python."""

    def __init__(self, component: Component, name: str) -> None:
        self.component = component
        self.eq: Equations = component.equations
        super().__init__(name, component.variables)
        self.can = Capabilities(True, True, any(self.eq.announced), True)
        if self.eq.follows_inputs:
            self.can = replace(self.can, input_derivatives=2)
        self.t = 0.0
        self.x = self._starts(self.eq.states)
        self.p = self._starts(self.eq.parameters)
        self._u = self.u.copy()
        self._slopes: list[np.ndarray] = []  # derivatives of the inputs at the start of a step
        self._since = 0.0  # s, where that step began
        self.tables = {b.name: component.values[b.name] for b in self.eq.tables}
        self._constants: dict[float, np.ndarray] = {}  # by step length; of the parameters as they are
        self.tolerance = 1e-8
        self.after_event = False  # the states are a hair past an event: the next step is a short one

    def _starts(self, blocks: tuple[Block, ...]) -> np.ndarray:
        return np.concatenate([np.zeros(0)] + [np.ravel(self.variables[b.name].start) for b in blocks])

    # values

    def _place(self, name: str) -> tuple[np.ndarray, Block]:
        for values, blocks in ((self.x, self.eq.states), (self._u, self.eq.inputs), (self.p, self.eq.parameters)):
            for block in blocks:
                if block.name == name:
                    return values, block
        raise WiringError(f"{self.name}.{name} cannot be set: it is computed")

    def set(self, name: str, value: Any) -> None:
        variable = self.variable(name)
        if variable.type == "String":
            self.tables[name] = table_rows(value)
            return
        values, block = self._place(name)
        if np.shape(value) not in (block.shape, ()):
            raise WiringError(
                f"{self.name}.{name} has shape {list(block.shape)}, but was given {list(np.shape(value))}"
            )
        values[block.at] = np.ravel(np.broadcast_to(value, block.shape))
        if variable.causality == "input":
            self.u[block.at] = values[block.at]
        else:
            self._constants.clear()

    def move(self, name: str, value: Any) -> None:
        self.set(name, value)

    def get(self, name: str) -> Any:
        variable = self.variable(name)
        if variable.causality == "output":
            value = self._call("out")[next(b.at for b in self.eq.outputs if b.name == name)]
        elif name.startswith("der("):
            value = self._call("ode")[next(b.at for b in self.eq.states if f"der({b.name})" == name)]
        elif variable.type == "String":
            return table_text(self.tables[name])
        else:
            values, block = self._place(name)
            value = values[block.at]
        return value.reshape(variable.shape).copy() if variable.shape else float(value[0])

    def push(self) -> None:
        self._u[:] = self.u
        self._slopes = []

    def set_input_derivatives(self, values: list[np.ndarray]) -> None:
        if len(values) > self.can.input_derivatives:
            super().set_input_derivatives(values)
        self._slopes = [np.array(v, float) for v in values]

    def _inputs(self, t: float) -> np.ndarray:
        """Return the inputs at *t*: those set, or a polynomial from where the step began."""
        u, since = self._u, t - self._since
        for order, slope in enumerate(self._slopes, 1):
            u = u + since**order / (1, 1, 2)[order] * slope
        return u

    def pull(self) -> None:
        self.y[:] = self._call("out")

    # equations

    def _rows(self, t: float, x: np.ndarray, h: float) -> np.ndarray:
        if self.eq.where is None:
            return np.zeros(0)
        keys = np.asarray(self.eq.where(t, h, x, self._inputs(t), self.p, 0, self.constants(h))).ravel()
        found, k = [], 0
        for block in self.eq.tables:
            rows = self.tables[block.name]
            for key in keys[k : k + block.shape[0]]:
                found.append(rows[max(np.searchsorted(rows[:, 0], key, side="right") - 1, 0)])
            k += block.shape[0]
        return np.concatenate(found)

    def _call(
        self, function: str, t: float | None = None, x: np.ndarray | None = None, h: float = 0.0, *more: Any
    ) -> np.ndarray:
        t, x = self.t if t is None else t, self.x if x is None else x
        u = self._inputs(t)
        given = (t, h, x, u, self.p, self._rows(t, x, h), self.constants(h), *more)
        return np.asarray(getattr(self.eq, function)(*given)).ravel()

    def _check(self, values: np.ndarray, blocks: tuple[Block, ...], t: float, what: str) -> None:
        if not np.all(np.isfinite(values)):
            bad = int(np.flatnonzero(~np.isfinite(values))[0])
            block = next(b for b in blocks if b.at.start <= bad < b.at.stop)
            label = self.variables[block.name].labels()[bad - block.at.start]
            raise StepError(self.name, t, f"{what} {label} is {values[bad]}")

    def looked_up(self) -> np.ndarray:
        """Return the rows of the tables that are read where the instance is, flattened."""
        return self._rows(self.t, self.x, 0.0)

    def constants(self, h: float) -> np.ndarray:
        """Return what depends on the parameters and the step length *h* (s) alone, flattened."""
        if self.eq.once is None:
            return np.zeros(0)
        if h not in self._constants:
            self._constants = {h: np.asarray(self.eq.once(0, h, 0, 0, self.p, 0, 0)).ravel()}
        return self._constants[h]

    # life

    def enter_initialization(self, start: int = 0, stop: int | None = None, tolerance: float | None = None) -> None:
        self.t = seconds(start)
        self.tolerance = tolerance or self.tolerance

    def exit_initialization(self) -> None:
        self._check(self.x, self.eq.states, self.t, "start value")

    def step(self, start: int, end: int, *, early_return: bool = False) -> Advance:
        self._check(self._u, self.eq.inputs, seconds(start), "input")
        now, self._since = start, seconds(start)
        for tick in self._ticks(start, end):
            if self.eq.sync is not None and tick < end:
                if tick > now and (stopped := self._advance(now, tick, early_return)).early:
                    return stopped
                self.t = seconds(tick)
                self.x = self._call("sync", h=seconds(end - tick))
                self._check(self.x, self.eq.states, self.t, "state")
                now = tick
        advance = self._advance(now, end, early_return)
        if advance.reached == end:
            self.t = seconds(end)
        self._check(self.x, self.eq.states, self.t, "state")
        return advance

    def _ticks(self, start: int, end: int) -> list[int]:
        if self.eq.period is None:
            return [start]
        period = round(self.p[self.eq.period] * NS)
        return list(range(-(-start // period) * period, end, period))

    def _advance(self, start: int, end: int, early_return: bool) -> Advance:
        """Integrate from one tick to another, through every event that does not stop it."""
        t, stop = seconds(start), seconds(end)
        if self.eq.flow is not None:
            n = 1 if self.eq.micro is None else max(1, ceil((stop - t) / self.p[self.eq.micro] - 1e-6))
            h = seconds(end - start) / n
            for i in range(n):
                self.x = self._call("flow", t + i * h, self.x, h)
            return Advance(end)
        if self.eq.ode is None:
            return Advance(end)
        announced, early = np.array(self.eq.announced), False
        while t < stop:
            t, crossed = self._integrate(t, stop)
            self.t = t
            if crossed is None:
                break
            if self.eq.jump is not None:
                self.x = self._call("jump", t, self.x, 0.0, crossed)
            if early_return and np.any(crossed[announced]):
                reached, early = max(tick_at_or_after(t), start + 1), True
                if reached < end:
                    return Advance(reached, early)
        return Advance(end, early)

    def _signs(self, t: float, x: np.ndarray) -> np.ndarray:
        return np.where(self._call("zero", t, x) >= 0, 1, -1) if self.eq.zero is not None else np.zeros(0, int)

    def _integrate(self, t: float, stop: float) -> tuple[float, np.ndarray | None]:
        """Integrate to *stop* or just past the first event; return the time and the directions crossed."""
        from scipy.integrate import DOP853  # takes a second to import, and FMUs bring their own integrator

        scale = np.maximum(self.eq.nominal, 1e-300) * self.tolerance
        # Past an event a large step would miss that an indicator goes back and crosses again, as a ball's on a floor.
        first = min(AFTER_EVENT, stop - t) if self.after_event else None
        options = {"rtol": self.tolerance, "atol": scale, "first_step": first}
        solver = DOP853(lambda t, x: self._call("ode", t, x), t, self.x, stop, **options)
        before = self._signs(t, self.x)
        while solver.status == "running":
            message = solver.step()
            self.after_event = False
            if solver.status == "failed" or not np.all(np.isfinite(solver.y)):
                raise StepError(self.name, solver.t, f"the integrator gave up: {message or 'a state is not finite'}")
            if np.any(self._signs(solver.t, solver.y) != before):
                dense = solver.dense_output()
                time = self._locate(dense, solver.t_old, solver.t, before)
                self.x = dense(time)
                self.after_event = True
                return time, (self._signs(time, self.x) - before) // 2
        self.x = solver.y
        return stop, None

    def _locate(self, dense: Callable[[float], np.ndarray], low: float, high: float, before: np.ndarray) -> float:
        """Return the first float after *low* at which an indicator has another sign than *before*, by bisection."""
        while low < (middle := (low + high) / 2) < high:
            if np.any(self._signs(middle, dense(middle)) != before):
                high = middle
            else:
                low = middle
        return high

    # rollback

    def snapshot(self) -> Any:
        kept: dict[str, Any] = {
            "t": self.t, "x": self.x, "u": self._u, "p": self.p, "after_event": self.after_event,
            "slopes": self._slopes, "since": self._since,
        }  # fmt: skip
        return {name: np.copy(value) for name, value in kept.items()}

    def restore(self, snapshot: Any) -> None:
        self.after_event = bool(snapshot["after_event"])
        self._constants.clear()
        self.t, self.x, self.p = float(snapshot["t"]), snapshot["x"].copy(), snapshot["p"].copy()
        self._slopes, self._since = list(snapshot["slopes"]), float(snapshot["since"])
        self._u[:] = snapshot["u"]
        self.u[:] = snapshot["u"]

    def serialize(self, snapshot: Any) -> bytes:
        return pickle.dumps(snapshot)

    def deserialize(self, data: bytes) -> Any:
        return pickle.loads(data)

    def directional_derivative(self, unknowns: list[str], knowns: list[str], seed: np.ndarray) -> np.ndarray:
        dx, du = np.zeros_like(self.x), np.zeros_like(self._u)
        at = 0
        for name in knowns:
            target, blocks = (du, self.eq.inputs) if self.variable(name).causality == "input" else (dx, self.eq.states)
            block = next(b for b in blocks if b.name == name)
            n = block.at.stop - block.at.start
            target[block.at] = np.ravel(seed)[at : at + n]
            at += n
        result = self._call("jvp", None, None, 0.0, dx, du)
        parts = []
        for name in unknowns:
            if name.startswith("der("):
                parts.append(result[next(b.at for b in self.eq.states if f"der({b.name})" == name)])
            else:
                block = next(b for b in self.eq.outputs if b.name == name)
                parts.append(result[len(self.x) + block.at.start : len(self.x) + block.at.stop])
        return np.concatenate(parts)
