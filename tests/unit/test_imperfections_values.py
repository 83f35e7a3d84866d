"""Sensors and actuators: what they show, sample by sample, and what they refuse."""

from typing import Any

import numpy as np
import pytest

from controllers.actuator import Actuator
from controllers.sensor import Sensor
from cosim import DeclarationError
from cosim.twin import PythonInstance

MS = 1_000_000  # ns


def started(component: Any) -> PythonInstance:
    instance: PythonInstance = component.instance()
    instance.enter_initialization()
    instance.exit_initialization()
    return instance


def shown(component: Any, signal: Any, step: int = MS) -> np.ndarray:
    """Return the outputs after each step, with *signal* (n, ...) as input over it."""
    instance, rows = started(component), []
    for k, value in enumerate(np.asarray(signal, float)):
        instance.u[:] = np.ravel(value)
        instance.push()
        instance.step(k * step, (k + 1) * step)
        instance.pull()
        rows.append(instance.y.copy())
    return np.array(rows)


def test_a_perfect_sensor_shows_what_it_sees_to_the_bit() -> None:
    signal = np.random.default_rng(1).standard_normal((20, 4, 4)) * 1e-5
    np.testing.assert_array_equal(shown(Sensor(shape=[4, 4], unit="1/kg"), signal), signal.reshape(20, 16))


def test_it_holds_its_sample_until_the_next_tick() -> None:
    found = shown(Sensor(period=3e-3), np.arange(9.0))
    np.testing.assert_array_equal(found.ravel(), [0, 0, 0, 3, 3, 3, 6, 6, 6])


@pytest.mark.parametrize("delay", [1, 3])
def test_it_shows_what_was_measured_some_ticks_ago_and_first_the_first(delay: int) -> None:
    signal = np.arange(10.0)[:, None] + [5.0, 105.0]
    found = shown(Sensor(shape=[2], delay=delay), signal)
    expected = np.vstack([np.repeat(signal[:1], delay, axis=0), signal[:-delay]])
    np.testing.assert_array_equal(found, expected)


def test_a_matrix_is_delayed_element_by_element() -> None:
    signal = np.arange(4 * 6.0).reshape(4, 2, 3)
    found = shown(Sensor(shape=[2, 3], delay=1), signal)
    np.testing.assert_array_equal(found.reshape(4, 2, 3), signal[[0, 0, 1, 2]])


def test_it_shows_multiples_of_its_quantum() -> None:
    signal = [0.124, 0.126, -0.124, -0.126, 0.375, 7.0]  # 0.375 lies between two: halves go upwards
    np.testing.assert_array_equal(shown(Sensor(quantum=0.25), signal).ravel(), [0.0, 0.25, 0.0, -0.25, 0.5, 7.0])


def test_noise_comes_before_quantisation_and_both_before_the_delay() -> None:
    signal = np.linspace(-1, 1, 40)
    noisy = shown(Sensor(noise=0.3, seed=5), signal)
    both = shown(Sensor(noise=0.3, seed=5, quantum=0.5, delay=1), signal)
    np.testing.assert_array_equal(both[1:], 0.5 * np.floor(noisy[:-1] / 0.5 + 0.5))


def test_the_same_seed_gives_the_same_noise_and_another_another() -> None:
    signal = np.zeros((30, 2))
    one, again, other = (shown(Sensor(shape=[2], noise=1.0, seed=s), signal) for s in (3, 3, 4))
    np.testing.assert_array_equal(one, again)
    assert not np.any(one == other)
    assert not np.any(one[:, 0] == one[:, 1])


def test_noise_is_the_same_after_going_back() -> None:
    instance = started(Sensor(noise=1.0, delay=2))
    instance.step(0, 5 * MS)
    saved = instance.snapshot()
    rows = []
    for _ in range(2):
        instance.restore(saved)
        instance.step(5 * MS, 12 * MS)
        instance.pull()
        rows.append(instance.y.copy())
    np.testing.assert_array_equal(rows[0], rows[1])


def test_noise_does_not_depend_on_how_the_time_is_cut_into_steps() -> None:
    signal = np.zeros(20)
    fine = shown(Sensor(noise=1.0), signal)
    coarse = shown(Sensor(noise=1.0), signal[::5], 5 * MS)
    np.testing.assert_array_equal(coarse, fine[4::5])


def test_a_perfect_actuator_gives_what_is_asked_to_the_bit() -> None:
    signal = np.random.default_rng(1).standard_normal((20, 3)) * 1e3
    np.testing.assert_array_equal(shown(Actuator(shape=[3], unit="N"), signal), signal)


def test_an_actuator_saturates_on_both_sides() -> None:
    np.testing.assert_array_equal(shown(Actuator(limit=2.0), [1, 3, -1, -3]).ravel(), [1, 2, -1, -2])


def test_an_actuator_without_a_lag_moves_at_its_largest_rate_and_stops_where_it_is_asked_to_be() -> None:
    found = shown(Actuator(rate_limit=400.0), [1.0, 1.0, 1.0, 1.0, -1.0])
    # 0.4 a step; rounding of the sums
    np.testing.assert_allclose(found.ravel(), [0.4, 0.8, 1.0, 1.0, 0.6], rtol=1e-14)


def test_every_element_can_have_numbers_of_its_own() -> None:
    signal = np.full((3, 2), 10.0)
    found = shown(Sensor(shape=[2], noise=[0.0, 1.0], quantum=[4.0, 0.0]), signal)
    np.testing.assert_array_equal(found[:, 0], 12.0)
    assert np.all(found[:, 1] != 10.0)
    np.testing.assert_array_equal(shown(Actuator(shape=[2], limit=[3.0, 0.0]), signal), [[3.0, 10.0]] * 3)


@pytest.mark.parametrize(
    ("kind", "values", "sentence"),
    [
        (Sensor, {"noise": -1.0}, "Sensor.noise is -1; it must be 0 or positive"),
        (Sensor, {"quantum": -0.5}, "Sensor.quantum is -0.5; it must be 0 or positive"),
        (Sensor, {"seed": 1.5}, "Sensor.seed is 1.5; it must be a whole number from 0 to 1048575"),
        (Sensor, {"seed": 2**20}, "Sensor.seed is 1048576.0; it must be a whole number from 0 to 1048575"),
        (Sensor, {"shape": [33, 32]}, "Sensor.shape has 1056 elements; there is noise for 1024"),
        (Sensor, {"delay": 1.5}, "Sensor.delay must be a whole number, not 1.5"),
        (Actuator, {"lag": -1e-3}, "Actuator.lag is -0.001; it must be 0 or positive"),
        (Actuator, {"limit": [1.0, -1.0], "shape": [2]}, "Actuator.limit is -1; it must be 0 or positive"),
    ],
)
def test_what_no_device_can_be_is_refused(kind: Any, values: dict[str, Any], sentence: str) -> None:
    with pytest.raises(DeclarationError) as caught:
        kind(**values)
    assert str(caught.value) == sentence
