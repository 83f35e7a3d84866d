"""Where an FMU's scalars lie and what they are called; what depends on what."""

from __future__ import annotations

import numpy as np
import pytest

from cosim import Component, input, output, parameter, state, structural, table
from fmus.declared import declared_variables
from fmus.layout import Layout


class Thing(Component):
    """Something of everything."""

    n = structural(2, "a size")
    k = parameter(3.0, "N/m", "stiffness")
    F = input("N", "force", shape=(2, 2))
    q = input("m", "seen by nobody")
    z = state([0.5, 0.25], "m", "position", shape="n")
    road = table(2, "height by position", start=[[0, 7]])
    y = output("m", "what the table says where z[2] is")
    Q = output("N", "force, its first row only", shape=2)

    def derivatives(s):
        return dict(z=-s.z + s.F[1, 0])

    def lookups(s):
        return dict(road=s.z[1])

    def outputs(s):
        return dict(y=s.road[0, 1], Q=s.F[0, :].T + s.time)


@pytest.fixture
def layout() -> Layout:
    """Return the layout of a component with other values than its class has."""
    return Layout.of(Thing(k=5.0, n=2))


def test_slots(layout: Layout) -> None:
    assert layout.reference == {
        "time": 0, "k": 1, "F": 2, "q": 6, "z": 7, "y": 9, "Q": 10, "der(z)": 12, "road": 14,
    }  # fmt: skip
    assert layout.labels() == [
        "time", "k", "F[1,1]", "F[1,2]", "F[2,1]", "F[2,2]", "q", "z[1]", "z[2]",
        "y", "Q[1]", "Q[2]", "der(z[1])", "der(z[2])",
    ]  # fmt: skip


def test_start_values_are_those_of_the_class(layout: Layout) -> None:
    assert layout.start().tolist() == [3.0, 0, 0, 0, 0, 0, 0.5, 0.25]


def test_dependencies(layout: Layout) -> None:
    found = layout.dependencies()
    names = np.array(layout.labels()[: found.shape[1]])
    depends = {unknown: set(names[row]) for unknown, row in zip(layout.labels()[9:], found, strict=True)}
    assert depends == {
        "y": {"z[2]"},  # through the place where the table is read
        "Q[1]": {"time", "F[1,1]"},
        "Q[2]": {"time", "F[1,2]"},
        "der(z[1])": {"z[1]", "F[2,1]"},
        "der(z[2])": {"z[2]", "F[2,1]"},
    }


class Named:
    """A variable as FMPy describes it, as far as it is read."""

    def __init__(self, name: str, reference: int, **about: object) -> None:
        self.name, self.valueReference = name, reference
        self.type, self.causality, self.variability, self.unit = "Real", "input", "continuous", None
        self.declaredType = self.description = self.shape = None
        self.start: str | None = str(reference)
        vars(self).update(about)


class Description:
    """A model description as FMPy gives it, as far as it is read."""

    fmiVersion, unitDefinitions, outputs = "2.0", (), ()

    def __init__(self, *variables: Named) -> None:
        self.modelVariables = variables


def test_scalars_become_arrays_in_any_order() -> None:
    shuffled = [Named(f"P[{i},{j}]", 10 * i + j) for i, j in ((2, 1), (1, 2), (1, 1), (2, 2), (1, 3), (2, 3))]
    variables, references = declared_variables(Description(*shuffled))
    assert list(variables) == ["P"]
    assert variables["P"].shape == (2, 3)
    assert references["P"].values == (11, 12, 13, 21, 22, 23)
    assert variables["P"].start.tolist() == [[11, 12, 13], [21, 22, 23]]


def test_derivatives_of_arrays_are_arrays() -> None:
    variables, _ = declared_variables(Description(Named("der(z[1])", 1), Named("der(z[2])", 2)))
    assert {n: v.shape for n, v in variables.items()} == {"der(z)": (2,)}


@pytest.mark.parametrize(
    "scalars",
    [
        [Named("a[1]", 1), Named("a[3]", 3)],  # a hole
        [Named("a[0]", 1), Named("a[1]", 3)],  # counted from 0
        [Named("a[1]", 1), Named("a[2]", 2, type="Integer")],  # two types
        [Named("a[1]", 1), Named("a[2]", 2, unit="m")],  # two units
        [Named("a[1]", 1), Named("a[1,2]", 2)],  # two shapes
        [Named("a", 1), Named("a[1]", 2)],  # the name is taken
    ],
)
def test_what_is_no_array_stays_scalars(scalars: list[Named]) -> None:
    variables, _ = declared_variables(Description(*scalars))
    assert {n: v.shape for n, v in variables.items()} == {s.name: () for s in scalars}
