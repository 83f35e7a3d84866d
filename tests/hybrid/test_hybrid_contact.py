"""Contact made and lost in the wheels: on request everybody meets there, by announcement or by an indicator."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from studies.catalog import find_scenario
from studies.runner import Result, execute

LOCATED = {"components": {"wheels": {"located": 1}}}
INDICATED = {"run": {"events": {"wheels.contact": "change"}}}
SHORT = {"run": {"duration": 0.12}, "components": {"chassis": {"type": "ChassisModal"}}}


def impact(*changes: dict[str, Any]) -> Result:
    return execute(find_scenario("ramp-impact").load("uncontrolled", [SHORT, *changes]))


@pytest.mark.parametrize("change", [LOCATED, INDICATED], ids=["announced", "indicator"])
def test_everybody_meets_where_contact_is_made_and_lost(change: dict[str, Any]) -> None:
    record = impact(change).record
    met = [t for t, who in record.events if who == "wheels"]
    contact = record["wheels.contact"]
    changed = record.time_ns[1:][np.any(contact[1:] != contact[:-1], axis=1)]
    assert len(changed) >= 4  # the undamped wheels rebound
    assert set(changed) <= set(met)  # no contact changes but at a point everybody meets
    # ... and nobody meets for nothing: left and right wheel may be a rounding, and so a tick, apart.
    assert all(np.min(np.abs(changed - t)) <= 1 for t in met)
    off_grid = np.array(met) % 100_000
    assert np.count_nonzero(off_grid) >= len(met) - 1


def test_located_or_not_the_impact_is_the_same() -> None:
    """The reduced model has the contact inside its step, so locating it changes no more than the coupling's own error.

    That is 7.7e-5 m/s at this macro step.
    """
    plain, located = impact().record, impact(LOCATED).record
    at = np.isin(located.time_ns, plain.time_ns)
    common = np.isin(plain.time_ns, located.time_ns)
    difference = located["body.gap_rate"][at] - plain["body.gap_rate"][common]
    assert np.max(np.abs(difference)) < 7.7e-5
    assert len(located) > len(plain)
