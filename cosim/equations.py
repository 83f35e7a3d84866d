"""The equations of a component as CasADi functions of flat vectors, for the Python instance and for the C code.

Every function takes ``(t, h, x, u, p, w, k)``: time, step length, states, inputs, parameters, looked-up table rows and
the constants that ``once`` computes from h and p, each flattened in the order of declaration, arrays row-major.
``jump`` takes the crossing directions ``c`` behind them, ``jvp`` the seeds ``dx, du``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import casadi as ca
import numpy as np

from .component import EQUATIONS
from .errors import DeclarationError
from .symbols import Block, Namespace, collect, layout, shaped, symbols

if TYPE_CHECKING:
    from .component import Component


@dataclass(frozen=True)
class Equations:
    """Layout and functions; a function is None where the component does not define it."""

    states: tuple[Block, ...]
    inputs: tuple[Block, ...]
    parameters: tuple[Block, ...]
    outputs: tuple[Block, ...]
    events: tuple[Block, ...]
    tables: tuple[Block, ...]  # shape (keys, columns)
    once: ca.Function | None
    ode: ca.Function | None
    out: ca.Function
    sync: ca.Function | None
    flow: ca.Function | None
    zero: ca.Function | None
    jump: ca.Function | None
    where: ca.Function | None
    jvp: ca.Function
    feedthrough: dict[str, tuple[str, ...]]
    period: int | None  # index of the sample period among the parameters
    micro: int | None  # index of the longest micro step of a flow among them
    announced: tuple[bool, ...]  # per event indicator: does a step return early there
    nominal: np.ndarray  # per state

    @property
    def follows_inputs(self) -> bool:
        """Whether inputs that move within a step are seen there: not by a flow over the whole of it."""
        return self.flow is None or self.micro is not None

    def deciding(self) -> tuple[bool, np.ndarray]:
        """Return whether the indicators depend on states, parameters and tables alone, and on which states (n,)."""
        alone, states = True, np.zeros(len(self.nominal), bool)
        for f in (self.zero, self.where):
            if f is not None:
                alone = alone and not (reads(f, "t") or reads(f, "u"))
                states |= np.array(ca.DM(f.jac_sparsity(0, f.name_in().index("x")), 1)).any(axis=0)
        return alone, states

    def functions(self) -> dict[str, ca.Function]:
        """Return the functions that exist, by name."""
        return {name: f for name, f in vars(self).items() if isinstance(f, ca.Function)}


def _announced(component: Component, event: str) -> bool:
    announce = component.declarations[event].announce
    return bool(component.structure[announce]) if isinstance(announce, str) else announce


def reads(function: ca.Function, argument: str) -> bool:
    """Return whether the result of an equation function depends on an *argument*, by its letter."""
    return bool(function.jac_sparsity(0, function.name_in().index(argument)).nnz())


def build(component: Component) -> Equations:
    """Evaluate the component's equations on symbols; raises DeclarationError where they contradict the declarations."""
    outputs, _ = layout(component, "output")
    events, n_g = layout(component, "event")
    _check_roles(component, events=n_g > 0)
    v = symbols(component)
    defined = {name: hasattr(component, name) for name in ("derivatives", "sync", "flow", "jump")}

    def found(name: str, blocks: tuple[Block, ...], default: Callable[[Block], ca.SX] | None = None) -> ca.SX:
        return collect(component, name, v.s, blocks, default)

    kind = component.symbols
    out = found("outputs", outputs) if outputs else kind(0, 1)
    ode = found("derivatives", v.states, v.constant if defined["sync"] else None) if defined["derivatives"] else None
    sync = v.function("sync", found("sync", v.states, v.held)) if defined["sync"] else None
    flow = v.function("flow", found("flow", v.states, v.held)) if defined["flow"] else None
    zero = v.function("zero", found("crossings", events)) if events else None
    jump = None
    if defined["jump"]:
        c = kind.sym("c", n_g)
        v.s.crossed = Namespace(**{b.name: shaped(c, b) for b in events})
        jump = v.function("jump", found("jump", v.states, v.held), c)
    f_out = v.function("out", out)
    depends = ca.DM(f_out.jac_sparsity(0, 3), 1)  # of the outputs on the inputs
    dx, du = kind.sym("dx", v.x.numel()), kind.sym("du", v.u.numel())
    rates = ca.vertcat(ode if ode is not None else kind.zeros(v.x.numel()), out)
    return Equations(
        states=v.states,
        inputs=v.inputs,
        parameters=v.parameters,
        outputs=outputs,
        events=events,
        tables=v.tables,
        once=v.function("once", v.constants) if v.k.numel() else None,
        ode=v.function("ode", ode) if ode is not None else None,
        out=f_out,
        sync=sync,
        flow=flow,
        zero=zero,
        jump=jump,
        where=v.function("where", v.keys) if v.tables else None,
        jvp=v.function("jvp", ca.jtimes(rates, v.x, dx) + ca.jtimes(rates, v.u, du), dx, du)
        if kind is ca.MX
        else v.function("jvp", ca.jtimes(rates, ca.vertcat(v.x, v.u), ca.vertcat(dx, du)), dx, du),
        feedthrough={o.name: tuple(i.name for i in v.inputs if depends[o.at, i.at].nnz()) for o in outputs},
        period=next((b.at.start for b in v.parameters if b.name == "period"), None),
        micro=next((b.at.start for b in v.parameters if b.name == "micro_step"), None),
        announced=tuple(_announced(component, b.name) for b in events for _ in range(b.at.start, b.at.stop)),
        nominal=np.array(
            [component.declarations[b.name].nominal for b in v.states for _ in range(b.at.start, b.at.stop)]
        ),
    )


def _check_roles(component: Component, *, events: bool) -> None:
    """Refuse sets of equation functions that contradict each other or the declarations."""
    name = type(component).__name__
    period = component.declarations.get("period")
    if period is not None and (period.role, period.unit) != ("parameter", "s"):
        raise DeclarationError(f"{name}.period must be a parameter in s")
    has = {function: hasattr(component, function) for function in EQUATIONS}
    states, tables = bool(component.declared("state")), bool(component.declared("table"))
    advanced = has["derivatives"] or has["flow"] or has["sync"]
    rules = (
        (states and not advanced, "declares states, but no derivatives, flow or sync"),
        (has["flow"] and events, "declares events, which a flow cannot locate; write derivatives"),
        (events != has["crossings"], "needs both declared events and crossings(s), or neither"),
        (has["jump"] and not events, "defines jump(s), but declares no event"),
        (tables != has["lookups"], "needs both declared tables and lookups(s), or neither"),
        (
            bool(component.declared("output")) != has["outputs"],
            "needs both declared outputs and outputs(s), or neither",
        ),
    )
    for broken, sentence in rules:
        if broken:
            raise DeclarationError(f"{name} {sentence}")
