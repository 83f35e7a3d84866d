"""The FMU of a component computes what its Python instance computes: two codes, one set of equations."""

from __future__ import annotations

import numpy as np
import pytest
from specimens import Flow, Mass, Road, Specimen

import fmus
from cosim import Instance
from cosim.clock import NS

# The same operations in the same order: what remains are last-place differences of mathematical functions between
# CasADi's evaluation and the C library, a few ulp (2.2e-16) times the condition of the formulas.
SAME = 1e-12
TOLERANCE = 1e-8  # of both integrators; independent ones agree to a modest multiple of it
STEPS = 100 * TOLERANCE


def prepared(instance: Instance, values: dict[str, np.ndarray], start: int = 0) -> Instance:
    """Initialise an instance with these inputs and states."""
    for name, value in values.items():
        instance.set(name, value)
    instance.enter_initialization(start)
    instance.push()
    instance.exit_initialization()
    instance.pull()
    return instance


def close(a: np.ndarray, b: np.ndarray, tolerance: float, scale: float = 0.0) -> bool:
    """Whether two arrays agree relative to their largest element, or to *scale* if that is larger."""
    largest = max(np.max(np.abs(b), initial=0.0), scale)
    return bool(np.all(np.abs(np.asarray(a) - b) <= tolerance * largest))


def states(instance: Instance) -> dict[str, np.ndarray]:
    return {n: np.asarray(instance.get(n)) for n, v in instance.variables.items() if v.causality == "local"}


def agree(found: Instance, expected: Instance, tolerance: float, scale: float = 0.0) -> None:
    """Compare all outputs, states and derivatives of two instances."""
    for v in expected.outputs:
        a, b = found.y[found.y_at[v.name]], expected.y[expected.y_at[v.name]]
        assert close(a, b, tolerance, scale), f"{v.name}: {a} in the FMU, {b} in Python"
    for name, value in states(expected).items():
        assert close(found.get(name), value, tolerance, scale), (
            f"{name}: {found.get(name)} in the FMU, {value} in Python"
        )


def test_outputs_and_derivatives_agree(specimen: Specimen, fmi: int, rng: np.random.Generator) -> None:
    for trial in range(6):
        values = specimen.values(rng)
        twin = prepared(specimen.component.instance(), values, start=trial * NS)
        fmu = prepared(fmus.instantiate(specimen.component, fmi=fmi), values, start=trial * NS)
        agree(fmu, twin, SAME)
        for name in values:
            assert np.array_equal(fmu.get(name), twin.get(name))
        fmu.close()


def test_sync_agrees(specimen: Specimen, fmi: int, rng: np.random.Generator) -> None:
    if specimen.component.equations.sync is None:
        pytest.skip("has no sync")
    for _ in range(6):
        values = specimen.values(rng)
        twin = prepared(specimen.component.instance(), values)
        fmu = prepared(fmus.instantiate(specimen.component, fmi=fmi), values)
        # The shortest step: sync, and 1 ns of dynamics, in which both integrators are exact to rounding.
        for instance in (twin, fmu):
            instance.step(0, 1)
            instance.pull()
        agree(fmu, twin, SAME)
        fmu.close()


def test_whole_steps_agree(specimen: Specimen, fmi: int, rng: np.random.Generator) -> None:
    values, h = specimen.values(rng), round(specimen.step * NS)
    twin = prepared(specimen.component.instance(), values)
    fmu = prepared(fmus.instantiate(specimen.component, fmi=fmi), values)
    for n in range(specimen.steps):
        for instance in (twin, fmu):
            if n == specimen.steps // 2:
                for name in instance.u_at:
                    instance.u[instance.u_at[name]] *= 0.9
            instance.push()
            instance.step(n * h, (n + 1) * h)
            instance.pull()
    agree(fmu, twin, STEPS, scale=1.0)
    fmu.close()


def test_every_row_is_found(fmi: int, rng: np.random.Generator) -> None:
    """On a key, an ulp beside it, between, before the first and behind the last; forwards, backwards and at random."""
    keys = np.cumsum(rng.uniform(0.01, 1.0, 40))
    rows = np.column_stack([keys, np.arange(40.0), np.zeros(40)])
    asked = np.concatenate([keys, np.nextafter(keys, np.inf), np.nextafter(keys, -np.inf), [keys[0] - 5, keys[-1] + 5]])
    fmu = fmus.instantiate(Road(offset=0.0, pieces=rows), fmi=fmi)
    for order in (np.sort(asked), np.sort(asked)[::-1], rng.permutation(asked)):
        for x in order:
            fmu.set("x", x)
            expected = max(np.searchsorted(keys, x, side="right") - 1, 0)
            assert np.array_equal(fmu.get("height"), [expected, expected]), x


def test_tolerance_of_the_importer_is_used(fmi: int) -> None:
    def end(tolerance: float) -> float:
        fmu = fmus.instantiate(Mass(d=0.0), fmi=fmi)
        fmu.set("F", 0.0)
        fmu.enter_initialization(tolerance=tolerance)
        fmu.push()
        fmu.exit_initialization()
        fmu.step(0, 2 * NS)
        return float(fmu.get("x"))

    exact = 0.1 * np.cos(np.sqrt(50.0 / 2.0) * 2.0)  # x0 cos(w t)
    errors = [abs(end(tolerance) - exact) for tolerance in (1e-4, 1e-6, 1e-10)]
    # proportional to the tolerance but for a factor: a hundredth of the tolerance gains more than a tenth
    assert errors[1] < errors[0] / 10
    assert errors[2] < errors[1] / 10
    assert errors[2] < 1e-9


def test_flow_is_exact(fmi: int) -> None:
    fmu = fmus.instantiate(Flow(w=31.0), fmi=fmi)
    prepared(fmu, {})
    fmu.step(0, NS)
    assert fmu.get("x") == pytest.approx(np.cos(31.0), abs=1e-14)
