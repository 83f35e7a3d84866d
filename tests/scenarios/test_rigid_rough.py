"""The claim of rigid-rough: contacts are lost and regained for a minute, without sticking, sinking in or chatter."""

import numpy as np
import pytest
from rigid_checks import assert_keeps_the_laws_of_contact, chatter, depths, touchdowns

from studies.catalog import find_scenario
from studies.runner import execute


@pytest.mark.parametrize(("variant", "duration"), [("straight", 60.0), ("slalom", 60.0), ("bouncing", 15.0)])
def test_contacts_are_lost_and_regained_without_sticking_or_drift(variant: str, duration: float) -> None:
    result = execute(find_scenario("rigid-rough").load(variant, [{"run": {"duration": duration}}]))
    record, step = result.record, result.scenario.run.step
    assert record.time[-1] == duration
    assert_keeps_the_laws_of_contact(record, step)

    assert np.all(touchdowns(record) >= duration)  # once a second and more
    lost = record["wheels.contact"] < 0.5
    assert np.all(np.sum(lost, axis=0) * step > 0.02 * duration)  # for a share of the time that is no chatter
    assert np.all(chatter(record) < 1e-3)

    tenth = len(record) // 10
    deep, bound = depths(record, step, slice(-tenth, None))  # by the landings of the last tenth alone
    assert np.all(deep <= bound)
    assert record["body.position"][-1, 0] > 1.5 * duration  # it got along, at three quarters of the speed or more
    if variant == "slalom":
        assert np.max(np.abs(record["wheels.lateral"])) > 300  # N: it steers by friction, beyond half a wheel's load
        yaw = np.unwrap(2 * np.arctan2(record["body.orientation"][:, 3], record["body.orientation"][:, 0]))
        assert np.ptp(yaw) > 0.3
