"""What the equations of a component are written with: flat vectors of symbols, and the namespace that shows them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from .errors import DeclarationError, nearest

if TYPE_CHECKING:
    from .component import Component


@dataclass(frozen=True)
class Block:
    """Where one declared quantity lies in its flat vector."""

    name: str
    shape: tuple[int, ...]
    at: slice


class Namespace(SimpleNamespace):
    """The ``s`` of the equations; a misspelt name is a DeclarationError."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        raise DeclarationError(f"the equations read s.{name}, which is not declared; {nearest(name, vars(self))}")


def layout(component: Component, role: str) -> tuple[tuple[Block, ...], int]:
    blocks, at = [], 0
    for name, d in component.declared(role).items():
        shape = component.shape_of(d)
        size = int(np.prod(shape, dtype=int))
        blocks.append(Block(name, shape, slice(at, at + size)))
        at += size
    return tuple(blocks), at


def shaped(flat: ca.SX, block: Block) -> ca.SX:
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


def collect(
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
class Symbols:
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


def symbols(component: Component) -> Symbols:
    states, n_x = layout(component, "state")
    inputs, n_u = layout(component, "input")
    parameters, n_p = layout(component, "parameter")
    kind = component.symbols
    t, h = kind.sym("t"), kind.sym("h")
    x, u, p = kind.sym("x", n_x), kind.sym("u", n_u), kind.sym("p", n_p)
    s = Namespace(time=t, dt=h, **component.structure)
    for flat, blocks in ((x, states), (u, inputs), (p, parameters)):
        for block in blocks:
            setattr(s, block.name, shaped(flat, block))
    k, constants = _constants(component, s, [b.name for b in parameters])
    tables, keys = _lookups(component, s)
    w = kind.sym("w", tables[-1].at.stop if tables else 0)
    for block in tables:
        setattr(s, block.name, shaped(w, block))
    return Symbols(states, inputs, parameters, tables, t, h, x, u, p, w, k, s, keys, constants)


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
