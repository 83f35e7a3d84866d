"""Shapes and units that are left to whoever makes the component."""

from typing import Any

import numpy as np
import pytest

from cosim import Component, DeclarationError, input, output, parameter, state, structural


class Hold(Component):
    """Remembers the last *n* values of a signal of any shape and unit."""

    unit = structural("N", "unit of the signal")
    shape = structural((2,), "shape of the signal")
    n = structural(3, "how many values")
    rate = parameter(1.0, "unit/s", "a rate of it")
    u = input("unit", "the signal", shape="shape")
    x = state(0.0, "unit", "the signal", shape="shape")
    line = state(0.0, "unit", "the last values", shape=("n", "shape"))
    count = state(0.0, "1", "how many there were", whole=True)
    y = output("unit", "the signal", shape="shape")

    def sync(s: Any) -> dict[str, Any]:
        return dict(x=s.u, count=s.count + 1)

    def outputs(s: Any) -> dict[str, Any]:
        return dict(y=s.x)


@pytest.mark.parametrize(
    ("shape", "line"), [((), (3, 1)), ((4,), (3, 4)), ([2, 3], (3, 6))], ids=["scalar", "vector", "matrix"]
)
def test_a_shape_named_alone_is_taken_as_it_is_and_beside_others_as_its_number_of_elements(
    shape: Any, line: tuple[int, ...]
) -> None:
    variables = Hold(shape=shape).variables
    assert variables["u"].shape == variables["x"].shape == variables["y"].shape == tuple(shape)
    assert variables["line"].shape == line


def test_a_unit_named_is_that_of_the_component_made() -> None:
    variables = Hold(unit="m/s").variables
    assert [variables[n].unit for n in ("u", "x", "line", "y", "rate", "count")] == [*4 * ["m/s"], "m/s2", "1"]


def test_values_of_any_shape_pass_row_by_row() -> None:
    instance = Hold(shape=(2, 3)).instance()
    instance.enter_initialization()
    instance.exit_initialization()
    instance.u[:] = np.arange(6)
    instance.push()
    instance.step(0, 1)
    np.testing.assert_array_equal(instance.get("y"), [[0, 1, 2], [3, 4, 5]])


def test_states_of_whole_numbers_are_discrete() -> None:
    assert Hold().variables["count"].variability == "discrete"


def test_components_that_differ_in_structure_do_not_share_equations() -> None:
    assert Hold().equations is not Hold(shape=(3,)).equations
    assert Hold(rate=2.0).equations is Hold().equations


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"unit": "furlong"}, "Hold.unit: cannot read unit 'furlong': the symbol 'furlong' is not known"),
        ({"unit": 1}, "Hold.unit must be the spelling of a unit, such as 'm/s', not 1"),
        ({"shape": 4}, "Hold.shape must be a shape of at most 2 sizes, such as [4] or [], not 4"),
        ({"shape": [1, 2, 3]}, "Hold.shape must be a shape of at most 2 sizes, such as [4] or [], not [1, 2, 3]"),
        ({"shape": [2.0]}, "Hold.shape must be a shape of at most 2 sizes, such as [4] or [], not [2.0]"),
        ({"rate": [1.0, 2.0], "unit": "m"}, "Hold.rate [m/s] has shape [], but was given [2]"),
    ],
)
def test_values_that_do_not_fit_are_refused(values: dict[str, Any], sentence: str) -> None:
    with pytest.raises(DeclarationError) as caught:
        Hold(**values)
    assert str(caught.value) == sentence


def test_a_name_that_is_no_unit_of_the_component_is_read_as_a_unit() -> None:
    with pytest.raises(DeclarationError, match=r"Bad.u: cannot read unit 'size': the symbol 'size' is not known"):

        class Bad(Component):
            """Names a size as a unit."""

            size = structural(3, "a size")
            u = input("size", "an input")
