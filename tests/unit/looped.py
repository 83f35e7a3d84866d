"""What the tests of algebraic loops share: components that feed through, in a ring, and what comes of it."""

from __future__ import annotations

from typing import Any

import casadi as ca
import pytest

from cosim import Component, CouplingError, Instance, System, input, output, parameter

ROUNDING = 1e-14  # relative; a dozen roundings of 1.1e-16 each, in evaluations and one small linear solve


class Line(Component):
    """y = k u + c."""

    k = parameter(2.0, "1", "gain")
    c = parameter(1.0, "1", "offset")
    u = input("1", "what goes in", start=0.2)
    y = output("1", "what comes out")

    def outputs(s: Any) -> dict[str, Any]:
        return dict(y=s.k * s.u + s.c)


class Curve(Component):
    """y = f(u) of the chosen kind, and its two inputs side by side."""

    u = input("1", "what goes in", start=0.2)
    cosine = output("1", "cos u")
    cube = output("1", "c - u^3 with c = 10")
    parabola = output("1", "u^2 + 1, which no u equals")
    root = output("1", "the square root of u")

    def outputs(s: Any) -> dict[str, Any]:
        return dict(cosine=ca.cos(s.u), cube=10 - s.u**3, parabola=s.u**2 + 1, root=ca.sqrt(s.u))


def initial(parts: dict[str, Instance], wires: dict[str, Any]) -> System:
    """Return a system that has been initialised."""
    system = System(parts, wires)
    system.initialize()
    return system


def refusal(parts: dict[str, Instance], wires: dict[str, Any]) -> str:
    """Return the sentence with which a system refuses to be initialised."""
    with pytest.raises(CouplingError) as caught:
        initial(parts, wires)
    return str(caught.value)


def lines(*gains: float) -> dict[str, Instance]:
    """Return lines by the names a, b, ..."""
    return {chr(ord("a") + i): Line(k=k).instance() for i, k in enumerate(gains)}


RING = {"a.u": "b.y", "b.u": "a.y"}
