"""The contract of a component: what a declaration refuses, in which words, and what it accepts."""

from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np
import pytest

from cosim import Component, DeclarationError, event, input, output, parameter, state, structural, table
from cosim.component import table_rows, table_text


class Thing(Component):
    """One of everything that can be given a value."""

    kind = structural("round", "its kind", choices=("round", "flat"))
    n = structural(3, "how many")
    k = parameter(2.0, "N/m", "stiffness")
    shape = parameter(1.0, "1", "weights", shape="n")
    rows = table(2, "heights")
    u = input("m", "elongation", shape="n")
    F = output("N", "force", shape="n")

    def lookups(s: Any) -> dict[str, Any]:
        return dict(rows=[s.u[0]])

    def outputs(s: Any) -> dict[str, Any]:
        return dict(F=-s.k * s.shape * s.u + s.rows[0, 1])


def test_values_are_checked_and_read_back() -> None:
    thing = Thing(k=5, n=2, kind="flat", shape=[1, 2], rows=[[0, 1], [2, 3]])
    assert (thing.k, thing.n, thing.kind) == (5.0, 2, "flat")
    np.testing.assert_array_equal(thing.shape, [1, 2])
    assert repr(thing) == "Thing(kind='flat', n=2, k=5.0, shape=[1.0, 2.0], rows=[[0.0, 1.0], [2.0, 3.0]])"
    assert thing.replace(k=6).k == 6.0
    assert thing.k == 5.0


def test_values_cannot_be_changed_in_place() -> None:
    with pytest.raises(ValueError, match="read-only"):
        Thing().values["shape"][0] = 7


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"kk": 1.0}, "Thing has no parameter 'kk'; did you mean 'k'?"),
        ({"kind": "square"}, "Thing.kind cannot be 'square'; it is one of 'round', 'flat'"),
        ({"n": 2.5}, "Thing.n must be a whole number, not 2.5"),
        ({"n": -1}, "Thing.n must be a whole number, not -1"),
        ({"k": "stiff"}, "Thing.k [N/m] must be a number or an array of numbers, not 'stiff'"),
        ({"k": [1.0, 2.0]}, "Thing.k [N/m] has shape [], but was given [2]"),
        ({"shape": [1.0, 2.0]}, "Thing.shape [1] has shape [3], but was given [2]"),
        ({"k": float("nan")}, "Thing.k [N/m] must be finite, not nan"),
        ({"rows": [[0, 1, 2]]}, "Thing.rows [1] needs rows of 2 numbers, not an array of shape (1, 3)"),
        (
            {"rows": [[1, 0], [0, 0]]},
            "Thing.rows [1] needs its first column ascending, since rows are looked up by it",
        ),
    ],
)
def test_values_that_do_not_fit_are_refused(values: dict[str, Any], sentence: str) -> None:
    with pytest.raises(DeclarationError) as caught:
        Thing(**values)
    assert str(caught.value) == sentence


def reserved() -> Any:
    class Bad(Component):
        """Uses a name of the contract."""

        time = parameter(1.0, "s", "a time")


def meaningless() -> Any:
    class Bad(Component):
        """Says nothing."""

        k = parameter(1.0, "s", "")


def strange_unit() -> Any:
    class Bad(Component):
        """Uses a unit nobody knows."""

        k = parameter(1.0, "furlong", "a length")


def three_dimensions() -> Any:
    class Bad(Component):
        """Has a block of numbers."""

        u = input("1", "a block", shape=(2, 2, 2))


@pytest.mark.parametrize(
    ("declare", "sentence"),
    [
        (reserved, "Bad cannot declare 'time': the name is reserved by the contract"),
        (meaningless, "Bad.k has no meaning; write one line on what it is"),
        (strange_unit, "Bad.k: cannot read unit 'furlong': the symbol 'furlong' is not known"),
        (three_dimensions, "Bad.u has 3 dimensions; declare at most 2"),
    ],
)
def test_declarations_that_are_none(declare: Callable[[], Any], sentence: str) -> None:
    with pytest.raises(DeclarationError) as caught:
        declare()
    assert str(caught.value) == sentence


def bad(**body: Any) -> type[Component]:
    """Return a component with a state, an input and an output, and these functions or further declarations."""
    declared = {"x": state(0.0, "m", "a state"), "u": input("m", "an input"), "y": output("m", "an output")}
    defined = {"derivatives": lambda s: {"x": s.u}, "outputs": lambda s: {"y": s.x}}
    merged = {name: thing for name, thing in {**declared, **defined, **body}.items() if thing is not None}
    for name, thing in merged.items():
        if hasattr(thing, "role"):
            thing.__set_name__(Component, name)
    return type("Bad", (Component,), {"__doc__": "Breaks one rule.", **merged})


BROKEN: list[tuple[dict[str, Any], str]] = [
    (
        {"outputs": lambda s: {"y": s.z}},
        "Bad.outputs: the equations read s.z, which is not declared; known: time, dt, x, u",
    ),
    ({"outputs": lambda s: {"yy": s.x}}, "Bad.outputs returned 'yy', which is not declared for it; did you mean 'y'?"),
    ({"outputs": lambda s: {}}, "Bad.outputs returned nothing for y, which is declared"),
    ({"outputs": lambda s: s.x}, "Bad.outputs returned SX; return a dict of names to expressions"),
    ({"outputs": lambda s: {"y": "x"}}, "Bad.outputs returned str for y; return a CasADi expression"),
    ({"outputs": lambda s: {"y": ca.vertcat(s.x, s.x)}}, "Bad.outputs returned shape [2, 1] for y, declared []"),
    (
        {"outputs": lambda s: {"y": s.x if s.u > 0 else s.u}},
        "Bad.outputs branched on a value that is only known at run time; write casadi.if_else(condition, a, b)",
    ),
    ({"derivatives": None}, "Bad declares states, but no derivatives, flow or sync"),
    ({"outputs": None}, "Bad needs both declared outputs and outputs(s), or neither"),
    (
        {"derivatives": None, "flow": lambda s: {}, "e": event("an event"), "crossings": lambda s: {"e": s.x}},
        "Bad declares events, which a flow cannot locate; write derivatives",
    ),
    ({"e": event("an event")}, "Bad needs both declared events and crossings(s), or neither"),
    ({"crossings": lambda s: {}}, "Bad needs both declared events and crossings(s), or neither"),
    ({"jump": lambda s: {}}, "Bad defines jump(s), but declares no event"),
    ({"rows": table(2, "a table")}, "Bad needs both declared tables and lookups(s), or neither"),
    ({"rows": table(2, "a table"), "lookups": lambda s: {}}, "Bad.lookups must return keys for rows"),
    ({"period": parameter(1.0, "min", "a period")}, "Bad.period must be a parameter in s"),
    (
        {"period": state(1.0, "s", "a period"), "derivatives": lambda s: {"x": 0, "period": 0}},
        "Bad.period must be a parameter in s",
    ),
]


@pytest.mark.parametrize(("body", "sentence"), BROKEN, ids=[sentence[:60] for _, sentence in BROKEN])
def test_equations_that_contradict_the_declarations(body: dict[str, Any], sentence: str) -> None:
    with pytest.raises(DeclarationError) as caught:
        bad(**body)().equations  # noqa: B018
    assert str(caught.value) == sentence


def test_the_unbroken_one_is_fine() -> None:
    assert bad()().equations.feedthrough == {"y": ()}


def test_a_state_has_no_value_outside_an_instance() -> None:
    with pytest.raises(AttributeError, match=r"Bad.x is a state: it has a value in an instance only"):
        bad()().x  # noqa: B018


def test_dependencies_are_found_in_the_equations() -> None:
    class Through(Component):
        """One output of each kind."""

        a = input("1", "first", shape=2)
        b = input("1", "second")
        x = state(0.0, "1", "a state")
        held = output("1", "from the state")
        both = output("1", "from both", shape=2)

        def derivatives(s: Any) -> dict[str, Any]:
            return dict(x=s.b)

        def outputs(s: Any) -> dict[str, Any]:
            return dict(held=s.x, both=s.a * s.b)

    depends = {name: v.depends_on for name, v in Through().variables.items() if v.causality == "output"}
    assert depends == {"held": (), "both": ("a", "b")}
    assert Through().variables["der(x)"].unit == "1/s"


def test_matrices_are_row_major() -> None:
    class Matrix(Component):
        """y = A u."""

        A = parameter([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]], "1", "a matrix")
        u = input("1", "a vector", shape=3)
        y = output("1", "a vector", shape=2)
        B = output("1", "twice the matrix", shape=(2, 3))

        def outputs(s: Any) -> dict[str, Any]:
            return dict(y=s.A @ s.u, B=2 * s.A)

    instance = Matrix().instance()
    instance.u[:] = [1, 10, 100]
    instance.push()
    instance.pull()
    np.testing.assert_array_equal(instance.y, [321, 654, 2, 4, 6, 8, 10, 12])
    np.testing.assert_array_equal(instance.get("B"), [[2, 4, 6], [8, 10, 12]])
    assert instance.variable("A").labels() == ["A[1,1]", "A[1,2]", "A[1,3]", "A[2,1]", "A[2,2]", "A[2,3]"]


def test_tables_are_looked_up_by_the_last_row_not_above_the_key() -> None:
    instance = Thing(n=1, rows=[[0, 10], [1, 20], [2, 30]], shape=0.0).instance()
    found = []
    for u in (-5.0, 0.0, 0.999, 1.0, 7.0):
        instance.u[0] = u
        instance.push()
        instance.pull()
        found.append(instance.y[0])
    assert found == [10, 10, 10, 20, 30]


def test_the_text_of_a_table_keeps_every_bit() -> None:
    rows = np.array([[0.0, 0.1], [1 / 3, 1e-300]])
    np.testing.assert_array_equal(table_rows(table_text(rows)), rows)
    with pytest.raises(DeclarationError) as caught:
        table_rows("1 2; three")
    assert str(caught.value) == (
        "a table's text is rows of numbers separated by ';': could not convert string to float: 'three'"
    )


def test_equations_are_built_once_per_structure() -> None:
    assert Thing(k=1.0).equations is Thing(k=2.0).equations
    assert Thing(n=2).equations is not Thing(n=3).equations


def test_sizes_may_be_named() -> None:
    assert Thing(n=2).variables["u"].shape == (2,)
    assert len(Thing(n=5).instance().y) == 5
