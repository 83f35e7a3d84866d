"""The rows of slip and friction of the verdict against sums by hand."""

import numpy as np
import pytest

from studies.metrics import control, slip

TIME = np.array([0.0, 0.1, 0.2])


def row(signals: dict[str, np.ndarray], key: str) -> float | None:
    return next(m.value for m in slip.figures(TIME, signals.get) if m.key == key)


def test_the_work_of_the_motors_counts_driving_and_braking() -> None:
    torque = np.array([[9.0] * 4, [2.0, 0.0, 0.0, -1.0], [1.0, 0.0, 0.0, 0.0]])
    spin = np.array([[9.0] * 4, [10.0, 5.0, 5.0, 10.0], [20.0, 5.0, 5.0, 10.0]])
    found = slip.motor_energy(TIME, {"drive.torque": torque, "drive.spin": spin}.get)
    assert found == pytest.approx(0.1 * (20 + 10) + 0.1 * 20)
    assert slip.motor_energy(TIME, {"drive.torque": torque}.get) is None


def test_slip_counts_in_both_directions() -> None:
    signals = {"drive.slip": np.array([[0.1, -0.3, 0.0, 0.2]]), "drive.slip_energy": np.array([1.0, 2.5])}
    assert row(signals, "slip_peak") == pytest.approx(0.3)
    assert row(signals, "slip_loss") == pytest.approx(2.5)
    assert row({}, "slip_peak") is None


def test_the_share_of_the_ellipse_leaves_out_wheels_without_load() -> None:
    signals = {
        "wheels.traction": np.array([[30.0, 0.0, 0.5, 0.0]]),
        "wheels.lateral": np.array([[40.0, -60.0, 0.0, 0.0]]),
        "wheels.friction_limit": np.array([[100.0, 80.0, 0.5, 0.0]]),
    }
    assert row(signals, "ellipse_used") == pytest.approx(0.75)
    assert row(signals, "lateral_peak") == pytest.approx(60.0)
    assert row({**signals, "wheels.lateral": np.zeros((1, 4))}, "ellipse_used") is None


@pytest.mark.parametrize(("mu", "used", "saturated"), [(0.5, 0.8, 50.0), (1e6, None, None)])
def test_without_a_limit_no_share_of_it_is_used(mu: float, used: float | None, saturated: float | None) -> None:
    """The load is 100 N; one of two steps ends with a wheel that slides on less than the limit."""
    signals = {
        "wheels.traction": np.array([[0.0] * 4, [40.0, 0.0, 0.0, 0.0], [20.0, 0.0, 0.0, 0.0]]),
        "wheels.lateral": np.full((3, 4), 30.0),
        "wheels.normal_force": np.full((3, 4), 100.0),
        "wheels.friction_limit": np.full((3, 4), 100.0 * mu),
        "wheels.sliding": np.array([[0.0] * 4, [0.0] * 4, [1.0, 0.0, 0.0, 0.0]]),
    }
    found = {m.key: m.value for m in control.figures(TIME, signals.get)}
    assert found["friction_used"] == (used if used is None else pytest.approx(used))
    assert found["saturated"] == (saturated if saturated is None else pytest.approx(saturated))
    assert found["friction_needed"] == pytest.approx(0.4)
    assert row(signals, "ellipse_used") == (used if used is None else pytest.approx(1.0))
