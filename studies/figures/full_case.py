"""Runs of the full-order robot that several figures show, each done once."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np

from cosim.errors import ScenarioError

from ..catalog import find_scenario
from ..metrics import as_mapping
from ..runner import Result, execute

SCENARIO = "full-order-ramp"
IMPACT = 0.3  # s, when its front wheels meet the ramp
ASSUMED = (
    "rings of 0.83 kg with 32 nodes (Table 6.2), k_w = 5.6e6 N/m per axle (Fig 6.9) by a press test; rim inertia "
    "0.01 kg.m2, how the rings bend and stretch, and how the forces were applied are not given"
)


@cache
def run(variant: str, scenario: str = SCENARIO) -> Result:
    """Return the run of a variant; raises ScenarioError if it fails."""
    result = execute(find_scenario(scenario).load(variant))
    if result.error is not None:
        raise ScenarioError(f"{scenario}, {variant}: {result.error}")
    return result


def value(variant: str, key: str) -> float:
    """Return a figure of the verdict on a run of the ramp; 0 where there is none."""
    return float(as_mapping(run(variant).metrics)[key] or 0.0)


def axle_force(variant: str, wheels: slice) -> np.ndarray:
    """Return the normal force (n,) in N of an axle."""
    F = run(variant).signal("wheels.normal_force")
    assert F is not None
    return np.asarray(F[:, wheels].sum(axis=1))


def per_axle(variants: Sequence[str], key: str, unit: str, scale: float = 1.0) -> str:
    """Return a figure of the verdicts, one after the other, as text."""
    return ", ".join(f"{v} {scale * value(v, key):.4g} {unit}".rstrip() for v in variants)
