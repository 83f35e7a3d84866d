"""Algebraic loops that have no solution, or none that can be found, are refused: by path, value, residual and unit."""

from typing import Any

import pytest
from looped import RING, Curve, Line, initial, refusal
from toys import Scripted, port

from cosim import Component, Instance, input, output


def test_a_loop_of_other_types_settles_or_is_refused() -> None:
    class Switch(Scripted):
        """A comparator with a switch: shows 5 while off and 1 while on, and whether its input is above *at*."""

        at = 3.0

        def pull(self) -> None:
            self.y[0] = 1.0 if self.values["on"] else 5.0
            self.values["above"] = bool(self.held[0] > self.at)

    ports = [
        port("u", "input"), port("on", "input", "Boolean", start=False),
        port("y", "output", depends_on=("on",)), port("above", "output", "Boolean", depends_on=("u",)),
    ]  # fmt: skip

    def switch(at: float) -> dict[str, Instance]:
        part = Switch(ports)
        part.at = at
        part.values |= {"above": False}
        return {"s": part, "a": Line(k=1.0, c=0.0).instance()}

    wires = {"a.u": "s.y", "s.u": "a.y", "s.on": "s.above"}
    assert initial(switch(0.5), wires)["s.y"] == 1.0  # on, and above 0.5: on
    assert (
        "does not settle at initialisation: values that are no real numbers still change after 20 passes, of s.on"
        in (
            refusal(switch(3.0), wires)  # off: 5 is above 3, so on; on: 1 is not, so off
        )
    )


def test_a_loop_without_a_solution_is_named_with_its_residual() -> None:
    sentence = refusal(
        {"a": Curve().instance(), "b": Line(k=1.0, c=0.0).instance()}, {"a.u": "b.y", "b.u": "a.parabola"}
    )
    assert sentence.startswith(
        "the algebraic loop a.u -> a.parabola -> b.u -> b.y -> a.u is not solved at initialisation: after "
    )
    residual = float(sentence.split("a residual of ")[1].split(";")[0])
    assert residual == pytest.approx(0.75, rel=1e-3)  # the least of u^2 + 1 - u, printed to three digits
    assert sentence.endswith(
        "it breaks where one of these outputs comes from a state instead of directly from an input"
    )


@pytest.mark.parametrize(("offset", "residual"), [(0.0, 0.0), (1.0, 1.0)])
def test_a_loop_that_any_or_no_value_solves_is_refused(offset: float, residual: float) -> None:
    parts = {"a": Line(k=1.0, c=0.0).instance(), "b": Line(k=1.0, c=offset).instance()}
    sentence = refusal(parts, RING)
    assert "its equations are singular there, as they are without a solution or with more than one" in sentence
    assert float(sentence.split("a residual of ")[1].split(";")[0]) == pytest.approx(residual, abs=1e-15)


def test_a_residual_has_its_unit() -> None:
    class Lever(Component):
        """F = F + 2 N, which cannot be."""

        F = input("N", "force")
        out = output("N", "force")

        def outputs(s: Any) -> dict[str, Any]:
            return dict(out=s.F + 2)

    assert "l.F is 0 N where l.out gives 2 N, a residual of 2 N;" in refusal(
        {"l": Lever().instance()}, {"l.F": "l.out"}
    )


def test_a_start_outside_the_domain_is_named() -> None:
    part = Curve().instance()
    part.set("u", -1.0)
    sentence = refusal({"a": part}, {"a.u": "a.root"})
    assert "after 0 iterations a.u is -1 where a.root gives nan" in sentence
    assert "a start value nearer to a solution may help" in sentence


def test_a_loop_that_is_only_assumed_says_so() -> None:
    silent = Scripted([port("u", "input"), port("y", "output", depends_on=None)])
    sentence = refusal({"a": Line(k=1.0, c=1.0).instance(), "b": silent}, RING)
    assert "(b.y: dependencies not declared, so all inputs are assumed to feed through)" in sentence
