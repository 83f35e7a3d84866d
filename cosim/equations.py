"""The equations of a component as CasADi functions of flat vectors, for the Python instance and for the C code.

Every function takes ``(t, h, x, u, p, w, k)``: time, step length, states, inputs, parameters, looked-up table rows and
the constants that ``once`` computes from h and p, each flattened in the order of declaration, arrays row-major.
``jump`` takes the crossing directions ``c`` behind them, ``jvp`` the seeds ``dx, du``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from .component import EQUATIONS
from .errors import DeclarationError, nearest

if TYPE_CHECKING:
    from .component import Component


@dataclass(frozen=True)
class Block:
    """Where one declared quantity lies in its flat vector."""

    name: str
    shape: tuple[int, ...]
    at: slice


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
                alone = alone and not any(f.jac_sparsity(0, f.name_in().index(name)).nnz() for name in ("t", "u"))
                states |= np.array(ca.DM(f.jac_sparsity(0, f.name_in().index("x")), 1)).any(axis=0)
        return alone, states

    def functions(self) -> dict[str, ca.Function]:
        """Return the functions that exist, by name."""
        return {name: f for name, f in vars(self).items() if isinstance(f, ca.Function)}


class Namespace(SimpleNamespace):
    """The ``s`` of the equations; a misspelt name is a DeclarationError."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        raise DeclarationError(f"the equations read s.{name}, which is not declared; {nearest(name, vars(self))}")


def _layout(component: Component, role: str) -> tuple[tuple[Block, ...], int]:
    blocks, at = [], 0
    for name, d in component.declared(role).items():
        shape = component.shape_of(d)
        size = int(np.prod(shape, dtype=int))
        blocks.append(Block(name, shape, slice(at, at + size)))
        at += size
    return tuple(blocks), at


def _unflatten(flat: ca.SX, block: Block) -> ca.SX:
    part = flat[block.at]
    return ca.reshape(part, block.shape[1], block.shape[0]).T if len(block.shape) == 2 else part


def _flatten(value: Any, block: Block, where: str, kind: Any = ca.SX) -> ca.SX:
    try:
        sx = kind(value) if not isinstance(value, (list, tuple)) else ca.vertcat(*value)
        sx = ca.densify(kind(sx))
    except (NotImplementedError, TypeError, RuntimeError):
        raise DeclarationError(
            f"{where} returned {type(value).__name__} for {block.name}; return a CasADi expression"
        ) from None
    want = ((*block.shape, 1, 1))[:2]
    if len(block.shape) == 1 and sx.shape == (1, block.shape[0]):
        sx = sx.T
    if sx.shape != want:
        raise DeclarationError(
            f"{where} returned shape {list(sx.shape)} for {block.name}, declared {list(block.shape)}"
        )
    return ca.reshape(sx.T, -1, 1) if len(block.shape) == 2 else sx


def _evaluate(component: Component, function: str, s: Namespace) -> dict[str, Any]:
    where = f"{type(component).__name__}.{function}"
    try:
        result = getattr(component, function)(s)
    except Exception as error:
        if isinstance(error, DeclarationError):
            raise DeclarationError(f"{where}: {error}") from None
        if "__bool__" in str(error) or "Only scalar" in str(error) or "truth value" in str(error):
            raise DeclarationError(
                f"{where} branched on a value that is only known at run time; write casadi.if_else(condition, a, b)"
            ) from error
        raise
    if not isinstance(result, dict):
        raise DeclarationError(f"{where} returned {type(result).__name__}; return a dict of names to expressions")
    return result


def _collect(
    component: Component,
    function: str,
    s: Namespace,
    blocks: tuple[Block, ...],
    default: Callable[[Block], ca.SX] | None,
) -> ca.SX:
    """Call one equation function and flatten what it returns over *blocks*; *default* fills what it leaves out."""
    where = f"{type(component).__name__}.{function}"
    result = _evaluate(component, function, s)
    known = [b.name for b in blocks]
    for name in result:
        if name not in known:
            raise DeclarationError(f"{where} returned {name!r}, which is not declared for it; {nearest(name, known)}")
    parts = []
    for block in blocks:
        if block.name in result:
            parts.append(_flatten(result[block.name], block, where, component.symbols))
        elif default is not None:
            parts.append(default(block))
        else:
            raise DeclarationError(f"{where} returned nothing for {block.name}, which is declared")
    return ca.vertcat(*parts) if parts else component.symbols(0, 1)


@dataclass
class _Symbols:
    """The flat vectors as symbols and the namespace ``s`` that shows their parts."""

    states: tuple[Block, ...]
    inputs: tuple[Block, ...]
    parameters: tuple[Block, ...]
    tables: tuple[Block, ...]
    t: ca.SX
    h: ca.SX
    x: ca.SX
    u: ca.SX
    p: ca.SX
    w: ca.SX
    k: ca.SX
    s: Namespace
    keys: ca.SX  # where the tables are read, in their order
    constants: ca.SX  # what k stands for

    def function(self, name: str, result: ca.SX, *more: ca.SX) -> ca.Function:
        """Return *result* as a function of the flat vectors and *more*."""
        extra = [f"a{i}" for i in range(len(more))]
        arguments = [self.t, self.h, self.x, self.u, self.p, self.w, self.k, *more]
        names = ["t", "h", "x", "u", "p", "w", "k", *extra]
        return ca.Function(name, arguments, [ca.cse(ca.densify(result))], names, ["r"])

    def held(self, block: Block) -> ca.SX:
        """Return a state as it is."""
        return self.x[block.at]

    def constant(self, block: Block) -> ca.SX:
        """Return the derivative of a state that only ``sync`` or ``jump`` changes."""
        return type(self.x).zeros(block.at.stop - block.at.start)


def _symbols(component: Component) -> _Symbols:
    states, n_x = _layout(component, "state")
    inputs, n_u = _layout(component, "input")
    parameters, n_p = _layout(component, "parameter")
    kind = component.symbols
    t, h = kind.sym("t"), kind.sym("h")
    x, u, p = kind.sym("x", n_x), kind.sym("u", n_u), kind.sym("p", n_p)
    s = Namespace(time=t, dt=h, **component.structure)
    for flat, blocks in ((x, states), (u, inputs), (p, parameters)):
        for block in blocks:
            setattr(s, block.name, _unflatten(flat, block))
    k, constants = _constants(component, s, [b.name for b in parameters])
    tables, keys = _lookups(component, s)
    w = kind.sym("w", tables[-1].at.stop if tables else 0)
    for block in tables:
        setattr(s, block.name, _unflatten(w, block))
    return _Symbols(states, inputs, parameters, tables, t, h, x, u, p, w, k, s, keys, constants)


def _constants(component: Component, s: Namespace, parameters: list[str]) -> tuple[ca.SX, ca.SX]:
    """Put the component's constants into *s* as symbols; return these, flattened, and what they stand for."""
    kind = component.symbols
    if not hasattr(component, "constants"):
        return kind.sym("k", 0), kind(0, 1)
    known = {name: getattr(s, name) for name in ("dt", *component.structure, *parameters)}
    found = {n: kind(v) for n, v in _evaluate(component, "constants", Namespace(**known)).items()}
    for name in found:
        if name in component.declarations:
            raise DeclarationError(f"{type(component).__name__}.constants returned {name!r}, which is declared")
    parts = [ca.vec(ca.densify(v)) for v in found.values()]
    k, at = kind.sym("k", sum(v.numel() for v in parts)), 0
    for name, value in found.items():
        setattr(s, name, ca.reshape(k[at : at + value.numel()], *value.shape))
        at += value.numel()
    return k, ca.vertcat(*parts)


def _lookups(component: Component, s: Namespace) -> tuple[tuple[Block, ...], ca.SX]:
    """Return where the rows of each declared table lie, and the keys they are looked up by."""
    if not (declared := component.declared("table")):
        return (), component.symbols(0, 1)
    found = _evaluate(component, "lookups", s)
    if set(found) != set(declared):
        raise DeclarationError(f"{type(component).__name__}.lookups must return keys for {', '.join(declared)}")
    blocks, keys, at = [], [], 0
    for name, d in declared.items():
        key = found[name]
        keys.append(ca.vertcat(*key) if isinstance(key, (list, tuple)) else component.symbols(key))
        rows = keys[-1].numel()
        blocks.append(Block(name, (rows, d.columns), slice(at, at + rows * d.columns)))
        at += rows * d.columns
    return tuple(blocks), ca.vertcat(*keys)


def _announced(component: Component, event: str) -> bool:
    announce = component.declarations[event].announce
    return bool(component.structure[announce]) if isinstance(announce, str) else announce


def build(component: Component) -> Equations:
    """Evaluate the component's equations on symbols; raises DeclarationError where they contradict the declarations."""
    outputs, _ = _layout(component, "output")
    events, n_g = _layout(component, "event")
    _check_roles(component, events=n_g > 0)
    v = _symbols(component)
    defined = {name: hasattr(component, name) for name in ("derivatives", "sync", "flow", "jump")}

    def collect(name: str, blocks: tuple[Block, ...], default: Callable[[Block], ca.SX] | None = None) -> ca.SX:
        return _collect(component, name, v.s, blocks, default)

    kind = component.symbols
    out = collect("outputs", outputs) if outputs else kind(0, 1)
    ode = collect("derivatives", v.states, v.constant if defined["sync"] else None) if defined["derivatives"] else None
    sync = v.function("sync", collect("sync", v.states, v.held)) if defined["sync"] else None
    flow = v.function("flow", collect("flow", v.states, v.held)) if defined["flow"] else None
    zero = v.function("zero", collect("crossings", events)) if events else None
    jump = None
    if defined["jump"]:
        c = kind.sym("c", n_g)
        v.s.crossed = Namespace(**{b.name: _unflatten(c, b) for b in events})
        jump = v.function("jump", collect("jump", v.states, v.held), c)
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
