"""Directional derivatives of the FMU are the slopes of its own outputs and derivatives."""

from __future__ import annotations

import numpy as np
import pytest
from specimens import Mass, Specimen
from test_twin_agreement import prepared

import fmus
from cosim import WiringError


def response(specimen: Specimen, fmi: int, values: dict[str, np.ndarray], unknowns: list[str]) -> np.ndarray:
    fmu = prepared(fmus.instantiate(specimen.component, fmi=fmi), values)
    found = np.concatenate([np.zeros(0), *(np.ravel(fmu.get(n)) for n in unknowns)])
    fmu.close()
    return found


def test_directional_derivatives_are_slopes(specimen: Specimen, fmi: int, rng: np.random.Generator) -> None:
    variables = specimen.component.variables
    values = specimen.values(rng)
    unknowns = [n for n, v in variables.items() if v.causality == "output" or n.startswith("der(")]
    seeds = {n: rng.standard_normal(np.shape(v)) * (0.1 + np.abs(v)) for n, v in values.items()}
    fmu = prepared(fmus.instantiate(specimen.component, fmi=fmi), values)
    seed = np.concatenate([np.zeros(0), *(np.ravel(v) for v in seeds.values())])
    exact = fmu.directional_derivative(unknowns, list(seeds), seed)
    # Central differences: truncation d^2 f'''/6 and rounding eps f/d balance near d = 1e-5 at an error of about 1e-10.
    d = 1e-5
    ahead, behind = (
        response(specimen, fmi, {n: v + sign * d * seeds[n] for n, v in values.items()}, unknowns) for sign in (1, -1)
    )
    slopes = (ahead - behind) / (2 * d)
    scale = max(1.0, float(np.max(np.abs(exact), initial=0)), float(np.max(np.abs(ahead), initial=0)))
    assert np.max(np.abs(exact - slopes), initial=0) < 1e-7 * scale
    assert exact.size == 0 or np.any(exact != 0) or specimen.component.equations.sync is not None


def test_one_column_at_a_time(fmi: int) -> None:
    fmu = prepared(fmus.instantiate(Mass(m=2.0, k=50.0, d=0.4), fmi=fmi), {"F": np.array(3.0)})
    assert fmu.directional_derivative(["der(v)"], ["F"], np.array([1.0])) == pytest.approx([0.5])
    assert fmu.directional_derivative(["der(v)"], ["x"], np.array([2.0])) == pytest.approx([-50.0])
    assert fmu.directional_derivative(["power", "der(x)"], ["v"], np.array([1.0])) == pytest.approx([3.0, 1.0])
    with pytest.raises(WiringError, match="was given a seed of 2 numbers for F"):
        fmu.directional_derivative(["der(v)"], ["F"], np.ones(2))
